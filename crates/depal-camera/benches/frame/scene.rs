//! The scene of the comparison figures.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use depal_camera::{CameraSpec, Material, RenderMesh, RenderShape, SensorSpec, TriangleMesh};
use depal_frames::{Intrinsics, Point, Pose, Rotation, Shape, Vector};

fn placed(at: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose::from_parts(Vector::from(at).into(), Rotation::new(Vector::from(turn)))
}

fn solid(id: u32, shape: Shape, at: [f64; 3], turn: [f64; 3]) -> RenderShape {
    RenderShape {
        world_from_shape: placed(at, turn),
        shape,
        id,
        material: Material::KRAFT,
        edge_radius: 0.0,
    }
}

/// The cartons of a scene with rounded edges.
pub fn rounded(scene: &[RenderShape], edge_radius: f64) -> Vec<RenderShape> {
    let mut scene = scene.to_vec();
    for item in scene.iter_mut().filter(|item| (10..110).contains(&item.id)) {
        item.edge_radius = edge_radius;
    }
    scene
}

/// The cartons of a scene with a stripe of another material over the middle of each: a solid of its own.
pub fn taped(scene: &[RenderShape], material: Material) -> Vec<RenderShape> {
    let cartons = scene.iter().filter(|item| (10..110).contains(&item.id));
    let stripes = cartons.map(|carton| RenderShape {
        world_from_shape: carton.world_from_shape * Pose::translation(0.0, 0.0, 0.070_05),
        shape: Shape::cuboid(0.3001, 0.05, 0.06),
        material,
        ..carton.clone()
    });
    scene.iter().cloned().chain(stripes).collect()
}

/// Floor, pallet and 100 cartons.
pub fn stack() -> Vec<RenderShape> {
    let block =
        |size: [f64; 3], at| solid(1, Shape::cuboid(size[0], size[1], size[2]), at, [0.0; 3]);
    let mut scene = vec![solid(
        0,
        Shape::cuboid(8.0, 8.0, 0.2),
        [0.0, 0.0, -0.1],
        [0.0; 3],
    )];
    for n in 0..7 {
        let y = -0.44 + 0.88 / 6.0 * f64::from(n);
        scene.push(block([1.2, 0.1, 0.022], [0.0, y, 0.133]));
    }
    for n in 0..9 {
        let at = [
            f64::from(n % 3 - 1) * 0.53,
            f64::from(n / 3 - 1) * 0.44,
            0.072,
        ];
        scene.push(block([0.14, 0.12, 0.1], at));
    }
    for n in 0..3 {
        scene.push(block(
            [1.2, 0.1, 0.022],
            [0.0, f64::from(n - 1) * 0.44, 0.011],
        ));
    }
    for n in 0..100_u32 {
        let (column, line, layer) = (n % 4, n / 4 % 5, n / 20);
        let at = [
            (f64::from(column) - 1.5) * 0.303,
            (f64::from(line) - 2.0) * 0.203,
            0.244 + 0.2 * f64::from(layer),
        ];
        let yaw = 0.005 * (f64::from(n) * 1.7).sin();
        scene.push(solid(
            10 + n,
            Shape::cuboid(0.3, 0.2, 0.2),
            at,
            [0.0, 0.0, yaw],
        ));
    }
    scene
}

/// A surface of revolution about Z: radius and height of each ring.
fn revolved(rings: &[(f64, f64)], around: usize) -> TriangleMesh {
    let mut vertices = Vec::new();
    for (radius, height) in rings {
        for k in 0..around {
            let (s, c) = (TAU * k as f64 / around as f64).sin_cos();
            vertices.push(Point::new(radius * c, radius * s, *height));
        }
    }
    let mut triangles = Vec::new();
    let at = |ring: usize, k: usize| (ring * around + k % around) as u32;
    for ring in 1..rings.len() {
        for k in 0..around {
            let [a, b, c, d] = [
                at(ring - 1, k),
                at(ring - 1, k + 1),
                at(ring, k),
                at(ring, k + 1),
            ];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    TriangleMesh::new(vertices, triangles).expect("indices within range")
}

/// Five tubes, five balls and a plate: 22,212 triangles, and the same as primitives.
pub fn arm() -> (Vec<RenderMesh>, Vec<RenderShape>) {
    let tube: Vec<(f64, f64)> = (0..18)
        .map(|k| match k {
            0 => (1e-6, -0.25),
            17 => (1e-6, 0.25),
            _ => (0.09, -0.25 + 0.5 * f64::from(k - 1) / 15.0),
        })
        .collect();
    let tube = Arc::new(revolved(&tube, 60));
    let ball: Vec<(f64, f64)> = (0..25)
        .map(|k| {
            let angle = PI * (f64::from(k) / 24.0 - 0.5);
            (0.11 * angle.cos().max(1e-6), 0.11 * angle.sin())
        })
        .collect();
    let ball = Arc::new(revolved(&ball, 50));
    let (mut meshes, mut shapes) = (Vec::new(), Vec::new());
    for n in 0..5 {
        let t = f64::from(n) / 5.0;
        let at = [1.3 - 1.2 * t, 0.6 - 0.6 * t, 1.35 + 0.25 * (t * 3.0).sin()];
        let tubular = placed(at, [0.4, 1.2 - 0.3 * t, t]);
        let joint = placed([at[0] - 0.12, at[1] - 0.06, at[2] + 0.02], [0.0; 3]);
        for (mesh, world_from_mesh) in [(&tube, tubular), (&ball, joint)] {
            meshes.push(RenderMesh {
                world_from_mesh,
                mesh: mesh.clone(),
                id: 200,
                material: Material::PAINT,
            });
        }
        for (shape, world_from_shape) in [
            (
                Shape::Cylinder {
                    half_length: 0.25,
                    radius: 0.09,
                },
                tubular,
            ),
            (Shape::Sphere { radius: 0.11 }, joint),
        ] {
            shapes.push(RenderShape {
                world_from_shape,
                shape,
                id: 200,
                material: Material::PAINT,
                edge_radius: 0.0,
            });
        }
    }
    let plate = solid(
        200,
        Shape::cuboid(0.4, 0.3, 0.02),
        [0.1, 0.0, 1.25],
        [0.0, 0.0, 0.3],
    );
    let triangles: usize = meshes.iter().map(|m| m.mesh.triangles().len()).sum();
    assert!(
        (22_000..23_000).contains(&triangles),
        "{triangles} triangles"
    );
    shapes.push(plate);
    (meshes, shapes)
}

pub fn camera(width: usize, height: usize, sensor: SensorSpec) -> CameraSpec {
    let f = 0.95 * width as f64;
    CameraSpec {
        intrinsics: Intrinsics {
            width,
            height,
            fx: f,
            fy: f,
            cx: (width as f64 - 1.0) / 2.0,
            cy: (height as f64 - 1.0) / 2.0,
        },
        near: 0.5,
        far: 4.0,
        baseline: 0.3,
        sensor,
    }
}
