//! Recall, false positives, errors and time against layout, gap, camera preset and height.
//!
//! `cargo bench -p depal-vision --bench table` prints Markdown tables; `-- speed` only the times per stage.
//! Everything is drawn by the simulated camera at 1280 x 1024 with all noise terms on.
#![allow(clippy::disallowed_methods)] // a bench may read the clock

use std::time::Instant;

use depal_camera::SensorSpec;
use depal_frames::DepthFrame;
use depal_vision::{Stage, VisionSettings, detect, detect_staged};
use rendered::{Layout, Score, camera, layer, looking_down, picture, stacked};

#[path = "../tests/rendered/mod.rs"]
mod rendered;

const TOP: f64 = 0.75;
/// Seeds that no tunable was chosen on.
const FRESH: std::ops::Range<u64> = 5000..5008;
/// Each estimation is repeated: other work on the machine only makes it slower.
const REPEATS: usize = 5;

/// Least time of the whole and of each stage, milliseconds.
fn times(frame: &DepthFrame, settings: &VisionSettings, repeats: usize) -> (f64, [f64; 5]) {
    let mut whole = f64::INFINITY;
    let mut stages = [f64::INFINITY; 5];
    for _ in 0..repeats {
        let mut marks: Vec<(Stage, Instant)> = Vec::new();
        let start = Instant::now();
        let detection = detect_staged(frame, settings, &mut |stage| {
            marks.push((stage, Instant::now()));
        });
        let end = Instant::now();
        drop(detection);
        whole = whole.min((end - start).as_secs_f64() * 1e3);
        for (n, (stage, began)) in marks.iter().enumerate() {
            let ended = marks.get(n + 1).map_or(end, |next| next.1);
            let slot = &mut stages[*stage as usize];
            *slot = slot.min((ended - *began).as_secs_f64() * 1e3);
        }
    }
    (whole, stages)
}

fn speed(repeats: usize) {
    println!(
        "| layout | gap mm | cartons | gate | pieces | outlines | coverings | obstacles | whole ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    for layout in [Layout::Regular20, Layout::Brick20, Layout::Pinwheel21] {
        for gap_mm in [5.0, 3.0, 1.0, 0.0] {
            if let Ok(only) = std::env::var("GAP")
                && only != format!("{gap_mm}")
            {
                continue;
            }
            let cartons = layer(layout, gap_mm * 1e-3, TOP, FRESH.start);
            let frame = picture(&spec, &at, &stacked(&cartons, TOP), FRESH.start);
            let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
            let (whole, stages) = times(&frame, &settings, repeats);
            let stages: Vec<String> = stages.iter().map(|ms| format!("{ms:.1}")).collect();
            let found = detect(&frame, &settings).boxes.len();
            println!(
                "| {layout:?} | {gap_mm} | {found}/{} | {} | {whole:.1} |",
                cartons.len(),
                stages.join(" | ")
            );
        }
    }
}

fn row(layout: Layout, gap_mm: f64, preset: &str, sensor: SensorSpec, distance: f64) {
    let spec = camera(sensor);
    let world_from_camera = looking_down(TOP + distance);
    let mut score = Score::default();
    for seed in FRESH {
        let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
        let frame = picture(&spec, &world_from_camera, &stacked(&cartons, TOP), seed);
        let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
        score.time_ms.push(times(&frame, &settings, REPEATS).0);
        score.add(
            &world_from_camera,
            &cartons,
            &detect(&frame, &settings).boxes,
        );
    }
    println!(
        "| {layout:?} | {gap_mm} | {preset} | {distance:.1} | {} |",
        score.line()
    );
}

fn main() {
    if std::env::args().any(|a| a == "speed") {
        speed(std::env::var("N").map_or(15, |n| n.parse().unwrap_or(15)));
        return;
    }
    println!(
        "| layout | gap mm | camera | distance m | found | false | xy median / p95 mm | z p95 mm | yaw median / p95 deg | tilt p95 deg | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for layout in [
        Layout::Regular20,
        Layout::Brick20,
        Layout::Pinwheel21,
        Layout::Brick,
        Layout::Pinwheel,
        Layout::Mixed,
    ] {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            row(layout, gap, "laser-3m", SensorSpec::laser_3m(), 2.0);
        }
    }
    for (preset, sensor) in [
        ("ideal", SensorSpec::ideal()),
        ("laser-2m", SensorSpec::laser_2m()),
        ("time-of-flight", SensorSpec::time_of_flight()),
    ] {
        row(Layout::Regular20, 5.0, preset, sensor, 2.0);
        row(Layout::Regular20, 1.0, preset, sensor, 2.0);
    }
    for distance in [1.8, 2.5, 3.0] {
        for gap in [3.0, 0.0] {
            row(
                Layout::Regular20,
                gap,
                "laser-3m",
                SensorSpec::laser_3m(),
                distance,
            );
        }
    }
    println!();
    speed(REPEATS);
}
