//! From one posture to another among boxes: the way that `depal plan` gives.
//!
//! The ladder: the straight joint move; raised vias in several heights; two random trees with a fixed seed.
//! What it finds is then bent by small seeded changes while that saves time, and proved on the bare bodies.
//! Ways are compared by their times at the speed and acceleration limits of the joints; torques, where the arm has
//! limits for them, count in the time of the way that is given, and a way on which they could not hold the arm is none.
//! Effort is counted in checks, never in seconds: the same question gets the same answer everywhere.

mod blends;
mod certificate;
mod checker;
pub(crate) mod oriented;
mod refine;
mod request;
mod route;
mod scene;
mod solid;
mod tree;
mod ways;

pub use checker::TransferChecker;
pub use request::{TransferGoal, TransferPlan, TransferRefusal, TransferScene, TransferWaypoint};
pub use route::plan_transfer;
