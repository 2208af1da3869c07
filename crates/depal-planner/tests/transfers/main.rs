//! Ways among boxes, judged by an oracle that shares nothing with the planner but the arm's forward kinematics.

mod cell;
mod hard;
mod hard_set;
mod oracle;
mod pallet;
mod promise;
