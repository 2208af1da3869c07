//! One frame of a palletizing cell at 1280x1024 on one thread: rendering alone, sensor alone, both.
#![allow(missing_docs)] // criterion's macro makes a public function

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, capture, render, sense};
use depal_frames::{Intrinsics, Pose, Rotation, Shape, Vector};

fn solid(id: u32, shape: Shape, at: [f64; 3], turn: [f64; 3]) -> RenderShape {
    RenderShape {
        world_from_shape: Pose::from_parts(
            Vector::from(at).into(),
            Rotation::new(Vector::from(turn)),
        ),
        shape,
        id,
        material: Material::KRAFT,
    }
}

/// Floor, 19 pallet boards, 60 cartons with 3 mm gaps and an arm of 30 primitives over them.
fn cell() -> Vec<RenderShape> {
    let mut scene = vec![solid(
        0,
        Shape::cuboid(8.0, 8.0, 0.2),
        [0.0, 0.0, -0.1],
        [0.0; 3],
    )];
    for n in 0..19 {
        let y = -0.38 + 0.042 * f64::from(n);
        scene.push(solid(
            1,
            Shape::cuboid(1.2, 0.035, 0.144),
            [0.0, y, 0.072],
            [0.0; 3],
        ));
    }
    for n in 0..60_u32 {
        let (column, line, layer) = (n % 4, n / 4 % 4, n / 16);
        let at = [
            (f64::from(column) - 1.5) * 0.303,
            (f64::from(line) - 1.5) * 0.203,
            0.244 + 0.2 * f64::from(layer),
        ];
        scene.push(solid(
            10 + n,
            Shape::cuboid(0.3, 0.2, 0.2),
            at,
            [0.0, 0.0, 0.003 * f64::from(n % 3)],
        ));
    }
    for n in 0..30_u32 {
        let t = f64::from(n) / 30.0;
        let at = [0.9 - 0.9 * t, 0.5 - 0.4 * t, 1.3 + 0.3 * (t * 6.0).sin()];
        let shape = match n % 3 {
            0 => Shape::Capsule {
                half_length: 0.15,
                radius: 0.08,
            },
            1 => Shape::Cylinder {
                half_length: 0.08,
                radius: 0.09,
            },
            _ => Shape::cuboid(0.15, 0.15, 0.1),
        };
        scene.push(solid(200, shape, at, [t * 3.0, 1.0, t]));
    }
    scene
}

fn frame(c: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let intrinsics = Intrinsics {
        width: 1280,
        height: 1024,
        fx: 1216.0,
        fy: 1216.0,
        cx: 639.5,
        cy: 511.5,
    };
    let spec = CameraSpec {
        intrinsics,
        near: 0.5,
        far: 4.0,
        baseline: 0.3,
        sensor: SensorSpec::laser_structured_light(),
    };
    let ideal = CameraSpec {
        sensor: SensorSpec::ideal(),
        ..spec
    };
    let world_from_camera = Pose::from_parts(
        Vector::new(0.0, 0.0, 3.0).into(),
        Rotation::new(Vector::x() * std::f64::consts::PI),
    );
    let scene = cell();
    for (name, spec) in [
        ("redraw without projector", &ideal),
        ("redraw with projector", &spec),
    ] {
        let mut rendering = render(spec, &world_from_camera, &scene);
        c.bench_function(name, |b| {
            b.iter(|| {
                one_thread
                    .install(|| rendering.redraw(spec, &world_from_camera, black_box(&scene)));
            });
        });
    }
    let rendering = render(&spec, &world_from_camera, &scene);
    c.bench_function("sense", |b| {
        b.iter(|| one_thread.install(|| sense(&spec, black_box(&rendering), 1)));
    });
    c.bench_function("capture", |b| {
        b.iter(|| one_thread.install(|| capture(&spec, &world_from_camera, black_box(&scene), 1)));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = frame
}
criterion_main!(benches);
