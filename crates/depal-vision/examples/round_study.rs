//! Study of rounded edges.
#![allow(missing_docs)]
use depal_camera::{CameraSpec, SensorSpec};
use depal_frames::Vector;
use depal_vision::{VisionSettings, detect};
use rendered::{Layout, Score, camera, layer, looking_down, picture, quantile, stacked};

#[path = "../tests/rendered/mod.rs"]
mod rendered;

const TOP: f64 = 0.75;

fn env<T: std::str::FromStr>(name: &str, other: T) -> T {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(other)
}

fn list(name: &str, other: &str) -> Vec<f64> {
    env(name, other.to_string()).split(',').map(|v| v.parse().unwrap()).collect()
}

fn spec() -> CameraSpec {
    let sensor = match env("SENSOR", "laser3".to_string()).as_str() {
        "ideal" => SensorSpec::ideal(),
        "laser2" => SensorSpec::laser_2m(),
        "laser3d" => SensorSpec { scale_error: 0.0, bowl: 0.0, ..SensorSpec::laser_3m() },
        _ => SensorSpec::laser_3m(),
    };
    let mut spec = camera(sensor);
    let f = env("PX", 1.0);
    let k = &mut spec.intrinsics;
    k.width = (k.width as f64 * f).round() as usize;
    k.height = (k.height as f64 * f).round() as usize;
    k.fx *= f; k.fy *= f;
    k.cx = (k.width as f64 - 1.0) / 2.0;
    k.cy = (k.height as f64 - 1.0) / 2.0;
    spec
}

fn main() {
    let spec = spec();
    let seeds = env("SEED", 7000u64)..env("SEED", 7000u64) + env("N", 4u64);
    let layouts: Vec<Layout> = match env("LAYOUT", "all".to_string()).as_str() {
        "one" => vec![Layout::Regular20],
        "big" => vec![Layout::Brick, Layout::Pinwheel, Layout::Mixed],
        "twenty" => vec![Layout::Regular20, Layout::Brick20, Layout::Pinwheel21, Layout::RunningBond20],
        _ => vec![Layout::Regular20, Layout::Brick20, Layout::Pinwheel21, Layout::RunningBond20, Layout::Brick, Layout::Pinwheel, Layout::Mixed],
    };
    let distance = env("D", 2.0);
    for r in list("R", "0,1,2,3,5") {
        for gap in list("GAP", "5,3,1,0") {
            let cases: Vec<(Layout, u64)> = layouts.iter().flat_map(|l| seeds.clone().map(move |s| (*l, s))).collect();
            let half = cases.len().div_ceil(2);
            let at = looking_down(TOP + distance);
            let mut total = Score::default();
            let mut errors: Vec<[f64; 4]> = Vec::new();
            let (spec, at) = (&spec, &at);
            let parts: Vec<(Score, Vec<[f64; 4]>)> = std::thread::scope(|scope| {
                let running: Vec<_> = cases.chunks(half).map(|cases| scope.spawn(move || {
                    let mut total = Score::default();
                    let mut errors = Vec::new();
                    for &(layout, seed) in cases {
                        let cartons = layer(layout, gap * 1e-3, TOP, seed);
                        let mut shapes = stacked(&cartons, TOP);
                        for shape in shapes.iter_mut().filter(|s| s.id < 1000) { shape.edge_radius = r * 1e-3; }
                        let frame = picture(spec, at, &shapes, seed);
                        let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
                        let boxes = detect(&frame, &settings).boxes;
                        total.add(at, &cartons, &boxes);
                        for b in &boxes {
                            let p = (at * b.camera_from_box).translation.vector;
                            let _: Vector = p;
                            if let Some(c) = cartons.iter().find(|c| (c.x - p.x).hypot(c.y - p.y) < 0.02) {
                                errors.push([c.x, c.y, (p.x - c.x) * 1e3, (p.y - c.y) * 1e3]);
                            }
                        }
                    }
                    (total, errors)
                })).collect();
                running.into_iter().map(|r| r.join().unwrap()).collect()
            });
            for (s, e) in parts { total.absorb(s); errors.extend(e); }
            // slope per axis and offset
            let fit = |k: usize| {
                let n = errors.len() as f64;
                let mx = errors.iter().map(|e| e[k]).sum::<f64>() / n;
                let me = errors.iter().map(|e| e[k + 2]).sum::<f64>() / n;
                let sxx: f64 = errors.iter().map(|e| (e[k] - mx).powi(2)).sum();
                let sxe: f64 = errors.iter().map(|e| (e[k] - mx) * (e[k + 2] - me)).sum();
                let slope = sxe / sxx;
                let rest: Vec<f64> = errors.iter().map(|e| (e[k + 2] - me - slope * (e[k] - mx)).abs()).collect();
                (slope, me, quantile(&rest, 0.5), quantile(&rest, 0.95))
            };
            let (x, y) = (fit(0), fit(1));
            println!("r {r} gap {gap}: {} | slope {:+.2} {:+.2} mean {:+.2} {:+.2} rest p50 {:.2} {:.2} p95 {:.2} {:.2}",
                total.errors(), x.0, y.0, x.1, y.1, x.2, y.2, x.3, y.3);
        }
    }
}
