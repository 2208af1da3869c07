#![allow(warnings)]
use depal_camera::SensorSpec;
use disturbed::Disturbance;
use rendered::{Layout, camera, layer, looking_down, picture, stacked};
#[path = "../tests/disturbed/mod.rs"]
mod disturbed;
#[path = "../src/lost.rs"]
mod lost;
#[path = "../src/outliers.rs"]
mod outliers;
#[path = "../tests/rendered/mod.rs"]
mod rendered;
#[path = "../src/strips.rs"]
mod strips;
static T: std::sync::LazyLock<std::time::Instant> =
    std::sync::LazyLock::new(std::time::Instant::now);
fn ran() -> u64 {
    return T.elapsed().as_nanos() as u64;
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|t| t.split(' ').next()?.parse().ok())
        .unwrap_or(0)
}
fn least(mut f: impl FnMut()) -> f64 {
    (0..30)
        .map(|_| {
            let s = ran();
            f();
            ran() - s
        })
        .min()
        .unwrap() as f64
        * 1e-6
}
fn main() {
    let spec = camera(SensorSpec::laser_3m());
    for (gap, d) in [
        (5.0, Disturbance::None),
        (1.0, Disturbance::None),
        (0.0, Disturbance::None),
        (3.0, Disturbance::Lost(0.002)),
        (3.0, Disturbance::Lost(0.01)),
        (3.0, Disturbance::Lost(0.1)),
        (3.0, Disturbance::Outliers(0.005)),
    ] {
        let cartons = layer(Layout::Regular20, gap * 1e-3, 0.75, 7);
        let frame = d.of(
            &picture(&spec, &looking_down(2.75), &stacked(&cartons, 0.75), 7),
            7,
        );
        let w = frame.intrinsics.width;
        let a = least(|| {
            std::hint::black_box(outliers::without_outliers(&frame.depth, w, 0.01));
        });
        let b = least(|| {
            std::hint::black_box(lost::mended(&frame.depth, w, 0.01));
        });
        let some = lost::mended(&frame.depth, w, 0.01).is_some();
        println!("gap {gap} {d:?}: outliers {a:.3} ms, lost {b:.3} ms, mended {some}");
    }
}
