//! Vision's results in the server's words.

use depal_frames::BoxSize;
use depal_interface::{CustomPort, Status, VisionPoint, VisionResult};

use crate::picture::Picture;
use crate::spec::{CellSpec, VisionProject};

/// The points of a picture with the data of the project's own; what vision says where it has none, 1024 if a port has
/// not a row for each.
pub(super) fn vision_result(spec: &CellSpec, picture: &Picture) -> Result<VisionResult, Status> {
    let labels = picture.labels.clone()?;
    let points: Vec<VisionPoint> = labels
        .into_iter()
        .zip(&picture.base_from_boxes)
        .map(|(label, base_from_object)| VisionPoint {
            base_from_object: *base_from_object,
            label,
        })
        .collect();
    let custom_ports = custom_ports(spec, picture)?;
    Ok(VisionResult {
        points,
        custom_ports,
    })
}

/// The project's own data, a row of every port for each report of a picture.
pub(crate) fn custom_ports(spec: &CellSpec, picture: &Picture) -> Result<Vec<CustomPort>, Status> {
    let project = spec.projects.get(&picture.project);
    project
        .map_or(Ok(Vec::new()), |project| {
            project.custom_rows(picture.detection.boxes.len())
        })
        .map_err(|_port| Status::PosesNotCustomData)
}

/// What a vision project reports where the planning project reports this; its own codes stay.
pub(super) fn seen_from_vision(status: Status) -> Status {
    let is_own = |status: &Status| (1001..1100).contains(&status.code());
    if is_own(&status) {
        return status;
    }
    let codes = Status::ALL.iter().copied();
    codes
        .filter(|code| is_own(code) && *code != Status::VisionTimeout)
        .find(|code| code.seen_from_viz() == status)
        .unwrap_or(Status::PathPlanningError)
}

/// A project as recipe (103) and box size (501) leave it: the size wins.
pub(super) fn configured(
    spec: &CellSpec,
    project: i32,
    recipe: Option<i32>,
    size: Option<BoxSize>,
) -> VisionProject {
    let mut project = spec
        .projects
        .get(&project)
        .expect("server and workflow know the same projects")
        .clone();
    if let Some(recipe) = recipe.and_then(|recipe| project.recipes.remove(&recipe)) {
        project.settings.sizes = recipe.sizes;
        project.labels = recipe.labels;
    }
    if let Some(size) = size {
        project.settings.sizes = vec![size];
    }
    project
}
