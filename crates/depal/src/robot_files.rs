//! Mesh files of a robot description that is named on the command line.

use std::path::Path;

use depal_scene::MeshFiles;

/// Beside and above the description, and in the folders of `ROS_PACKAGE_PATH`.
pub fn mesh_files(urdf: &Path) -> MeshFiles {
    let list = std::env::var_os("ROS_PACKAGE_PATH").unwrap_or_default();
    let folders = std::env::split_paths(&list).filter(|p| !p.as_os_str().is_empty());
    MeshFiles::beside(urdf).searching(folders.collect(), "ROS_PACKAGE_PATH")
}
