//! What tape and label do to a picture of one carton.

use depal_camera::{CameraSpec, SensorSpec, capture};
use depal_frames::Intrinsics;

use super::*;

const WIDTH: usize = 640;

/// From 1.5 m above the top of a carton of 400 x 300 x 250 mm: about 1.5 mm a pixel.
fn camera(sensor: SensorSpec) -> CameraSpec {
    CameraSpec {
        intrinsics: Intrinsics {
            width: WIDTH,
            height: 512,
            fx: 1000.0,
            fy: 1000.0,
            cx: 319.5,
            cy: 255.5,
        },
        near: 0.3,
        far: 5.0,
        baseline: 0.3,
        sensor,
    }
}

fn carton(skin: CartonSkin, edge_radius: f64) -> Vec<RenderShape> {
    skin.dress(RenderShape {
        world_from_shape: Pose::from_parts(
            Vector::new(0.0, 0.0, 1.625).into(),
            Rotation::new(Vector::x() * std::f64::consts::PI),
        ),
        shape: Shape::cuboid(0.4, 0.3, 0.25),
        id: 7,
        material: Material::WOOD,
        edge_radius,
    })
}

fn taped(material: Material) -> CartonSkin {
    CartonSkin {
        tape: Some(Tape {
            material,
            width: 0.05,
        }),
        ..CartonSkin::default()
    }
}

/// Where a pixel of the top lies, metres from its middle.
fn on_top(pixel: usize) -> [f64; 2] {
    let (u, v) = (pixel % WIDTH, pixel / WIDTH);
    [
        (u as f64 - 319.5) / 1000.0 * 1.5,
        (v as f64 - 255.5) / 1000.0 * 1.5,
    ]
}

#[test]
fn a_bare_carton_is_one_solid_of_brown_board() {
    let shapes = carton(CartonSkin::default(), 0.0);
    assert_eq!(shapes.len(), 1);
    assert_eq!(shapes[0].material, Material::KRAFT);
}

#[test]
fn black_tape_takes_depth_in_its_stripe_and_nowhere_else() {
    for edge_radius in [0.0, 0.004] {
        let spec = camera(SensorSpec::laser_3m());
        let shoot = |skin| capture(&spec, &Pose::identity(), &carton(skin, edge_radius), 1);
        let bare = shoot(CartonSkin::default());
        let black = shoot(taped(Material::BLACK_TAPE));
        assert_eq!(bare.ids, black.ids, "tape adds nothing to the outline");
        let (mut inside, mut lost, mut beside) = (0_u32, 0_u32, 0_u32);
        for pixel in (0..bare.ids.len()).filter(|pixel| bare.ids[*pixel] == 7) {
            let [x, y] = on_top(pixel);
            let (with, without) = (black.frame.depth[pixel], bare.frame.depth[pixel]);
            if y.abs() < 0.023 && x.abs() < 0.19 {
                inside += 1;
                lost += u32::from(with == 0.0);
                assert!(black.frame.intensity[pixel] < bare.frame.intensity[pixel]);
            } else if y.abs() > 0.031 {
                beside += 1;
                assert_eq!(with == 0.0, without == 0.0, "at {x} {y} m");
                assert!((with - without).abs() < 0.000_11, "{with} {without} m");
            }
        }
        assert!(beside > 10_000 && inside > 5_000);
        let share = f64::from(lost) / f64::from(inside);
        assert!(share > 0.55, "{share} of the stripe is lost");
    }
}

#[test]
fn several_exposures_bring_glossy_tape_back_and_no_black_one() {
    let lost = |material: Material, hdr: bool| {
        let spec = camera(SensorSpec {
            hdr,
            ..SensorSpec::laser_3m()
        });
        let shot = capture(&spec, &Pose::identity(), &carton(taped(material), 0.0), 1);
        // The mirror image of the projector lies at half of the baseline.
        let there = |pixel: &usize| {
            let [x, y] = on_top(*pixel);
            y.abs() < 0.023 && (x - 0.15).abs() < 0.03
        };
        let pixels: Vec<usize> = (0..shot.ids.len()).filter(there).collect();
        let lost = pixels.iter().filter(|p| shot.frame.depth[**p] == 0.0);
        lost.count() as f64 / pixels.len() as f64
    };
    assert!(lost(Material::GLOSSY_TAPE, false) > 0.98);
    assert!(lost(Material::GLOSSY_TAPE, true) < 0.1);
    assert!(lost(Material::BLACK_TAPE, true) > 0.55);
    assert!(lost(Material::KRAFT, false) < 0.02);
}

/// How wide the stripe is on the top and how far it goes down a short side, as seen by an ideal camera.
#[test]
fn tape_is_as_wide_as_told_and_wraps_round_edges() {
    for edge_radius in [0.0, 0.004, 0.02] {
        let shapes = carton(taped(Material::BLACK_TAPE), edge_radius);
        let spec = camera(SensorSpec::ideal());
        let shot = capture(&spec, &Pose::identity(), &shapes, 1);
        let is_dark = |u: usize, v: usize| shot.frame.intensity[v * WIDTH + u] < 40;
        let rows = (205..307).filter(|v| is_dark(319, *v)).count() as f64;
        let wide = rows / 1000.0 * 1.5;
        assert!((wide - 0.05).abs() < 0.002, "{wide} m at {edge_radius} m");
        // The stripe goes over the edge: no board is seen between its end and the outline.
        let middle = 255;
        let last = (0..WIDTH).rfind(|u| shot.ids[middle * WIDTH + u] == 7);
        let last = last.expect("the carton is in the middle of the picture");
        assert!((last - 20..=last).all(|u| is_dark(u, middle)), "{last}");
    }
}

#[test]
fn a_label_is_white_where_it_lies_and_takes_nothing() {
    let skin = CartonSkin {
        label: Some(Label {
            size: [0.15, 0.1],
            at: [0.1, 0.05],
            turn: 0.0,
        }),
        // Dark, but without chance losses.
        ..taped(Material::matt(0.04))
    };
    let spec = camera(SensorSpec::ideal());
    let shot = capture(&spec, &Pose::identity(), &carton(skin, 0.0), 1);
    let grey = |x: f64, y: f64| {
        let at = |metres: f64, centre: f64| (metres / 1.5 * 1000.0 + centre).round() as usize;
        // The carton's Y points against the image's: it hangs upside down from the world's Z.
        shot.frame.intensity[at(-y, 255.5) * WIDTH + at(x, 319.5)]
    };
    let (label, board, tape) = (grey(0.1, 0.05), grey(-0.1, 0.05), grey(-0.1, 0.0));
    assert!(label > board && board > tape, "{label} {board} {tape}");
    assert!(
        grey(0.03, 0.09) > board && grey(0.02, 0.09) < label,
        "its corner"
    );
    assert!(grey(0.1, 0.002) > board, "over the tape");
    assert!(grey(0.1, -0.005) < board, "beside it the tape");
    let carton = (0..shot.ids.len()).filter(|pixel| shot.ids[*pixel] == 7);
    for pixel in carton {
        assert!((shot.frame.depth[pixel] - shot.ideal_depth[pixel]).abs() < 1e-6);
    }
}
