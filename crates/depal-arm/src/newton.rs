//! The chain library's own solver from one beginning.

use depal_frames::{JointPositions, Pose, convert};
use k::InverseKinematicsSolver;
use nalgebra_030 as na;

use crate::{
    JointLimit,
    chain::{Chain, Motion},
    numeric::{self, TOLERANCE},
};

/// Steps from one beginning: it meets its posture within a dozen or jumps about for long.
const STEPS: usize = 24;

/// Newton's method with the inverse (of more than six joints the pseudo-inverse) of the Jacobian: fast where it works,
/// and without damping it jumps far where the arm is nearly stretched, which meets branches that others miss.
pub(crate) struct Newton<'a> {
    chain: &'a Chain,
    arm: k::SerialChain<f64>,
    solver: k::JacobianIkSolver<f64>,
}

impl<'a> Newton<'a> {
    /// The same chain for the library. None for mimics, which its Jacobian does not know, and for fewer than six joints,
    /// which cannot bring a flange to every pose.
    pub fn new(chain: &'a Chain, limits: &[JointLimit]) -> Option<Self> {
        if limits.len() < 6 {
            return None;
        }
        // A node holds its children only: all are kept until the chain has them.
        let mut nodes: Vec<k::Node<f64>> = Vec::new();
        let mut origin = Pose::identity();
        let mut next_joint = 0;
        let mut hang = |node: k::Node<f64>| {
            if let Some(parent) = nodes.last() {
                node.set_parent(parent);
            }
            nodes.push(node);
        };
        for &node in &chain.path {
            let node = &chain.nodes[node];
            origin *= node.origin;
            let Motion::Revolute {
                axis,
                index,
                multiplier,
                offset,
            } = &node.motion
            else {
                continue;
            };
            let own = *index == next_joint && *multiplier == 1.0 && *offset == 0.0;
            if !own {
                return None;
            }
            let limit = limits[next_joint];
            next_joint += 1;
            let axis = na::Unit::new_normalize(na::Vector3::new(axis.x, axis.y, axis.z));
            let walls = (limit.upper - limit.lower < std::f64::consts::TAU)
                .then(|| k::joint::Range::new(limit.lower, limit.upper));
            hang(
                k::NodeBuilder::new()
                    .joint_type(k::JointType::Rotational { axis })
                    .limits(walls)
                    .origin(convert::to_nalgebra_030(&origin))
                    .into_node(),
            );
            origin = Pose::identity();
        }
        hang(
            k::NodeBuilder::new()
                .joint_type(k::JointType::Fixed)
                .origin(convert::to_nalgebra_030(&origin))
                .into_node(),
        );
        Some(Self {
            chain,
            arm: k::SerialChain::from_end(nodes.last()?),
            solver: k::JacobianIkSolver::new(TOLERANCE, TOLERANCE, 1.0, STEPS),
        })
    }

    /// Joints inside the limits that bring the flange to `target`, as the flat chain agrees; none when it gets lost.
    pub fn solve(
        &self,
        target: &Pose,
        from: &JointPositions,
        limits: &[JointLimit],
    ) -> Option<JointPositions> {
        self.arm.set_joint_positions_unchecked(from);
        self.solver
            .solve(&self.arm, &convert::to_nalgebra_030(target))
            .ok()?;
        let found = JointPositions::from_slice(&self.arm.joint_positions());
        let found = numeric::home(found, limits)?;
        (numeric::error(self.chain, target, &found).norm() < 1e-8).then_some(found)
    }
}
