use depal_frames::{JointPositions, Pose, Rotation, Vector};
use nalgebra::Unit;

/// How a link moves against its parent.
#[derive(Debug, Clone)]
pub(crate) enum Motion {
    Fixed,
    Revolute { axis: Unit<Vector>, index: usize },
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
            Motion::Revolute { axis, index } => Pose::from_parts(
                self.origin.translation,
                self.origin.rotation * Rotation::from_axis_angle(axis, joints[*index]),
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

    /// Axis direction and a point on it in the base frame at zero joints, in joint order.
    pub fn axes_at_zero(&self, joint_count: usize) -> Vec<(Vector, Vector)> {
        let links = self.base_from_links(&JointPositions::zeros(joint_count));
        self.path
            .iter()
            .filter_map(|&node| match &self.nodes[node].motion {
                Motion::Fixed => None,
                Motion::Revolute { axis, .. } => Some((
                    links[node].rotation * axis.into_inner(),
                    links[node].translation.vector,
                )),
            })
            .collect()
    }
}
