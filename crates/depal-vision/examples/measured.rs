//! Prints what is measured of cartons whose sizes are not given: found, wrong, spanning, sizes.
//!
//! `cargo run --release -p depal-vision --example measured -- [FIRST_SEED] [SEEDS]`; the environment variables CASE
//! (start of a name) and GAP choose single rows, BOXES prints every wrong report.

use depal_vision::RejectReason;
use rendered::quantile;
use unsized_scenes::{
    CASES, Case, Sensor, measured, scene,
    verdict::{Verdict, judge},
};

#[path = "../tests/generator/mod.rs"]
mod generator;
#[path = "../tests/rendered/mod.rs"]
mod rendered;
#[path = "../tests/unsized_scenes/mod.rs"]
mod unsized_scenes;

type Refused = Vec<RejectReason>;

fn one(case: Case, gap: f64, sensor: Sensor, seed: u64) -> (Verdict, Refused) {
    let scene = scene(case, gap, seed, sensor);
    let detection = measured(&scene, sensor, seed);
    let mut verdict = judge(&scene, &detection.boxes);
    for note in &mut verdict.notes {
        *note = format!("seed {seed}: {note}");
    }
    let refused = detection.rejected.iter().map(|r| r.reason).collect();
    (verdict, refused)
}

fn row(case: Case, gap: f64, sensor: Sensor, seeds: &[u64]) -> Verdict {
    let mut total = Verdict::default();
    let mut refused: Refused = Vec::new();
    let parts: Vec<Vec<(Verdict, Refused)>> = std::thread::scope(|scope| {
        let running: Vec<_> = seeds
            .chunks(seeds.len().div_ceil(2).max(1))
            .map(|part| {
                scope.spawn(move || part.iter().map(|&s| one(case, gap, sensor, s)).collect())
            })
            .collect();
        running
            .into_iter()
            .map(|t| t.join().expect("no estimation panics"))
            .collect()
    });
    for (verdict, reasons) in parts.into_iter().flatten() {
        total.absorb(verdict);
        refused.extend(reasons);
    }
    let mean = total.off_mm.iter().sum::<f64>() / total.off_mm.len().max(1) as f64;
    let off: Vec<f64> = total.off_mm.iter().map(|o| o.abs()).collect();
    let of = |reason: RejectReason| refused.iter().filter(|r| **r == reason).count();
    println!(
        "| {case:?} | {} | {sensor:?} | {}/{} | {} | {} | {} | {mean:+.2} | {:.2} / {:.2} | {} | {:.2} | {} {} {} |",
        if case.has_own_gaps() {
            "own".to_string()
        } else {
            format!("{}", gap * 1e3)
        },
        total.found,
        total.wanted,
        total.wrong,
        total.covered,
        total.spanning,
        quantile(&off, 0.95),
        quantile(&off, 1.0),
        off.iter().filter(|o| **o > 2.0).count(),
        quantile(&total.xy_mm, 0.95),
        of(RejectReason::Ambiguous),
        of(RejectReason::NoKnownSize),
        of(RejectReason::Covered),
    );
    if std::env::var("BOXES").is_ok() {
        for note in &total.notes {
            println!("    {note}");
        }
    }
    total
}

fn main() {
    let argument = |n: usize, default: u64| {
        let given = std::env::args().nth(n).and_then(|a| a.parse().ok());
        given.unwrap_or(default)
    };
    let (first, count) = (argument(1, 30_000), argument(2, 10));
    let seeds: Vec<u64> = (first..first + count).collect();
    println!(
        "| case | gap mm | sensor | found | wrong | covered | spanning | size bias | size p95 / max | > 2 mm | xy p95 | ambiguous, no size, covered |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut all = Verdict::default();
    for case in CASES {
        if std::env::var("CASE").is_ok_and(|c| !format!("{case:?}").starts_with(&c)) {
            continue;
        }
        let gaps: &[f64] = if case.has_own_gaps() {
            &[0.0]
        } else {
            &[10.0, 5.0, 3.0, 1.0, 0.0]
        };
        for gap in gaps {
            if std::env::var("GAP").is_ok_and(|g| !case.has_own_gaps() && g != format!("{gap}")) {
                continue;
            }
            for sensor in [Sensor::Camera, Sensor::Second] {
                all.absorb(row(case, gap * 1e-3, sensor, &seeds));
            }
        }
    }
    println!(
        "all: {}/{} found, wrong {}, covered {}, spanning {}",
        all.found, all.wanted, all.wrong, all.covered, all.spanning
    );
}
