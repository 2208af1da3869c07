//! The active stereo preset: 10 mm of noise (one sigma) at 2 m, more than what tells two cartons apart. Averaged along
//! the tops it says enough where gaps let the projector's shadow in.

use depal_camera::{CameraSpec, SensorSpec};
use depal_frames::DepthFrame;
use depal_vision::{VisionSettings, detect};
use rendered::{
    Layout, Score, camera, layer, looking_down, picture, quantile, small_stereo, stacked,
};

mod rendered;

const TOP: f64 = 0.75;

fn frame_of(
    spec: &CameraSpec,
    layout: Layout,
    gap_mm: f64,
    distance: f64,
    seed: u64,
) -> DepthFrame {
    let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
    let at = looking_down(TOP + distance);
    picture(spec, &at, &stacked(&cartons, TOP), seed)
}

fn score(spec: &CameraSpec, layout: Layout, gap_mm: f64, distance: f64) -> Score {
    let mut score = Score::default();
    for seed in 8100..8102 {
        let frame = frame_of(spec, layout, gap_mm, distance, seed);
        let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
        let boxes = detect(&frame, &settings).boxes;
        let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
        score.add(&looking_down(TOP + distance), &cartons, &boxes);
    }
    println!(
        "{layout:?} {gap_mm} mm, {} px, {distance} m: {}",
        spec.intrinsics.fx,
        score.errors()
    );
    score
}

#[test]
fn packed_cartons_with_gaps() {
    for spec in [camera(SensorSpec::active_stereo()), small_stereo()] {
        for (layout, distance) in [
            (Layout::Regular20, 2.0),
            (Layout::Brick, 2.0),
            (Layout::Pinwheel, 1.5),
        ] {
            for gap_mm in [5.0, 3.0, 1.0] {
                let score = score(&spec, layout, gap_mm, distance);
                assert_eq!(score.false_positives, 0);
                // A gap of a third of a pixel leaves too little of an edge.
                let fine = spec.intrinsics.fx > 1000.0 || gap_mm > 1.0;
                let least = if fine { 0.9 } else { 0.05 };
                assert!(score.found as f64 >= least * score.wanted as f64);
                assert!(quantile(&score.xy_mm, 0.95) < 6.0);
                // Bowl and scale of the preset are 4 mm each.
                assert!(quantile(&score.z_mm, 0.95) < 10.0);
            }
        }
    }
}

/// Without a gap only heights would tell, and those drown: what several readings fit is refused.
#[test]
fn butted_cartons_are_not_mistaken() {
    for spec in [camera(SensorSpec::active_stereo()), small_stereo()] {
        for distance in [1.5, 2.0] {
            for layout in [Layout::Brick, Layout::Pinwheel, Layout::Regular] {
                assert_eq!(score(&spec, layout, 0.0, distance).false_positives, 0);
            }
        }
    }
}

/// The same pictures without averaging: nothing is found, as before.
#[test]
fn averaging_is_what_finds_them() {
    let spec = camera(SensorSpec::active_stereo());
    let frame = frame_of(&spec, Layout::Regular20, 3.0, 2.0, 8100);
    let suited = VisionSettings::new(Layout::Regular20.sizes()).suited_to(&frame);
    assert!(suited.average_px > 0);
    let plain = VisionSettings {
        average_px: 0,
        ..suited.clone()
    };
    assert!(detect(&frame, &suited).boxes.len() >= 18);
    assert!(detect(&frame, &plain).boxes.len() <= 10);
}

#[test]
fn better_cameras_are_not_averaged() {
    for sensor in [
        SensorSpec::laser_3m(),
        SensorSpec::laser_2m(),
        SensorSpec::ideal(),
        SensorSpec::time_of_flight(),
    ] {
        let frame = frame_of(&camera(sensor), Layout::Brick, 3.0, 2.0, 8100);
        let suited = VisionSettings::new(Layout::Brick.sizes()).suited_to(&frame);
        assert_eq!(suited.average_px, 0);
        assert!(suited.smear_px < 5, "{}", suited.smear_px);
    }
}
