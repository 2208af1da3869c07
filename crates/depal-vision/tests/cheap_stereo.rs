//! Pictures of a cheap stereo camera: 640 x 480, steps of one millimetre, several millimetres of
//! correlated noise, every depth step smeared over eleven to fifteen pixels, cartons packed tightly.
//!
//! At least nine of ten fully visible tops of both layers are found, and none spans two cartons.

use cheap::{picture, shapes};
use depal_frames::{BoxSize, Pose, Rotation, Vector};
use depal_vision::{DetectedBox, VisionSettings, detect, detect_any_size};
use rendered::{Carton, HEIGHT, Score, looking_down};

mod cheap;
mod rendered;

const TOP: f64 = 0.75;

/// Two layers of `columns` x `rows` cartons; of the upper one only the first columns are there.
fn two_layers(size: [f64; 2], columns: usize, rows: usize, upper: usize) -> Vec<Carton> {
    const GAP: f64 = 0.002;
    let mut cartons = Vec::new();
    for (layer, count) in [(0, columns), (1, upper)] {
        for i in 0..count {
            for j in 0..rows {
                let place = |n: usize, of: usize, side: f64| {
                    (n as f64 - (of as f64 - 1.0) / 2.0) * (side + GAP)
                };
                cartons.push(Carton {
                    x: place(i, columns, size[0]),
                    y: place(j, rows, size[1]),
                    top: TOP - HEIGHT * f64::from(1 - layer),
                    yaw: 0.0,
                    tilt: [0.0; 2],
                    size: [size[0], size[1], HEIGHT],
                });
            }
        }
    }
    cartons
}

/// Those of the upper layer, and those of the lower one beside it.
fn visible(cartons: &[Carton]) -> Vec<Carton> {
    let bare = |c: &&Carton| {
        !cartons
            .iter()
            .any(|o| o.top > c.top + 0.01 && (o.x - c.x).abs() < 0.1 && (o.y - c.y).abs() < 0.1)
    };
    cartons.iter().filter(bare).copied().collect()
}

fn leaning(degrees: f64) -> Pose {
    // Turned about a point of its axis, at the height of the stack.
    let down = looking_down(0.0);
    let turn = Rotation::new(Vector::x() * degrees.to_radians());
    let at = turn * Vector::new(0.0, 0.0, 1.5) + Vector::new(0.0, 0.0, TOP);
    Pose::from_parts(at.into(), turn * down.rotation)
}

/// All tops that lie bare, of both layers.
fn score(
    cartons: &[Carton],
    size: [f64; 2],
    at: &Pose,
    with_intensity: bool,
    seeds: std::ops::Range<u64>,
) -> Score {
    let mut score = Score::default();
    for seed in seeds {
        for reach in [5, 7] {
            let mut frame = picture(at, &shapes(cartons), reach, seed);
            if !with_intensity {
                frame.intensity = Vec::new();
            }
            let size = BoxSize::from_mm([size[0] * 1e3, size[1] * 1e3, HEIGHT * 1e3]);
            let settings = VisionSettings::new(vec![size]).suited_to(&frame);
            assert!(
                (7..=22).contains(&settings.smear_px),
                "{}",
                settings.smear_px
            );
            let boxes: Vec<DetectedBox> = detect(&frame, &settings).boxes;
            score.add(at, &visible(cartons), &boxes);
        }
    }
    score
}

fn most(name: &str, score: &Score, share: f64) {
    let line = score.line();
    println!("{name}: {line}");
    assert_eq!(score.false_positives, 0, "{name}: {line}");
    assert!(
        score.found as f64 >= share * score.wanted as f64,
        "{name}: {line}"
    );
}

#[test]
fn tight_layers_that_one_arrangement_covers_need_no_intensity() {
    let size = [0.4, 0.3];
    let cartons = two_layers(size, 3, 3, 1);
    let score = score(&cartons, size, &looking_down(TOP + 1.5), false, 3000..3004);
    most("400 x 300", &score, 0.9);
}

