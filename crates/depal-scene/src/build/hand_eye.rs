//! The calibration of a scene: the board, and poses at which the camera sees it.

use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, capture};
use depal_cell::calibration::{BOARD_ID, CalibrationSpec};
use depal_cell::spec::CellSpec;
use depal_frames::nalgebra::Translation3;
use depal_frames::{Intrinsics, JointPositions, PlacedShape, Point, Pose, Rotation, Shape, Vector};
use depal_interface::CalibrationPose;
use depal_vision::calibration::{CircleBoard, Mounting, PosePlan, plan_poses};

use super::BuildError;
use crate::calibration::{BoardMounting, Calibration};
use crate::scene::Scene;

/// Tool and board stay this far above the stack, metres.
const CLEARANCE: f64 = 0.05;
/// Height of the volume above the stack, metres, unless the scene gives one.
const HEIGHT: f64 = 1.2;
/// Above the stack the volume begins here, metres: the tool hangs below a tilted board.
const ABOVE_STACK: f64 = 0.3;
/// The view is tested on a picture smaller by this factor: a fortieth of the plate still shows.
const SHRINK: usize = 4;
/// Points looked at on a joint move between two poses.
const PATH_POINTS: usize = 16;

/// Board and mounting, if the scene has a calibration.
pub(super) fn spec(
    scene: &Scene,
    base_from_world: &Pose,
) -> Result<Option<CalibrationSpec>, BuildError> {
    let Some(calibration) = &scene.calibration else {
        return Ok(None);
    };
    if calibration.mounted == BoardMounting::Fixed {
        return Err(BuildError::Unsupported {
            key: "calibration.mounted".to_owned(),
            what: "a camera on the flange, which a fixed board needs,".to_owned(),
        });
    }
    let [roll, pitch, yaw] = calibration.rpy_deg.map(f64::to_radians);
    let placed = Pose::from_parts(
        Translation3::from(Vector::from(calibration.xyz_mm) * 1e-3),
        Rotation::from_euler_angles(roll, pitch, yaw),
    );
    let (mounting, board_pose) = match calibration.mounted {
        BoardMounting::Flange => (Mounting::EyeToHand, placed),
        BoardMounting::Fixed => (Mounting::EyeInHand, base_from_world * placed),
    };
    let board = CircleBoard {
        columns: calibration.board.columns as usize,
        rows: calibration.board.rows as usize,
        pitch: calibration.board.pitch_mm * 1e-3,
        disc_diameter: calibration.board.disc_mm * 1e-3,
    };
    board
        .validate()
        .map_err(|problem| mismatch("calibration.board", &problem))?;
    Ok(Some(CalibrationSpec {
        board,
        mounting,
        board_pose,
        repeatability: calibration.repeatability_mm * 1e-3,
    }))
}

fn mismatch(key: &'static str, problem: &dyn std::error::Error) -> BuildError {
    BuildError::Mismatch {
        key,
        message: problem.to_string(),
    }
}

/// Where 701 sends the robot: spread over the volume, within reach, the board in plain sight of camera
/// and projector, tool and board above the stack there and on the joint moves between.
/// None without a calibration.
pub(super) fn poses(
    scene: &Scene,
    cell: &CellSpec,
) -> Result<Option<Vec<CalibrationPose>>, BuildError> {
    let (Some(calibration), Some(spec)) = (&scene.calibration, &cell.calibration) else {
        return Ok(None);
    };
    let view = View {
        cell,
        spec,
        camera: small(&cell.camera),
        least_height: stack_top(cell) + CLEARANCE,
    };
    let (centre, half_extents) = volume(scene, calibration, stack_top(cell));
    let base_from_world = cell.world_from_base.inverse();
    let plan = PosePlan {
        board: spec.board,
        mounting: spec.mounting,
        intrinsics: cell.camera.intrinsics,
        camera: cell.base_from_camera,
        board_pose: spec.board_pose,
        region: base_from_world * Pose::translation(centre.x, centre.y, centre.z),
        half_extents,
        max_tilt: calibration.max_tilt_deg.to_radians(),
        count: calibration.poses as usize,
    };
    let flanges = plan_poses(&plan, |base_from_flange| {
        view.joints(base_from_flange)
            .is_some_and(|joints| view.is_free(&joints) && view.is_board_seen(&joints))
    })
    .map_err(|problem| mismatch("calibration", &problem))?;
    view.in_order(&flanges).map(Some)
}

