//! Joint torques from a motion: recursive Newton-Euler over the tree of links.

use depal_frames::{JointPositions, Point, Pose, Vector};
use nalgebra::Matrix3;

use crate::{
    Arm, ArmError, Place,
    chain::{Chain, Motion},
};

/// Standard acceleration of free fall (third CGPM, 1901), m/s2; it points along -Z of the base.
const GRAVITY: f64 = 9.806_65;

/// What hangs on the flange: a tool, a carton, or both [together](Load::and).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the flange frame, m.
    pub centre: Point,
    /// About the centre of mass, in the directions of the flange frame, kg m2. Zero for a point mass.
    pub inertia: Matrix3<f64>,
}

impl Load {
    /// Nothing.
    pub const NONE: Self = Self {
        mass: 0.0,
        centre: Point::new(0.0, 0.0, 0.0),
        inertia: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// A mass (kg) in one point of the flange frame (m).
    pub fn point(mass: f64, centre: Point) -> Self {
        Self {
            mass,
            centre,
            inertia: Matrix3::zeros(),
        }
    }

    /// This load and another one as one body.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass <= 0.0 {
            return Self::NONE;
        }
        let centre = (self.centre.coords * self.mass + other.centre.coords * other.mass) / mass;
        let moved = |load: &Self| {
            let arm = load.centre.coords - centre;
            // Steiner's law.
            load.inertia
                + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * load.mass
        };
        Self {
            mass,
            centre: Point::from(centre),
            inertia: moved(self) + moved(other),
        }
    }
}

/// Mass, centre of mass and inertia about it, in a link's own frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inertial {
    pub mass: f64,
    pub centre: Vector,
    pub inertia: Matrix3<f64>,
}

/// Masses of all links, in their order, and what the joints can give.
#[derive(Debug, Clone)]
pub(crate) struct Dynamics {
    pub inertials: Vec<Inertial>,
    /// N m per driven joint, infinite where the file gives none; none if there is no finite one.
    pub torque_limits: Option<JointPositions>,
}

impl Dynamics {
    /// `efforts` in N m per driven joint. One that is zero, negative or no number is no limit, and neither is that
    /// of a joint above which no link has a mass: nothing true could be said about its torque.
    pub fn new(chain: &Chain, inertials: Vec<Inertial>, efforts: &[f64]) -> Self {
        let mut carries = vec![false; efforts.len()];
        for (link, inertial) in inertials.iter().enumerate() {
            let mut node = Some(link).filter(|_| inertial.mass > 0.0);
            while let Some(at) = node {
                if let Motion::Revolute { index, .. } = &chain.nodes[at].motion {
                    carries[*index] = true;
                }
                node = chain.nodes[at].parent;
            }
        }
        let mut limits = JointPositions::zeros(efforts.len());
        for (limit, (&effort, carries)) in limits.iter_mut().zip(efforts.iter().zip(carries)) {
            *limit = if effort > 0.0 && carries {
                effort
            } else {
                f64::INFINITY
            };
        }
        let limited = limits.iter().any(|limit| limit.is_finite());
        Self {
            inertials,
            torque_limits: limited.then_some(limits),
        }
    }
}

impl Arm {
    /// What each joint can give, N m, base to flange: the `effort` of the file, infinite where it is 0 or where no link
    /// above the joint has a mass. None if no joint is limited; then no torque needs to be looked at.
    pub fn torque_limits(&self) -> Option<&JointPositions> {
        self.dynamics.torque_limits.as_ref()
    }

    /// The same arm with other torque limits, N m, base to flange; 0 for none.
    ///
    /// # Errors
    /// [`ArmError::AccelerationCount`] when the list does not fit the joints.
    pub fn with_torque_limits(mut self, max_torques: &[f64]) -> Result<Self, ArmError> {
        if max_torques.len() != self.joint_count() {
            return Err(ArmError::AccelerationCount {
                at: Place::file(self.name()),
                found: max_torques.len(),
                expected: self.joint_count(),
            });
        }
        self.dynamics = Dynamics::new(&self.chain, self.dynamics.inertials, max_torques);
        Ok(self)
    }

