//! Prints recall, false reports and errors against gap and layer.

use depal_vision::{VisionSettings, detect};

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn main() {
    let seeds: u64 = std::env::args()
        .nth(1)
        .and_then(|a| a.parse().ok())
        .unwrap_or(2);
    let settings = VisionSettings::new(vec![synthetic::carton()]);
    println!(
        "gap layer | found fp | xy mm median p95 max | z p95 | yaw deg median p95 | tilt p95 | refused"
    );
    for layer in [6, 1] {
        for gap_mm in [6.0, 4.0, 3.0, 2.0, 1.0, 0.0] {
            let mut score = synthetic::Score::default();
            let mut reasons = Vec::new();
            for seed in 0..seeds {
                let scene = synthetic::stack(layer, gap_mm * 1e-3, seed);
                let frame = scene.frame(seed);
                let detection = detect(&frame, &settings);
                score.add(&scene, detection.boxes.iter().map(|b| &b.camera_from_box));
                reasons.extend(detection.rejected.iter().map(|r| r.reason));
            }
            println!(
                "{gap_mm:3} {layer:5} | {} | refused {reasons:?}",
                score.line()
            );
        }
    }
}
