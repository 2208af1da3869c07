//! Frames that no camera should deliver: no panic, no carton out of nothing.

use depal_frames::{BoxSize, DepthFrame, Intrinsics};
use depal_time::RandomStreams;
use depal_vision::{VisionSettings, detect, detect_any_size};

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

/// A thousand frames of plates, ramps, stripes, noise and holes in every mixture: nothing panics,
/// and what is reported is finite.
#[test]
fn a_thousand_random_frames() {
    for seed in 0..1000 {
        let mut r = RandomStreams::new(seed).stream("frame");
        let (width, height) = (
            r.uniform(1.0, 200.0) as usize,
            r.uniform(1.0, 160.0) as usize,
        );
        let base = r.uniform(0.2, 4.0);
        let slope = [r.uniform(-0.01, 0.01), r.uniform(-0.01, 0.01)];
        let noise = r.uniform(0.0, 0.02);
        let holes = r.uniform(0.0, 0.5);
        let plates: Vec<[f64; 5]> = (0..r.next_u64() % 6)
            .map(|_| {
                [
                    r.uniform(0.0, width as f64),
                    r.uniform(0.0, height as f64),
                    r.uniform(1.0, 120.0),
                    r.uniform(1.0, 120.0),
                    r.uniform(-0.5, 0.5),
                ]
            })
            .collect();
        let mut image = frame(width, height, |i| {
            let (u, v) = ((i % width) as f64, (i / width) as f64);
            let mut z = base + slope[0] * u + slope[1] * v;
            for [x, y, a, b, rise] in &plates {
                if (u - x).abs() < *a && (v - y).abs() < *b {
                    z += rise;
                }
            }
            if r.uniform(0.0, 1.0) < holes {
                0.0
            } else {
                (z + r.uniform(-noise, noise)) as f32
            }
        });
        // Focal lengths and centres that no lens has are part of it.
        image.intrinsics.fx = r.uniform(1.0, 2000.0);
        image.intrinsics.fy = r.uniform(1.0, 2000.0);
        image.intrinsics.cx += r.uniform(-500.0, 500.0);
        let sizes = [
            [400.0, 300.0, 250.0],
            [120.0, 80.0, 60.0],
            [50.0, 50.0, 50.0],
        ];
        let settings = VisionSettings::new(sizes.map(BoxSize::from_mm).to_vec()).suited_to(&image);
        for detection in [
            detect(&image, &settings),
            detect_any_size(&image, &settings),
        ] {
            for found in &detection.boxes {
                let t = found.camera_from_box.translation.vector;
                assert!(t.iter().all(|c| c.is_finite()), "seed {seed}: {found:?}");
                assert!(
                    (0.0..=1.0).contains(&found.confidence),
                    "seed {seed}: {found:?}"
                );
            }
        }
    }
}

/// As wide as an image may be; a picture cut short in transit is missing its lower half.
#[test]
fn very_wide_and_half_received() {
    let wide = frame(16384, 300, |_| 2.0);
    assert_eq!(detect(&wide, &settings()).boxes, []);
    let half = frame(640, 480, |i| if i < 640 * 200 { 2.0 } else { 0.0 });
    assert_eq!(detect(&half, &settings()).boxes, []);
}