    /// Torque of every driven joint, N m, positive where the joint counts up, that makes the arm move so
    /// (rad, rad/s, rad/s2) with `load` at its flange, the base upright and at rest. Of a joint that others mimic it is
    /// the sum of what all of them take, by virtual work. Friction and the inertia of motors are not in it.
    ///
    /// Recursive Newton-Euler: J. Luh, M. Walker, R. Paul, "On-line computational scheme for mechanical manipulators",
    /// ASME Journal of Dynamic Systems, Measurement, and Control 102, 1980.
    ///
    /// # Panics
    /// If a vector has fewer entries than the arm has joints.
    pub fn joint_torques(
        &self,
        joints: &JointPositions,
        speeds: &JointPositions,
        accelerations: &JointPositions,
        load: &Load,
    ) -> JointPositions {
        let nodes = &self.chain.nodes;
        let poses = self.chain.base_from_links(joints);
        let mut states: Vec<State> = Vec::with_capacity(nodes.len());
        let mut wrenches: Vec<Wrench> = Vec::with_capacity(nodes.len());
        for (index, node) in nodes.iter().enumerate() {
            let pose = &poses[index];
            let state = match node.parent {
                None => State::AT_REST,
                Some(parent) => {
                    let mut state = states[parent]
                        .at(pose.translation.vector - poses[parent].translation.vector);
                    if let Motion::Revolute {
                        axis,
                        index: joint,
                        multiplier,
                        ..
                    } = &node.motion
                    {
                        let axis = pose.rotation * axis.into_inner();
                        let turn = axis * (multiplier * speeds[*joint]);
                        state.bend +=
                            axis * (multiplier * accelerations[*joint]) + state.turn.cross(&turn);
                        state.turn += turn;
                    }
                    state
                }
            };
            states.push(state);
            wrenches.push(state.wrench(pose, &self.dynamics.inertials[index]));
        }
        if load.mass > 0.0 {
            let tip = self.chain.path.last().copied().unwrap_or(0);
            let body = Inertial {
                mass: load.mass,
                centre: load.centre.coords,
                inertia: load.inertia,
            };
            let wrench = states[tip].wrench(&poses[tip], &body);
            wrenches[tip].force += wrench.force;
            wrenches[tip].moment += wrench.moment;
        }
        let mut torques = JointPositions::zeros(self.joint_count());
        for (index, node) in nodes.iter().enumerate().rev() {
            let Wrench { force, moment } = wrenches[index];
            if let Motion::Revolute {
                axis,
                index: joint,
                multiplier,
                ..
            } = &node.motion
            {
                let axis = poses[index].rotation * axis.into_inner();
                torques[*joint] += multiplier * axis.dot(&moment);
            }
            if let Some(parent) = node.parent {
                let way = poses[index].translation.vector - poses[parent].translation.vector;
                wrenches[parent].force += force;
                wrenches[parent].moment += moment + way.cross(&force);
            }
        }
        torques
    }

    /// [`Arm::joint_torques`] of an arm that stands.
    pub fn holding_torques(&self, joints: &JointPositions, load: &Load) -> JointPositions {
        let zero = JointPositions::zeros(self.joint_count());
        self.joint_torques(joints, &zero, &zero, load)
    }
}

/// How a link moves, in the directions of the base.
#[derive(Debug, Clone, Copy)]
struct State {
    /// rad/s.
    turn: Vector,
    /// rad/s2.
    bend: Vector,
    /// Of the link's origin, m/s2, with the push of the ground against gravity.
    rise: Vector,
}

impl State {
    const AT_REST: Self = Self {
        turn: Vector::new(0.0, 0.0, 0.0),
        bend: Vector::new(0.0, 0.0, 0.0),
        rise: Vector::new(0.0, 0.0, GRAVITY),
    };

    /// Of a point of the same body.
    fn at(&self, way: Vector) -> Self {
        Self {
            rise: self.rise + self.bend.cross(&way) + self.turn.cross(&self.turn.cross(&way)),
            ..*self
        }
    }

    /// Force on the body and its moment about the link's origin.
    fn wrench(&self, pose: &Pose, body: &Inertial) -> Wrench {
        let centre = pose.rotation * body.centre;
        let force = self.at(centre).rise * body.mass;
        // Spun in the link's frame, where the inertia stays the same.
        let (turn, bend) = (
            pose.rotation.inverse_transform_vector(&self.turn),
            pose.rotation.inverse_transform_vector(&self.bend),
        );
        let spin = body.inertia * bend + turn.cross(&(body.inertia * turn));
        Wrench {
            force,
            moment: pose.rotation * spin + centre.cross(&force),
        }
    }
}

/// N and N m, in the directions of the base.
#[derive(Debug, Clone, Copy)]
struct Wrench {
    force: Vector,
    moment: Vector,
}
