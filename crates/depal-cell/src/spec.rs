//! Everything a cell is made of, in SI units: what a scene file comes down to.

use std::collections::BTreeMap;
use std::sync::Arc;

use depal_arm::Arm;
use depal_camera::{CameraSpec, Mounting};
use depal_controller::ControllerSpec;
use depal_frames::{BoxSize, PlacedShape, Pose, Vector};
use depal_gripper::GripperSpec;
use depal_interface::{self as interface, ServerSettings};
use depal_planner::{PlaceSpec, PlannerSettings};
use depal_time::SimDuration;
use depal_vision::{RegionOfInterest, VisionSettings};
use depal_workflow::Project;
use depal_world::{CartonSpec, WorldSpec};

use crate::calibration::CalibrationSpec;
use crate::skin::CartonSkin;

/// The whole cell before its first tick.
#[derive(Debug, Clone)]
pub struct CellSpec {
    /// Name of the scene.
    pub scene: String,
    /// Seed of everything random.
    pub seed: u64,
    /// The arm.
    pub arm: Arc<Arm>,
    /// Where its base stands.
    pub world_from_base: Pose,
    /// The tool.
    pub gripper: GripperSpec,
    /// What the vacuum pump really reaches, Pa below ambient; the gripper's switches keep their rating.
    pub available_vacuum: f64,
    /// Signals between cabinet and gripper.
    pub wiring: GripperWiring,
    /// Floor, pallet, fences, conveyors and the physics' settings.
    pub world: WorldSpec,
    /// Cartons as they are stacked, before they settle.
    pub cartons: Vec<CartonSpec>,
    /// What the camera sees of them, in the same order; beyond its end they are of brown board, without tape.
    pub skins: Vec<CartonSkin>,
    /// How long they settle before the start.
    pub settle_time: SimDuration,
    /// The camera.
    pub camera: CameraSpec,
    /// What carries the camera, and where it really is.
    pub mounting: Mounting,
    /// Where calibration says the camera is: in the robot base, or on the flange if that carries it. Vision
    /// results reach the robot through this pose alone, see [`CellSpec::base_from_camera`].
    pub carrier_from_camera: Pose,
    /// The board for command 701; absent: no calibration is set up.
    pub calibration: Option<CalibrationSpec>,
    /// The vision projects by number.
    pub projects: BTreeMap<i32, VisionProject>,
    /// The planning project.
    pub workflow: Project,
    /// The vision server.
    pub interface: ServerSettings,
    /// The port that the robot program connects to.
    pub port: u16,
    /// Present if the robot task is a controller with a data block: then vision connects to the task and polls
    /// the block, instead of the task connecting to vision, and the sessions are those of
    /// [`depal_interface::plc_port`].
    pub plc: Option<PlcPort>,
    /// The cabinet.
    pub controller: ControllerSpec,
    /// What the planner knows about the cell, base frame: floor, pallet, conveyor, fences.
    pub known_obstacles: Vec<PlacedShape>,
    /// Where cartons go.
    pub place: PlaceSpec,
    /// Tunables of the planner.
    pub planner: PlannerSettings,
    /// How long things take, in simulated time.
    pub latencies: Latencies,
    /// After this the run is over.
    pub time_limit: SimDuration,
    /// The program may end while cartons are left; else that is a failure.
    pub may_leave_cartons: bool,
}

/// One vision project: what a user would have typed in.
#[derive(Debug, Clone)]
pub struct VisionProject {
    /// Its number.
    pub id: i32,
    /// Settings of the estimation, sizes of the first recipe included, without a region.
    pub settings: VisionSettings,
    /// Where cartons are looked for; absent: everywhere in view.
    pub region: Option<Region>,
    /// What goes out as label with a carton of each size; empty: the size's place in the list, from 0.
    pub labels: Vec<String>,
    /// What a recipe number switches it to.
    pub recipes: BTreeMap<i32, Recipe>,
    /// Data of the project's own that goes out with every point.
    pub custom_ports: Vec<CustomPort>,
    /// The project plans a path by these steps, the recognition included; absent: it gives points.
    pub path: Option<Project>,
}

