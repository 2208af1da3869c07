//! Prints recall, false reports and errors of whole layers seen by the second sensor model, against layout and gap.
//!
//! `cargo run --release -p depal-vision --example packed -- [FIRST_SEED] [SEEDS]`; the environment variables GAP and
//! LAYOUT choose single rows, BOXES prints the errors of each carton.

use depal_vision::{Detection, VisionSettings, detect};
use generator::Noise;
use rendered::{Carton, Layout, Score, quantile};

#[path = "../tests/generator/mod.rs"]
mod generator;
#[path = "../tests/rendered/mod.rs"]
mod rendered;

const LAYOUTS: [Layout; 3] = [Layout::Regular20, Layout::Brick20, Layout::Pinwheel21];

fn detected(layout: Layout, gap: f64, seed: u64) -> (Vec<Carton>, Detection) {
    let cartons = generator::cartons(layout, gap * 1e-3, seed);
    let frame = generator::frame(&cartons, Noise::White, false, seed);
    let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
    let detection = detect(&frame, &settings);
    (cartons, detection)
}

fn print_boxes(cartons: &[Carton], detection: &Detection) {
    for c in cartons {
        for b in &detection.boxes {
            let pose = generator::at() * b.camera_from_box;
            let p = pose.translation.vector;
            if (c.x - p.x).hypot(c.y - p.y) < 0.02 {
                let x = pose.rotation * depal_frames::Vector::x();
                let mut yaw = x.y.atan2(x.x) - c.yaw;
                yaw -= (yaw / std::f64::consts::PI).round() * std::f64::consts::PI;
                println!(
                    "box {:6.1} {:6.1}  error {:+.2} {:+.2} mm, yaw {:+.3} deg, sides {}",
                    c.x * 1e3,
                    c.y * 1e3,
                    (p.x - c.x) * 1e3,
                    (p.y - c.y) * 1e3,
                    yaw.to_degrees(),
                    b.proven_sides
                );
            }
        }
    }
}

fn main() {
    let argument = |n: usize, default: u64| {
        let given = std::env::args().nth(n).and_then(|a| a.parse().ok());
        given.unwrap_or(default)
    };
    let (first, seeds) = (argument(1, 15_000), argument(2, 10));
    let chosen = |name: &str, value: String| std::env::var(name).is_ok_and(|v| v != value);
    println!(
        "| layout | gap mm | found | false | xy median / p95 | z p95 | yaw median / p95 | tilt p95 | max xy | refused |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for layout in LAYOUTS {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            if chosen("GAP", format!("{gap}")) || chosen("LAYOUT", format!("{layout:?}")) {
                continue;
            }
            let frames: Vec<u64> = (first..first + seeds).collect();
            let mut score = Score::default();
            let mut refused = Vec::new();
            let halves: Vec<Vec<(u64, Vec<Carton>, Detection)>> = std::thread::scope(|scope| {
                let running: Vec<_> = frames
                    .chunks(frames.len().div_ceil(2).max(1))
                    .map(|part| {
                        scope.spawn(move || {
                            part.iter()
                                .map(|&seed| {
                                    let (cartons, detection) = detected(layout, gap, seed);
                                    (seed, cartons, detection)
                                })
                                .collect()
                        })
                    })
                    .collect();
                running
                    .into_iter()
                    .map(|r| r.join().expect("no estimation panics"))
                    .collect()
            });
            for (seed, cartons, detection) in halves.iter().flatten() {
                let mut own = Score::default();
                own.add(&generator::at(), cartons, &detection.boxes);
                if own.found < own.wanted || own.false_positives > 0 {
                    let reasons: Vec<_> = detection.rejected.iter().map(|r| r.reason).collect();
                    refused.push(format!("{seed}: {}/{} {reasons:?}", own.found, own.wanted));
                }
                if std::env::var("BOXES").is_ok() {
                    println!("seed {seed}");
                    print_boxes(cartons, detection);
                }
                score.absorb(own);
            }
            println!(
                "| {layout:?} | {gap} | {} | {:.2} | {} |",
                score.errors(),
                quantile(&score.xy_mm, 1.0),
                refused.len()
            );
            for line in refused {
                println!("    {line}");
            }
        }
    }
}
