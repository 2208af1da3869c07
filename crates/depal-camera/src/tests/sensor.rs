//! The sensor model against its own formulas.

mod device;
mod filter;
mod losses;
mod materials;
mod noise;
mod shadow;
mod signal;
mod terms;

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
