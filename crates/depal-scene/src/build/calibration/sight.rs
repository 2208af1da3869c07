//! Whether a pose is of use to a calibration: within reach, free, the board in plain sight.

use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, capture};
use depal_cell::calibration::{BOARD_ID, CalibrationSpec};
use depal_cell::spec::CellSpec;
use depal_frames::{Intrinsics, JointPositions, PlacedShape, Point, Pose, Shape, Vector};
use depal_interface::CalibrationPose;
use depal_vision::calibration::Mounting;

use crate::build::BuildError;

/// The view is tested on a picture smaller by this factor: a fortieth of the plate still shows.
const SHRINK: usize = 4;
/// Points looked at on a joint move between two poses.
const PATH_POINTS: usize = 16;

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
pub(super) struct Sight<'a> {
    cell: &'a CellSpec,
    spec: &'a CalibrationSpec,
    camera: CameraSpec,
    /// Tool and board stay above, world, metres.
    least_height: f64,
}

impl<'a> Sight<'a> {
    pub(super) fn new(cell: &'a CellSpec, spec: &'a CalibrationSpec, least_height: f64) -> Self {
        Self {
            cell,
            spec,
            camera: small(&cell.camera),
            least_height,
        }
    }

    pub(super) fn joints(&self, base_from_flange: &Pose) -> Option<JointPositions> {
        let start = &self.cell.controller.start;
        self.cell.arm.inverse_nearest(base_from_flange, start)
    }

    /// Corners of tool and plate above everything; a fixed plate is itself part of that.
    pub(super) fn is_free(&self, joints: &JointPositions) -> bool {
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
        let is_carried = self.spec.mounting == Mounting::EyeToHand;
        tool.chain(plate.into_iter().filter(|_| is_carried))
            .all(|corner| corner.z >= self.least_height)
    }

    /// Every pixel of the plate that would be seen without arm and tool is seen with them, and lit.
    pub(super) fn is_board_seen(&self, joints: &JointPositions) -> bool {
        let cell = self.cell;
        let base_from_flange = cell.arm.base_from_flange(joints);
        let (plate, _) = self
            .spec
            .bodies(&(cell.world_from_base * self.spec.base_from_board(&base_from_flange)));
        let seen = |shapes: &[RenderShape]| {
            let base_from_camera = cell.base_from_camera(Some(&base_from_flange));
            let world_from_camera = cell.world_from_base * base_from_camera;
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
            edge_radius: 0.0,
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
    pub(super) fn in_order(&self, flanges: &[Pose]) -> Result<Vec<CalibrationPose>, BuildError> {
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
