//! What is drawn once: the still parts of the cell, and the solids of what moves.

use depal_frames::{Intrinsics, PlacedShape, Pose};
use rerun::{
    Pinhole, RecordingStream, RecordingStreamResult, SeriesLines, TextDocument, ViewCoordinates,
};

use crate::picture::IMAGE_STEP;
use crate::shapes::{log_static_shapes, transform};

/// What does not change during a run and is drawn once.
#[derive(Debug, Clone)]
pub struct RecordingSetup {
    /// Name shown by the viewer: scene and seed.
    pub title: String,
    /// Markdown shown in the Readme tab.
    pub readme: String,
    /// The arm's links with their coloured solids, in link frames.
    pub arm_links: Vec<(String, Vec<(PlacedShape, [u8; 3])>)>,
    /// Joint names, in the order of the joint positions.
    pub joint_names: Vec<String>,
    /// Solids of the gripper, in the tool frame.
    pub gripper_bodies: Vec<PlacedShape>,
    /// Rectangle of each section in the tool frame: min x, max x, min y, max y, metres.
    pub section_areas: Vec<[f64; 4]>,
    /// Everything that stands still: name, solids in the world frame, colour.
    pub fixed: Vec<(String, Vec<PlacedShape>, [u8; 3])>,
    /// The camera.
    pub intrinsics: Intrinsics,
    /// World pose of a camera that stands still; one on the flange comes with each capture.
    pub world_from_camera: Option<Pose>,
}

/// Draws what stands still, the shapes of what moves, and the names of the plots.
pub(crate) fn log_setup(
    stream: &RecordingStream,
    setup: &RecordingSetup,
) -> RecordingStreamResult<()> {
    stream.log_static("/", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    stream.log_static(
        "readme",
        &TextDocument::new(setup.readme.as_str()).with_media_type("text/markdown"),
    )?;
    for (name, shapes, rgb) in &setup.fixed {
        let coloured: Vec<_> = shapes.iter().map(|shape| (shape.clone(), *rgb)).collect();
        log_static_shapes(stream, &format!("world/{name}"), &coloured)?;
    }
    for (name, shapes) in &setup.arm_links {
        log_static_shapes(stream, &format!("world/robot/{name}"), shapes)?;
    }
    let mut tool: Vec<_> = setup
        .gripper_bodies
        .iter()
        .map(|body| (body.clone(), [70, 70, 78]))
        .collect();
    for area in &setup.section_areas {
        let centre =
            Pose::translation(0.5 * (area[0] + area[1]), 0.5 * (area[2] + area[3]), -0.004);
        let size = depal_frames::Vector::new(area[1] - area[0], area[3] - area[2], 0.006);
        tool.push((PlacedShape::cuboid(centre, size), [30, 110, 180]));
    }
    log_static_shapes(stream, "world/robot/gripper", &tool)?;
    if let Some(world_from_camera) = &setup.world_from_camera {
        stream.log_static("world/camera", &transform(world_from_camera))?;
    }
    let step = IMAGE_STEP as f32;
    let i = &setup.intrinsics;
    stream.log_static(
        "world/camera/image",
        &Pinhole::from_focal_length_and_resolution(
            [i.fx as f32 / step, i.fy as f32 / step],
            [
                (i.width / IMAGE_STEP) as f32,
                (i.height / IMAGE_STEP) as f32,
            ],
        )
        .with_camera_xyz(rerun::components::ViewCoordinates::RDF)
        .with_image_plane_distance(0.3),
    )?;
    for section in 1..=setup.section_areas.len() {
        stream.log_static(
            format!("gripper/vacuum/section_{section}"),
            &SeriesLines::new().with_names([format!("section {section}")]),
        )?;
    }
    Ok(())
}
