//! Pixels that are lost.

use super::*;

#[test]
fn pixels_at_a_step_drop_or_mix_in_the_given_shares() {
    let sensor = SensorSpec {
        edge_dropout: 0.3,
        mixed_pixels: 0.1,
        ..SensorSpec::ideal()
    };
    let spec = camera(640, 480, sensor);
    let plate = solid(1, Shape::cuboid(4.0, 0.6, 0.2), [0.0, 0.0, 1.9], [0.0; 3]);
    let (mut at_step, mut lost, mut elsewhere) = (0.0, 0.0, 0);
    // Shares of the way from the near surface to the far one.
    let mut between = Vec::new();
    for seed in 0..4 {
        let shot = shoot(&spec, &[plate.clone(), wall(0, 2.3)], seed);
        for v in 1..479 {
            for u in 0..640 {
                let p = v * 640 + u;
                let step = shot.ids[p] != shot.ids[p - 640] || shot.ids[p] != shot.ids[p + 640];
                let z = shot.frame.depth[p];
                let exact = shot.ideal_depth[p];
                if step && (u > 0 && u < 639) {
                    at_step += 1.0;
                    lost += f64::from(u8::from(z == 0.0));
                    if z != 0.0 && z != exact {
                        between.push(f64::from(z - 1.8) / 0.5);
                    }
                } else if !step && z != exact {
                    elsewhere += 1;
                }
            }
        }
    }
    assert!(at_step > 5000.0);
    assert!(
        (lost / at_step - 0.3_f64).abs() < 0.03,
        "{}",
        lost / at_step
    );
    let mixed = between.len() as f64;
    assert!(
        (mixed / at_step - 0.1_f64).abs() < 0.02,
        "{}",
        mixed / at_step
    );
    // Anywhere between, one place as often as another.
    let share = |from: f64| {
        let inside = |x: &&f64| (from..from + 0.25).contains(*x);
        between.iter().filter(inside).count() as f64 / mixed
    };
    for quarter in [0.0, 0.25, 0.5, 0.75] {
        let share = share(quarter);
        assert!((share - 0.25).abs() < 0.06, "{quarter}: {share}");
    }
    assert_eq!(elsewhere, 0);
}

#[test]
fn grazing_surfaces_are_lost_between_60_and_78_degrees() {
    let sensor = SensorSpec {
        grazing_start: 60.0_f64.to_radians(),
        grazing_end: 78.0_f64.to_radians(),
        ..SensorSpec::ideal()
    };
    let kept = |tilt_deg: f64| {
        let mut spec = camera(101, 101, sensor);
        spec.intrinsics.fx = 5000.0; // nearly parallel rays: the incidence is the tilt
        spec.intrinsics.fy = 5000.0;
        let board = solid(
            1,
            Shape::cuboid(4.0, 4.0, 0.001),
            [0.0, 0.0, 2.0],
            [tilt_deg.to_radians(), 0.0, 0.0],
        );
        let shot = shoot(&spec, &[board], 1);
        shot.frame.depth.iter().filter(|z| **z > 0.0).count() as f64 / (101.0 * 101.0)
    };
    assert_eq!(kept(55.0), 1.0);
    assert_eq!(kept(81.0), 0.0);
    let (c, s, e) = (
        70.0_f64.to_radians().cos(),
        0.5,
        78.0_f64.to_radians().cos(),
    );
    let expected = (c - e) / (s - e);
    assert!(
        (kept(70.0) - expected).abs() < 0.03,
        "{} expected {expected}",
        kept(70.0)
    );
}

#[test]
fn range_limits_and_random_dropout() {
    let mut spec = camera(
        320,
        240,
        SensorSpec {
            random_dropout: 0.002,
            ..SensorSpec::ideal()
        },
    );
    let lost = shoot(&spec, &[wall(0, 2.0)], 1)
        .frame
        .depth
        .iter()
        .filter(|z| **z == 0.0)
        .count() as f64
        / 76800.0;
    assert!((lost - 0.002).abs() < 0.0006, "{lost}");
    spec.far = 1.9;
    let shot = shoot(&spec, &[wall(0, 2.0)], 1);
    assert!(shot.frame.depth.iter().all(|z| *z == 0.0));
    assert!(shot.ideal_depth.iter().all(|z| (*z - 2.0).abs() < 1e-6));
}

#[test]
fn a_covered_lens_sees_nothing() {
    let mut spec = camera(64, 48, SensorSpec::laser_structured_light());
    let scene = two_boxes(true);
    assert!(shoot(&spec, &scene, 1).frame.depth.iter().any(|z| *z > 0.0));
    spec.sensor.blackout = true;
    let shot = shoot(&spec, &scene, 1);
    assert!(shot.frame.depth.iter().all(|z| *z == 0.0));
    assert!(shot.frame.intensity.iter().all(|g| *g == 0));
    assert_eq!(shot.frame.intensity.len(), 64 * 48);
}
