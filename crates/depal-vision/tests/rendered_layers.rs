//! Recall, false reports and errors on layers taken by the simulated camera with all noise on.

use depal_camera::{Material, RenderShape, SensorSpec};
use depal_frames::{DepthFrame, Point, Pose};
use depal_vision::{VisionSettings, detect};
use rendered::{
    Carton, Layout, Score, block, camera, layer, looking_down, picture, quantile, stacked,
};

mod rendered;

const TOP: f64 = 0.75;

fn taken(layout: Layout, gap_mm: f64, distance: f64, seeds: std::ops::Range<u64>) -> Score {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + distance);
    let mut score = Score::default();
    for seed in seeds {
        let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
        let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
        let detection = detect(&frame, &VisionSettings::new(layout.sizes()));
        score.add(&at, &cartons, &detection.boxes);
    }
    score
}

fn all(name: &str, score: &Score, xy_p95_mm: f64) {
    let line = score.line();
    assert_eq!(score.false_positives, 0, "{name}: {line}");
    assert_eq!(score.found, score.wanted, "{name}: {line}");
    assert!(quantile(&score.xy_mm, 0.5) <= 0.4, "{name}: {line}");
    assert!(quantile(&score.xy_mm, 0.95) <= xy_p95_mm, "{name}: {line}");
    assert!(quantile(&score.z_mm, 0.95) <= 1.5, "{name}: {line}");
    assert!(quantile(&score.tilt_deg, 0.95) <= 0.2, "{name}: {line}");
    assert!(quantile(&score.yaw_deg, 0.5) <= 0.1, "{name}: {line}");
}

#[test]
fn every_layout_with_wide_gaps() {
    for layout in [
        Layout::Regular,
        Layout::Brick,
        Layout::Pinwheel,
        Layout::Mixed,
    ] {
        for gap in [5.0, 3.0] {
            all(
                &format!("{layout:?} {gap} mm"),
                &taken(layout, gap, 2.0, 0..2),
                1.0,
            );
        }
    }
}

#[test]
fn every_layout_with_a_gap_of_a_pixel() {
    for layout in [
        Layout::Regular,
        Layout::Brick,
        Layout::Pinwheel,
        Layout::Mixed,
    ] {
        all(
            &format!("{layout:?} 1 mm"),
            &taken(layout, 1.0, 2.0, 0..2),
            1.0,
        );
    }
}

#[test]
fn layers_of_one_size_without_gaps() {
    for layout in [Layout::Regular, Layout::Brick, Layout::Pinwheel] {
        all(
            &format!("{layout:?} 0 mm"),
            &taken(layout, 0.0, 2.0, 0..3),
            1.2,
        );
    }
}

/// Sixteen cartons can be covered in many ways; one of them was taken for its edges although its
/// cartons were less plane.
#[test]
fn no_wrong_reading_from_farther_away() {
    let score = taken(Layout::Regular, 0.0, 2.5, 3..6);
    assert_eq!(score.false_positives, 0, "{}", score.line());
    assert_eq!(score.found, score.wanted, "{}", score.line());
}

/// Without differences in height nothing tells the readings apart: then nothing wrong is said.
#[test]
fn level_cartons_without_gaps_are_never_misread() {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    for layout in [Layout::Regular, Layout::Pinwheel] {
        let mut score = Score::default();
        for seed in 0..3 {
            let mut cartons = layer(layout, 0.0, TOP, seed);
            for carton in &mut cartons {
                carton.top = TOP;
            }
            let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
            let detection = detect(&frame, &VisionSettings::new(layout.sizes()));
            score.add(&at, &cartons, &detection.boxes);
        }
        assert_eq!(score.false_positives, 0, "{layout:?}: {}", score.line());
    }
}

/// A sheet of cardboard over a full stack is no layer of cartons.
#[test]
fn a_slip_sheet_on_a_full_stack_gives_nothing() {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    for (n, sheet) in [[1.2, 0.8], [1.16, 0.78]].into_iter().enumerate() {
        let cartons = layer(Layout::Regular, 0.003, TOP, n as u64);
        let mut shapes: Vec<RenderShape> = stacked(&cartons, TOP);
        shapes.push(block(
            2000,
            [0.0, 0.0, TOP + 0.003],
            [sheet[0], sheet[1], 0.003],
            0.004,
            Material::KRAFT,
        ));
        let frame = picture(&spec, &at, &shapes, n as u64);
        let detection = detect(&frame, &VisionSettings::new(Layout::Regular.sizes()));
        assert_eq!(detection.boxes, [], "{sheet:?}");
    }
}

/// Level cartons without gaps: depth alone tells nothing. A thin dark line along each side does, and
/// without it they are refused.
#[test]
fn dark_lines_in_the_intensity_image_tell_level_cartons_apart() {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    let (mut with, mut without) = (Score::default(), Score::default());
    for seed in 0..3 {
        let mut cartons = layer(Layout::Pinwheel, 0.0, TOP, seed);
        for carton in &mut cartons {
            carton.top = TOP;
        }
        let mut frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
        let settings = VisionSettings::new(Layout::Pinwheel.sizes());
        without.add(&at, &cartons, &detect(&frame, &settings).boxes);
        for carton in &cartons {
            draw_outline(&mut frame, &at, carton);
        }
        with.add(&at, &cartons, &detect(&frame, &settings).boxes);
    }
    assert_eq!(with.false_positives + without.false_positives, 0);
    assert!(without.found * 2 < without.wanted, "{}", without.line());
    assert!(with.found * 10 >= with.wanted * 9, "{}", with.line());
}

/// Darkens the pixels under the sides of a carton's top.
fn draw_outline(frame: &mut DepthFrame, world_from_camera: &Pose, carton: &Carton) {
    let (s, c) = carton.yaw.sin_cos();
    let half = [carton.size[0] / 2.0, carton.size[1] / 2.0];
    let width = frame.intrinsics.width;
    for n in 0..=2000 {
        let t = f64::from(n) / 1000.0 - 1.0;
        for (x, y) in [
            (t * half[0], half[1]),
            (t * half[0], -half[1]),
            (half[0], t * half[1]),
            (-half[0], t * half[1]),
        ] {
            let p = Point::new(
                carton.x + x * c - y * s,
                carton.y + x * s + y * c,
                carton.top,
            );
            let p = world_from_camera.inverse_transform_point(&p);
            let (u, v) = frame.intrinsics.project(&p);
            frame.intensity[(v + 0.5) as usize * width + (u + 0.5) as usize] = 20;
        }
    }
}
