//! What surfaces are made of.

use super::*;

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
    // Without the errors of the device: they are the same on every material.
    let sensor = SensorSpec {
        bowl: 0.0,
        scale_error: 0.0,
        ..SensorSpec::laser_3m()
    };
    let spec = camera(640, 480, sensor);
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
