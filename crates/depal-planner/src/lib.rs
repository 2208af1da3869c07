//! Which box to pick, with which sections, and a collision-free way there and back.
//!
//! [`plan_pick`] takes what vision saw (boxes and leftover points), what is known of the cell, where the arm is and where
//! the carton shall go. It answers with at most [`PlannerSettings::max_waypoints`] waypoints or with a [`Refusal`]
//! that names every candidate and its reason. Same request, same waypoints.
//!
//! It must never know: the true world, physics, vision's inner workings, protocols, time.
//!
//! How it decides:
//! 1. Order: boxes of the top layer first (within half a height), nearest to the place first; covered ones are left out.
//!    With [`PlannerSettings::max_group`] above 1 the layer is divided into the fewest picks: rectangles of like boxes
//!    side by side, each of which the gripper can hold and the arm carry, so that no box is left alone without need.
//!    The boxes of a group that cannot be picked together come again one by one.
//! 2. Grasp: every rectangle of neighbouring sections whose cups lie wholly on faces of the group, none on a gap or on a
//!    box beside it, in four yaws; more sealed area first, then less offset. Only what holds
//!    [`PlannerSettings::max_carton_mass`] on every face is kept.
//! 3. Joints: all branches and turns of the inverse at pick and place, sorted by obstacle-free time.
//! 4. Path: direct joint move, then turn-while-raised and lift-turn-lower templates, in order of their time;
//!    checked with padded bodies, corner chords included. Where all of them are blocked, a seeded search with two trees.
//! 5. Certificate: the chosen path once more with true bodies, by bisection on distance until nothing can touch between
//!    two checked states. It yields [`PickPlan::min_clearance`].
//!
//! How candidates are ordered and reduced:
//! - A layer is gone through twice: every group with its best grasps, then every group with the rest of them and the search.
//!   A layer below is looked at only when this one has failed. The first group that has a way wins; what was turned down
//!   before it stands in [`PickPlan::rejected`] in that order, and [`Refusal::NothingFits`] has them all.
//! - In a group, equally good grasps, the turns at the place and all joints at both ends are one list by obstacle-free
//!   time ([`PlannerSettings::attempts_per_grasp`] of it), each with the low lift and then with the high one; first one wins.
//! - Such a list is tried by all threads of the rayon pool: the first candidate by itself, the others in batches of four.
//!   A batch is reduced from its front: failures up to the first success count, everything after it is dropped, whichever
//!   thread was done first. What always has to be known of all (reach and touches of grasps, both free moves of a way,
//!   distances along it) is collected in its order. So plan, reasons and clearance have the same bits with any number of
//!   threads, and a single thread does no more than it would alone.
//!
//! [`plan_transfer`] answers a narrower question for any arm: from one posture to another (or to a tool pose) among boxes,
//! as fast as the limits of the arm allow. It tries the straight joint move, raised vias and a seeded search, bends the way
//! by small changes while that saves time, flies its corners as parabolas, and proves it on the bare bodies.
//! Its effort is counted in checks, so the answer does not depend on the computer.
//!
//! Times are those of `depal-motion`, which also moves the arm: [`PickPlan::estimated_time`] and
//! [`TransferPlan::motion_time`] are what a cabinet takes, within 1 %. Torques count in both where the arm has limits for
//! them, with the gripper and the assumed cartons or with [`TransferScene::load`]. They do not count where ways are
//! compared during the search, nor in [`TransferPlan::lower_bound`].
//!
//! [`TransferChecker`] answers single questions about the same scene: what touches, what is free, how near things are.
//!
//! Units: metres, radians, seconds, kilograms, f64; collision checks run in f32.
//! Frames: everything in the arm's base frame, Z up; a box frame sits in the middle of the top face, Z up, X along the long side.
//!
//! What lies below a seen box is unknown: it is treated as solid down to the floor, as wide as the box.
//!
//! ```
//! use depal_planner::{PlannerSettings, Refusal};
//! let settings = PlannerSettings { max_carton_mass: 12.0, ..PlannerSettings::default() };
//! assert_eq!(settings.max_waypoints, 20);
//! assert_eq!(Refusal::NoBoxes.to_string(), "no boxes were seen");
//! ```
//!
//! Limitations: groups are rectangles of like boxes turned alike, centred on their sections; boxes must stand upright (a few degrees of tilt).
//! [`plan_transfer`] gives joint moves only and needs 1.5 mm of room at both ends.

mod bodies;
mod bounds;
mod candidate;
mod certificate;
mod contact;
mod given;
mod grasp;
mod group;
mod in_order;
mod path;
mod pick;
mod plan;
mod planner;
mod refusal;
mod request;
mod search;
mod situation;
mod suction;
mod timing;
mod transfer;
mod tree;
mod world;

pub use given::{GivenMove, MoveRefusal, check_moves};
pub use plan::{Motion, PickPlan, Waypoint};
pub use planner::plan_pick;
pub use refusal::{Obstacle, Refusal, RejectReason, Rejection, Stage, Touch};
pub use request::{PlaceSpec, PlanRequest, PlannerSettings, SeenBox};
pub use transfer::{
    TransferChecker, TransferGoal, TransferPlan, TransferRefusal, TransferScene, TransferWaypoint,
    plan_transfer,
};

#[cfg(test)]
mod tests;
