use depal_frames::{Pose, Shape};

use super::*;
use crate::{CameraError, Capture, capture, render, sense};

fn shoot(spec: &CameraSpec, scene: &[RenderShape], seed: u64) -> Capture {
    capture(spec, &Pose::identity(), scene, seed)
}

/// Two rows of cartons with a gap of 3 mm, 0.2 m high on a slab, tops at 2 m.
fn two_boxes(along_x: bool) -> Vec<RenderShape> {
    let (size, gap) = (0.3, 0.003);
    let half = f64::midpoint(size, gap);
    let place = |id, s: f64| {
        let at = if along_x {
            [s, 0.0, 2.1]
        } else {
            [0.0, s, 2.1]
        };
        solid(id, Shape::cuboid(size, size, 0.2), at, [0.0; 3])
    };
    vec![place(1, -half), place(2, half), wall(0, 2.2)]
}

/// Share of holes among the pixels that look into the gap (inside the boxes' extent).
fn gap_holes(along_x: bool, sensor: SensorSpec) -> (usize, f64) {
    let spec = camera(1280, 1024, sensor);
    let shot = shoot(&spec, &two_boxes(along_x), 3);
    let i = spec.intrinsics;
    let half_px = (0.13 / 2.0 * i.fx) as usize;
    let (mut seen, mut holes) = (0, 0);
    for across in 0..7 {
        for along in 0..2 * half_px {
            let (u, v) = if along_x {
                (i.cx as usize - 3 + across, i.cy as usize - half_px + along)
            } else {
                (i.cx as usize - half_px + along, i.cy as usize - 3 + across)
            };
            let pixel = v * i.width + u;
            if shot.ideal_depth[pixel] > 2.005 {
                seen += 1;
                holes += usize::from(shot.frame.depth[pixel] == 0.0);
            }
        }
    }
    (seen, holes as f64 / seen as f64)
}

#[test]
fn a_gap_across_the_baseline_is_holes_and_along_it_is_not() {
    let shadow_only = SensorSpec {
        shadow: true,
        ..SensorSpec::ideal()
    };
    let (seen, share) = gap_holes(true, shadow_only);
    assert!(seen > 100 && share >= 0.8, "{seen} pixels, {share}");
    let (_, share) = gap_holes(true, SensorSpec::laser_structured_light());
    assert!(share >= 0.8, "{share}");
    // The projector shines along the other gap to its bottom.
    let (seen, share) = gap_holes(false, shadow_only);
    assert!(seen > 100 && share <= 0.3, "{seen} pixels, {share}");
    // Without the projector there are no holes at all.
    assert_eq!(gap_holes(true, SensorSpec::ideal()).1, 0.0);
}

#[test]
fn the_shadow_falls_away_from_the_projector() {
    // A plate 0.5 m before a wall: its shadow lies on the side away from the projector,
    // baseline * (z_wall - z_plate) / z_plate = 0.3 * 0.5 / 1.5 = 0.1 m wide on the wall.
    let sensor = SensorSpec {
        shadow: true,
        ..SensorSpec::ideal()
    };
    for baseline in [0.3, -0.3] {
        let mut spec = camera(640, 480, sensor);
        spec.baseline = baseline;
        let plate = solid(
            1,
            Shape::cuboid(0.3, 0.3, 0.001),
            [0.0, 0.0, 1.5005],
            [0.0; 3],
        );
        let shot = shoot(&spec, &[plate, wall(0, 2.0)], 0);
        let row = 240 * 640;
        let lost = |u: usize| shot.frame.depth[row + u] == 0.0;
        let left = (0..320).filter(|u| lost(*u)).count();
        let right = (320..640).filter(|u| lost(*u)).count();
        let expected = 0.1 / 2.0 * spec.intrinsics.fx;
        let (shaded, clear) = if baseline > 0.0 {
            (left, right)
        } else {
            (right, left)
        };
        assert!(
            (shaded as f64 - expected).abs() <= 2.0,
            "{shaded} px, expected {expected}"
        );
        assert_eq!(clear, 0);
    }
}

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

