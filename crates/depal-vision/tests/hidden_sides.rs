//! Tops of which a taller neighbour hides one side: from the camera, or from the projector alone.
//! The shares are those hidden from the camera; on one side the projector's shadow hides up to eight percent more.
//! The sides that are seen and the known size say where the hidden one is.

use depal_camera::SensorSpec;
use depal_frames::BoxSize;
use depal_time::RandomStreams;
use depal_vision::{VisionSettings, detect};
use rendered::{Carton, HEIGHT, Score, block, camera, looking_down, picture, quantile};

mod rendered;

const LOW: f64 = 0.55;
const DISTANCE: f64 = 2.2;
const GAP: f64 = 0.004;
const SIZE: [f64; 3] = [0.4, 0.3, HEIGHT];

/// A carton and beside it, towards the camera's axis, one that stands higher by its own height. `side`: where
/// the lower one lies, as an axis and a sign; `hidden`: share of its extent that the camera does not see.
fn pair(side: (usize, f64), hidden: f64, seed: u64) -> [Carton; 2] {
    let mut r = RandomStreams::new(seed).stream("pair");
    let (axis, sign) = side;
    // From the camera the upper edge at `e` falls on the lower top at `e * DISTANCE / (DISTANCE - HEIGHT)`.
    let e = (hidden * SIZE[axis] + GAP) * (DISTANCE - HEIGHT) / HEIGHT;
    let at = |distance: f64, across: f64| {
        let mut xy = [across, across];
        xy[axis] = sign * distance;
        xy
    };
    let aside = r.uniform(-0.1, 0.1);
    let upper = at(e - SIZE[axis] / 2.0, aside);
    let lower = at(e + GAP + SIZE[axis] / 2.0, aside + r.uniform(-0.02, 0.02));
    let mut carton = |[x, y]: [f64; 2], top: f64| Carton {
        x,
        y,
        top,
        yaw: r.uniform(-0.003, 0.003),
        tilt: [0.0; 2],
        size: SIZE,
    };
    [carton(lower, LOW), carton(upper, LOW + HEIGHT)]
}

fn score(side: (usize, f64), hidden: f64, seeds: std::ops::Range<u64>) -> Score {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(LOW + DISTANCE);
    let mut score = Score::default();
    for seed in seeds {
        let cartons = pair(side, hidden, seed);
        let mut shapes: Vec<_> = (0..2).map(|n| cartons[n].shape(n as u32)).collect();
        let under = Carton {
            top: LOW,
            ..cartons[1]
        };
        shapes.push(under.shape(2));
        shapes.push(block(
            3,
            [0.0, 0.0, (LOW - HEIGHT) / 2.0 - 0.01],
            [1.2, 1.0, LOW - HEIGHT],
            0.0,
            depal_camera::Material::KRAFT,
        ));
        shapes.push(block(
            4,
            [0.0, 0.0, -0.1],
            [8.0, 8.0, 0.2],
            0.0,
            depal_camera::Material::CONCRETE,
        ));
        let frame = picture(&spec, &at, &shapes, seed);
        let settings = VisionSettings::new(vec![BoxSize::from_mm(SIZE.map(|s| s * 1e3))]);
        let d = detect(&frame, &settings);
        score.add(&at, &cartons, &d.boxes);
    }
    score
}

#[test]
fn a_side_hidden_by_a_taller_neighbour_follows_from_the_size() {
    let mut failed = Vec::new();
    for side in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        for hidden in [0.005, 0.01, 0.02, 0.035, 0.05] {
            let score = score(side, hidden, 0..4);
            let line = format!("{side:?} {} %: {}", hidden * 100.0, score.line());
            if score.false_positives > 0
                || score.found < score.wanted
                || quantile(&score.xy_mm, 1.0) > 1.0
            {
                failed.push(line);
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Light from the right does not reach the right end of the lower one, and on the left a wall stands so close that what
/// is lost there may be its shadow as well as a gap.
#[test]
fn a_top_between_two_taller_ones_fills_the_room() {
    let spec = camera(SensorSpec::laser_3m());
    let at = looking_down(LOW + DISTANCE);
    let mut score = Score::default();
    for (seed, x) in [(0, -0.24), (1, -0.2), (2, -0.16)] {
        let carton = |n: i32, top: f64| Carton {
            x: x + f64::from(n) * (SIZE[0] + GAP),
            y: 0.05,
            top,
            yaw: 0.0,
            tilt: [0.0; 2],
            size: SIZE,
        };
        let cartons = [
            carton(0, LOW),
            carton(-1, LOW + HEIGHT),
            carton(1, LOW + HEIGHT),
        ];
        let under = [carton(-1, LOW), carton(1, LOW)];
        let all = (0..).zip(cartons.iter().chain(&under));
        let mut shapes: Vec<_> = all.map(|(id, c)| c.shape(id)).collect();
        let below = LOW - HEIGHT - 0.002;
        let (centre, size) = ([0.0, 0.0, below / 2.0], [1.4, 1.0, below]);
        shapes.push(block(5, centre, size, 0.0, depal_camera::Material::KRAFT));
        let frame = picture(&spec, &at, &shapes, seed);
        let settings = VisionSettings::new(vec![BoxSize::from_mm(SIZE.map(|s| s * 1e3))]);
        score.add(&at, &cartons, &detect(&frame, &settings).boxes);
    }
    let line = score.line();
    assert_eq!(score.false_positives, 0, "{line}");
    assert_eq!(score.found, score.wanted, "{line}");
    assert!(quantile(&score.xy_mm, 1.0) <= 3.0, "{line}");
}
