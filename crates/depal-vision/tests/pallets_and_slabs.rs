//! What lies beneath cartons is none, whatever sizes are given: boards of a pallet, corners of a slab.

use depal_camera::Material;
use depal_frames::BoxSize;
use depal_vision::{DetectedBox, VisionSettings, detect};
use generator::{Noise, at, frame_of};
use rendered::{Carton, block, floor};
use unsized_scenes::{Case, Scene, Sensor, frame, scene};

mod generator;
mod rendered;
mod unsized_scenes;

const SENSORS: [Sensor; 2] = [Sensor::Camera, Sensor::Second];

fn found(scene: &Scene, sizes: &[[f64; 3]], sensor: Sensor, seed: u64) -> Vec<DetectedBox> {
    let frame = frame(scene, sensor, seed);
    let sizes = sizes.iter().map(|s| BoxSize::from_mm(*s)).collect();
    detect(&frame, &VisionSettings::new(sizes).suited_to(&frame)).boxes
}

fn carton([x, y]: [f64; 2], top: f64, size: [f64; 3]) -> Carton {
    Carton {
        x,
        y,
        top,
        yaw: 0.0,
        tilt: [0.0; 2],
        size,
    }
}

fn is_at(found: &DetectedBox, carton: &Carton) -> bool {
    let p = (at() * found.camera_from_box).translation.vector;
    (p.x - carton.x).hypot(p.y - carton.y) < 0.005 && (p.z - carton.top).abs() < 0.005
}

/// Boards as long and as wide as a carton are bare boards all the same; a carton as long and as wide as they, put on
/// them, is found.
#[test]
fn boards_are_no_cartons() {
    for (seed, sensor) in (73_000..).zip([SENSORS, SENSORS].concat()) {
        for size in [
            [1200.0, 145.0, 100.0],
            [1200.0, 100.0, 120.0],
            [150.0, 100.0, 100.0],
            [240.0, 145.0, 150.0],
        ] {
            let mut pallet = scene(Case::Boards, 0.0, seed, sensor);
            let none = found(&pallet, &[size], sensor, seed);
            assert_eq!(none, [], "{sensor:?} {size:?}");
            let [length, width, height] = size.map(|s| s * 1e-3);
            let on_it = carton([0.0, 0.1], height, [length, width, height]);
            pallet.others.push(on_it.shape(0));
            let one = found(&pallet, &[size], sensor, seed);
            assert!(
                one.len() == 1 && is_at(&one[0], &on_it),
                "{sensor:?} {size:?}: {one:?}"
            );
        }
    }
}

/// A carton between two that are lower by no more than a board is thick stands on no bearers.
#[test]
fn a_carton_between_lower_ones_is_no_board() {
    let sizes = [[300.0, 200.0, 200.0], [300.0, 200.0, 180.0]];
    for (seed, sensor) in (73_100..).zip([SENSORS, SENSORS].concat()) {
        let row = [-0.206, 0.0, 0.206].map(|y| {
            let height = if y == 0.0 { 0.2 } else { 0.18 };
            carton([0.0, y], height - 0.2, [0.3, 0.2, height])
        });
        let mut pallet = scene(Case::Layer(rendered::Layout::Regular20), 0.01, seed, sensor);
        pallet.cartons = row.to_vec();
        let boxes = found(&pallet, &sizes, sensor, seed);
        for carton in &row {
            assert!(
                boxes.iter().any(|b| is_at(b, carton)),
                "{sensor:?} {seed}: {boxes:?}"
            );
        }
    }
}

/// Beside a corner of a slab two higher cartons hide the rest, just so that what is seen of it is as large as one.
/// The strip beside them shows that the slab goes on.
#[test]
fn a_corner_of_a_slab_is_no_carton() {
    for seed in 73_200..73_206 {
        let size = [0.15, 0.1, 0.1];
        // Seen from 2 m above, their edges hide what lies beneath by a twentieth of how far out they are.
        let (beside, before) = (
            [0.55 / 1.05 - 0.075, 0.46],
            [0.6 - 0.075, 0.4 / 1.05 - 0.05],
        );
        let cartons = [carton(beside, 0.0, size), carton(before, 0.0, size)];
        let mut shapes: Vec<_> = (0..).zip(&cartons).map(|(n, c)| c.shape(n)).collect();
        let slab = [0.0, 0.0, -0.202];
        let sides = [1.3, 1.1, 0.2];
        shapes.push(block(1000, slab, sides, 0.0, Material::KRAFT));
        shapes.push(floor(-1.0));
        let frame = frame_of(&shapes, Noise::White, false, seed);
        let settings = VisionSettings::new(vec![BoxSize::from_mm(size.map(|s| s * 1e3))]);
        let boxes = detect(&frame, &settings.suited_to(&frame)).boxes;
        assert_eq!(boxes.len(), 2, "{seed}: {boxes:?}");
        assert!(cartons.iter().all(|c| boxes.iter().any(|b| is_at(b, c))));
    }
}
