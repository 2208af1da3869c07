//! Filters of the vendor and several exposures: off in every preset, and what they do when on.

use super::*;
use crate::Material;

#[test]
fn no_preset_has_them_on() {
    for s in [
        SensorSpec::ideal(),
        SensorSpec::laser_2m(),
        SensorSpec::laser_3m(),
        SensorSpec::active_stereo(),
        SensorSpec::time_of_flight(),
    ] {
        assert!(!s.hdr && !s.outlier_removal && !s.median);
    }
}

#[test]
fn outlier_removal_takes_flying_pixels_and_leaves_surfaces() {
    let sensor = SensorSpec {
        mixed_pixels: 0.3,
        ..SensorSpec::ideal()
    };
    let filtered = SensorSpec {
        outlier_removal: true,
        ..sensor
    };
    let scene = [
        solid(1, Shape::cuboid(0.6, 0.6, 0.2), [0.0, 0.0, 1.9], [0.0; 3]),
        wall(0, 2.3),
    ];
    let count = |sensor: SensorSpec| {
        let shot = shoot(&camera(320, 240, sensor), &scene, 2);
        let pairs = || shot.frame.depth.iter().zip(&shot.ideal_depth);
        let flying = |(z, exact): &(&f32, &f32)| **z > 0.0 && (*z - *exact).abs() > 0.02;
        let right = pairs().filter(|(z, exact)| z == exact).count();
        (pairs().filter(flying).count(), right)
    };
    let (before, after) = (count(sensor), count(filtered));
    assert!(before.0 > 150, "{before:?}");
    assert!(after.0 * 5 < before.0, "{before:?} {after:?}");
    // Only a few of the exact ones go, beside steps whose other pixels fly.
    assert!(before.1 - after.1 < 320 * 240 / 500, "{before:?} {after:?}");
}

#[test]
fn the_median_smooths_white_noise_and_fills_nothing() {
    let sensor = SensorSpec {
        axial_noise: 0.001,
        random_dropout: 0.05,
        ..SensorSpec::ideal()
    };
    let filtered = SensorSpec {
        median: true,
        ..sensor
    };
    let look = |sensor: SensorSpec| {
        let depth = shoot(&camera(320, 240, sensor), &[wall(0, 3.0)], 2)
            .frame
            .depth;
        let holes: Vec<usize> = (0..depth.len()).filter(|p| depth[*p] == 0.0).collect();
        let squares: f64 = depth
            .iter()
            .filter(|z| **z > 0.0)
            .map(|z| f64::from(z - 3.0).powi(2))
            .sum();
        (holes, (squares / depth.len() as f64).sqrt())
    };
    let (before, after) = (look(sensor), look(filtered));
    assert_eq!(before.0, after.0);
    assert!(!before.0.is_empty());
    // A median of nine normal numbers has 0.41 of their deviation.
    assert!(
        (0.38..0.46).contains(&(after.1 / before.1)),
        "{} {}",
        before.1,
        after.1
    );
}

#[test]
fn filtered_pictures_have_the_same_bits_on_any_number_of_threads() {
    let sensor = SensorSpec {
        outlier_removal: true,
        median: true,
        ..SensorSpec::laser_3m()
    };
    let spec = camera(333, 251, sensor);
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool")
            .install(|| shoot(&spec, &two_boxes(true), 9))
    };
    assert_eq!(on(1), on(8));
}

#[test]
fn several_exposures_measure_what_one_over_exposes() {
    let lost = |hdr: bool| {
        let sensor = SensorSpec {
            hdr,
            ..SensorSpec::ideal()
        };
        let mut board = wall(1, 1.5);
        board.material = Material::GLOSSY_TAPE;
        board.material.dropout = 0.0;
        let shot = shoot(&camera(320, 240, sensor), &[board], 5);
        let holes = shot.frame.depth.iter().filter(|z| **z == 0.0).count();
        (holes, shot.frame.intensity)
    };
    let (once, often) = (lost(false), lost(true));
    assert!(once.0 > 200, "{}", once.0);
    assert_eq!(often.0, 0);
    assert_eq!(once.1, often.1);
}
