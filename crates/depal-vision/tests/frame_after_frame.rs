//! Memory is kept from one frame to the next: no frame may leave anything of itself in the results of a later one,
//! and what lies deep below the cartons must not be torn to pieces by its noise.

use depal_camera::{CameraSpec, SensorSpec};
use depal_frames::{BoxSize, DepthFrame, Intrinsics};
use depal_vision::{RejectReason, VisionSettings, detect, detect_any_size};
use generator::Noise;
use rendered::{Carton, HEIGHT, Layout, camera, layer, looking_down, picture, stacked};

mod generator;
mod rendered;

const TOP: f64 = 0.75;

fn everything_found(frame: &DepthFrame, sizes: &[BoxSize]) -> String {
    let settings = VisionSettings::new(sizes.to_vec()).suited_to(frame);
    let known = detect(frame, &settings);
    let any = detect_any_size(frame, &settings);
    assert!(!known.boxes.is_empty());
    format!("{known:?} {any:?}")
}

/// Frames that leave different memory behind: few and many cartons, gaps and none, another size of the image.
fn frames() -> Vec<(DepthFrame, Vec<BoxSize>)> {
    let spec = camera(SensorSpec::laser_3m());
    let k = spec.intrinsics;
    let small = CameraSpec {
        intrinsics: Intrinsics {
            width: k.width / 2,
            height: k.height / 2,
            fx: k.fx / 2.0,
            fy: k.fy / 2.0,
            cx: (k.cx - 0.5) / 2.0,
            cy: (k.cy - 0.5) / 2.0,
        },
        ..spec
    };
    [
        (Layout::Pinwheel21, 0.0, &spec),
        (Layout::Regular20, 0.005, &spec),
        (Layout::Regular, 0.005, &small),
        (Layout::Mixed, 0.003, &spec),
        (Layout::Brick20, 0.0, &spec),
    ]
    .into_iter()
    .map(|(layout, gap, spec)| {
        let cartons = layer(layout, gap, TOP, 6100);
        let shapes = stacked(&cartons, TOP);
        let frame = picture(spec, &looking_down(TOP + 2.0), &shapes, 6100);
        (frame, layout.sizes())
    })
    .collect()
}

#[test]
fn later_frames_give_the_same_bits_as_first_ones() {
    let frames = frames();
    // A thread of its own for each has nothing from before.
    let first: Vec<String> = std::thread::scope(|scope| {
        let each = frames
            .iter()
            .map(|(frame, sizes)| scope.spawn(|| everything_found(frame, sizes)));
        let each: Vec<_> = each.collect();
        each.into_iter()
            .map(|thread| thread.join().unwrap())
            .collect()
    });
    let there_and_back = (0..frames.len()).chain((0..frames.len()).rev());
    for n in there_and_back {
        let (frame, sizes) = &frames[n];
        assert!(everything_found(frame, sizes) == first[n], "frame {n}");
    }
}

#[test]
fn a_floor_far_below_the_cartons_stays_in_one_piece() {
    let cartons = generator::cartons(Layout::Regular20, 0.005, 6200);
    // Most of the picture shows the tops and the slab on which they stand.
    let slab = Carton {
        x: 0.0,
        y: 0.0,
        top: -HEIGHT - 0.002,
        yaw: 0.0,
        tilt: [0.0; 2],
        size: [1.8, 1.4, 0.2],
    };
    let shown: Vec<Carton> = cartons.iter().copied().chain([slab]).collect();
    let frame = generator::frame(&shown, Noise::White, false, 6200);
    let suited = VisionSettings::new(Layout::Regular20.sizes()).suited_to(&frame);
    let bare = VisionSettings {
        step_noise: 0.0,
        ..suited.clone()
    };
    let floor = |settings: &VisionSettings| {
        let found = detect(&frame, settings);
        assert_eq!(found.boxes.len(), cartons.len());
        let background = found
            .rejected
            .iter()
            .filter(|r| r.reason == RejectReason::Background);
        background.map(|r| r.area).fold(0.0, f64::max)
    };
    let (whole, torn) = (floor(&suited), floor(&bare));
    assert!(whole > 1.1 * torn, "{whole:.3} m2, {torn:.3} m2 without");
}