/// What a vision project looks for once a recipe has been switched to.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// The known sizes.
    pub sizes: Vec<BoxSize>,
    /// What goes out as label with a carton of each size, as in [`VisionProject::labels`].
    pub labels: Vec<String>,
}

/// A box in which cartons are looked for. It stays where it is, wherever the camera goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Its middle and axes in the robot base.
    pub base_from_region: Pose,
    /// Half of its sides, metres.
    pub half_extents: Vector,
}

/// Data of a vision project's own under a name.
#[derive(Debug, Clone, PartialEq)]
pub struct CustomPort {
    /// The name: the server sends ports in its byte order.
    pub name: String,
    /// What it gives.
    pub rows: CustomRows,
}

/// What a custom port gives.
#[derive(Debug, Clone, PartialEq)]
pub enum CustomRows {
    /// The same numbers with every point.
    Same(Vec<f64>),
    /// A row of its own for each point, in the order of the points.
    ByPoint(Vec<Vec<f64>>),
}

impl VisionProject {
    /// The settings for a picture that was taken from there, the region in the camera frame.
    pub fn settings_from(&self, base_from_camera: &Pose) -> VisionSettings {
        let camera_from_base = base_from_camera.inverse();
        VisionSettings {
            region: self.region.as_ref().map(|region| RegionOfInterest {
                camera_from_region: camera_from_base * region.base_from_region,
                half_extents: region.half_extents,
            }),
            ..self.settings.clone()
        }
    }

    /// What goes out with each of `points` points, a row of every port for each.
    ///
    /// # Errors
    /// The name of a port whose rows are not as many as the points (1024).
    pub fn custom_rows(&self, points: usize) -> Result<Vec<interface::CustomPort>, &str> {
        let filled = |port: &CustomPort| match &port.rows {
            CustomRows::Same(row) => Some(vec![row.clone(); points]),
            CustomRows::ByPoint(rows) => (rows.len() == points).then(|| rows.clone()),
        };
        let ports = self.custom_ports.iter().map(|port| {
            let rows = filled(port).ok_or(port.name.as_str())?;
            let name = port.name.clone();
            Ok(interface::CustomPort { name, rows })
        });
        ports.collect()
    }
}

/// The data block of a controller, as vision reaches it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlcPort {
    /// Where the controller listens; 102 as a rule.
    pub port: u16,
    /// Number of the block.
    pub db: u16,
    /// Rack of the processor.
    pub rack: u8,
    /// Its slot.
    pub slot: u8,
    /// How often Command Trigger is looked at.
    pub poll: SimDuration,
}

/// Signals between cabinet and gripper.
#[derive(Debug, Clone, PartialEq)]
pub struct GripperWiring {
    /// What switches the sections.
    pub sections: SectionSignals,
    /// Digital input: every switched-on section holds vacuum.
    pub vacuum_ok: String,
}

/// The outputs of the cabinet that switch the gripper's sections.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionSignals {
    /// Group outputs of 16 bits; digital output `d` of a section is bit `d % 16` of group `d / 16`.
    Groups(Vec<String>),
    /// One digital output for each section, in the order of the sections.
    Single(Vec<String>),
}

impl SectionSignals {
    /// The names of all outputs.
    pub fn names(&self) -> &[String] {
        match self {
            Self::Groups(names) | Self::Single(names) => names,
        }
    }
}

/// How long things take, in simulated time, whatever the computer needs for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Latencies {
    /// One way between robot and vision server.
    pub network: SimDuration,
    /// From the trigger to the middle of the exposure.
    pub exposure: SimDuration,
    /// From the exposure to the carton poses: transfer and estimation.
    pub vision: SimDuration,
    /// From the poses to the path.
    pub planning: SimDuration,
}