/// The volume in the world: its middle and half of its sides.
fn volume(scene: &Scene, calibration: &Calibration, stack_top: f64) -> (Vector, Vector) {
    if let (Some(centre), Some(size)) = (calibration.region_xyz_mm, calibration.region_size_mm) {
        return (Vector::from(centre) * 1e-3, Vector::from(size) * 0.5e-3);
    }
    let pallet = &scene.pallet;
    let middle = stack_top + ABOVE_STACK + 0.5 * HEIGHT;
    (
        Vector::new(pallet.xyz_mm[0] * 1e-3, pallet.xyz_mm[1] * 1e-3, middle),
        Vector::new(
            0.5e-3 * pallet.size_mm[0],
            0.5e-3 * pallet.size_mm[1],
            0.5 * HEIGHT,
        ),
    )
}

/// Height of the highest carton, or of the highest fixed solid that is not the floor, world, metres.
fn stack_top(cell: &CellSpec) -> f64 {
    let cartons = cell
        .cartons
        .iter()
        .map(|c| c.world_from_centre.translation.z + 0.5 * c.size.height);
    let fixed = cell
        .known_obstacles
        .iter()
        .map(|o| (cell.world_from_base * o.pose).translation.z + upright_half_height(&o.shape));
    cartons.chain(fixed).fold(0.0, f64::max)
}

fn upright_half_height(shape: &Shape) -> f64 {
    match shape {
        Shape::Cuboid { half_extents } => half_extents.z,
        Shape::Cylinder { half_length, .. } => *half_length,
        Shape::Capsule {
            half_length,
            radius,
        } => half_length + radius,
        Shape::Sphere { radius } => *radius,
        Shape::Hull(hull) => hull.half_extents().z,
    }
}

/// The same camera with fewer pixels and no noise, the projector's shadow alone.
fn small(camera: &CameraSpec) -> CameraSpec {
    let i = &camera.intrinsics;
    let shrink = SHRINK as f64;
    CameraSpec {
        intrinsics: Intrinsics {
            width: (i.width / SHRINK).max(1),
            height: (i.height / SHRINK).max(1),
            fx: i.fx / shrink,
            fy: i.fy / shrink,
            cx: i.cx / shrink,
            cy: i.cy / shrink,
        },
        sensor: SensorSpec {
            shadow: true,
            ..SensorSpec::ideal()
        },
        ..*camera
    }
}

/// What tells whether a pose is of use.
struct View<'a> {
    cell: &'a CellSpec,
    spec: &'a CalibrationSpec,
    camera: CameraSpec,
    /// Tool and board stay above, world, metres.
    least_height: f64,
}

