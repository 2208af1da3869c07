//! Recall, false positives and errors against layout, gap, camera preset and distance; the hard cases; measured sizes;
//! time per stage.
//!
//! `cargo bench -p depal-vision --bench table` prints Markdown tables; `-- speed` only the times per stage, `-- 2m` only
//! layouts and gaps at 2 m with sizes, `-- unsized` only those without. `EDGE_MM=3` rounds the cartons' edges.
//! Everything is drawn by the simulated camera at 1280 x 1024 with all noise terms on. Frames are worked on side by
//! side, but the times are taken on one thread with nothing else running.
#![allow(clippy::disallowed_methods)] // a bench may read the clock

use std::time::Instant;

use cases::Case;
use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec};
use depal_frames::{BoxSize, DepthFrame, Intrinsics};
use depal_vision::{VisionSettings, detect, detect_any_size, detect_staged};
use rendered::{
    Carton, HEIGHT, Layout, Score, block, camera, layer, looking_down, picture, quantile,
    small_stereo, stacked,
};

#[path = "../tests/cases/mod.rs"]
mod cases;
#[path = "../tests/rendered/mod.rs"]
mod rendered;

const TOP: f64 = 0.75;
/// Seeds that no tunable was chosen on.
const FRESH: std::ops::Range<u64> = 5000..5008;
const LAYOUTS: [Layout; 4] = [
    Layout::Regular20,
    Layout::Brick20,
    Layout::Pinwheel21,
    Layout::RunningBond20,
];

/// Least time of the whole, of suiting the settings to the picture and of each stage, milliseconds. The whole is all
/// that happens between a picture and its boxes; the memory that one estimation has fetched the next one uses again.
fn times(frame: &DepthFrame, sizes: &[BoxSize], repeats: usize) -> (f64, [f64; 6]) {
    let mut whole = f64::INFINITY;
    let mut stages = [f64::INFINITY; 6];
    for _ in 0..repeats {
        let mut marks: Vec<(usize, Instant)> = Vec::new();
        let start = Instant::now();
        let settings = VisionSettings::new(sizes.to_vec()).suited_to(frame);
        marks.push((0, start));
        let detection = detect_staged(frame, &settings, &mut |stage| {
            marks.push((1 + stage as usize, Instant::now()));
        });
        let end = Instant::now();
        drop(detection);
        whole = whole.min((end - start).as_secs_f64() * 1e3);
        for (n, (slot, began)) in marks.iter().enumerate() {
            let ended = marks.get(n + 1).map_or(end, |next| next.1);
            stages[*slot] = stages[*slot].min((ended - *began).as_secs_f64() * 1e3);
        }
    }
    (whole, stages)
}

/// Cartons on a slab that is wider than they are, over a floor: both in view as the surfaces of a cell are, seen by a
/// camera with a wider view.
fn on_slab_and_floor(cartons: &[Carton]) -> Vec<RenderShape> {
    let mut shapes: Vec<RenderShape> = (0..).zip(cartons).map(|(n, c)| c.shape(n)).collect();
    let below = TOP - HEIGHT - 0.002;
    for (id, size, top) in [
        (1000, [1.8, 1.4, 0.2], below),
        (1001, [8.0, 8.0, 0.1], TOP - 1.0),
    ] {
        let centre = [0.0, 0.0, top - size[2] / 2.0];
        shapes.push(block(id, centre, size, 0.0, Material::KRAFT));
    }
    shapes
}

/// 1280 x 1024 pixels that see 2.1 x 1.7 m at 2 m.
fn wide_camera() -> CameraSpec {
    let spec = camera(SensorSpec::laser_3m());
    CameraSpec {
        intrinsics: Intrinsics {
            fx: 1216.0,
            fy: 1216.0,
            ..spec.intrinsics
        },
        ..spec
    }
}

