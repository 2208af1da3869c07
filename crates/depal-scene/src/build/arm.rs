//! The arm of a scene, with the solids of its mesh files.

use std::path::Path;

use depal_arm::{Arm, ArmWarning};

use super::BuildError;
use crate::mesh_files::MeshFiles;
use crate::robot::Robot;

/// Reads the description; its collision meshes become convex hulls for planner, physics, camera and recording alike.
/// A mesh that cannot be had is an error: without it the arm would pass through things.
pub(super) fn arm(robot: &Robot) -> Result<Arm, BuildError> {
    let accelerations: Vec<f64> = robot
        .acceleration_deg_s2
        .iter()
        .map(|a| a.to_radians())
        .collect();
    let files = MeshFiles::beside(Path::new(&robot.urdf.path)).with_packages(&robot.packages);
    let meshes = |name: &str| files.bytes(name);
    let arm =
        Arm::from_urdf_with_meshes(&robot.urdf.text, &robot.urdf.path, &accelerations, &meshes)?;
    let lost = |w: &&ArmWarning| matches!(w, ArmWarning::MeshUnread { .. });
    match arm.warnings().iter().find(lost) {
        Some(warning) => Err(BuildError::Mesh(warning.to_string())),
        None => Ok(arm),
    }
}
