//! Processor time of one estimation, whatever else the computer does (Linux): least of many runs.
#![allow(clippy::disallowed_methods)] // a stopwatch, not part of the estimation

use depal_vision::{VisionSettings, detect};

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

/// Nanoseconds that this thread has run.
fn ran() -> u64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .unwrap_or(0)
}

fn main() {
    let settings = VisionSettings::new(vec![synthetic::carton()]);
    for (layer, gap_mm) in [(6, 4.0), (6, 0.0), (1, 4.0), (1, 2.0)] {
        let frame = synthetic::stack(layer, gap_mm * 1e-3, 1).frame(1);
        let least = (0..20)
            .map(|_| {
                let started = ran();
                let boxes = detect(&frame, &settings).boxes.len();
                assert!(boxes > 0);
                ran() - started
            })
            .min()
            .unwrap_or(0);
        println!(
            "layer {layer} gap {gap_mm} mm: {:.1} ms",
            least as f64 * 1e-6
        );
    }
}
