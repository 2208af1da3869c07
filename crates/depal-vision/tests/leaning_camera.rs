//! Cameras that look at a layer from the side: side faces come into view, and tops are narrow.

use depal_camera::SensorSpec;
use depal_frames::{Pose, Rotation, Vector};
use depal_vision::{VisionSettings, detect};
use rendered::{Layout, Score, camera, layer, looking_down, picture, quantile, stacked};

mod rendered;

const TOP: f64 = 0.75;

/// A camera `distance` metres from the middle of the tops, its axis so far from the vertical, in that direction.
fn leaning(distance: f64, lean_deg: f64, towards: Vector) -> Pose {
    let about = Vector::z().cross(&towards);
    Pose::translation(0.0, 0.0, TOP)
        * Rotation::new(about.normalize() * lean_deg.to_radians())
        * looking_down(distance)
}

fn taken(layout: Layout, gap_mm: f64, lean_deg: f64, towards: Vector) -> Score {
    let spec = camera(SensorSpec::laser_3m());
    let at = leaning(2.2, lean_deg, towards);
    let mut score = Score::default();
    for seed in 0..2 {
        let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
        let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
        let detection = detect(&frame, &VisionSettings::new(layout.sizes()));
        score.add(&at, &cartons, &detection.boxes);
    }
    score
}

#[test]
fn a_camera_may_lean_as_far_as_a_wall_mount_makes_it() {
    for towards in [Vector::x(), Vector::y(), Vector::new(1.0, -2.0, 0.0)] {
        for lean in [20.0, 30.0] {
            for (layout, gap) in [
                (Layout::Regular, 5.0),
                (Layout::Brick, 3.0),
                (Layout::Pinwheel, 1.0),
                (Layout::Regular, 0.0),
            ] {
                let score = taken(layout, gap, lean, towards);
                let line = score.line();
                let name = format!("{layout:?} {gap} mm, {lean} degrees to {towards:?}");
                println!("{name}: {line}");
                assert_eq!(score.false_positives, 0, "{name}: {line}");
                assert_eq!(score.found, score.wanted, "{name}: {line}");
                assert!(quantile(&score.xy_mm, 0.95) <= 3.0, "{name}: {line}");
                assert!(quantile(&score.yaw_deg, 0.95) <= 0.6, "{name}: {line}");
                assert!(quantile(&score.tilt_deg, 0.95) <= 0.6, "{name}: {line}");
            }
        }
    }
}

/// Of a stack seen from far below its tops only a side face would remain; it is none of the tops.
#[test]
fn side_faces_are_no_tops() {
    let spec = camera(SensorSpec::laser_3m());
    // Standing cartons whose sides have the known size: 300 wide and 200 high.
    let cartons = layer(Layout::Regular, 0.005, TOP, 1);
    let at = leaning(2.2, 48.0, Vector::y());
    let frame = picture(&spec, &at, &stacked(&cartons, TOP), 1);
    let found = detect(&frame, &VisionSettings::new(Layout::Regular.sizes())).boxes;
    let up = at.rotation.inverse() * Vector::z();
    for carton in found {
        let normal = carton.camera_from_box.rotation * Vector::z();
        assert!(normal.angle(&up) < 0.1, "{carton:?}");
    }
}