#[test]
fn pixels_at_a_step_drop_or_mix_in_the_given_shares() {
    let sensor = SensorSpec {
        edge_dropout: 0.3,
        mixed_pixels: 0.1,
        ..SensorSpec::ideal()
    };
    let spec = camera(640, 480, sensor);
    let plate = solid(1, Shape::cuboid(4.0, 0.6, 0.2), [0.0, 0.0, 1.9], [0.0; 3]);
    let (mut at_step, mut lost, mut mixed, mut elsewhere) = (0.0, 0.0, 0.0, 0);
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
                    mixed += f64::from(u8::from(z > 1.85 && z < 2.25));
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
    assert!(
        (mixed / at_step - 0.1_f64).abs() < 0.02,
        "{}",
        mixed / at_step
    );
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
fn dark_tape_is_lost_and_noisier_boards_are_noisier() {
    let spec = camera(
        64,
        64,
        SensorSpec {
            dark_limit: 0.05,
            ..SensorSpec::ideal()
        },
    );
    let mut board = wall(0, 2.0);
    assert!(
        shoot(&spec, std::slice::from_ref(&board), 1)
            .frame
            .depth
            .iter()
            .all(|z| *z > 0.0)
    );
    board.material = Material::BLACK_TAPE;
    assert!(
        shoot(&spec, &[board], 1)
            .frame
            .depth
            .iter()
            .all(|z| *z == 0.0)
    );

    let spread = |albedo| {
        let spec = camera(
            200,
            200,
            SensorSpec {
                axial_noise: 0.0005,
                radiometric_noise: true,
                ..SensorSpec::ideal()
            },
        );
        let mut board = wall(0, 3.0);
        board.material = Material::matt(albedo);
        let shot = shoot(&spec, &[board], 1);
        (shot
            .frame
            .depth
            .iter()
            .map(|z| f64::from(z - 3.0).powi(2))
            .sum::<f64>()
            / 40000.0)
            .sqrt()
    };
    let ratio: f64 = spread(0.125) / spread(0.5);
    assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
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
fn the_seam_in_the_intensity_image_is_the_shadow_of_a_real_gap() {
    let seam = |gap: f64| {
        let half = f64::midpoint(0.3, gap);
        let scene = [
            solid(1, Shape::cuboid(0.3, 0.3, 0.2), [-half, 0.0, 2.1], [0.0; 3]),
            solid(2, Shape::cuboid(0.3, 0.3, 0.2), [half, 0.0, 2.1], [0.0; 3]),
            wall(0, 2.2),
        ];
        let sensor = SensorSpec {
            shadow: true,
            blur: true,
            ..SensorSpec::ideal()
        };
        let spec = camera(1280, 1024, sensor);
        let shot = shoot(&spec, &scene, 1);
        let row = &shot.frame.intensity[512 * 1280 + 620..512 * 1280 + 660];
        let bright = f64::from(*row.iter().max().expect("pixels"));
        let dark = f64::from(*row.iter().min().expect("pixels"));
        let steepest = row
            .windows(2)
            .map(|w| w[0].abs_diff(w[1]))
            .max()
            .expect("pixels");
        (dark / bright, steepest)
    };
    assert!(seam(0.003).0 < 0.7, "{:?}", seam(0.003));
    // Butt joint of equal boards: nothing but the slow fall of the light.
    assert!(seam(0.0).0 > 0.95 && seam(0.0).1 <= 1, "{:?}", seam(0.0));
}

#[test]
fn nonsense_is_refused_with_its_name() {
    let mut spec = camera(64, 48, SensorSpec::default());
    assert_eq!(spec.validate(), Ok(()));
    spec.far = 0.1;
    let error = spec.validate().expect_err("far < near");
    assert!(matches!(
        error,
        CameraError::OutOfRange { field: "far", .. }
    ));
    assert_eq!(
        error.to_string(),
        "camera far: expected more than near, m, found 0.1"
    );
    spec.far = f64::NAN;
    assert!(spec.validate().is_err());
}

#[test]
fn redrawing_into_used_buffers_is_the_same_as_a_fresh_picture() {
    let small = camera(64, 48, SensorSpec::ideal());
    let large = camera(160, 120, SensorSpec::laser_structured_light());
    let at = Pose::identity();
    let mut rendering = render(&large, &at, &[wall(5, 1.2)]);
    let scene = &two_boxes(true)[..2]; // nothing behind the boxes
    for spec in [small, large] {
        rendering.redraw(&spec, &at, scene);
        assert_eq!(sense(&spec, &rendering, 3), shoot(&spec, scene, 3));
    }
}

/// A board with a strip of another material across its middle, face at 1.5 m.
fn taped(material: Material) -> Vec<RenderShape> {
    let mut strip = solid(
        2,
        Shape::cuboid(4.0, 0.06, 0.0002),
        [0.0, 0.0, 1.5],
        [0.0; 3],
    );
    strip.material = material;
    vec![wall(1, 1.5), strip]
}

#[test]
fn materials_differ_in_losses_noise_and_brightness() {
    let spec = camera(640, 480, SensorSpec::laser_3m());
    // Share lost, deviation of depth and mean grey on the strip.
    let look = |material: Material| {
        let shot = shoot(&spec, &taped(material), 5);
        let (mut seen, mut total, mut squares, mut grey) = (0.0, 0.0, 0.0, 0.0);
        for pixel in (0..640 * 480).filter(|p| shot.ids[*p] == 2) {
            total += 1.0;
            grey += f64::from(shot.frame.intensity[pixel]);
            let z = shot.frame.depth[pixel];
            if z > 0.0 {
                seen += 1.0;
                squares += f64::from(z - shot.ideal_depth[pixel]).powi(2);
            }
        }
        assert!(total > 1000.0);
        (1.0 - seen / total, (squares / seen).sqrt(), grey / total)
    };
    let (kraft, label) = (look(Material::KRAFT), look(Material::LABEL));
    let (tape, film) = (look(Material::BLACK_TAPE), look(Material::FILM));
    assert!(kraft.0 < 0.01 && label.0 < 0.01);
    assert!(label.2 > 1.3 * kraft.2, "{label:?} {kraft:?}");
    assert!(tape.0 > 0.3 && tape.2 < 0.3 * kraft.2, "{tape:?}");
    assert!(film.0 > 0.1 && film.1 > 2.0 * kraft.1, "{film:?} {kraft:?}");
}

#[test]
fn a_glossy_strip_is_over_exposed_only_in_the_mirror_direction() {
    let spec = camera(640, 480, SensorSpec::laser_3m());
    // A level strip mirrors the projector at half the baseline: x = 0.15 m.
    let shot = shoot(&spec, &taped(Material::GLOSSY_TAPE), 5);
    let lost = |x: f64| {
        let u = (x / 1.5 * spec.intrinsics.fx + spec.intrinsics.cx) as usize;
        let mut lost = 0;
        for v in 232..248 {
            lost += (u - 8..u + 8)
                .filter(|u| shot.frame.depth[v * 640 + u] == 0.0)
                .count();
        }
        f64::from(lost as u32) / 256.0
    };
    assert_eq!(lost(0.15), 1.0);
    assert!(
        lost(-0.4) < 0.3 && lost(0.6) < 0.3,
        "{} {}",
        lost(-0.4),
        lost(0.6)
    );
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
