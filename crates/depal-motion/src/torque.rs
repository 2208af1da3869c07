//! Torque limits as limits of path acceleration and squared path speed.

use std::sync::Arc;

use depal_arm::{Arm, Load};
use depal_frames::JointPositions;

use crate::MotionError;
use crate::curve::{Derivatives, combine};
use crate::passes::Limit;

/// Share of a torque limit that the law may use: limits are held at three places of a cell, and bend between them.
const USED: f64 = 0.995;
/// Share of a torque limit that may go into holding the arm still. What is left accelerates it.
const HELD: f64 = 0.98;

/// What an arm with a load may do.
#[derive(Debug, Clone)]
pub(crate) struct TorqueLimits {
    arm: Arc<Arm>,
    /// What is always there.
    tool: Load,
    /// The tool and what it carries.
    load: Load,
    /// N m, infinite for a joint without limit.
    limits: JointPositions,
}

impl TorqueLimits {
    /// None for an arm without torque limits. `load` is what the tool carries, without the tool.
    pub fn new(arm: &Arc<Arm>, tool: &Load, load: &Load) -> Option<Self> {
        let limits = *arm.torque_limits()?;
        Some(Self {
            arm: Arc::clone(arm),
            tool: *tool,
            load: tool.and(load),
            limits,
        })
    }

    /// Tool and load together.
    pub fn load(&self) -> &Load {
        &self.load
    }

    /// Whether these are the limits of another tool or load.
    pub fn differ(&self, tool: &Load, load: &Load) -> bool {
        self.tool != *tool || self.load != tool.and(load)
    }

    /// The arm with its tool, and the arm with its tool and load. A torque is linear in the mass of the load, so what
    /// holds for both holds for every mass between.
    fn loads(&self) -> impl Iterator<Item = &Load> {
        std::iter::once(&self.tool).chain(Some(&self.load).filter(|load| **load != self.tool))
    }

    /// The limits at a place of a path with these derivatives, where the squared rate has grown by `gain`
    /// times the path's acceleration. Each as a share of its torque limit.
    pub fn rows(&self, joints: &JointPositions, at: &Derivatives, gain: f64) -> Vec<Limit> {
        let zero = JointPositions::zeros(joints.len());
        let mut rows = Vec::new();
        for load in self.loads() {
            let torques =
                |speeds, accelerations| self.arm.joint_torques(joints, speeds, accelerations, load);
            let rest = torques(&zero, &zero);
            let of_a = combine(&[1.0, -1.0], &[&torques(&zero, &at.first), &rest]);
            let of_x = combine(&[1.0, -1.0], &[&torques(&at.first, &at.second), &rest]);
            for (j, limit) in self.limits.iter().enumerate() {
                if limit.is_finite() {
                    rows.push(Limit {
                        of_a: (of_a[j] + gain * of_x[j]) / limit,
                        of_x: of_x[j] / limit,
                        rest: rest[j] / limit,
                        limit: USED,
                    });
                }
            }
        }
        rows
    }

    /// Whether the arm can stand there and have something left to move with.
    pub fn check_holding(&self, joints: &JointPositions) -> Result<(), MotionError> {
        for load in self.loads() {
            let torques = self.arm.holding_torques(joints, load);
            for (j, (torque, limit)) in torques.iter().zip(self.limits.iter()).enumerate() {
                if torque.abs() > HELD * limit {
                    return Err(MotionError::Overload {
                        joint: j + 1,
                        needed_nm: torque.abs(),
                        usable_nm: HELD * limit,
                        load_kg: load.mass,
                    });
                }
            }
        }
        Ok(())
    }
}
