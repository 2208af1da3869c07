//! Depth pictures that a stereo matcher made of two views, not a blur: 640 x 480, 55 mm between the eyes, two layers,
//! packed tightly, one known size, no intensity.

use cheap::shapes;
use depal_frames::{BoxSize, Pose, Rotation, Vector};
use depal_vision::{VisionSettings, detect};
use matched::matched;
use rendered::{Carton, HEIGHT, Score, looking_down};

mod cheap;
mod matched;
mod rendered;

const TOP: f64 = 0.75;
const GAP: f64 = 0.002;

/// Two layers of `columns` x `rows` cartons; of the upper one only the first columns are there.
fn two_layers(size: [f64; 2], columns: usize, rows: usize, upper: usize) -> Vec<Carton> {
    let mut cartons = Vec::new();
    for (layer, count) in [(0, columns), (1, upper)] {
        for i in 0..count {
            for j in 0..rows {
                let place = |n: usize, of: usize, side: f64| {
                    (n as f64 - (of as f64 - 1.0) / 2.0) * (side + GAP)
                };
                cartons.push(Carton {
                    x: place(i, columns, size[0]),
                    y: place(j, rows, size[1]),
                    top: TOP - HEIGHT * f64::from(1 - layer),
                    yaw: 0.0,
                    tilt: [0.0; 2],
                    size: [size[0], size[1], HEIGHT],
                });
            }
        }
    }
    cartons
}

/// Above the middle, leaning about the camera's X.
fn above(distance: f64, degrees: f64) -> Pose {
    let turn = Rotation::new(Vector::x() * degrees.to_radians());
    let at = turn * Vector::new(0.0, 0.0, distance) + Vector::new(0.0, 0.0, TOP);
    Pose::from_parts(at.into(), turn * looking_down(0.0).rotation)
}

/// All tops that lie bare, of both layers.
fn score(size: [f64; 2], counts: [usize; 3], at: &Pose, seed: u64) -> Score {
    let [columns, rows, upper] = counts;
    let cartons = two_layers(size, columns, rows, upper);
    let bare: Vec<Carton> = cartons
        .iter()
        .filter(|c| {
            !cartons
                .iter()
                .any(|o| o.top > c.top + 0.01 && (o.x - c.x).hypot(o.y - c.y) < 0.1)
        })
        .copied()
        .collect();
    let frame = matched(at, &shapes(&cartons), seed);
    let size = BoxSize::from_mm([size[0] * 1e3, size[1] * 1e3, HEIGHT * 1e3]);
    let settings = VisionSettings::new(vec![size]).suited_to(&frame);
    let mut score = Score::default();
    score.add(at, &bare, &detect(&frame, &settings).boxes);
    score
}

#[test]
fn tops_of_both_layers() {
    let mut total = Score::default();
    for (n, (size, counts)) in [
        ([0.4, 0.3], [3, 3, 1]),
        ([0.4, 0.3], [2, 3, 2]),
        ([0.35, 0.25], [3, 3, 2]),
        ([0.4, 0.4], [3, 2, 1]),
        ([0.5, 0.3], [2, 3, 1]),
    ]
    .into_iter()
    .enumerate()
    {
        for degrees in [0.0, 10.0] {
            let seed = 9100 + n as u64;
            let one = score(size, counts, &above(1.5, degrees), seed);
            println!("{size:?} {counts:?} lean {degrees}: {}", one.line());
            total.absorb(one);
        }
    }
    println!("{}", total.line());
    assert_eq!(total.false_positives, 0);
    assert!(total.found as f64 >= 0.9 * total.wanted as f64);
}
