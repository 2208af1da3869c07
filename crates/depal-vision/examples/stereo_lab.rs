//! lab
use depal_camera::{CameraSpec, SensorSpec};
use depal_frames::Intrinsics;
use depal_vision::{VisionSettings, detect};
use rendered::*;
#[path = "../tests/rendered/mod.rs"]
mod rendered;
const TOP: f64 = 0.75;
fn main() {
    let v = |n: &str, d: f64| std::env::var(n).map_or(d, |x| x.parse().unwrap());
    let seeds = v("FROM", 4000.0) as u64..(v("FROM", 4000.0) + v("COUNT", 2.0)) as u64;
    let real = v("REAL", 0.0) > 0.0;
    for distance in [2.0, 1.5] {
        for gap in [5.0, 3.0, 1.0, 0.0] {
            if v("GAP", gap) != gap || v("DIST", distance) != distance { continue; }
            for layout in [Layout::Regular20, Layout::Brick, Layout::Pinwheel, Layout::Regular] {
                if distance < 2.0 && layout == Layout::Regular20 && !real { continue; }
                if v("LAYOUT", -1.0) >= 0.0 && v("LAYOUT", -1.0) != layout as i32 as f64 { continue; }
                let mut spec = camera(SensorSpec::active_stereo());
                if real {
                    spec = CameraSpec { intrinsics: Intrinsics { width: 1280, height: 720, fx: 640.0, fy: 640.0, cx: 639.5, cy: 359.5 }, baseline: 0.05, ..spec };
                }
                let at = looking_down(TOP + distance);
                let mut score = Score::default();
                let mut why = String::new();
                for seed in seeds.clone() {
                    let cartons = layer(layout, gap * 1e-3, TOP, seed);
                    let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
                    let start = std::time::Instant::now();
                    let settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
                    let t1 = start.elapsed().as_secs_f64() * 1e3;
                    let d = detect(&frame, &settings);
                    score.time_ms.push(start.elapsed().as_secs_f64() * 1e3);
                    score.add(&at, &cartons, &d.boxes);
                    why = format!("suit {t1:.0} ms step {:.4} smear {} ", settings.step, settings.smear_px);
                    for r in d.rejected.iter().filter(|r| r.area > 0.02) { why += &format!("{:?} {:.3}, ", r.reason, r.area); }
                    if v("DUMP", 0.0) > 0.0 {
                        let mut o = String::new();
                        for &z in &frame.depth { o += &format!("{:.4}\n", z); }
                        std::fs::write("/tmp/stereo/depth.txt", o).unwrap();
                        std::fs::write("/tmp/stereo/grey.bin", &frame.intensity).unwrap();
                    }
                }
                println!("{layout:?} gap {gap} at {distance}: {}\n     {why}", score.line());
            }
        }
    }
}
