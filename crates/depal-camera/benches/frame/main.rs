//! One frame of a palletizing cell on one thread: rendering alone, sensor alone, both.
//!
//! The scene of the comparison figures: 100 cartons with 3 mm gaps in five layers, a pallet of 19
//! boards and blocks, the floor, and an arm of 22,212 triangles half over the stack; once more with
//! an arm of primitives instead, once with the cartons' edges rounded by 3 mm, and once with glossy tape on
//! every carton.
#![allow(missing_docs)] // criterion's macro makes a public function
#![allow(clippy::disallowed_methods)] // a bench may read the clock

mod scene;

use std::f64::consts::PI;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use depal_camera::{
    CameraSpec, Material, RenderMesh, RenderShape, Rendering, SensorSpec, render_with_meshes,
    sense_frame,
};
use depal_frames::{Pose, Rotation, Vector};
use scene::{arm, camera, rounded, stack, taped};

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
    let with_edges = rounded(&with_mesh, 0.003);
    let with_tape = taped(&with_mesh, Material::GLOSSY_TAPE);
    let arms: [(&str, &[RenderShape], &[RenderMesh]); 4] = [
        ("22k triangles", &with_mesh, &meshes),
        ("22k triangles, edges of 3 mm", &with_edges, &meshes),
        ("22k triangles, glossy tape", &with_tape, &meshes),
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
            if width > 640 && name == "22k triangles" {
                one_thread.install(|| stages(&spec, &rendering));
            }
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

/// What each term adds to the sensor's time: all terms against all but that one.
fn stages(spec: &CameraSpec, rendering: &Rendering) {
    let (all, none) = (spec.sensor, SensorSpec::ideal());
    let terms = [
        ("all terms", all),
        ("no term", none),
        (
            "without shadow",
            SensorSpec {
                shadow: false,
                ..all
            },
        ),
        (
            "without jitter",
            SensorSpec {
                lateral_jitter_px: 0.0,
                ..all
            },
        ),
        (
            "without steps",
            SensorSpec {
                edge_dropout: 0.0,
                mixed_pixels: 0.0,
                ..all
            },
        ),
        (
            "without grazing",
            SensorSpec {
                grazing_start: none.grazing_start,
                grazing_end: none.grazing_end,
                ..all
            },
        ),
        (
            "without rounding",
            SensorSpec {
                quantum: 0.0,
                ..all
            },
        ),
        ("without lens", SensorSpec { blur: false, ..all }),
    ];
    let i = spec.intrinsics;
    let mut shot = depal_camera::sense(spec, rendering, 1).frame;
    for (name, sensor) in terms {
        let spec = CameraSpec { sensor, ..*spec };
        least_times(&format!("sensor {}x{}, {name}", i.width, i.height), || {
            sense_frame(&spec, black_box(rendering), 1, &mut shot);
        });
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
