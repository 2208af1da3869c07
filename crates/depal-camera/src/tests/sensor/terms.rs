//! Every term by itself: alone it does what it is for, and all the others do without it.

use super::*;
use crate::Material;

/// The whole model. A rounding of disparity and a bias of distance are no part of the preset.
fn all() -> SensorSpec {
    SensorSpec {
        disparity_step_px: 0.05,
        distance_bias: 0.011,
        ..SensorSpec::laser_3m()
    }
}

/// Name, the term alone, and the whole model without it.
fn terms() -> Vec<(&'static str, SensorSpec, SensorSpec)> {
    let (all, none) = (all(), SensorSpec::ideal());
    macro_rules! terms {
        ($($name:literal: $($field:ident),+;)*) => {
            vec![$((
                $name,
                SensorSpec { $($field: all.$field,)+ ..none },
                SensorSpec { $($field: none.$field,)+ ..all },
            )),*]
        };
    }
    terms! {
        "shadow": shadow;
        "axial noise": axial_noise;
        "correlated noise": axial_noise, correlated_share;
        "jitter": lateral_jitter_px;
        "edge dropout": edge_dropout;
        "mixed pixels": mixed_pixels;
        "random dropout": random_dropout;
        "grazing": grazing_start, grazing_end;
        "darkness": dark_limit;
        "weak signal": axial_noise, radiometric_noise;
        "signal and distance": axial_noise, radiometric_noise, signal_distance;
        "bowl": bowl;
        "scale": scale_error;
        "bias": distance_bias;
        "rounding": quantum;
        "disparity": disparity_step_px;
        "lens": blur;
        "intensity noise": intensity_noise;
    }
}

/// Two cartons on a floor, a third that is seen at a grazing angle, and black tape.
fn scene() -> Vec<RenderShape> {
    let mut scene = two_boxes(true);
    scene.push(solid(
        7,
        Shape::cuboid(0.3, 0.3, 0.1),
        [0.1, 0.45, 2.0],
        [1.15, 0.0, 0.0],
    ));
    let mut tape = solid(
        8,
        Shape::cuboid(0.05, 0.2, 0.0002),
        [-0.2, 0.0, 2.0],
        [0.0; 3],
    );
    tape.material = Material::matt(0.015);
    scene.push(tape);
    scene
}

#[test]
fn each_term_alone_changes_the_picture_and_off_its_effect_is_gone() {
    let scene = scene();
    let rendering = render(
        &camera(640, 480, SensorSpec::ideal()),
        &Pose::identity(),
        &scene,
    );
    let shot = |sensor| sense(&camera(640, 480, sensor), &rendering, 4);
    let (ideal, whole) = (shot(SensorSpec::ideal()), shot(all()));
    // Without any term the picture is what is there.
    assert_eq!(ideal.frame.depth, ideal.ideal_depth);
    for (name, alone, without) in terms() {
        let alone = shot(alone).frame;
        let of_light = ["lens", "intensity noise"].contains(&name);
        assert_eq!(alone.depth == ideal.frame.depth, of_light, "{name} alone");
        assert!(alone != ideal.frame, "{name} alone does nothing");
        assert!(
            shot(without).frame != whole.frame,
            "{name} missing is not seen"
        );
    }
}

#[test]
fn without_a_term_what_it_takes_stays() {
    let scene = scene();
    let holes = |sensor: SensorSpec| {
        let shot = shoot(&camera(640, 480, sensor), &scene, 4);
        shot.frame.depth.iter().filter(|z| **z == 0.0).count()
    };
    let (all, none) = (SensorSpec::laser_3m(), SensorSpec::ideal());
    assert_eq!(holes(none), 0);
    // Noise, jitter, mixing and rounding take nothing.
    let lossless = SensorSpec {
        shadow: false,
        edge_dropout: 0.0,
        random_dropout: 0.0,
        grazing_start: none.grazing_start,
        grazing_end: none.grazing_end,
        dark_limit: 0.0,
        ..all
    };
    assert_eq!(holes(lossless), 0);
    for (name, sensor) in [
        (
            "shadow",
            SensorSpec {
                shadow: all.shadow,
                ..lossless
            },
        ),
        (
            "edges",
            SensorSpec {
                edge_dropout: all.edge_dropout,
                ..lossless
            },
        ),
        (
            "chance",
            SensorSpec {
                random_dropout: all.random_dropout,
                ..lossless
            },
        ),
        (
            "grazing",
            SensorSpec {
                grazing_start: all.grazing_start,
                grazing_end: all.grazing_end,
                ..lossless
            },
        ),
        (
            "darkness",
            SensorSpec {
                dark_limit: all.dark_limit,
                ..lossless
            },
        ),
    ] {
        assert!(holes(sensor) > 200, "{name}: {} holes", holes(sensor));
    }
}
