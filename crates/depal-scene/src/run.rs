//! Planning settings, the limits of a run and what makes it accepted.

use crate::reader::section;
use crate::rules::{Flag, Maybe, Number, SHARE, above, number, whole};

const COUNT: Number = number(0.0, 1e9);

section! {
    /// Settings of the path planner.
    pub struct Planner {
        /// Clear distance that a transfer keeps from everything, mm.
        /// Default 20: covers vision errors and the swing of a carried carton; more makes longer ways.
        clearance_mm: f64, number(0.0, 1000.0), default(20.0);
        /// Clear distance while a carton leaves its neighbours, mm.
        /// Default 0: cartons stand 2 mm apart and less.
        extraction_clearance_mm: f64, number(0.0, 100.0), default(0.0);
        /// Straight way up out of the stack before the carton may turn, mm.
        /// Default 300: a carton of 250 mm is out of its layer.
        lift_mm: f64, number(0.0, 5000.0), default(300.0);
        /// Straight way down onto a carton or the conveyor, mm.
        /// Default 150: time to slow down before the touch; more takes longer.
        approach_mm: f64, number(0.0, 5000.0), default(150.0);
        /// Most waypoints of one path.
        /// Default 20: one reply of the interface.
        max_waypoints: u32, whole(2, 500), default(20);
        /// Holding force over the load, at least, when the speed of a carried carton is chosen.
        /// Default 2: the usual factor for porous goods; more is slower and drops less.
        suction_safety: f64, number(1.0, 20.0), default(2.0);
        /// Mass that a carton is taken to have, kg, for want of a scale.
        /// Default 20: the heaviest of the default range.
        assumed_mass_kg: f64, above(0.0, 1000.0), default(20.0);
    }
}

section! {
    /// Limits of a run.
    pub struct Run {
        /// Simulated time after which a run is stopped, s.
        /// Default 1200: 48 cartons at 144 in an hour.
        max_sim_s: f64, above(0.0, 1e6), default(1200.0);
        /// Whether the program may end while cartons are left.
        /// Default false: a pallet is to be emptied.
        may_leave_cartons: bool, Flag, default(false);
    }
}

section! {
    /// Thresholds that a run must keep to be accepted; what is left out is not looked at.
    pub struct Accept {
        /// Cartons delivered, at least.
        delivered_min: Option<f64>, Maybe(COUNT), default(None);
        /// Cartons dropped, at most.
        dropped_max: Option<f64>, Maybe(COUNT), default(None);
        /// Picks succeeded over picks attempted, at least.
        pick_success_min: Option<f64>, Maybe(SHARE), default(None);
        /// Cartons delivered per hour of simulated time, at least.
        boxes_per_hour_min: Option<f64>, Maybe(COUNT), default(None);
        /// Cartons found over cartons that could be seen whole, at least.
        vision_recall_min: Option<f64>, Maybe(SHARE), default(None);
        /// Cartons reported where none is, at most.
        false_picks_max: Option<f64>, Maybe(COUNT), default(None);
        /// Error of position that 95 of 100 estimates keep, mm, at most.
        pose_err_mm_p95_max: Option<f64>, Maybe(number(0.0, 1e6)), default(None);
        /// Error of direction that 95 of 100 estimates keep, degrees, at most.
        pose_err_deg_p95_max: Option<f64>, Maybe(number(0.0, 180.0)), default(None);
    }
}
