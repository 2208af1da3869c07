//! Two computations of the same flange must agree.

use std::collections::BTreeMap;

use depal_frames::{JointPositions, Pose, convert};

use crate::{ArmError, Place, arm::Inverse, urdf::Loaded};

/// Flange poses of two computations may differ by this much, m.
const FORWARD_TOLERANCE_M: f64 = 1e-9;
/// ... and by this much, rad (the angle between two nearly equal quaternions is itself known to about 1e-8).
const FORWARD_TOLERANCE_RAD: f64 = 1e-7;
/// Joint states on which a description is checked.
const CHECKED_STATES: usize = 64;

/// The flat chain against the closed-form model and against an independent reading of the same file.
pub(crate) fn check_forward(
    loaded: &Loaded,
    inverse: &Inverse,
    model_from_base: &Pose,
    file: &str,
) -> Result<(), ArmError> {
    let oracle = k::Chain::<f64>::from(&loaded.robot);
    for state in 0..CHECKED_STATES {
        // A fixed low-discrepancy walk through the joint box (multiples of irrational numbers, modulo 1).
        let mut joints = JointPositions::zeros(loaded.limits.len());
        for (i, limit) in loaded.limits.iter().enumerate() {
            let root = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0][i % 8].sqrt();
            let fraction = (root * (state as f64 + 0.5)).fract();
            joints[i] = limit.lower + (limit.upper - limit.lower) * fraction;
        }
        let ours = loaded.chain.base_from_tip(&joints);
        let closed_form = match inverse {
            Inverse::Wrist(solver) => {
                Some(model_from_base.inverse() * solver.base_from_flange(&joints))
            }
            Inverse::Palletizer(_) | Inverse::Numeric => None,
        };
        let chain = oracle_pose(&oracle, loaded, &joints);
        for (oracle, other) in [
            ("the closed-form model", closed_form),
            ("the chain library", Some(chain)),
        ] {
            let Some(other) = other else { continue };
            let error_m = (ours.translation.vector - other.translation.vector).norm();
            let error_rad = ours.rotation.angle_to(&other.rotation);
            if !(error_m <= FORWARD_TOLERANCE_M && error_rad <= FORWARD_TOLERANCE_RAD) {
                return Err(ArmError::ForwardMismatch {
                    at: Place::file(file),
                    oracle,
                    error_m,
                    error_rad,
                    joints: joints.to_vec(),
                });
            }
        }
    }
    Ok(())
}

/// Flange pose by the chain library. NaN (a mismatch) when it does not know the joints or the flange.
pub(crate) fn oracle_pose(
    oracle: &k::Chain<f64>,
    loaded: &Loaded,
    joints: &JointPositions,
) -> Pose {
    let mut positions: BTreeMap<&str, f64> = BTreeMap::new();
    for (name, &position) in loaded.joint_names.iter().zip(joints.iter()) {
        positions.insert(name, position);
    }
    // A node does not move its mimics: chains of them are followed until nothing new is known.
    let mimics = || {
        let joints = loaded.robot.joints.iter();
        joints.filter_map(|j| Some((j.name.as_str(), j.mimic.as_ref()?)))
    };
    for _ in mimics() {
        for (name, mimic) in mimics() {
            if let Some(master) = positions.get(mimic.joint.as_str()) {
                let position =
                    mimic.multiplier.unwrap_or(1.0) * master + mimic.offset.unwrap_or(0.0);
                positions.insert(name, position);
            }
        }
    }
    for (name, &position) in &positions {
        if let Some(node) = oracle.find(name) {
            node.set_joint_position_unchecked(position);
        }
    }
    oracle.update_transforms();
    match oracle
        .find_link(&loaded.tip)
        .and_then(k::Node::world_transform)
    {
        Some(pose) => convert::from_nalgebra_030(&pose),
        None => Pose::translation(f64::NAN, f64::NAN, f64::NAN),
    }
}
