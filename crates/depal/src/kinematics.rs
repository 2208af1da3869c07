//! `depal kinematics`: postures of an arm, where its links are then, and what the inverse gives back.

use std::path::Path;

use depal_arm::{Arm, ArmWarning};
use depal_frames::{JointPositions, Pose};
use depal_time::RandomStreams;
use serde_json::{Map, Value, json};

use crate::failure::Failure;

/// Prints `samples` random postures inside the limits.
pub fn kinematics(path: &Path, samples: usize, seed: u64, as_json: bool) -> Result<(), Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::unread(path, error))?;
    let arm = Arm::from_urdf_uniform(&text, &path.to_string_lossy(), 1.0)
        .map_err(|error| Failure::Input(error.to_string()))?;
    for warning in arm.warnings() {
        // Meshes do not move a link.
        if !matches!(warning, ArmWarning::MeshSkipped { .. }) {
            tell!("warning: {warning}");
        }
    }
    let mut random = RandomStreams::new(seed).stream("kinematics");
    let mut listed = Vec::new();
    for index in 0..samples {
        let mut joints = JointPositions::zeros(arm.joint_count());
        for (q, limit) in joints.iter_mut().zip(arm.limits()) {
            *q = random.uniform(limit.lower, limit.upper);
        }
        let base_from_tip = arm.base_from_flange(&joints);
        let solutions = arm.inverse(&base_from_tip);
        if !as_json {
            print_row(index, &joints, &base_from_tip, solutions.len());
            continue;
        }
        let links: Map<String, Value> = arm
            .links()
            .iter()
            .zip(arm.base_from_links(&joints))
            .map(|(link, pose)| (link.name.clone(), pose_json(&pose)))
            .collect();
        let ik: Vec<Vec<f64>> = solutions.iter().map(|s| s.to_vec()).collect();
        listed.push(json!({
            "joints": joints.to_vec(), "links": links, "tip": pose_json(&base_from_tip), "ik": ik,
        }));
    }
    if as_json {
        let document = json!({
            "base": arm.links()[0].name, "tip": arm.tip(), "joint_names": arm.joint_names(),
            "samples": listed,
        });
        say!("{document}");
    }
    Ok(())
}

fn pose_json(pose: &Pose) -> Value {
    let (t, q) = (pose.translation.vector, pose.rotation);
    json!({"xyz_m": [t.x, t.y, t.z], "quat_wxyz": [q.w, q.i, q.j, q.k]})
}

fn print_row(index: usize, joints: &JointPositions, base_from_tip: &Pose, solutions: usize) {
    let degrees: Vec<String> = joints
        .to_degrees()
        .iter()
        .map(|d| format!("{d:.1}"))
        .collect();
    let at = base_from_tip.translation.vector;
    say!(
        "{index}: joints {} deg, tip at ({:.4}, {:.4}, {:.4}) m, {solutions} solutions",
        degrees.join(" "),
        at.x,
        at.y,
        at.z
    );
}
