//! The calibration of a scene: poses that are of use, and refusals that say why.

use depal_vision::calibration::sees_board;

use super::sets;
use crate::{BuildError, Scene};

/// Two layers, so that there is room above them, and a board beside the tool.
const USUAL: [(&str, &str); 3] = [
    ("cartons.layers", "2"),
    ("cartons.count", "16"),
    ("calibration.xyz_mm", "[560, 0, 240]"),
];

fn scene(changes: &[(&str, &str)]) -> Scene {
    let overrides: Vec<(String, String)> = USUAL
        .iter()
        .chain(changes)
        .chain(&[("accept.delivered_min", "16")])
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    Scene::demo(&overrides, None).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn poses_are_within_reach_in_view_and_spread() {
    let spec = scene(&[]).cell_spec().unwrap();
    let calibration = spec.calibration.as_ref().unwrap();
    let poses = &spec.interface.calibration;
    assert_eq!(poses.len(), 15);
    spec.interface.check().unwrap();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for pose in poses {
        assert!(spec.arm.within_limits(&pose.joints));
        let reached = spec.arm.base_from_flange(&pose.joints);
        assert!(
            (reached.inverse() * pose.base_from_flange)
                .translation
                .vector
                .norm()
                < 1e-6
        );
        let base_from_board = calibration.base_from_board(&pose.base_from_flange);
        let camera_from_board = spec.base_from_camera(None).inverse() * base_from_board;
        assert!(sees_board(
            &spec.camera.intrinsics,
            &camera_from_board,
            &calibration.board
        ));
        for k in 0..3 {
            let x = base_from_board.translation.vector[k];
            low[k] = low[k].min(x);
            high[k] = high[k].max(x);
        }
    }
    for k in 0..3 {
        assert!(high[k] - low[k] > 0.4, "{low:?} to {high:?}");
    }
    // The same scene gives the same poses.
    assert_eq!(
        poses,
        &scene(&[]).cell_spec().unwrap().interface.calibration
    );
}

#[test]
fn what_cannot_be_calibrated_is_refused() {
    // Without the section there is no board, and command 701 has nowhere to send the robot.
    let plain = Scene::demo(&[], None).unwrap().cell_spec().unwrap();
    assert!(plain.calibration.is_none());
    assert!(plain.interface.calibration.is_empty());
    // Out of reach.
    let far = scene(&[
        ("calibration.region_xyz_mm", "[6000, 0, 1500]"),
        ("calibration.region_size_mm", "[500, 500, 500]"),
    ]);
    let problem = far.cell_spec().unwrap_err();
    assert!(
        problem
            .to_string()
            .contains("expected 15 calibration poses, found 0"),
        "{problem}"
    );
    // Under the tool's own plate.
    let hidden = scene(&[("calibration.xyz_mm", "[0, 0, 320]")]);
    let problem = hidden.cell_spec().unwrap_err();
    assert!(matches!(problem, BuildError::Mismatch { .. }), "{problem}");
}

/// Two layers, a board on them, and a camera beside the tool.
const IN_HAND: [(&str, &str); 9] = [
    ("cartons.layers", "2"),
    ("cartons.count", "16"),
    ("accept.delivered_min", "16"),
    ("camera.mount", "flange"),
    ("camera.xyz_mm", "[0, 320, 150]"),
    ("camera.look_at_mm", "[0, 320, 1000]"),
    ("camera.image_x_along", "[1, 0, 0]"),
    ("camera.focal_px", "[1000, 1000]"),
    ("calibration.xyz_mm", "[1700, 0, 660]"),
];

#[test]
fn a_camera_on_the_flange_looks_at_the_board_from_all_around() {
    let spec = Scene::demo(&sets(&IN_HAND), None)
        .unwrap_or_else(|errors| panic!("{errors}"))
        .cell_spec()
        .unwrap_or_else(|error| panic!("{error}"));
    let calibration = spec.calibration.as_ref().unwrap();
    let mut views: Vec<depal_frames::Vector> = Vec::new();
    for pose in &spec.interface.calibration {
        assert!(spec.arm.within_limits(&pose.joints));
        let base_from_camera = spec.base_from_camera(Some(&pose.base_from_flange));
        let camera_from_board =
            base_from_camera.inverse() * calibration.base_from_board(&pose.base_from_flange);
        assert!(sees_board(
            &spec.camera.intrinsics,
            &camera_from_board,
            &calibration.board
        ));
        views.push(base_from_camera.translation.vector);
    }
    assert_eq!(views.len(), 15);
    for k in 0..3 {
        let along = || views.iter().map(|view| view[k]);
        let spread = along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min);
        assert!(spread > 0.4, "axis {k}: {spread} m");
    }
    // The same flange poses without the camera on the flange see nothing of the sort.
    let truth = spec.world_from_camera(Some(&spec.interface.calibration[0].base_from_flange));
    let other = spec.world_from_camera(Some(&spec.interface.calibration[1].base_from_flange));
    assert!((truth.translation.vector - other.translation.vector).norm() > 0.1);
}

#[test]
fn board_and_camera_are_not_both_on_the_flange_and_not_both_still() {
    let refused = |changes: &[(&str, &str)]| {
        let overrides: Vec<(&str, &str)> = IN_HAND.iter().chain(changes).copied().collect();
        Scene::demo(&sets(&overrides), None)
            .unwrap_err()
            .to_string()
    };
    let text = refused(&[("calibration.mounted", "flange")]);
    assert!(
        text.contains("expected fixed for a camera that moves with the flange, found flange"),
        "{text}"
    );
    let text = refused(&[("camera.mount", "world"), ("calibration.mounted", "fixed")]);
    assert!(
        text.contains("expected flange for a camera that stands still, found fixed"),
        "{text}"
    );
    let text = refused(&[("camera.mount", "wrist")]);
    assert!(
        text.contains("expected one of world, flange, found"),
        "{text}"
    );
    // What fits may be said.
    let overrides: Vec<(&str, &str)> = IN_HAND
        .iter()
        .chain(&[("calibration.mounted", "fixed")])
        .copied()
        .collect();
    Scene::demo(&sets(&overrides), None).unwrap_or_else(|errors| panic!("{errors}"));
}

#[test]
fn keys_that_do_not_fit_are_told() {
    let overrides = [
        ("calibration.xyz_mm", "[560, 0, 240]"),
        ("calibration.board.disc_mm", "30"),
        ("calibration.region_xyz_mm", "[1700, 0, 900]"),
    ]
    .map(|(key, value)| (key.to_owned(), value.to_owned()));
    let text = Scene::demo(&overrides, None).unwrap_err().to_string();
    assert!(
        text.contains("a quarter to half of the pitch, found 30"),
        "{text}"
    );
    assert!(text.contains("region_size_mm together"), "{text}");
}
