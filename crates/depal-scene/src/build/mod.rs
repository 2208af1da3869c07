//! From a scene to a cell: millimetres, degrees and names become the specifications of the rooms.

mod arm;
mod calibration;
mod gripper;
mod plc;
mod program;
mod sensor;
mod server;
mod skins;
mod solids;
mod vision;
mod workflow;

use std::sync::Arc;

use depal_arm::{Arm, ArmError};
use depal_camera::{CameraSpec, Mounting};
use depal_cell::error::CellError;
use depal_cell::spec::{CellSpec, GripperWiring, Latencies, SectionSignals};
use depal_controller::{ControllerSpec, SignalSpec};
use depal_frames::{Intrinsics, JointPositions, PlacedShape, Pose};
use depal_planner::{PlaceSpec, PlannerSettings};
use depal_time::SimDuration;
use depal_vm::execution::RobotTask;
use depal_vm::{Diagnostic, SourceFile};
use depal_world::{CartonSpec, WorldSpec};

use crate::camera::{Camera, CameraMount};
use crate::gripper::Gripper;
use crate::interface::WireEncoding;
use crate::layout::{CartonPlacement, carton_layout};
use crate::robot::{Signal, SignalKind};
use crate::scene::Scene;

/// A scene that is ready to run.
pub struct Built {
    /// The cell.
    pub spec: CellSpec,
    /// The robot's task.
    pub task: Box<dyn RobotTask>,
    /// The program's texts, for messages.
    pub sources: Vec<SourceFile>,
    /// Warnings about the program.
    pub warnings: Vec<Diagnostic>,
}

