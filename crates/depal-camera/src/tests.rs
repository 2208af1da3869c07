//! Laws of the camera: exact geometry against ray casts, the sensor model against its own formulas.

mod decal;
mod facets;
mod geometry;
mod rounded;
mod sensor;

use depal_frames::{Intrinsics, Pose, Rotation, Shape, Vector};

use crate::{CameraSpec, Material, RenderShape, SensorSpec};

fn pinhole(width: usize, height: usize) -> Intrinsics {
    let f = 0.95 * width as f64;
    Intrinsics {
        width,
        height,
        fx: f,
        fy: f,
        cx: (width as f64 - 1.0) / 2.0,
        cy: (height as f64 - 1.0) / 2.0,
    }
}

fn camera(width: usize, height: usize, sensor: SensorSpec) -> CameraSpec {
    CameraSpec {
        intrinsics: pinhole(width, height),
        near: 0.3,
        far: 6.0,
        baseline: 0.3,
        sensor,
    }
}

/// A solid in the camera's own frame (the camera stands at the world's origin).
fn solid(id: u32, shape: Shape, at: [f64; 3], turn: [f64; 3]) -> RenderShape {
    RenderShape {
        world_from_shape: Pose::from_parts(
            Vector::from(at).into(),
            Rotation::new(Vector::from(turn)),
        ),
        shape,
        id,
        material: Material::KRAFT,
        edge_radius: 0.0,
    }
}

/// A wall across the view whose face is at depth `z`.
fn wall(id: u32, z: f64) -> RenderShape {
    solid(
        id,
        Shape::cuboid(20.0, 20.0, 1.0),
        [0.0, 0.0, z + 0.5],
        [0.0; 3],
    )
}
