use depal_frames::{JointPositions, Pose, Rotation, Vector};
use nalgebra::{Rotation3, Unit};

/// Directions and points may be this far from where a closed form has them.
const SQUARE: f64 = 1e-6;

/// How a link moves against its parent.
#[derive(Debug, Clone)]
pub(crate) enum Motion {
    Fixed,
    /// Turns by `multiplier * joint + offset`; 1 and 0 but for mimics.
    Revolute {
        axis: Unit<Vector>,
        index: usize,
        multiplier: f64,
        offset: f64,
    },
}

/// One link: where its joint sits on the parent, and how it turns.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// Index of the parent link; none for the root, which is node 0.
    pub parent: Option<usize>,
    /// `parent_from_joint` at zero.
    pub origin: Pose,
    pub motion: Motion,
}

impl Node {
    /// `parent_from_link`.
    fn pose(&self, joints: &[f64]) -> Pose {
        match &self.motion {
            Motion::Fixed => self.origin,
            Motion::Revolute {
                axis,
                index,
                multiplier,
                offset,
            } => Pose::from_parts(
                self.origin.translation,
                self.origin.rotation
                    * Rotation::from_axis_angle(axis, multiplier * joints[*index] + offset),
            ),
        }
    }
}

/// The tree of links as a flat list, parents before children.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    pub nodes: Vec<Node>,
    /// Links from the root (left out) to the flange.
    pub path: Vec<usize>,
}

impl Chain {
    pub fn base_from_tip(&self, joints: &JointPositions) -> Pose {
        self.path.iter().fold(Pose::identity(), |pose, &node| {
            pose * self.nodes[node].pose(joints)
        })
    }

    pub fn base_from_links(&self, joints: &JointPositions) -> Vec<Pose> {
        let mut poses: Vec<Pose> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            poses.push(match node.parent {
                Some(parent) => poses[parent] * node.pose(joints),
                None => node.origin,
            });
        }
        poses
    }

    /// The same arm in another frame at its foot.
    pub fn seen_from(&self, other_from_base: &Pose) -> Self {
        let mut chain = self.clone();
        for node in &mut chain.nodes {
            if node.parent == Some(0) {
                node.origin = other_from_base * node.origin;
            }
        }
        chain
    }

    /// The frame in which closed forms know an arm: Z along axis 1, Y along axis 2, origin where axis 1 is nearest to that
    /// of the base. The base's own frame when the axes lie so already, or are not square to each other.
    pub fn model_from_base(&self, joint_count: usize) -> Pose {
        let axes = self.axes_at_zero(joint_count);
        let [first, second, ..] = axes.as_slice() else {
            return Pose::identity();
        };
        let lies = |axis: &Vector, along: &Vector| axis.cross(along).norm() < SQUARE;
        if first.direction.dot(&second.direction).abs() > SQUARE
            || lies(&first.direction, &Vector::z())
                && lies(&second.direction, &Vector::y())
                && first.point.xy().norm() < SQUARE
        {
            return Pose::identity();
        }
        let towards = |axis: Vector, along: Vector| axis * axis.dot(&along).signum();
        let z = towards(first.direction, Vector::z());
        let y = towards(second.direction, Vector::y());
        let y = (y - z * y.dot(&z)).normalize();
        let turn = Rotation3::from_basis_unchecked(&[y.cross(&z), y, z]);
        let foot = first.point - z * first.point.dot(&z);
        Pose::from_parts(foot.into(), Rotation::from_rotation_matrix(&turn)).inverse()
    }

    /// The turning axes on the way to the tip in the base frame at zero joints, base first.
    pub fn axes_at_zero(&self, joint_count: usize) -> Vec<Axis> {
        self.axes(&JointPositions::zeros(joint_count))
    }

    /// The turning axes on the way to the tip in the base frame, base first.
    pub fn axes(&self, joints: &JointPositions) -> Vec<Axis> {
        let mut pose = Pose::identity();
        let mut axes = Vec::new();
        for &node in &self.path {
            let node = &self.nodes[node];
            if let Motion::Revolute {
                axis,
                index,
                multiplier,
                offset,
            } = &node.motion
            {
                let at = pose * node.origin;
                axes.push(Axis {
                    direction: at.rotation * axis.into_inner(),
                    point: at.translation.vector,
                    index: *index,
                    multiplier: *multiplier,
                    offset: *offset,
                });
            }
            pose *= node.pose(joints);
        }
        axes
    }
}

/// An axis in the base frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub direction: Vector,
    /// A point on it, m.
    pub point: Vector,
    /// Of the joint that drives it.
    pub index: usize,
    pub multiplier: f64,
    pub offset: f64,
}
