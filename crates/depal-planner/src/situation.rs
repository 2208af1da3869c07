use depal_frames::{JointPositions, Pose, Rotation, Vector};

use crate::{
    bodies::Robot,
    candidate::footprint_overlap,
    contact::Check,
    group::Group,
    refusal::{Refusal, Stage},
    request::PlanRequest,
    world::World,
};

/// The same obstacles in three thicknesses.
pub(crate) struct Worlds {
    pub far: World,
    pub close: World,
    pub bare: World,
}

/// What all candidates of one request share: arm and obstacles as solids, made once.
pub(crate) struct Situation<'a> {
    pub request: &'a PlanRequest<'a>,
    pub robot: Robot<'a>,
    pub worlds: Worlds,
    /// Whether the first move can keep the full padding; it cannot when the arm starts closer than that to something.
    pub starts_far: bool,
}

impl<'a> Situation<'a> {
    /// Refuses a start outside the limits or in touch with something.
    pub fn new(request: &'a PlanRequest<'a>) -> Result<Self, Refusal> {
        let settings = request.settings;
        let limits = request.arm.limits();
        for (i, (&position, limit)) in request.start.iter().zip(limits).enumerate() {
            if !(position >= limit.lower - 1e-6 && position <= limit.upper + 1e-6) {
                return Err(Refusal::StartOutsideLimits {
                    joint: i + 1,
                    position,
                    lower: limit.lower,
                    upper: limit.upper,
                });
            }
        }
        let mut situation = Self {
            request,
            robot: Robot::new(request.arm, request.gripper),
            worlds: Worlds {
                far: World::new(request, settings.transfer_padding),
                close: World::new(request, settings.close_padding),
                bare: World::new(request, 0.0),
            },
            starts_far: true,
        };
        let touch = |world| {
            let check = Check {
                robot: &situation.robot,
                world,
                carton: None,
                without: &[],
                stage: Stage::Start,
            };
            check.touch(&request.start)
        };
        if touch(&situation.worlds.far).is_some() {
            if let Some(touch) = touch(&situation.worlds.close) {
                return Err(Refusal::StartTouches(touch));
            }
            situation.starts_far = false;
        }
        Ok(situation)
    }

    pub fn tool(&self, joints: &JointPositions) -> Pose {
        self.request.arm.base_from_flange(joints) * self.request.gripper.flange_from_tcp
    }

    /// Where a group is taken to be: an arm with fewer than six axes cannot lean, so it comes down level.
    pub fn base_from_group(&self, group: &Group) -> Pose {
        let pose = group.whole.base_from_box;
        if self.request.arm.joint_count() >= 6 {
            return pose;
        }
        let long = pose.rotation * Vector::x();
        let level = Rotation::from_axis_angle(&Vector::z_axis(), long.y.atan2(long.x));
        Pose::from_parts(pose.translation, level)
    }

    /// How far the carton is lifted straight up: its bottom clears whatever stands beside it, corner cutting included.
    pub fn lift_height(&self, group: &Group) -> f64 {
        let target = &group.whole;
        let bottom = target.base_from_box.translation.z - target.size.height;
        let neighbours = self
            .request
            .boxes
            .iter()
            .enumerate()
            .filter(|&(i, other)| {
                !group.members.contains(&i) && footprint_overlap(target, other) > -0.1
            })
            .map(|(_, other)| other.base_from_box.translation.z)
            .fold(bottom, f64::max);
        neighbours + self.room_above() - bottom
    }

    /// The lift that brings the carton out of what it stands in: its bottom above all that is known within a hand's breadth
    /// of its sides, the walls of a cage or container.
    pub fn height_out(&self, group: &Group) -> f64 {
        let target = &group.whole;
        let pose = target.base_from_box;
        let bottom = pose.translation.z - target.size.height;
        let reach = 0.5 * target.size.length.hypot(target.size.width) + 0.15;
        let rim = self
            .worlds
            .bare
            .rim(&pose.translation.vector, reach)
            .map_or(bottom, |rim| rim.max(bottom));
        rim + self.room_above() - bottom
    }

    /// Between the bottom of a lifted carton and what it leaves below, m.
    fn room_above(&self) -> f64 {
        let settings = self.request.settings;
        let cut_corner = settings.corner_zone + settings.transfer_padding + 0.005;
        settings.lift_clearance.max(cut_corner)
    }
}
