use depal_arm::Arm;
use depal_frames::{JointPositions, PlacedShape, Pose, convert};
use depal_gripper::GripperSpec;
use parry3d::{math::Pose as Pose32, shape::SharedShape};

use crate::{
    bounds::{Bounds, BoxAround},
    world::solid,
};

/// Group of the gripper and the carton: beyond the last joint's own link.
const TOOL_GROUP: usize = 7;

/// One moving solid.
pub(crate) struct Body {
    pub name: String,
    /// Index of its frame: a link, or one past the last link for the flange.
    frame: usize,
    /// Joints that move it; the tool counts as one more, so that it is not a neighbour of the wrist.
    pub group: usize,
    frame_from_shape: Pose32,
    around: BoxAround,
    pub shape: SharedShape,
    /// From the shape's origin to its farthest point, m.
    pub radius: f32,
}

impl Body {
    fn new(name: &str, frame: usize, group: usize, placed: &PlacedShape, padding: f64) -> Self {
        let (frame_from_shape, shape) = solid(placed, padding);
        Self {
            name: name.to_owned(),
            frame,
            group,
            frame_from_shape,
            around: BoxAround::new(placed, &frame_from_shape, &shape),
            shape,
            radius: (placed.shape.bounding_radius() + padding.max(0.0)) as f32,
        }
    }

    /// Where the shape is, with the frames of [`Robot::frames`].
    pub fn pose(&self, frames: &[Pose]) -> Pose32 {
        convert::to_glam(&frames[self.frame]) * self.frame_from_shape
    }

    /// The box around it.
    pub fn bounds(&self, frames: &[Pose]) -> Bounds {
        self.around.at(&frames[self.frame])
    }

    /// The box around it is the body itself.
    pub fn is_box(&self) -> bool {
        self.around.is_solid
    }
}

/// Arm and gripper as solids.
pub(crate) struct Robot<'a> {
    pub arm: &'a Arm,
    pub gripper: &'a GripperSpec,
    /// Tool first: it is what touches most often.
    pub bodies: Vec<Body>,
    /// Pairs of `bodies` that may meet; after them those of a carton, whose index is one past the last body.
    pairs: Vec<(usize, usize)>,
    /// How many pairs there are without a carton.
    own_pairs: usize,
    /// Index of the link that carries the gripper.
    flange: usize,
}

impl<'a> Robot<'a> {
    pub fn new(arm: &'a Arm, gripper: &'a GripperSpec) -> Self {
        let mut bodies = Vec::new();
        for placed in &gripper.bodies {
            let on_flange = placed.moved(&gripper.flange_from_tcp);
            bodies.push(Body::new(
                "gripper",
                arm.links().len(),
                TOOL_GROUP,
                &on_flange,
                0.0,
            ));
        }
        for (i, link) in arm.links().iter().enumerate().rev() {
            for placed in &link.collision {
                bodies.push(Body::new(&link.name, i, arm.joints_below(i), placed, 0.0));
            }
        }
        let mut pairs = Vec::new();
        for (i, a) in bodies.iter().enumerate() {
            for (j, b) in bodies.iter().enumerate() {
                if may_meet(a.group, b.group) {
                    pairs.push((i, j));
                }
            }
        }
        let own_pairs = pairs.len();
        let near_carton = |(i, body): (usize, &Body)| {
            may_meet(TOOL_GROUP, body.group).then_some((bodies.len(), i))
        };
        pairs.extend(bodies.iter().enumerate().filter_map(near_carton));
        let flange = arm.links().iter().position(|link| link.name == arm.tip());
        Self {
            arm,
            gripper,
            bodies,
            pairs,
            own_pairs,
            flange: flange.expect("the flange is a link"),
        }
    }

    /// Pairs of bodies that may meet, by index; a carton's index is one past the last body.
    pub fn pairs(&self, with_carton: bool) -> &[(usize, usize)] {
        if with_carton {
            &self.pairs
        } else {
            &self.pairs[..self.own_pairs]
        }
    }

    /// The carton as one more body, smaller by `shrink` on every side. `carried` is in the tool frame.
    pub fn carton(&self, carried: &PlacedShape, shrink: f64) -> Body {
        let on_flange = carried.moved(&self.gripper.flange_from_tcp);
        Body::new(
            "carton",
            self.arm.links().len(),
            TOOL_GROUP,
            &on_flange,
            -shrink,
        )
    }

    /// Poses of all links and, last, of the flange.
    pub fn frames(&self, joints: &JointPositions) -> Vec<Pose> {
        let mut frames = self.arm.base_from_links(joints);
        frames.push(frames[self.flange]);
        frames
    }

    /// Pose of the tool, with the frames of [`Robot::frames`].
    pub fn tool(&self, frames: &[Pose]) -> Pose {
        frames[self.flange] * self.gripper.flange_from_tcp
    }
}

/// Which groups can reach each other: neighbours overlap by design, and some pairs are kept apart by the joint limits.
fn may_meet(outer: usize, inner: usize) -> bool {
    match outer {
        TOOL_GROUP => inner <= 3,
        5 | 6 => inner <= 2,
        4 => inner <= 1,
        _ => false,
    }
}
