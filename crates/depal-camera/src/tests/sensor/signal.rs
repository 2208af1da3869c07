//! The signal over distance: exposure, noise and darkness.

use super::*;
use crate::Material;

/// Noise and darkness of the preset, and nothing else.
fn radiometry(signal_distance: f64) -> SensorSpec {
    SensorSpec {
        axial_noise: 0.0005,
        radiometric_noise: true,
        dark_limit: 0.02,
        signal_distance,
        ..SensorSpec::ideal()
    }
}

/// Deviation of depth on solid `id`, over 0.5 mm (z/3)^2 / (cos theta sqrt(cos theta_proj)), which is
/// the model on brown board at the distance of the exposure.
fn deviation(spec: &CameraSpec, shot: &Capture, id: u32) -> f64 {
    let i = &spec.intrinsics;
    let (mut squares, mut count) = (0.0, 0.0);
    for p in (0..i.width * i.height).filter(|p| shot.ids[*p] == id) {
        let z = f64::from(shot.ideal_depth[p]);
        let ray = i.ray((p % i.width) as f64, (p / i.width) as f64);
        let to_light = Vector::new(spec.baseline, 0.0, 0.0) - ray * z;
        let (cos_view, cos_light) = (1.0 / ray.norm(), z / to_light.norm());
        let model = spec.sensor.axial_noise * (z / 3.0).powi(2) / (cos_view * cos_light.sqrt());
        squares += ((f64::from(shot.frame.depth[p]) - z) / model).powi(2);
        count += 1.0;
    }
    assert!(count > 10_000.0, "{count} pixels of {id}");
    f64::sqrt(squares / count)
}

#[test]
fn a_wall_of_board_follows_the_preset_up_to_the_longest_exposure_and_z_cubed_beyond() {
    let spec = camera(640, 480, radiometry(3.0));
    for (z, factor) in [
        (1.0, 1.0),
        (2.0, 1.0),
        (3.0, 1.0),
        (4.0, 4.0 / 3.0),
        (5.5, 5.5 / 3.0),
    ] {
        let shot = shoot(&spec, &[wall(0, z)], 11);
        let found = deviation(&spec, &shot, 0) / factor;
        assert!((found - 1.0).abs() < 0.05, "{z} m: {found} of the model");
    }
}

#[test]
fn in_one_picture_the_near_is_better_and_the_far_worse() {
    // Half of the picture at 1.5 m, half at 3 m.
    let near = solid(1, Shape::cuboid(8.0, 8.0, 0.2), [0.0, 4.0, 1.6], [0.0; 3]);
    let scene = [near, wall(2, 3.0)];
    // sqrt of the mean of 1/z^2 over both halves.
    let exposed_for = (2.0_f64 / (1.0 / 2.25 + 1.0 / 9.0)).sqrt();
    for (distance, factors) in [
        (3.0, [1.5 / exposed_for, 3.0 / exposed_for]),
        (0.0, [1.0, 1.0]),
    ] {
        let spec = camera(640, 480, radiometry(distance));
        let shot = shoot(&spec, &scene, 5);
        for (id, factor) in [1, 2].into_iter().zip(factors) {
            let found = deviation(&spec, &shot, id) / factor;
            assert!((found - 1.0).abs() < 0.05, "{distance} m, {id}: {found}");
        }
    }
}

#[test]
fn what_is_dark_is_lost_farther_away_and_seen_near() {
    let seen = |signal_distance: f64, z: f64, albedo: f64| {
        let mut board = wall(0, z);
        board.material = Material::matt(albedo);
        let shot = shoot(&camera(64, 48, radiometry(signal_distance)), &[board], 1);
        shot.frame.depth.iter().filter(|z| **z > 0.0).count()
    };
    // 0.03 x (2/2)^2 is more than the limit of 0.02, and 0.03 x (2/4)^2 is less.
    assert_eq!(seen(2.0, 2.0, 0.03), 64 * 48);
    assert_eq!(seen(2.0, 4.0, 0.03), 0);
    assert_eq!(seen(0.0, 4.0, 0.03), 64 * 48);
    assert_eq!(seen(2.0, 4.0, 0.5), 64 * 48);
}
