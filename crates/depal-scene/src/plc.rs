//! A controller of another make that runs the arm over an S7 data block, in place of a robot program.

use crate::choice::{choice, one_of};
use crate::reader::section;
use crate::rules::{ListOf, Maybe, Numbers, above, number, table, whole};

choice! {
    /// Who plans the path.
    pub enum PathSource {
        /// The Viz project: commands 201, 205 or 210, and 206.
        Viz = "viz",
        /// The vision project: commands 101, 105 or 210, and 206.
        Vision = "vision",
    }
}

choice! {
    /// How the path is fetched.
    pub enum PathFetch {
        /// 210: waypoints with motion types and velocities.
        PlanData = "plan_data",
        /// 205, or 105 of a vision project: waypoints alone.
        Path = "path",
    }
}

section! {
    /// An exit of a branch step that the program chooses in every run, with command 203.
    pub struct BranchChoice {
        /// Number of the branch step.
        step: u32, whole(1, 99), required;
        /// Exit, from 1.
        exit: u32, whole(1, 99), required;
    }
}

section! {
    /// The sequence of a Siemens controller. Vision polls its data block; the arm obeys it.
    pub struct Plc {
        /// Data block that vision polls.
        /// Default 1: the block of the interface's own example.
        db: u32, whole(1, 65_535), default(1);
        /// Rack of the controller.
        /// Default 0: that of an S7-1200 and S7-1500.
        rack: u32, whole(0, 7), default(0);
        /// Slot of the controller.
        /// Default 1: that of an S7-1200 and S7-1500.
        slot: u32, whole(0, 31), default(1);
        /// How often vision reads the block, ms.
        /// Default 20: the shortest of the interface's own setting.
        poll_ms: f64, number(1.0, 10_000.0), default(20.0);
        /// Number of the vision project.
        /// Default 1: the first.
        project: u32, whole(1, 99), default(1);
        /// Who plans.
        /// Default viz: the path project.
        source: PathSource, one_of(), default(PathSource::Viz);
        /// How the path is fetched.
        /// Default plan_data: with motion types and velocities.
        fetch: PathFetch, one_of(), default(PathFetch::PlanData);
        /// Size that 501 sets before the first run, mm.
        /// Default none: the project's own sizes hold.
        box_mm: Option<[f64; 3]>, Maybe(Numbers::<3>(above(0.0, 10_000.0))), default(None);
        /// Exits that 203 chooses after each 201.
        /// Default none.
        branch: Vec<BranchChoice>, ListOf(table(), 0, 16), default(Vec::new());
        /// How long the vacuum may take to build up, s.
        /// Default 1.5: a zone of this size takes a third of it.
        vacuum_s: f64, number(0.0, 60.0), default(1.5);
        /// How long the program waits for the first heartbeat of vision, s.
        /// Default 30: longer than the longest pause of a reconnecting vision server.
        vision_wait_s: f64, above(0.0, 3600.0), default(30.0);
        /// Straight way up after the release, mm.
        /// Default 150: clear of the carton.
        retreat_mm: f64, number(0.0, 5000.0), default(150.0);
        /// Velocity of waypoints that come without one, percent.
        /// Default 60: heavy cartons hold.
        path_percent: f64, above(0.0, 100.0), default(60.0);
        /// Failed picks in a row before the program gives up.
        /// Default 3.
        failures_max: u32, whole(1, 99), default(3);
    }
}
