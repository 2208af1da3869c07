//! Where a side of a carton does not show, one that was found beside it says that it ends there.

use depal_frames::{DepthFrame, Point};
use depal_vision::{VisionSettings, detect};
use generator::Noise;
use rendered::{Carton, Layout, Score};

mod generator;
mod rendered;

/// All of a layer are found, and nothing else, after `change` of the cartons and of their picture.
fn all_found(
    name: &str,
    (layout, gap_mm, seed): (Layout, f64, u64),
    lean: impl FnOnce(&mut [Carton]),
    change: impl FnOnce(&mut DepthFrame, &[Carton]),
) {
    let mut cartons = generator::cartons(layout, gap_mm * 1e-3, seed);
    lean(&mut cartons);
    let mut frame = generator::frame(&cartons, Noise::White, false, seed);
    change(&mut frame, &cartons);
    let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
    let mut score = Score::default();
    let detection = detect(&frame, &settings);
    score.add(&generator::at(), &cartons, &detection.boxes);
    let line = score.line();
    assert_eq!(
        score.false_positives, 0,
        "{name} {gap_mm} mm, seed {seed}: {line}"
    );
    assert_eq!(
        score.found, score.wanted,
        "{name} {gap_mm} mm, seed {seed}: {line}"
    );
}

/// The gap that the line of sight slants across shows its wall only: the surface seems to go on there.
#[test]
fn one_that_hangs_together_with_found_ones_is_no_floor() {
    for seed in 1..4 {
        let layer = (Layout::Pinwheel21, 2.0, seed);
        all_found("gaps", layer, |_| {}, |_, _| {});
    }
}

/// Under tape nothing is covered exactly: each carton must be proven by its sides, some of which are those of others
/// that were found before.
#[test]
fn cartons_with_tape_across_that_interlock() {
    for gap_mm in [1.0, 0.0] {
        for seed in [1, 5] {
            all_found(
                "tape",
                (Layout::Pinwheel21, gap_mm, seed),
                |_| {},
                |frame, cartons| tape(frame, cartons, 0.05),
            );
        }
    }
}

/// Nothing is measured on a band across the middle of each carton, from side to side.
fn tape(frame: &mut DepthFrame, cartons: &[Carton], wide: f64) {
    let k = frame.intrinsics;
    for (i, z) in frame.depth.iter_mut().enumerate() {
        let (u, v) = ((i % k.width) as f64, (i / k.width) as f64);
        let place = generator::at() * Point::from(k.ray(u, v) * f64::from(*z));
        let taped = cartons.iter().any(|c| {
            let q = c.rotation().inverse() * (place - Point::new(c.x, c.y, c.top));
            q.z.abs() < 0.01 && q.x.abs() < wide / 2.0 && q.y.abs() < c.size[1] / 2.0
        });
        if taped {
            *z = 0.0;
        }
    }
}

/// The two that touch hang together where all others are set apart: a plane fitted to both leans half as much.
#[test]
fn one_that_leans_against_another_is_found_by_what_is_level_around() {
    for seed in 1..5 {
        let layout = Layout::Regular20;
        let push = |cartons: &mut [Carton]| {
            let carton = &mut cartons[seed as usize * 7 % 15];
            carton.tilt[0] = 0.05;
            carton.top += 0.5 * carton.size[1] * 0.05;
            carton.y -= 0.005;
        };
        all_found("pushed", (layout, 5.0, seed), push, |_, _| {});
    }
}

/// It touches the next one along its low side, where no edge shows: those that stand around say that its size is known.
#[test]
fn one_that_leans_among_others_is_one_of_their_size() {
    for (seed, angle) in [(2, 0.06), (3, -0.1)] {
        let raise = |cartons: &mut [Carton]| {
            let carton = &mut cartons[seed as usize * 7 % 20];
            carton.tilt[1] = angle;
            carton.top += 0.5 * carton.size[0] * angle.abs().sin();
        };
        all_found("leaning", (Layout::Pinwheel21, 1.0, seed), raise, |_, _| {});
    }
}
