//! The calibration of a scene: poses that are of use, and refusals that say why.

use depal_vision::calibration::sees_board;

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
        let camera_from_board = spec.base_from_camera.inverse() * base_from_board;
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
    // A fixed board needs a camera on the flange.
    let fixed = scene(&[("calibration.mounted", "fixed")]);
    let problem = fixed.cell_spec().unwrap_err();
    assert!(
        matches!(problem, BuildError::Unsupported { .. }),
        "{problem}"
    );
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