/// Why a scene that reads well cannot be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The arm's file is wrong.
    #[error("robot.urdf: {0}")]
    Arm(#[from] ArmError),
    /// A mesh of the arm's file cannot be had, or not be read.
    #[error("robot.urdf: {0}")]
    Mesh(String),
    /// The robot program is wrong; the diagnostics say where.
    #[error("robot.program: {} error(s)", diagnostics.len())]
    Program {
        /// Errors and warnings, in the order of the text.
        diagnostics: Vec<Diagnostic>,
        /// The texts that they point into.
        sources: Vec<SourceFile>,
    },
    /// Two parts do not fit together.
    #[error("{key}: {message}")]
    Mismatch {
        /// The key to change.
        key: &'static str,
        /// Expected and found.
        message: String,
    },
    /// The cell refuses.
    #[error(transparent)]
    Cell(#[from] CellError),
}

impl Scene {
    /// Makes the cell and loads the robot program.
    ///
    /// # Errors
    /// See [`BuildError`]; nothing is half built.
    pub fn build(&self) -> Result<Built, BuildError> {
        let spec = self.cell_spec()?;
        if let Some(controller) = &self.plc {
            let task = Box::new(plc::task(controller, &spec)?);
            return Ok(Built {
                spec,
                task,
                sources: Vec::new(),
                warnings: Vec::new(),
            });
        }
        let program = program::load_program(&self.robot, &spec)?;
        Ok(Built {
            spec,
            task: program.task,
            sources: program.sources,
            warnings: program.warnings,
        })
    }

    /// The cell alone, without its robot program.
    ///
    /// # Errors
    /// See [`BuildError`].
    pub fn cell_spec(&self) -> Result<CellSpec, BuildError> {
        let robot = &self.robot;
        let arm = Arc::new(arm::arm(robot)?);
        if robot.start_joints_deg.len() != arm.joint_count() {
            return Err(BuildError::Mismatch {
                key: "robot.start_joints_deg",
                message: format!(
                    "expected {} values, one for each joint of {}, found {}",
                    arm.joint_count(),
                    arm.name(),
                    robot.start_joints_deg.len()
                ),
            });
        }
        let start = JointPositions::from_degrees(&robot.start_joints_deg);
        if !arm.within_limits(&start) {
            return Err(BuildError::Mismatch {
                key: "robot.start_joints_deg",
                message: format!(
                    "expected angles inside the limits of {}, found {:?}",
                    arm.name(),
                    robot.start_joints_deg
                ),
            });
        }
        let driven = scaled(&arm, robot.velocity_scale)?;
        let mut controller = ControllerSpec::new("rob1", driven, start);
        controller.mounted = gripper::load(&self.gripper);
        controller.signals = robot.signal.iter().map(signal).collect();
        controller.families = robot.language().signal_families();
        controller.statement_cost = SimDuration::from_nanos((robot.statement_cost_us * 1e3) as u64);

        let world_from_base = solids::pose_mm_yaw(robot.base_xyz_mm, robot.base_yaw_deg);
        let base_from_world = world_from_base.inverse();
        let (mounting, carrier_from_camera) = mounting(&self.camera, &base_from_world);
        let workflow = workflow::workflow(self);
        let placements = carton_layout(self, self.streams());
        let to_base = |shape: &PlacedShape| shape.moved(&base_from_world);
        let mut spec = CellSpec {
            scene: self.name.clone(),
            seed: self.seed,
            world_from_base,
            gripper: gripper::gripper(&self.gripper),
            available_vacuum: self.gripper.vacuum_kpa * 1e3,
            wiring: GripperWiring {
                sections: section_signals(&self.gripper),
                vacuum_ok: self.gripper.vacuum_signal.clone(),
            },
            world: WorldSpec {
                fixed: solids::fixed_bodies(self),
                conveyors: vec![solids::conveyor(&self.conveyor)],
                carton_edge_radius: self.cartons.edge_radius_mm * 1e-3,
                ..WorldSpec::default()
            },
            cartons: self.carton_specs(&placements),
            skins: skins::skins(self, &placements),
            settle_time: SimDuration::from_millis(2000),
            camera: camera(&self.camera)?,
            mounting,
            carrier_from_camera,
            calibration: calibration::spec(self, &base_from_world)?,
            projects: vision::projects(self, &base_from_world),
            interface: server::server(self, &workflow),
            workflow,
            port: self.interface.port,
            plc: self
                .plc
                .as_ref()
                .filter(|_| self.interface.encoding == WireEncoding::S7)
                .map(|controller| plc::port(controller, &self.interface)),
            controller,
            known_obstacles: solids::known_obstacles(self).iter().map(to_base).collect(),
            place: PlaceSpec {
                base_from_place: base_from_world
                    * solids::pose_mm_yaw(self.conveyor.place_xyz_mm, self.conveyor.place_yaw_deg),
                yaws: vec![0.0, std::f64::consts::PI],
            },
            planner: self.planner_settings(),
            latencies: Latencies {
                network: SimDuration::from_secs_f64(self.latency.network_ms * 1e-3),
                exposure: SimDuration::from_secs_f64(self.camera.exposure_s),
                vision: SimDuration::from_secs_f64(self.latency.vision_s),
                planning: SimDuration::from_secs_f64(self.latency.planning_s),
            },
            time_limit: SimDuration::from_secs_f64(self.run.max_sim_s),
            may_leave_cartons: self.run.may_leave_cartons,
            arm,
        };
        spec.interface.calibration = calibration::poses(self, &spec)?;
        Ok(spec)
    }

    fn carton_specs(&self, placements: &[CartonPlacement]) -> Vec<CartonSpec> {
        placements
            .iter()
            .map(|placement| CartonSpec {
                size: placement.size,
                mass: placement.mass_kg,
                world_from_centre: placement.world_from_carton,
                friction: self.cartons.friction,
            })
            .collect()
    }

    fn planner_settings(&self) -> PlannerSettings {
        let planner = &self.planner;
        let infinite = f64::INFINITY;
        let payload = self.robot.payload_kg.unwrap_or(infinite);
        PlannerSettings {
            max_load: payload - self.gripper.mass_kg,
            max_moment: self.robot.wrist_moment_n_m.unwrap_or(infinite),
            max_waypoints: planner.max_waypoints as usize,
            max_carton_mass: planner.assumed_mass_kg,
            suction_safety: planner.suction_safety,
            approach_height: planner.approach_mm * 1e-3,
            place_height: planner.approach_mm * 1e-3,
            lift_clearance: planner.lift_mm * 1e-3,
            transfer_padding: planner.clearance_mm * 1e-3,
            ..PlannerSettings::default()
        }
    }
}

fn section_signals(gripper: &Gripper) -> SectionSignals {
    match gripper.single_outputs() {
        Some(names) => SectionSignals::Single(names),
        None => SectionSignals::Groups(vec![gripper.sections_signal.clone()]),
    }
}

/// The arm as the cabinet drives it: `scale` times as fast on the same ways.
fn scaled(arm: &Arc<Arm>, scale: f64) -> Result<Arc<Arm>, ArmError> {
    if (scale - 1.0).abs() < f64::EPSILON {
        return Ok(Arc::clone(arm));
    }
    let limits = || arm.limits().iter();
    let speeds: Vec<f64> = limits().map(|l| l.max_speed * scale).collect();
    let accelerations = limits().map(|l| l.max_acceleration * scale * scale);
    let arm = Arm::clone(arm).with_rates(&speeds, &accelerations.collect::<Vec<f64>>())?;
    Ok(Arc::new(arm))
}

fn signal(signal: &Signal) -> SignalSpec {
    use depal_controller::SignalKind as Kind;
    let bits = signal.bits as u8;
    let kind = match signal.kind {
        SignalKind::DigitalInput => Kind::DigitalInput,
        SignalKind::DigitalOutput => Kind::DigitalOutput,
        SignalKind::GroupInput => Kind::GroupInput { bits },
        SignalKind::GroupOutput => Kind::GroupOutput { bits },
    };
    SignalSpec::new(&signal.name, kind)
}

/// Where the camera really is, and where calibration says that it is on its carrier: base or flange.
fn mounting(camera: &Camera, base_from_world: &Pose) -> (Mounting, Pose) {
    let calibrated = camera.carrier_from_camera();
    let really = camera.true_carrier_from_camera();
    match camera.mount {
        CameraMount::World => {
            let world_from_camera = really;
            (
                Mounting::EyeToHand { world_from_camera },
                base_from_world * calibrated,
            )
        }
        CameraMount::Flange => {
            let flange_from_camera = really;
            (Mounting::EyeInHand { flange_from_camera }, calibrated)
        }
    }
}

fn camera(camera: &Camera) -> Result<CameraSpec, BuildError> {
    let [cx, cy] = camera.principal_point_px();
    let spec = CameraSpec {
        intrinsics: Intrinsics {
            width: camera.width as usize,
            height: camera.height as usize,
            fx: camera.focal_px[0],
            fy: camera.focal_px[1],
            cx,
            cy,
        },
        near: camera.near_mm * 1e-3,
        far: camera.far_mm * 1e-3,
        baseline: camera.baseline_mm * 1e-3,
        sensor: sensor::sensor(camera),
    };
    spec.validate().map_err(|error| BuildError::Mismatch {
        key: "camera",
        message: error.to_string(),
    })?;
    Ok(spec)
}
