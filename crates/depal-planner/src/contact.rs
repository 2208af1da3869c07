use depal_frames::{JointPositions, Pose};
use parry3d::math::Pose as Pose32;

use crate::{
    bodies::{Body, Robot},
    bounds::{Bounds, meet, solids_meet},
    refusal::{Obstacle, Stage, Touch},
    world::{self, World},
};

/// What is checked on one stretch of the way.
#[derive(Clone, Copy)]
pub(crate) struct Check<'a> {
    pub robot: &'a Robot<'a>,
    pub world: &'a World,
    /// The carton on the gripper.
    pub carton: Option<&'a Body>,
    /// Seen boxes that are no obstacles here: those to be picked.
    pub without: &'a [usize],
    pub stage: Stage,
}

/// One state, measured.
pub(crate) struct Measured {
    pub poses: Vec<Pose32>,
    /// m, at most the cap.
    pub distance: f32,
    pub nearest: Option<Touch>,
}

impl<'a> Check<'a> {
    /// All bodies, the carton last.
    fn bodies(&self) -> impl Iterator<Item = &'a Body> + use<'a> {
        self.robot.bodies.iter().chain(self.carton)
    }

    fn says(&self, body: &Body, obstacle: Obstacle) -> Touch {
        Touch {
            stage: self.stage,
            body: body.name.clone(),
            obstacle,
        }
    }

    /// The boxes around all bodies.
    fn bounds(&self, frames: &[Pose]) -> Vec<Bounds> {
        self.bodies().map(|body| body.bounds(frames)).collect()
    }

    /// Pairs of moving bodies that may meet, as indices into [`Check::bodies`].
    fn pairs(&self) -> &'a [(usize, usize)] {
        self.robot.pairs(self.carton.is_some())
    }

    fn body(&self, index: usize) -> &'a Body {
        match self.robot.bodies.get(index) {
            Some(body) => body,
            None => self
                .carton
                .expect("only the carton comes after the robot's bodies"),
        }
    }

    fn link_of(&self, body: &Body) -> Obstacle {
        let links = self.robot.arm.links();
        let index = links.iter().position(|l| l.name == body.name);
        Obstacle::Link(index.unwrap_or(links.len()))
    }

    /// The first touch of one state, in a fixed order: carton, gripper, links from the wrist inwards, then the arm with itself.
    pub fn touch(&self, joints: &JointPositions) -> Option<Touch> {
        self.touch_at(&self.robot.frames(joints))
    }

    /// The same with the frames of [`Robot::frames`] at that state.
    pub fn touch_at(&self, frames: &[Pose]) -> Option<Touch> {
        let bounds = self.bounds(frames);
        let meets = |(i, body): (usize, &Body)| {
            if body.group == 0 {
                return None;
            }
            let obstacle = self.world.meets(body, frames, &bounds[i], self.without)?;
            Some(self.says(body, obstacle))
        };
        let last = bounds.len() - 1;
        if let Some(carton) = self.carton
            && let Some(touch) = meets((last, carton))
        {
            return Some(touch);
        }
        if let Some(touch) = self.robot.bodies.iter().enumerate().find_map(meets) {
            return Some(touch);
        }
        self.pairs().iter().find_map(|&(i, j)| {
            if bounds[i].clear_of(&bounds[j]) {
                return None;
            }
            let (a, b) = (self.body(i), self.body(j));
            let exactly = || solids_meet(&a.pose(frames), &a.shape, &b.pose(frames), &b.shape);
            let are_boxes = a.is_box() && b.is_box();
            meet((&bounds[i], &bounds[j]), are_boxes, exactly)
                .then(|| self.says(a, self.link_of(b)))
        })
    }

    /// Poses of all bodies and the least distance to obstacles and between pairs.
    pub fn measure(&self, joints: &JointPositions, cap: f32) -> Measured {
        let frames = self.robot.frames(joints);
        let bounds = self.bounds(&frames);
        let poses: Vec<Pose32> = self.bodies().map(|body| body.pose(&frames)).collect();
        let (mut distance, mut nearest) = (cap, None);
        for ((body, pose), around) in self.bodies().zip(&poses).zip(&bounds) {
            if body.group == 0 {
                continue;
            }
            let (d, what) = self
                .world
                .distance(body, pose, around, self.without, distance);
            if d < distance {
                distance = d;
                nearest = what.map(|w| self.says(body, w));
            }
        }
        for &(i, j) in self.pairs() {
            if bounds[i].apart(&bounds[j], distance) {
                continue;
            }
            let (a, b) = (self.body(i), self.body(j));
            if let Some(d) = world::distance(&poses[i], &a.shape, &poses[j], &b.shape)
                && d < distance
            {
                distance = d;
                nearest = Some(self.says(a, self.link_of(b)));
            }
        }
        Measured {
            poses,
            distance,
            nearest,
        }
    }

    /// Longest way of any point of any body between two states near each other, m.
    pub fn displacement(&self, from: &[Pose32], to: &[Pose32]) -> f32 {
        let mut largest: f32 = 0.0;
        for ((body, a), b) in self.bodies().zip(from).zip(to) {
            if body.group == 0 {
                continue;
            }
            let (qa, qb) = (a.rotation, b.rotation);
            let qb = if qa.dot(qb) < 0.0 { -qb } else { qb };
            // The turn is twice the angle between the quaternions, and their chord is hardly shorter than that angle.
            let turn = 2.02 * (qb - qa).length();
            let way = (b.translation - a.translation).length() + turn * body.radius;
            largest = largest.max(way);
        }
        largest
    }
}
