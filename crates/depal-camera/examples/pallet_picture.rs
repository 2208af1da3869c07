//! Takes one picture of a pallet with cartons and an arm-like figure and writes it as two PNGs.
//!
//! `cargo run --release -p depal-camera --example pallet_picture -- FOLDER`
//! writes `depth.png` (16 bit, 0.1 mm steps), `depth-view.png` (8 bit, stretched) and `intensity.png`.
#![allow(clippy::disallowed_methods)] // an example may write its files

use std::fs::File;
use std::path::Path;

use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, capture};
use depal_frames::{Intrinsics, Pose, Rotation, Shape, Vector};

fn solid(id: u32, shape: Shape, at: [f64; 3], turn: [f64; 3], material: Material) -> RenderShape {
    RenderShape {
        world_from_shape: Pose::from_parts(
            Vector::from(at).into(),
            Rotation::new(Vector::from(turn)),
        ),
        shape,
        id,
        material,
        edge_radius: 0.0,
    }
}

fn scene() -> Vec<RenderShape> {
    let mut scene = vec![solid(
        0,
        Shape::cuboid(8.0, 8.0, 0.2),
        [0.0, 0.0, -0.1],
        [0.0; 3],
        Material::CONCRETE,
    )];
    for n in 0..7 {
        let y = -0.345 + 0.115 * f64::from(n);
        scene.push(solid(
            1,
            Shape::cuboid(1.2, 0.09, 0.022),
            [0.0, y, 0.133],
            [0.0; 3],
            Material::WOOD,
        ));
    }
    for n in 0..9 {
        let at = [
            f64::from(n % 3 - 1) * 0.53,
            f64::from(n / 3 - 1) * 0.34,
            0.061,
        ];
        scene.push(solid(
            1,
            Shape::cuboid(0.14, 0.1, 0.122),
            at,
            [0.0; 3],
            Material::WOOD,
        ));
    }
    for n in 0..26 {
        let (column, line, layer) = (n % 4, n / 4 % 4, n / 16);
        let gap = if layer == 0 { 0.003 } else { 0.006 };
        let at = [
            (f64::from(column) - 1.5) * (0.3 + gap),
            (f64::from(line) - 1.5) * (0.2 + gap),
            0.244 + 0.2 * f64::from(layer),
        ];
        let turn = [0.0, 0.0, 0.004 * f64::from(n % 3 - 1)];
        scene.push(solid(
            10 + n as u32,
            Shape::cuboid(0.3, 0.2, 0.2),
            at,
            turn,
            Material::KRAFT,
        ));
        let label = [at[0] + 0.05, at[1] + 0.03, at[2] + 0.1];
        scene.push(solid(
            10 + n as u32,
            Shape::cuboid(0.1, 0.07, 0.0002),
            label,
            turn,
            Material::LABEL,
        ));
        let tape = [at[0], at[1], at[2] + 0.1];
        let material = if n % 5 == 0 {
            Material::BLACK_TAPE
        } else {
            Material::PAINT
        };
        scene.push(solid(
            10 + n as u32,
            Shape::cuboid(0.3, 0.05, 0.0001),
            tape,
            turn,
            material,
        ));
    }
    let arm = Shape::Capsule {
        half_length: 0.35,
        radius: 0.07,
    };
    scene.push(solid(
        100,
        arm,
        [0.75, 0.2, 1.1],
        [0.3, 1.2, 0.0],
        Material::PAINT,
    ));
    scene.push(solid(
        100,
        Shape::Cylinder {
            half_length: 0.1,
            radius: 0.1,
        },
        [0.4, 0.3, 0.95],
        [0.4, 0.3, 0.0],
        Material::PAINT,
    ));
    scene.push(solid(
        100,
        Shape::Sphere { radius: 0.1 },
        [-0.7, -0.5, 0.1],
        [0.0; 3],
        Material::LABEL,
    ));
    scene
}

fn write_png(
    path: &Path,
    i: &Intrinsics,
    depth: png::BitDepth,
    bytes: &[u8],
) -> Result<(), Box<dyn std::error::Error>> {
    let mut encoder = png::Encoder::new(File::create(path)?, i.width as u32, i.height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    encoder.write_header()?.write_image_data(bytes)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let folder = Path::new(&folder);
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
    spec.validate()?;
    let world_from_camera = Pose::from_parts(
        Vector::new(0.0, 0.0, 2.4).into(),
        Rotation::new(Vector::x() * std::f64::consts::PI),
    );
    let shot = capture(&spec, &world_from_camera, &scene(), 7);
    let steps: Vec<u8> = shot
        .frame
        .depth
        .iter()
        .flat_map(|z| ((z * 10_000.0).round() as u16).to_be_bytes())
        .collect();
    let view: Vec<u8> = shot
        .frame
        .depth
        .iter()
        .map(|z| {
            if *z > 0.0 {
                (255.0 - (z - 1.0) * 150.0).clamp(20.0, 255.0) as u8
            } else {
                0
            }
        })
        .collect();
    write_png(
        &folder.join("depth.png"),
        &intrinsics,
        png::BitDepth::Sixteen,
        &steps,
    )?;
    write_png(
        &folder.join("depth-view.png"),
        &intrinsics,
        png::BitDepth::Eight,
        &view,
    )?;
    write_png(
        &folder.join("intensity.png"),
        &intrinsics,
        png::BitDepth::Eight,
        &shot.frame.intensity,
    )?;
    Ok(())
}