#[test]
fn small_cartons_with_and_without_intensity() {
    let size = [0.3, 0.2];
    let cartons = two_layers(size, 4, 4, 2);
    let at = looking_down(TOP + 1.5);
    for with_intensity in [true, false] {
        let score = score(&cartons, size, &at, with_intensity, 3010..3013);
        most("300 x 200", &score, 0.9);
    }
}

/// Six cartons on a square, or bricks on a rectangle, that depth alone allows to be arranged in several ways.
#[test]
fn where_depth_allows_several_arrangements_the_right_one_is_found() {
    let size = [0.3, 0.2];
    let at = looking_down(TOP + 1.5);
    for [columns, rows] in [[2, 3], [2, 6], [3, 3], [4, 3]] {
        for with_intensity in [true, false] {
            let cartons = two_layers(size, columns, rows, columns);
            let score = score(&cartons, size, &at, with_intensity, 3030..3034);
            most(&format!("{columns} x {rows}"), &score, 0.9);
        }
    }
}

/// Both layers lie bare in part, the camera leans, and steps are smeared over up to 21 pixels.
#[test]
fn layers_smeared_over_twenty_pixels() {
    let size = [0.4, 0.3];
    for reach in [5, 7, 10] {
        let mut score = Score::default();
        for seed in 3050..3052 {
            for upper in [1, 2] {
                let cartons = two_layers(size, 2, 3, upper);
                for degrees in [0.0, 10.0, -10.0] {
                    let at = leaning(degrees);
                    let mut frame = picture(&at, &shapes(&cartons), reach, seed);
                    frame.intensity = Vec::new();
                    let size = BoxSize::from_mm([size[0] * 1e3, size[1] * 1e3, HEIGHT * 1e3]);
                    let settings = VisionSettings::new(vec![size]).suited_to(&frame);
                    score.add(&at, &visible(&cartons), &detect(&frame, &settings).boxes);
                }
            }
        }
        most(&format!("reach {reach}"), &score, 0.9);
    }
}

#[test]
fn a_wrong_size_is_never_reported() {
    let cartons = two_layers([0.4, 0.3], 3, 3, 1);
    let at = looking_down(TOP + 1.5);
    for seed in 3040..3042 {
        let frame = picture(&at, &shapes(&cartons), 6, seed);
        // Not 300 x 200: six of those would cover just what three of the real ones do.
        for wrong in [
            [320.0, 220.0],
            [600.0, 400.0],
            [360.0, 300.0],
            [440.0, 300.0],
        ] {
            let size = BoxSize::from_mm([wrong[0], wrong[1], HEIGHT * 1e3]);
            let settings = VisionSettings::new(vec![size]).suited_to(&frame);
            assert_eq!(detect(&frame, &settings).boxes, [], "{wrong:?}");
        }
    }
}

#[test]
fn leaning_stacks() {
    let size = [0.4, 0.3];
    let cartons = two_layers(size, 3, 3, 1);
    for degrees in [10.0, -10.0] {
        let score = score(&cartons, size, &leaning(degrees), true, 3020..3022);
        most(&format!("lean {degrees}"), &score, 0.9);
    }
}

#[test]
fn free_standing_tops_are_measured() {
    let at = looking_down(TOP + 1.5);
    // Two of the smaller one side by side are not as large as the larger one: heights of this camera part nothing.
    let cartons = [[-0.35, 0.3, 0.2], [0.15, 0.4, 0.35]].map(|[x, l, w]| Carton {
        x,
        y: 0.02,
        top: TOP,
        yaw: 0.05,
        tilt: [0.0; 2],
        size: [l, w, HEIGHT],
    });
    let mut score = Score::default();
    for seed in 0..4 {
        let frame = picture(&at, &shapes(&cartons), 7, seed);
        let settings = VisionSettings::new(Vec::new()).suited_to(&frame);
        score.add(&at, &cartons, &detect_any_size(&frame, &settings).boxes);
    }
    most("measured", &score, 0.9);
}
