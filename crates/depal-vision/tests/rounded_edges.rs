//! Cartons with rounded edges: found and placed as well as sharp ones, with all noise on.

use depal_camera::SensorSpec;
use depal_frames::DepthFrame;
use depal_vision::{VisionSettings, detect};
use rendered::{Carton, Layout, Score, camera, layer, looking_down, picture, quantile, stacked};

mod rendered;

const TOP: f64 = 0.75;
const DISTANCE: f64 = 2.0;

/// A layer whose edges have that radius, millimetres, and its picture.
fn rounded(layout: Layout, gap_mm: f64, radius_mm: f64, seed: u64) -> (Vec<Carton>, DepthFrame) {
    let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
    let mut shapes = stacked(&cartons, TOP);
    for shape in shapes.iter_mut().take(cartons.len()) {
        shape.edge_radius = radius_mm * 1e-3;
    }
    let at = looking_down(TOP + DISTANCE);
    let frame = picture(&camera(SensorSpec::laser_3m()), &at, &shapes, seed);
    (cartons, frame)
}

fn score(radius_mm: f64, gap_mm: f64) -> Score {
    let mut score = Score::default();
    for layout in [Layout::Regular20, Layout::Brick20, Layout::Pinwheel21] {
        for seed in 9300..9302 {
            let (cartons, frame) = rounded(layout, gap_mm, radius_mm, seed);
            let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
            let at = looking_down(TOP + DISTANCE);
            score.add(&at, &cartons, &detect(&frame, &settings).boxes);
        }
    }
    score
}

/// Ends of surfaces put a carton 1.2 mm too close to the axis for each metre beside it: half a millimetre on the
/// median.
fn check(radius_mm: f64) {
    for gap_mm in [5.0, 3.0, 1.0, 0.0] {
        let score = score(radius_mm, gap_mm);
        let line = score.errors();
        let what = format!("radius {radius_mm} mm, gap {gap_mm} mm: {line}");
        assert_eq!(score.found, score.wanted, "{what}");
        assert_eq!(score.false_positives, 0, "{what}");
        assert!(quantile(&score.xy_mm, 0.5) <= 0.4, "{what}");
        let most = if gap_mm == 0.0 { 1.2 } else { 1.0 };
        assert!(quantile(&score.xy_mm, 0.95) <= most, "{what}");
        assert!(quantile(&score.yaw_deg, 0.95) <= 0.2, "{what}");
    }
}

#[test]
fn edges_of_2_mm() {
    check(2.0);
}

#[test]
fn edges_of_3_mm() {
    check(3.0);
}

#[test]
fn edges_of_5_mm() {
    check(5.0);
}
