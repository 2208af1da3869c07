//! Pictures of a cheap stereo camera, of stacks drawn by chance: one to three layers, cartons of 250 to 600 mm,
//! 1.2 to 2.2 m away, leaning up to ten degrees, smeared over 11 to 21 pixels, with waves and losses.

use cheap::{Flaws, exact, flawed, picture, shapes, share_in_view};
use depal_frames::{BoxSize, Pose, Rotation, Vector};
use depal_time::RandomStreams;
use depal_vision::{VisionSettings, detect};
use rendered::{Carton, HEIGHT, Score, looking_down};

mod cheap;
mod rendered;

const FLOOR: f64 = 0.144;

struct Scene {
    size: [f64; 2],
    cartons: Vec<Carton>,
    at: Pose,
    reach: usize,
    flaws: Flaws,
    what: String,
}

/// A stack in view of the camera.
fn scene(seed: u64) -> Scene {
    let mut r = RandomStreams::new(seed).stream("scene");
    let mut pick = |n: usize| (r.uniform(0.0, n as f64) as usize).min(n - 1);
    let reach = [5, 7, 10][pick(3)];
    let layers = 1 + pick(3);
    let kind = pick(3);
    let distance = r.uniform(1.2, 2.2);
    let lean = r.uniform(-10.0, 10.0f64);
    let a = (r.uniform(0.25, 0.6) * 200.0).round() / 200.0;
    let b = (r.uniform(0.25, 0.6) * 200.0).round() / 200.0;
    let size = [a.max(b), a.min(b)];
    let gap = r.uniform(0.0, 0.004);
    // What the camera sees of the uppermost layer, a margin left.
    let view = [640.0, 480.0].map(|n| 0.85 * distance * n / 600.0);
    let counts = [0, 1].map(|k| ((view[k] / size[k]) as usize).clamp(1, 4));
    let covered = |layer: usize, i: usize, j: usize| {
        // Each layer stands on the one before.
        (1..=layer).all(|n| match kind {
            0 => i + n < counts[0].max(1 + n),
            1 => j + n < counts[1].max(1 + n),
            _ => i + n < counts[0].max(1 + n) || j + n < counts[1].max(1 + n),
        })
    };
    let mut cartons = Vec::new();
    for layer in 0..layers {
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                if !covered(layer, i, j) {
                    continue;
                }
                let place = |n: usize, of: usize, side: f64| {
                    (n as f64 - (of as f64 - 1.0) / 2.0) * (side + gap)
                };
                cartons.push(Carton {
                    x: place(i, counts[0], size[0]),
                    y: place(j, counts[1], size[1]),
                    top: FLOOR + HEIGHT * (layer as f64 + 1.0),
                    yaw: 0.0,
                    tilt: [0.0; 2],
                    size: [size[0], size[1], HEIGHT],
                });
            }
        }
    }
    let top = cartons.iter().fold(0.0f64, |t, c| t.max(c.top));
    let turn = Rotation::new(Vector::x() * lean.to_radians())
        * Rotation::new(Vector::z() * r.uniform(-0.3, 0.3));
    let from = turn * Vector::new(0.0, 0.0, distance) + Vector::new(0.0, 0.0, top);
    let at = Pose::from_parts(from.into(), turn * looking_down(0.0).rotation);
    let flaws = Flaws {
        wave: [r.uniform(0.001, 0.0025), r.uniform(80.0, 240.0)],
        lost: r.uniform(0.0, 0.6),
    };
    let what = format!(
        "{:.0}x{:.0} {}x{} layers {layers} kind {kind} reach {reach} at {distance:.2} lean {lean:.1} gap {:.1} lost {:.1} wave {:.1}/{:.0}",
        size[0] * 1e3,
        size[1] * 1e3,
        counts[0],
        counts[1],
        gap * 1e3,
        flaws.lost,
        flaws.wave[0] * 2e3,
        flaws.wave[1],
    );
    Scene {
        size,
        cartons,
        at,
        reach,
        flaws,
        what,
    }
}

/// The score of one stack, and whether all was said.
fn score_of(seed: u64, with_intensity: bool) -> (Score, String) {
    let s = scene(seed);
    let solids = shapes(&s.cartons);
    let truth = exact(&s.at, &solids);
    let mut frame = flawed(
        picture(&s.at, &solids, s.reach, seed),
        &truth.depth,
        s.flaws,
        seed,
    );
    if !with_intensity {
        frame.intensity = Vec::new();
    }
    let (full, partly): (Vec<Carton>, Vec<Carton>) = s
        .cartons
        .iter()
        .filter(|c| share_in_view(c, &s.at, &truth) > 0.3)
        .partition(|c| share_in_view(c, &s.at, &truth) > 0.97);
    let size = BoxSize::from_mm([s.size[0] * 1e3, s.size[1] * 1e3, HEIGHT * 1e3]);
    let settings = VisionSettings::new(vec![size]).suited_to(&frame);
    let detection = detect(&frame, &settings);
    let mut score = Score::default();
    score.add(&s.at, &full, &detection.boxes);
    // What shows a part of its top may be found as well.
    let mut of_parts = Score::default();
    of_parts.add(&s.at, &partly, &detection.boxes);
    score.false_positives -= of_parts.found.min(score.false_positives);
    let reasons: Vec<String> = detection
        .rejected
        .iter()
        .filter(|r| r.area > 0.02)
        .map(|r| format!("{:?} {:.3}", r.reason, r.area))
        .collect();
    let line = format!(
        "{seed} {}/{} false {} xy {:.1} | {} | smear {} step {:.1} | {}",
        score.found,
        score.wanted,
        score.false_positives,
        rendered::quantile(&score.xy_mm, 1.0),
        s.what,
        settings.smear_px,
        settings.step * 1e3,
        reasons.join(", ")
    );
    (score, line)
}

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |n| n.parse().unwrap_or(otherwise))
}

#[test]
fn stacks_drawn_by_chance() {
    let from = number("FROM", 7000);
    for with_intensity in [true, false] {
        let mut total = Score::default();
        for seed in from..from + number("COUNT", 40) {
            let (score, line) = score_of(seed, with_intensity);
            if score.found < score.wanted || score.false_positives > 0 {
                println!("{line}");
            }
            total.absorb(score);
        }
        println!("intensity {with_intensity}: {}", total.line());
        assert_eq!(total.false_positives, 0);
        assert!(total.found as f64 >= 0.9 * total.wanted as f64);
    }
}
