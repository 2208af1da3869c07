//! Cartons whose sides differ by no more than a side may be off.

use depal_camera::Material;
use depal_frames::{BoxSize, Vector};
use depal_time::RandomStreams;
use depal_vision::{VisionSettings, detect};
use generator::{Noise, at, frame_of};
use rendered::{Carton, block, floor};

mod generator;
mod rendered;

const SIZE: [f64; 3] = [0.305, 0.300, 0.2];

/// Rows of four and three, 1 mm apart, as level as the second sensor's world is.
fn bricks(seed: u64) -> Vec<Carton> {
    let mut r = RandomStreams::new(seed).stream("bricks");
    let degree = 1f64.to_radians();
    let mut all = Vec::new();
    for (row, count) in (-1..=1).zip([4, 3, 4]) {
        for n in 0..count {
            all.push(Carton {
                x: (f64::from(n) - f64::from(count - 1) / 2.0) * (SIZE[0] + 0.001),
                y: f64::from(row) * (SIZE[1] + 0.001),
                top: r.uniform(-0.001, 0.001),
                yaw: 0.0,
                tilt: [(); 2].map(|()| r.normal(1.0) * 0.2 * degree),
                size: SIZE,
            });
        }
    }
    all
}

/// In a layer that hangs together none is reported the other way round than its own sides say: those that were placed
/// against it lie millimetres off.
#[test]
fn none_of_a_layer_lies_across() {
    let mut found = 0;
    for seed in 74_100..74_116 {
        let cartons = bricks(seed);
        let mut shapes: Vec<_> = (0..).zip(&cartons).map(|(n, c)| c.shape(n)).collect();
        let slab = [0.0, 0.0, -0.302];
        shapes.push(block(1000, slab, [1.3, 1.0, 0.2], 0.0, Material::KRAFT));
        shapes.push(floor(-1.0));
        let frame = frame_of(&shapes, Noise::White, false, seed);
        let sizes = vec![BoxSize::from_mm(SIZE.map(|s| s * 1e3))];
        for b in detect(&frame, &VisionSettings::new(sizes).suited_to(&frame)).boxes {
            let pose = at() * b.camera_from_box;
            let p = pose.translation.vector;
            let own = |c: &&Carton| (c.x - p.x).hypot(c.y - p.y) < 0.02;
            assert!(cartons.iter().any(|c| own(&c)), "{seed}: {p}");
            let along = (pose.rotation * Vector::x()).x.abs();
            assert!(along > 0.99, "{seed}: {:.2} {:.2} lies across", p.x, p.y);
            found += 1;
        }
    }
    assert!(found > 16 * 5, "{found}");
}
