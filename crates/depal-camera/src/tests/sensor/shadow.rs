//! Where the projector does not reach.

use super::*;

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
