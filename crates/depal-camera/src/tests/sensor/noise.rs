//! Errors of depth: random, systematic, rounded.

use super::*;

#[test]
fn noise_on_a_flat_wall_follows_the_model() {
    let sensor = SensorSpec {
        axial_noise: 0.0005,
        correlated_share: 0.5,
        ..SensorSpec::ideal()
    };
    for z in [1.0, 2.0, 3.0] {
        let spec = camera(640, 480, sensor);
        let shot = shoot(&spec, &[wall(0, z)], 11);
        // sigma = 0.5 mm (z/3)^2 / cos(theta), so the error over that has variance one.
        let mut sum = 0.0;
        let mut square = 0.0;
        let mut beside = 0.0;
        let mut last = 0.0;
        let mut count = 0.0;
        for v in 0..480 {
            for u in 0..640 {
                let cos = 1.0 / spec.intrinsics.ray(u as f64, v as f64).norm();
                let sigma = 0.0005 * (z / 3.0) * (z / 3.0) / cos;
                let error = (f64::from(shot.frame.depth_at(u, v)) - z) / sigma;
                sum += error;
                square += error * error;
                beside += error * last;
                last = error;
                count += 1.0;
            }
        }
        let (mean, sigma): (f64, f64) = (sum / count, (square / count).sqrt());
        assert!(mean.abs() < 0.03, "{z} m: mean {mean} sigma");
        assert!((sigma - 1.0).abs() < 0.05, "{z} m: {sigma} of the model");
        // Neighbours share nearly all of the correlated half and nothing of the white one.
        let correlation = beside / count;
        assert!((0.3..0.5).contains(&correlation), "{correlation}");
    }
}

#[test]
fn white_noise_is_white() {
    let spec = camera(
        640,
        480,
        SensorSpec {
            axial_noise: 0.001,
            ..SensorSpec::ideal()
        },
    );
    let a = shoot(&spec, &[wall(0, 3.0)], 1);
    let b = shoot(&spec, &[wall(0, 3.0)], 2);
    let error = |shot: &Capture, p: usize| f64::from(shot.frame.depth[p]) - 3.0;
    let pixels = 640 * 480;
    let product = |f: &dyn Fn(usize) -> f64| (0..pixels - 640).map(f).sum::<f64>() / pixels as f64;
    let variance = product(&|p| error(&a, p).powi(2));
    assert!(product(&|p| error(&a, p) * error(&a, p + 1)).abs() < 0.01 * variance);
    assert!(product(&|p| error(&a, p) * error(&a, p + 640)).abs() < 0.01 * variance);
    assert!(product(&|p| error(&a, p) * error(&b, p)).abs() < 0.01 * variance);
}

#[test]
fn depth_comes_in_steps() {
    let spec = camera(320, 240, SensorSpec::laser_structured_light());
    let shot = shoot(&spec, &two_boxes(true), 4);
    let mut distinct = std::collections::BTreeSet::new();
    for z in shot.frame.depth.iter().filter(|z| **z > 0.0) {
        let steps = (f64::from(*z) / 0.0001).round();
        assert_eq!(*z, (steps * 0.0001) as f32);
        distinct.insert(steps as i64);
    }
    assert!(distinct.len() > 10);
}

#[test]
fn same_seed_same_bits_on_any_number_of_threads() {
    let spec = camera(333, 251, SensorSpec::laser_structured_light());
    let mut scene = two_boxes(true);
    scene.push(solid(
        7,
        Shape::Capsule {
            half_length: 0.3,
            radius: 0.08,
        },
        [0.2, 0.1, 1.4],
        [0.9, 0.2, 0.0],
    ));
    let on = |threads: usize, seed: u64| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool")
            .install(|| shoot(&spec, &scene, seed))
    };
    let bits = |c: &Capture| {
        c.frame
            .depth
            .iter()
            .map(|z| z.to_bits())
            .collect::<Vec<_>>()
    };
    let one = on(1, 9);
    for threads in [2, 8] {
        let many = on(threads, 9);
        assert_eq!(bits(&one), bits(&many));
        assert_eq!(one, many);
    }
    assert_ne!(bits(&one), bits(&on(1, 10)));
}

#[test]
fn presets_differ_as_their_classes_do() {
    let spread = |sensor: SensorSpec, z: f64| {
        let spec = camera(320, 240, sensor);
        let shot = shoot(&spec, &[wall(0, z)], 3);
        let errors: Vec<f64> = (90..150)
            .flat_map(|v| (130..190).map(move |u| v * 320 + u))
            .map(|p| f64::from(shot.frame.depth[p]))
            .filter(|d| *d > 0.0)
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / errors.len() as f64).sqrt()
    };
    let at_2m = |sensor: SensorSpec| spread(sensor, 2.0) * 1e3;
    assert_eq!(at_2m(SensorSpec::ideal()), 0.0);
    let (mid, long) = (at_2m(SensorSpec::laser_2m()), at_2m(SensorSpec::laser_3m()));
    let (flight, stereo) = (
        at_2m(SensorSpec::time_of_flight()),
        at_2m(SensorSpec::active_stereo()),
    );
    assert!(
        mid < long && long < flight && flight < stereo,
        "{mid} {long} {flight} {stereo}"
    );
    assert!((0.15..0.35).contains(&long), "{long}");
}

#[test]
fn steps_of_disparity_grow_with_the_square_of_depth() {
    let sensor = SensorSpec {
        disparity_step_px: 0.125,
        axial_noise: 0.002,
        ..SensorSpec::ideal()
    };
    let spec = camera(320, 240, sensor);
    let steps = |z: f64| {
        let shot = shoot(&spec, &[wall(0, z)], 3);
        let mut values: Vec<f64> = shot.frame.depth.iter().map(|z| f64::from(*z)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
            .windows(2)
            .map(|w| w[1] - w[0])
            .fold(f64::INFINITY, f64::min)
    };
    let expected = |z: f64| z * z * 0.125 / (spec.intrinsics.fx * 0.3);
    for z in [1.0, 3.0] {
        assert!(
            (steps(z) / expected(z) - 1.0).abs() < 0.05,
            "{} {}",
            steps(z),
            expected(z)
        );
    }
}