fn speed(repeats: usize) {
    println!(
        "| layout | gap mm | distance m | over | cartons | suited | gate | pieces | outlines | coverings | obstacles | whole ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let is_asked =
        |gap_mm: f64| std::env::var("GAP").map_or(true, |only| only == format!("{gap_mm}"));
    let line = |layout: Layout, gap_mm: f64, distance: f64, over: &str, frame: &DepthFrame| {
        let sizes = layout.sizes();
        let (whole, stages) = times(frame, &sizes, repeats);
        let stages: Vec<String> = stages.iter().map(|ms| format!("{ms:.1}")).collect();
        let settings = VisionSettings::new(sizes).suited_to(frame);
        let found = detect(frame, &settings).boxes.len();
        println!(
            "| {layout:?} | {gap_mm} | {distance:.1} | {over} | {found}/{} | {} | {whole:.1} |",
            layer(layout, gap_mm * 1e-3, TOP, FRESH.start).len(),
            stages.join(" | ")
        );
    };
    let spec = camera(SensorSpec::laser_3m());
    for layout in LAYOUTS {
        for (gap_mm, distance) in [(5.0, 2.0), (3.0, 2.0), (1.0, 2.0), (0.0, 2.0), (0.0, 3.0)] {
            if is_asked(gap_mm) {
                let cartons = layer(layout, gap_mm * 1e-3, TOP, FRESH.start);
                let at = looking_down(TOP + distance);
                let frame = picture(&spec, &at, &stacked(&cartons, TOP), FRESH.start);
                line(layout, gap_mm, distance, "a block", &frame);
            }
        }
    }
    for layout in LAYOUTS {
        for gap_mm in [5.0, 3.0, 1.0, 0.0] {
            if is_asked(gap_mm) {
                let cartons = layer(layout, gap_mm * 1e-3, TOP, FRESH.start);
                let shapes = on_slab_and_floor(&cartons);
                let frame = picture(
                    &wide_camera(),
                    &looking_down(TOP + 2.0),
                    &shapes,
                    FRESH.start,
                );
                line(layout, gap_mm, 2.0, "slab and floor", &frame);
            }
        }
    }
}

/// One score for each seed, on as many threads as there are processors; the order is that of the seeds.
fn of_all_seeds(work: impl Fn(u64) -> Score + Sync) -> Score {
    let seeds: Vec<u64> = FRESH.collect();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let share = seeds.len().div_ceil(threads);
    let mut total = Score::default();
    std::thread::scope(|scope| {
        let running: Vec<_> = seeds
            .chunks(share)
            .map(|seeds| {
                let work = &work;
                scope.spawn(move || seeds.iter().map(|&seed| work(seed)).collect::<Vec<_>>())
            })
            .collect();
        for scores in running {
            for score in scores.join().expect("no estimation panics") {
                total.absorb(score);
            }
        }
    });
    total
}

fn row(layout: Layout, gap_mm: f64, preset: &str, sensor: SensorSpec, distance: f64) {
    row_of(layout, gap_mm, preset, &camera(sensor), distance);
}

fn row_of(layout: Layout, gap_mm: f64, preset: &str, spec: &CameraSpec, distance: f64) {
    let at = looking_down(TOP + distance);
    let score = of_all_seeds(|seed| {
        let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
        let frame = picture(spec, &at, &stacked(&cartons, TOP), seed);
        let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
        let mut score = Score::default();
        score.add(&at, &cartons, &detect(&frame, &settings).boxes);
        score
    });
    println!(
        "| {layout:?} | {gap_mm} | {preset} | {distance:.1} | {} |",
        score.errors()
    );
}

fn hard(case: Case) {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    let score = of_all_seeds(|seed| {
        let (wanted, shapes) = case.scene(TOP, seed);
        let frame = picture(&spec, &at, &shapes, seed);
        let settings = VisionSettings::new(case.sizes()).suited_to(&frame);
        let mut score = Score::default();
        score.add(&at, &wanted, &detect(&frame, &settings).boxes);
        score
    });
    println!("| {case:?} | {} |", score.errors());
}

/// Free-standing cartons of a size that the estimation is not told.
fn measured(preset: &str, sensor: SensorSpec, distance: f64) {
    let spec = camera(sensor);
    let at = looking_down(TOP + distance);
    let mut errors = Vec::new();
    let mut wanted = 0;
    for seed in FRESH {
        let cartons = layer(Layout::Mixed, 0.020, TOP, seed);
        wanted += cartons.len();
        let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
        let settings = VisionSettings::new(Vec::new()).suited_to(&frame);
        for found in detect_any_size(&frame, &settings).boxes {
            let p = (at * found.camera_from_box).translation.vector;
            let own = |c: &&Carton| (c.x - p.x).hypot(c.y - p.y) < 0.02;
            if let Some(carton) = cartons.iter().find(own) {
                errors.push((found.size.length - carton.size[0]).abs() * 1e3);
                errors.push((found.size.width - carton.size[1]).abs() * 1e3);
            }
        }
    }
    println!(
        "| {preset} | {distance:.1} | {}/{wanted} | {:.2} / {:.2} |",
        errors.len() / 2,
        quantile(&errors, 0.5),
        quantile(&errors, 0.95)
    );
}

/// Layers whose size the estimation is not told: what it measures, and by how much it is off on the mean.
fn unsized_layer(layout: Layout, gap_mm: f64) {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(TOP + 2.0);
    let (mut score, mut off) = (Score::default(), Vec::new());
    for seed in FRESH {
        let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
        let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
        let settings = VisionSettings::new(Vec::new()).suited_to(&frame);
        let boxes = detect_any_size(&frame, &settings).boxes;
        score.add(&at, &cartons, &boxes);
        for found in boxes {
            let p = (at * found.camera_from_box).translation.vector;
            let own = |c: &&Carton| (c.x - p.x).hypot(c.y - p.y) < 0.02;
            if let Some(carton) = cartons.iter().find(own) {
                off.push((found.size.length - carton.size[0]) * 1e3);
                off.push((found.size.width - carton.size[1]) * 1e3);
            }
        }
    }
    let bias = off.iter().sum::<f64>() / off.len().max(1) as f64;
    let size: Vec<f64> = off.iter().map(|mm| mm.abs()).collect();
    println!(
        "| {layout:?} | {gap_mm} | {} | {bias:+.2} | {:.2} |",
        score.errors(),
        quantile(&size, 0.95)
    );
}

fn unsized_layers() {
    println!(
        "| layout, no size given | gap mm | found | false | xy median / p95 mm | z p95 mm | yaw median / p95 deg | tilt p95 deg | size bias mm | size p95 mm |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for layout in LAYOUTS
        .into_iter()
        .chain([Layout::Brick, Layout::Pinwheel, Layout::Mixed])
    {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            unsized_layer(layout, gap);
        }
    }
}

fn main() {
    let asked = |name: &str| std::env::args().any(|a| a == name);
    if asked("speed") {
        speed(std::env::var("N").map_or(15, |n| n.parse().unwrap_or(15)));
        return;
    }
    if asked("unsized") {
        unsized_layers();
        return;
    }
    let errors =
        "found | false | xy median / p95 mm | z p95 mm | yaw median / p95 deg | tilt p95 deg |";
    println!("| layout | gap mm | camera | distance m | {errors}");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for layout in LAYOUTS
        .into_iter()
        .chain([Layout::Brick, Layout::Pinwheel, Layout::Mixed])
    {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            row(layout, gap, "laser-3m", SensorSpec::laser_3m(), 2.0);
        }
    }
    if asked("2m") {
        return;
    }
    let presets = [
        ("ideal", SensorSpec::ideal()),
        ("laser-2m", SensorSpec::laser_2m()),
        ("active-stereo", SensorSpec::active_stereo()),
        ("time-of-flight", SensorSpec::time_of_flight()),
    ];
    for (preset, sensor) in presets {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            row(Layout::Regular20, gap, preset, sensor, 2.0);
        }
    }
    for gap in [5.0, 3.0, 1.0, 0.0] {
        let sensor = SensorSpec::active_stereo();
        row(Layout::Pinwheel, gap, "active-stereo", sensor, 1.5);
    }
    for (distance, layout) in [(2.0, Layout::Regular20), (1.5, Layout::Regular20)] {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            row_of(
                layout,
                gap,
                "active-stereo, 640 px",
                &small_stereo(),
                distance,
            );
        }
    }
    for (distance, layout) in [
        // Close by only a small layer is in view.
        (1.5, Layout::Pinwheel),
        (2.5, Layout::Regular20),
        (3.0, Layout::Regular20),
    ] {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            let sensor = SensorSpec::laser_3m();
            row(layout, gap, "laser-3m", sensor, distance);
        }
    }
    println!("\n| case (laser-3m, 2.0 m) | {errors}");
    println!("|---|---|---|---|---|---|---|");
    for case in Case::ALL {
        hard(case);
    }
    println!("\n| camera | distance m | measured | size error median / p95 mm |");
    println!("|---|---|---|---|");
    for distance in [1.5, 2.0, 2.5, 3.0] {
        measured("laser-3m", SensorSpec::laser_3m(), distance);
    }
    measured("laser-2m", SensorSpec::laser_2m(), 2.0);
    measured("ideal", SensorSpec::ideal(), 2.0);
    println!();
    unsized_layers();
    println!();
    speed(5);
}
