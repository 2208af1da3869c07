//! Frames that no camera should deliver: no panic, no carton out of nothing.

use depal_frames::{BoxSize, DepthFrame, Intrinsics};
use depal_time::RandomStreams;
use depal_vision::{VisionSettings, detect};

fn intrinsics(width: usize, height: usize) -> Intrinsics {
    Intrinsics {
        width,
        height,
        fx: 400.0,
        fy: 400.0,
        cx: width as f64 / 2.0,
        cy: height as f64 / 2.0,
    }
}

fn frame(width: usize, height: usize, mut depth: impl FnMut(usize) -> f32) -> DepthFrame {
    DepthFrame {
        intrinsics: intrinsics(width, height),
        depth: (0..width * height).map(&mut depth).collect(),
        intensity: Vec::new(),
    }
}

fn settings() -> VisionSettings {
    VisionSettings::new(vec![BoxSize::from_mm([400.0, 300.0, 250.0])])
}

#[test]
fn small_and_thin_images() {
    for (width, height) in [
        (1, 1),
        (1, 7),
        (7, 1),
        (2, 2),
        (3, 5),
        (16384, 1),
        (1, 4000),
        (0, 0),
        (0, 5),
    ] {
        for z in [0.0, 1.0, 2.5] {
            assert_eq!(detect(&frame(width, height, |_| z), &settings()).boxes, []);
        }
    }
}

#[test]
fn one_value_everywhere() {
    for z in [
        0.5,
        1.0,
        3.0,
        f32::NAN,
        f32::INFINITY,
        -1.0,
        f32::MAX,
        f32::MIN_POSITIVE,
    ] {
        assert_eq!(detect(&frame(320, 240, |_| z), &settings()).boxes, []);
    }
}

#[test]
fn noise_of_every_kind() {
    for seed in 0..40 {
        let mut r = RandomStreams::new(seed).stream("noise");
        let spread = r.uniform(0.0, 2.0);
        let wild = frame(320, 256, |_| match r.next_u64() % 50 {
            0 => f32::NAN,
            1 => -1.0,
            2 => 1e30,
            3 => 0.0,
            _ => r.uniform(1.5, 1.5 + spread) as f32,
        });
        assert_eq!(detect(&wild, &settings()).boxes, [], "seed {seed}");
    }
}

#[test]
fn frames_that_contradict_themselves() {
    let good = frame(64, 48, |_| 1.0);
    let mut short = good.clone();
    short.depth.pop();
    assert_eq!(detect(&short, &settings()).points_in_region, 0);
    for f in [0.0, -5.0, f64::NAN, f64::INFINITY] {
        let mut odd = good.clone();
        odd.intrinsics.fx = f;
        assert_eq!(detect(&odd, &settings()).points_in_region, 0);
    }
    let mut odd = good;
    odd.intrinsics.cx = f64::NAN;
    assert_eq!(detect(&odd, &settings()).points_in_region, 0);
}

#[test]
fn senseless_sizes_and_tunables() {
    let flat = frame(320, 240, |_| 1.0);
    for side in [0.0, -1.0, f64::NAN, 1e-9, 1e9] {
        let size = BoxSize {
            length: side,
            width: side,
            height: side,
        };
        assert_eq!(detect(&flat, &VisionSettings::new(vec![size])).boxes, []);
    }
    for value in [0.0, -1.0, f64::NAN, 1e9] {
        let odd = VisionSettings {
            step: value,
            plane_tolerance: value,
            obstacle_voxel: value,
            max_depth: value,
            max_surface_side: value,
            ..settings()
        };
        assert_eq!(detect(&flat, &odd).boxes, []);
    }
}
