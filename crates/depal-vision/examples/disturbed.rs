//! Prints how many cartons of whole layers are found, and how many false ones, in pictures that were disturbed.
//!
//! `cargo run --release -p depal-vision --example disturbed -- [FIRST_SEED] [SEEDS] [WORD]`; with a word only those
//! disturbances that have it in their name.

use depal_camera::{Material, RenderShape, SensorSpec};
use depal_frames::DepthFrame;
use depal_vision::{VisionSettings, detect};
use disturbed::Disturbance;
use rendered::{Carton, Layout, Score, block, camera, layer, looking_down, picture, stacked};

#[path = "../tests/disturbed/mod.rs"]
mod disturbed;
#[path = "../tests/rendered/mod.rs"]
mod rendered;

const TOP: f64 = 0.75;
const LAYOUTS: [Layout; 3] = [Layout::Regular20, Layout::Brick20, Layout::Pinwheel21];
const GAPS: [f64; 4] = [5.0, 3.0, 1.0, 0.0];

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    Plain(Disturbance),
    Film,
    Tape(&'static str, bool),
}

fn strip(n: usize, c: &Carton, material: Material, across: bool) -> RenderShape {
    let size = if across {
        [0.040, c.size[1] - 0.004, 0.000_2]
    } else {
        [c.size[0] - 0.004, 0.040, 0.000_2]
    };
    let mut strip = block(4000 + n as u32, [c.x, c.y, c.top], size, c.yaw, material);
    strip.world_from_shape.translation.z += 0.000_1;
    strip
}

fn frame_of(what: What, cartons: &[Carton], seed: u64) -> DepthFrame {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    let mut shapes = stacked(cartons, TOP);
    match what {
        What::Plain(disturbance) => {
            return disturbance.of(&picture(&spec, &at, &shapes, seed), seed);
        }
        What::Film => {
            for shape in &mut shapes[..cartons.len()] {
                shape.material = Material::FILM;
            }
        }
        What::Tape(name, across) => {
            let material = if name == "glossy" {
                Material::GLOSSY_TAPE
            } else {
                Material::BLACK_TAPE
            };
            for (n, c) in cartons.iter().enumerate() {
                shapes.push(strip(n, c, material, across));
            }
        }
    }
    picture(&spec, &at, &shapes, seed)
}

fn scored(what: What, layout: Layout, gap: f64, seed: u64) -> Score {
    let at = looking_down(TOP + 2.0);
    let cartons = layer(layout, gap * 1e-3, TOP, seed);
    let frame = frame_of(what, &cartons, seed);
    let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
    let detection = detect(&frame, &settings);
    let mut score = Score::default();
    score.add(&at, &cartons, &detection.boxes);
    if std::env::var("WHY").is_ok() && (score.found < score.wanted || score.false_positives > 0) {
        for c in &cartons {
            let near = |b: &&depal_vision::DetectedBox| {
                let p = (at * b.camera_from_box).translation.vector;
                (c.x - p.x).hypot(c.y - p.y) < 0.02
            };
            if !detection.boxes.iter().any(|b| near(&b)) {
                let p = at.inverse_transform_point(&depal_frames::Point::new(c.x, c.y, c.top));
                let (u, v) = frame.intrinsics.project(&p);
                println!(
                    "      missing at pixel {u:.0} {v:.0}, yaw {:.3}, {:?}",
                    c.yaw, c.size
                );
            }
        }
        for b in &detection.boxes {
            let p = (at * b.camera_from_box).translation.vector;
            let near = |c: &&Carton| {
                (c.x - p.x).hypot(c.y - p.y) < 0.02 && (c.size[0] - b.size.length).abs() < 0.02
            };
            if !cartons.iter().any(|c| near(&c)) {
                let (u, v) = frame
                    .intrinsics
                    .project(&b.camera_from_box.translation.vector.into());
                println!(
                    "      false at pixel {u:.0} {v:.0}, {:?} sides {} conf {:.2}",
                    b.size, b.proven_sides, b.confidence
                );
            }
        }
        let reasons: Vec<_> = detection.rejected.iter().map(|r| r.reason).collect();
        println!(
            "    {layout:?} {gap} seed {seed}: {}/{} false {} {reasons:?}",
            score.found, score.wanted, score.false_positives
        );
    }
    score
}

fn main() {
    let number = |n: usize, default: u64| {
        let given = std::env::args().nth(n).and_then(|a| a.parse().ok());
        given.unwrap_or(default)
    };
    let (first, seeds) = (number(1, 100), number(2, 2));
    let word = std::env::args().nth(3).unwrap_or_default();
    let mut all = vec![What::Plain(Disturbance::None)];
    all.extend([0.002, 0.01, 0.02, 0.05, 0.1, 0.2].map(|p| What::Plain(Disturbance::Lost(p))));
    all.extend([0.01, 0.02, 0.05, 0.1].map(|p| What::Plain(Disturbance::Clusters(p))));
    all.push(What::Film);
    for name in ["glossy", "black"] {
        all.extend([false, true].map(|across| What::Tape(name, across)));
    }
    all.extend(
        [
            Disturbance::Outliers(0.005),
            Disturbance::Median,
            Disturbance::Interpolated,
            Disturbance::FilledFarther,
            Disturbance::Steps(0.001),
        ]
        .map(What::Plain),
    );
    println!("| disturbance | 5 mm | 3 mm | 1 mm | 0 mm | false | xy p95 |");
    println!("|---|---|---|---|---|---|---|");
    for what in all {
        let name = format!("{what:?}");
        if !name.contains(&word) {
            continue;
        }
        let mut cells = Vec::new();
        let mut total = Score::default();
        for gap in GAPS {
            let only = |name: &str, is: String| std::env::var(name).is_ok_and(|v| v != is);
            if only("GAP", format!("{gap}")) {
                continue;
            }
            let jobs: Vec<(Layout, u64)> = LAYOUTS
                .into_iter()
                .filter(|l| !only("LAYOUT", format!("{l:?}")))
                .flat_map(|l| (first..first + seeds).map(move |s| (l, s)))
                .collect();
            let mut sum = Score::default();
            std::thread::scope(|scope| {
                let running: Vec<_> = jobs
                    .chunks(jobs.len().div_ceil(2))
                    .map(|part| {
                        scope.spawn(move || {
                            part.iter()
                                .map(|&(l, s)| scored(what, l, gap, s))
                                .collect::<Vec<_>>()
                        })
                    })
                    .collect();
                for r in running {
                    for score in r.join().expect("no estimation panics") {
                        sum.absorb(score);
                    }
                }
            });
            let f = sum.false_positives;
            let mark = if f > 0 {
                format!(" !{f}")
            } else {
                String::new()
            };
            cells.push(format!("{}/{}{mark}", sum.found, sum.wanted));
            total.absorb(sum);
        }
        println!(
            "| {name} | {} | {} | {:.2} |",
            cells.join(" | "),
            total.false_positives,
            rendered::quantile(&total.xy_mm, 0.95)
        );
    }
}
