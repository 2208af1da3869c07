//! `depal render`: one picture with a scene's camera, and the truth about it.

use std::io::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use depal_camera::{sense, sense_frame};
use depal_cell::cell::render_shapes;
use depal_cell::spec::CellSpec;
use depal_frames::{DepthFrame, Pose};
use depal_time::RandomStreams;
use depal_world::World;
use serde_json::{Value, json};

use crate::cloud_picture::seen_from_the_side;
use crate::failure::Failure;
use crate::false_colour::false_colour;
use crate::image_file::{depth_png, false_colour_png, grey_png, write};
use crate::run::{explain, load_scene, seed};

/// Pictures that are timed; the least time counts, as other work on the computer only adds to it.
const TIMED_PICTURES: usize = 5;

/// Arguments of `depal render`.
#[derive(Args)]
pub struct RenderArgs {
    /// Scene file; the built-in demo if left out.
    scene: Option<PathBuf>,
    /// Seed of everything random; the scene's own if left out.
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Folder for the files; made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Override a key of the scene, as in camera.sensor=ideal. May be given many times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Also write the depth as a small picture for people: near is red, far is blue, invalid is black.
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
    /// Also write the points as seen from the side, in the same colours.
    #[arg(long, value_name = "FILE.png")]
    cloud_picture: Option<PathBuf>,
    /// Print the computing times as one JSON document on stdout: the least of five pictures each.
    #[arg(long)]
    json: bool,
}

/// Settles the cartons, takes the picture, writes the files.
pub fn render(args: &RenderArgs) -> Result<(), Failure> {
    let scene = load_scene(args.scene.as_deref(), &args.set, args.seed)?;
    let spec = scene
        .cell_spec()
        .map_err(|error| Failure::Input(explain(&error)))?;
    let world = spec.world_at_rest();
    let shapes = render_shapes(&world, &spec.skins);

    // The first picture fetches memory and tables; the others are what a camera does again and again.
    let world_from_camera = world_from_camera(&spec);
    let mut rendering = depal_camera::render(&spec.camera, &world_from_camera, &shapes);
    let noise_seed = RandomStreams::new(spec.seed).stream("camera/1").next_u64();
    let mut frame = sense(&spec.camera, &rendering, noise_seed).frame;
    let (mut render_ms, mut sensor_ms) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..TIMED_PICTURES {
        let started = Instant::now();
        rendering.redraw(&spec.camera, &world_from_camera, &shapes);
        render_ms = render_ms.min(started.elapsed().as_secs_f64() * 1e3);
        let started = Instant::now();
        sense_frame(&spec.camera, &rendering, noise_seed, &mut frame);
        sensor_ms = sensor_ms.min(started.elapsed().as_secs_f64() * 1e3);
    }

    std::fs::create_dir_all(&args.out).map_err(|error| {
        Failure::Environment(format!(
            "cannot make the folder {}: {error}\nhelp: name another folder with --out DIR",
            args.out.display()
        ))
    })?;
    let i = &frame.intrinsics;
    let text = |value: Value| format!("{value:#}\n").into_bytes();
    let intrinsics = json!({
        "width": i.width, "height": i.height, "fx": i.fx, "fy": i.fy, "cx": i.cx, "cy": i.cy,
    });
    for (name, bytes) in [
        ("depth.png", depth_png(i, &frame.depth)?),
        ("intensity.png", grey_png(i, &frame.intensity)?),
        ("intrinsics.json", text(intrinsics)),
        ("truth.json", text(truth(&spec, &world))),
        ("cloud.ply", cloud(&frame)),
    ] {
        write(&args.out.join(name), &bytes)?;
    }
    if let Some(path) = &args.picture {
        write(path, &false_colour_png(&false_colour(&frame))?)?;
    }
    if let Some(path) = &args.cloud_picture {
        let side = seen_from_the_side(&frame);
        write(path, &false_colour_png(&false_colour(&side))?)?;
    }
    if args.json {
        let round = |ms: f64| (ms * 1e3).round() / 1e3;
        say!(
            "{}",
            json!({"render_ms": round(render_ms), "sensor_ms": round(sensor_ms)})
        );
    } else {
        let valid = frame.depth.iter().filter(|z| **z > 0.0).count();
        tell!(
            "rendered in {render_ms:.1} ms, sensor {sensor_ms:.1} ms; {:.1} % of the pixels valid, seed {}",
            100.0 * valid as f64 / frame.depth.len().max(1) as f64,
            spec.seed
        );
        tell!("results      {}", args.out.display());
    }
    Ok(())
}

/// Where the camera is; one on the flange is where the arm's start has it.
fn world_from_camera(spec: &CellSpec) -> Pose {
    let start = &spec.controller.start;
    spec.world_from_camera(Some(&spec.arm.base_from_flange(start)))
}

/// Camera and cartons (geometric centres) in the robot's base frame.
fn truth(spec: &CellSpec, world: &World) -> Value {
    let base_from_world = spec.world_from_base.inverse();
    let pose = |base_from_it: Pose| {
        let t = base_from_it.translation.vector * 1e3;
        let q = base_from_it.rotation;
        json!({"xyz_mm": [t.x, t.y, t.z], "quat_wxyz": [q.w, q.i, q.j, q.k]})
    };
    let boxes: Vec<Value> = world
        .cartons()
        .into_iter()
        .map(|carton| {
            json!({
                "size_mm": carton.size.to_mm(),
                "pose": pose(base_from_world * carton.world_from_centre),
            })
        })
        .collect();
    json!({
        "camera": {"base_from_camera": pose(base_from_world * world_from_camera(spec))},
        "boxes": boxes,
    })
}

/// The valid points in the camera frame, metres, with their grey value: PLY, binary.
fn cloud(frame: &DepthFrame) -> Vec<u8> {
    let i = &frame.intrinsics;
    let points = frame.depth.iter().filter(|&&z| z > 0.0).count();
    let mut file = Vec::with_capacity(points * 13 + 300);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment camera frame, metres: X right, Y down, Z forward\n\
         element vertex {points}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar intensity\nend_header\n"
    )
    .expect("writing to memory does not fail");
    for (n, &z) in frame.depth.iter().enumerate().filter(|(_, z)| **z > 0.0) {
        let p = i.deproject((n % i.width) as f64, (n / i.width) as f64, f64::from(z));
        for coordinate in [p.x, p.y, p.z] {
            file.extend((coordinate as f32).to_le_bytes());
        }
        file.push(frame.intensity.get(n).copied().unwrap_or(0));
    }
    file
}