impl View<'_> {
    fn joints(&self, base_from_flange: &Pose) -> Option<JointPositions> {
        let start = &self.cell.controller.start;
        self.cell.arm.inverse_nearest(base_from_flange, start)
    }

    /// Corners of tool and plate above the stack.
    fn is_free(&self, joints: &JointPositions) -> bool {
        let base_from_flange = self.cell.arm.base_from_flange(joints);
        let world_from_flange = self.cell.world_from_base * base_from_flange;
        let world_from_tcp = world_from_flange * self.cell.gripper.flange_from_tcp;
        let world_from_board =
            self.cell.world_from_base * self.spec.base_from_board(&base_from_flange);
        let plate = self
            .spec
            .board
            .corners()
            .map(|corner| world_from_board * corner);
        let tool = self
            .cell
            .gripper
            .bodies
            .iter()
            .flat_map(|body| corners(body).map(|corner| world_from_tcp * corner));
        tool.chain(plate)
            .all(|corner| corner.z >= self.least_height)
    }

    /// Every pixel of the plate that would be seen without arm and tool is seen with them, and lit.
    fn is_board_seen(&self, joints: &JointPositions) -> bool {
        let cell = self.cell;
        let base_from_flange = cell.arm.base_from_flange(joints);
        let (plate, _) = self
            .spec
            .bodies(&(cell.world_from_base * self.spec.base_from_board(&base_from_flange)));
        let seen = |shapes: &[RenderShape]| {
            let world_from_camera = cell.world_from_base * cell.base_from_camera;
            let shot = capture(&self.camera, &world_from_camera, shapes, 0);
            let pixels = shot.ids.iter().zip(&shot.frame.depth);
            pixels
                .filter(|(id, z)| **id == BOARD_ID && **z > 0.0)
                .count()
        };
        let drawn = |body: PlacedShape| RenderShape {
            world_from_shape: body.pose,
            shape: body.shape,
            id: 0,
            material: Material::PAINT,
        };
        let mut shapes: Vec<RenderShape> = Vec::new();
        for (link, base_from_link) in cell
            .arm
            .links()
            .iter()
            .zip(cell.arm.base_from_links(joints))
        {
            let world_from_link = cell.world_from_base * base_from_link;
            shapes.extend(
                link.collision
                    .iter()
                    .map(|s| drawn(s.moved(&world_from_link))),
            );
        }
        let world_from_tcp = cell.world_from_base * base_from_flange * cell.gripper.flange_from_tcp;
        let bodies = cell.gripper.bodies.iter();
        shapes.extend(bodies.map(|s| drawn(s.moved(&world_from_tcp))));
        shapes.push(plate.clone());
        let alone = seen(&[plate]);
        alone > 0 && seen(&shapes) == alone
    }

    /// Nothing sinks to the stack on a joint move.
    fn is_way_free(&self, from: &JointPositions, to: &JointPositions) -> bool {
        (0..=PATH_POINTS).all(|k| self.is_free(&from.lerp(to, k as f64 / PATH_POINTS as f64)))
    }

    /// The nearest next pose each time, along free joint moves, home again at the end.
    fn in_order(&self, flanges: &[Pose]) -> Result<Vec<CalibrationPose>, BuildError> {
        let start = self.cell.controller.start;
        let mut left: Vec<CalibrationPose> = flanges
            .iter()
            .filter_map(|base_from_flange| {
                Some(CalibrationPose {
                    base_from_flange: *base_from_flange,
                    joints: self.joints(base_from_flange)?,
                })
            })
            .collect();
        let wanted = left.len();
        let mut ordered: Vec<CalibrationPose> = Vec::new();
        let mut here = start;
        while !left.is_empty() {
            let next = (0..left.len())
                .filter(|&k| self.is_way_free(&here, &left[k].joints))
                .min_by(|&a, &b| {
                    let way = |k: usize| left[k].joints.max_distance(&here);
                    way(a).total_cmp(&way(b))
                });
            let Some(next) = next else {
                break;
            };
            here = left[next].joints;
            ordered.push(left.remove(next));
        }
        if !left.is_empty() || !self.is_way_free(&here, &start) {
            return Err(BuildError::Mismatch {
                key: "calibration.region_xyz_mm",
                message: format!(
                    "expected joint moves above the stack from the start through {wanted} poses and back, \
                     found them for {}",
                    ordered.len()
                ),
            });
        }
        Ok(ordered)
    }
}

/// Corners of a box around a solid, in its parent's frame.
fn corners(body: &PlacedShape) -> [Point; 8] {
    let half = match &body.shape {
        Shape::Cuboid { half_extents } => *half_extents,
        Shape::Sphere { radius } => Vector::repeat(*radius),
        Shape::Hull(hull) => hull.half_extents(),
        Shape::Cylinder {
            half_length,
            radius,
        } => Vector::new(*radius, *radius, *half_length),
        Shape::Capsule {
            half_length,
            radius,
        } => Vector::new(*radius, *radius, half_length + radius),
    };
    std::array::from_fn(|k| {
        let side = |bit: usize, half: f64| if k & bit == 0 { -half } else { half };
        body.pose * Point::new(side(1, half.x), side(2, half.y), side(4, half.z))
    })
}
