//! What belongs to the camera and not to the picture.

use super::*;

const WIDTH: usize = 320;
const HEIGHT: usize = 240;

/// Error of depth on a wall, metres, when only these terms are on.
fn errors(sensor: SensorSpec, z: f64, seed: u64) -> Vec<f64> {
    let spec = camera(WIDTH, HEIGHT, sensor);
    let shot = shoot(&spec, &[wall(0, z)], seed);
    let pairs = shot.frame.depth.iter().zip(&shot.ideal_depth);
    pairs
        .map(|(found, exact)| f64::from(*found) - f64::from(*exact))
        .collect()
}

fn bowl(device_seed: u64) -> SensorSpec {
    SensorSpec {
        bowl: 0.0003,
        device_seed,
        ..SensorSpec::ideal()
    }
}

#[test]
fn the_bowl_is_the_same_in_every_picture_of_a_camera_and_another_in_another_one() {
    let one = errors(bowl(1), 2.0, 1);
    assert_eq!(one, errors(bowl(1), 2.0, 2));
    assert_ne!(one, errors(bowl(2), 2.0, 1));
}

#[test]
fn the_bowl_is_a_quadratic_with_a_tilt_as_high_as_the_preset_says() {
    let (mut bends, mut tilts) = (Vec::new(), Vec::new());
    for device in 0..20 {
        let e = errors(bowl(device), 2.0, 1);
        let least = e.iter().copied().fold(f64::INFINITY, f64::min);
        let most = e.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Single precision at 2 m: steps of 0.24 um.
        assert!((most - least - 0.0003).abs() < 1e-6, "{least} {most}");
        assert!((most + least).abs() < 1e-6, "{least} {most}");
        // Along any row: the second difference over thirds is the same everywhere.
        let at = |u: usize, v: usize| e[v * WIDTH + u];
        let bend = |v: usize, u: usize| at(u, v) - 2.0 * at(u + 80, v) + at(u + 160, v);
        assert!((bend(0, 0) - bend(200, 150)).abs() < 2e-6);
        assert!(bend(0, 0).abs() > 1e-5);
        bends.push(bend(0, 0) > 0.0);
        tilts.push(at(WIDTH - 1, 0) > at(0, 0));
    }
    // Bowls and domes, tilted either way.
    assert!(bends.contains(&true) && bends.contains(&false));
    assert!(tilts.contains(&true) && tilts.contains(&false));
}

#[test]
fn the_scale_error_grows_with_distance_and_has_the_sign_of_the_device() {
    let mut signs = Vec::new();
    for device_seed in 0..20 {
        let sensor = SensorSpec {
            scale_error: 0.0005,
            device_seed,
            ..SensorSpec::ideal()
        };
        for z in [1.0, 2.0, 3.0] {
            let error = errors(sensor, z, 7)[HEIGHT / 2 * WIDTH + WIDTH / 2];
            assert!((error.abs() - 0.0005 * z).abs() < 1e-6, "{error} at {z} m");
            signs.push(error > 0.0);
        }
        assert!(
            signs
                .iter()
                .rev()
                .take(3)
                .all(|s| *s == signs[signs.len() - 1])
        );
    }
    assert!(signs.contains(&true) && signs.contains(&false));
}

#[test]
fn the_laser_presets_carry_both() {
    for sensor in [SensorSpec::laser_2m(), SensorSpec::laser_3m()] {
        assert_eq!(sensor.bowl, 0.0003);
        assert!((0.0002..=0.0005).contains(&sensor.scale_error));
    }
}

#[test]
fn the_bias_is_the_same_at_all_distances_and_only_time_of_flight_has_it() {
    let sensor = SensorSpec {
        distance_bias: 0.011,
        ..SensorSpec::ideal()
    };
    for z in [1.0, 3.0] {
        for error in errors(sensor, z, 7) {
            assert!((error.abs() - 0.011).abs() < 1e-6, "{error} at {z} m");
        }
    }
    assert_eq!(SensorSpec::time_of_flight().distance_bias, 0.011);
    assert_eq!(SensorSpec::laser_3m().distance_bias, 0.0);
    assert_eq!(SensorSpec::active_stereo().distance_bias, 0.0);
}

#[test]
fn active_stereo_delivers_whole_steps_of_its_own_disparity() {
    // Its steps are those of 640 px and 50 mm, whatever the picture's size and the projector's place.
    let sensor = SensorSpec::active_stereo();
    let shot = shoot(&camera(WIDTH, HEIGHT, sensor), &[wall(0, 3.0)], 3);
    let mut seen = std::collections::BTreeSet::new();
    for z in shot.frame.depth.iter().filter(|z| **z > 0.0) {
        let steps = 640.0 * 0.05 * 32.0 / f64::from(*z);
        // Half a millimetre of rounding at 3 m is 0.057 steps; noise goes up to 0.1 m nearer.
        assert!((steps - steps.round()).abs() < 0.07, "{z} m: {steps} steps");
        seen.insert(steps.round() as i64);
    }
    assert!((10..50).contains(&seen.len()), "{seen:?}");
}
