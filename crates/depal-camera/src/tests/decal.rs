//! A print changes grey and noise where it is, and nothing else.

use depal_frames::{Pose, Shape};

use super::{camera, solid, wall};
use crate::{Capture, Decal, Material, SensorSpec, capture, capture_with_decals};

const PLATE: u32 = 3;

fn print_at(x: f64, y: f64, radius: f64) -> Decal {
    Decal {
        // Z of the print towards the camera: a half turn about X; the plate's face is at 1 m.
        world_from_decal: Pose::translation(0.0, 0.0, 1.0)
            * Pose::rotation(depal_frames::Vector::x() * std::f64::consts::PI),
        id: PLATE,
        discs: vec![([x, y], radius)],
        bare: Material::KRAFT.albedo,
        ink: 0.05,
    }
}

fn shot(sensor: SensorSpec, in_the_way: bool, decals: &[Decal]) -> Capture {
    let plate = Shape::cuboid(0.4, 0.4, 0.02);
    let mut shapes = vec![
        wall(1, 2.0),
        solid(PLATE, plate, [0.0, 0.0, 1.01], [0.0; 3]),
    ];
    if in_the_way {
        shapes.push(solid(
            9,
            Shape::cuboid(0.1, 0.1, 0.1),
            [0.0, 0.0, 0.8],
            [0.0; 3],
        ));
    }
    capture_with_decals(
        &camera(320, 240, sensor),
        &Pose::identity(),
        &shapes,
        decals,
        5,
    )
}

/// Centroid of the darkening, pixels, and its sum in grey values of the bare plate.
fn darkening(bare: &Capture, printed: &Capture) -> (f64, f64, f64) {
    let (mut sum, mut u, mut v) = (0.0, 0.0, 0.0);
    for (k, (a, b)) in bare
        .frame
        .intensity
        .iter()
        .zip(&printed.frame.intensity)
        .enumerate()
    {
        let loss = (f64::from(*a) - f64::from(*b)) / f64::from(*a).max(1.0);
        sum += loss;
        u += loss * (k % 320) as f64;
        v += loss * (k / 320) as f64;
    }
    (sum, u / sum, v / sum)
}

#[test]
fn a_disc_is_where_and_as_large_as_it_is_printed() {
    // Exposed for a plate at 1 m: nothing is cut off at white.
    let sensor = SensorSpec {
        exposure_distance: 0.9,
        ..SensorSpec::ideal()
    };
    let bare = shot(sensor, false, &[]);
    for (x, y) in [(0.0, 0.0), (0.0513, 0.0237), (-0.0731, 0.0449)] {
        let printed = shot(sensor, false, &[print_at(x, y, 0.05)]);
        assert_eq!(
            bare.frame.depth, printed.frame.depth,
            "ink has no thickness"
        );
        assert_eq!(bare.ids, printed.ids);
        let (sum, u, v) = darkening(&bare, &printed);
        let i = printed.frame.intrinsics;
        // The print's Y is the camera's -Y.
        let (wanted_u, wanted_v) = (x * i.fx + i.cx, -y * i.fy + i.cy);
        assert!((u - wanted_u).abs() < 0.05, "{u} for {wanted_u}");
        assert!((v - wanted_v).abs() < 0.05, "{v} for {wanted_v}");
        let loss = 1.0 - 0.05 / Material::KRAFT.albedo;
        let area = std::f64::consts::PI * (0.05 * i.fx).powi(2) * loss;
        assert!((sum / area - 1.0).abs() < 0.03, "{sum} for {area}");
    }
}

#[test]
fn what_stands_before_the_face_and_the_back_stay_clean() {
    let bare = shot(SensorSpec::ideal(), true, &[]);
    let printed = shot(SensorSpec::ideal(), true, &[print_at(0.0, 0.0, 0.05)]);
    assert_eq!(bare.frame.intensity, printed.frame.intensity);
    let mut behind = print_at(0.0, 0.0, 0.05);
    behind.world_from_decal = Pose::translation(0.0, 0.0, 1.02);
    let bare = shot(SensorSpec::ideal(), false, &[]);
    let printed = shot(SensorSpec::ideal(), false, &[behind]);
    assert_eq!(bare.frame.intensity, printed.frame.intensity);
    // Without a print both ways of taking a picture agree to the bit.
    let spec = camera(320, 240, SensorSpec::default());
    let shapes = [wall(1, 2.0)];
    assert_eq!(
        capture(&spec, &Pose::identity(), &shapes, 5),
        capture_with_decals(&spec, &Pose::identity(), &shapes, &[], 5)
    );
}

#[test]
fn depth_on_ink_is_noisier() {
    let sensor = SensorSpec {
        quantum: 0.0,
        dark_limit: 0.0,
        correlated_share: 0.0,
        ..SensorSpec::default()
    };
    let spread = |shot: &Capture| {
        let errors: Vec<f64> = (110..130)
            .flat_map(|v| (150..170).map(move |u| v * 320 + u))
            .filter(|k| shot.frame.depth[*k] > 0.0)
            .map(|k| f64::from(shot.frame.depth[k] - shot.ideal_depth[k]))
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let squares: f64 = errors.iter().map(|e| (e - mean).powi(2)).sum();
        (squares / errors.len() as f64).sqrt()
    };
    let bare = spread(&shot(sensor, false, &[]));
    let inked = spread(&shot(sensor, false, &[print_at(0.0, 0.0, 0.08)]));
    assert!(
        inked > 2.0 * bare,
        "{inked} m on ink, {bare} m on the bare plate"
    );
}
