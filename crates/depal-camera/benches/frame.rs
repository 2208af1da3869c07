//! One frame of a palletizing cell on one thread: rendering alone, sensor alone, both.
//!
//! The scene of the comparison figures: 100 cartons with 3 mm gaps in five layers, a pallet of 19
//! boards and blocks, the floor, and an arm of 22,212 triangles half over the stack; once more with
//! an arm of primitives instead.
#![allow(missing_docs)] // criterion's macro makes a public function
#![allow(clippy::disallowed_methods)] // a bench may read the clock

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use depal_camera::{
    CameraSpec, Material, RenderMesh, RenderShape, SensorSpec, TriangleMesh, render_with_meshes,
    sense_frame,
};
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
    }
}

/// Floor, pallet and 100 cartons.
fn stack() -> Vec<RenderShape> {
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
fn arm() -> (Vec<RenderMesh>, Vec<RenderShape>) {
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

fn camera(width: usize, height: usize, sensor: SensorSpec) -> CameraSpec {
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

fn frame(c: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let down = Pose::from_parts(
        Vector::new(0.0, 0.0, 3.0).into(),
        Rotation::new(Vector::x() * PI),
    );
    let (meshes, primitives) = arm();
    let mut with_mesh = stack();
    with_mesh.push(primitives[primitives.len() - 1].clone());
    let mut with_primitives = stack();
    with_primitives.extend(primitives);
    let arms: [(&str, &[RenderShape], &[RenderMesh]); 2] = [
        ("22k triangles", &with_mesh, &meshes),
        ("primitives", &with_primitives, &[]),
    ];
    for (width, height) in [(640, 480), (1280, 1024), (2048, 1536)] {
        let spec = camera(width, height, SensorSpec::laser_structured_light());
        for (name, shapes, meshes) in arms {
            let mut rendering = render_with_meshes(&spec, &down, shapes, meshes);
            least_times(&format!("render {width}x{height}, arm of {name}"), || {
                one_thread.install(|| {
                    rendering.redraw_with_meshes(&spec, &down, black_box(shapes), meshes);
                });
            });
            c.bench_function(&format!("render {width}x{height}, arm of {name}"), |b| {
                b.iter(|| {
                    one_thread.install(|| {
                        rendering.redraw_with_meshes(&spec, &down, black_box(shapes), meshes);
                    });
                });
            });
            let mut shot = depal_camera::sense(&spec, &rendering, 1).frame;
            least_times(&format!("sensor {width}x{height}, arm of {name}"), || {
                one_thread.install(|| sense_frame(&spec, black_box(&rendering), 1, &mut shot));
            });
            c.bench_function(&format!("sensor {width}x{height}, arm of {name}"), |b| {
                b.iter(|| {
                    one_thread.install(|| sense_frame(&spec, black_box(&rendering), 1, &mut shot));
                });
            });
        }
    }
}

/// Least and middle time of 200 frames: what the code needs when nothing else runs beside it.
fn least_times(name: &str, mut work: impl FnMut()) {
    let mut times: Vec<f64> = (0..200)
        .map(|_| {
            let start = std::time::Instant::now();
            work();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!(
        "{name}: least {:.2} ms, middle {:.2} ms",
        times[0], times[100]
    );
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = frame
}
criterion_main!(benches);
