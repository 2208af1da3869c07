//! What a cell shows to those who record it. Observers change nothing.

use depal_frames::{DepthFrame, JointPositions, Point, Pose};
use depal_time::SimTime;

use crate::event::Event;

/// Everything that moves, at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// When.
    pub time: SimTime,
    /// Commanded joints, radians.
    pub joints: JointPositions,
    /// World poses of the arm's links, in the arm's order.
    pub world_from_links: Vec<Pose>,
    /// World pose of the tool centre point.
    pub world_from_tcp: Pose,
    /// Vacuum of each section, Pa below ambient.
    pub section_vacuum: Vec<f64>,
    /// Valve of each section.
    pub valves: Vec<bool>,
    /// Cartons still in the cell.
    pub cartons: Vec<CartonView>,
}

/// One carton in a snapshot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartonView {
    /// Its number.
    pub id: u32,
    /// World pose of its geometric centre.
    pub world_from_centre: Pose,
    /// Length, width, height, metres.
    pub size: [f64; 3],
    /// What is happening to it.
    pub state: CartonViewState,
}

/// State of a carton for display.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CartonViewState {
    /// On the pallet.
    Waiting,
    /// Aimed at by the plan in execution.
    Target,
    /// Hanging on the gripper.
    Gripped,
    /// On the conveyor.
    Placed,
    /// Lost.
    Lost,
}

/// A frame and what vision made of it.
#[derive(Debug, Clone)]
pub struct CaptureView<'a> {
    /// When it was exposed.
    pub time: SimTime,
    /// Frame counter, from 1.
    pub number: u32,
    /// What vision saw.
    pub frame: &'a DepthFrame,
    /// Calibrated camera pose.
    pub world_from_camera: Pose,
    /// World poses of the reported top faces and their sizes (length, width, height).
    pub detections: Vec<(Pose, [f64; 3])>,
    /// World poses of the true top faces that should have been found, and their sizes.
    pub truth: Vec<(Pose, [f64; 3])>,
    /// Leftover points that the planner keeps clear of, world frame.
    pub obstacle_points: Vec<Point>,
}

/// Someone who records a run.
pub trait Observer {
    /// An event was logged.
    fn on_event(&mut self, event: &Event);
    /// The state of the cell, about 25 times a simulated second.
    fn on_snapshot(&mut self, snapshot: &Snapshot);
    /// A frame was taken and evaluated.
    fn on_capture(&mut self, capture: &CaptureView<'_>);
}
