//! What is drawn of a capture: depth image, points, estimates and truth.

use depal_cell::observer::CaptureView;
use depal_frames::Pose;
use rerun::{
    Arrows3D, Boxes3D, Color, EncodedDepthImage, FillMode, Points3D, RecordingStream,
    RecordingStreamResult,
};

use crate::shapes::{position, quaternion};

/// The depth image is stored at 1 / this resolution.
pub(crate) const IMAGE_STEP: usize = 2;
/// One point of the cloud in this many rows and columns.
const CLOUD_STEP: usize = 9;
/// Draws a capture at the stream's current time.
pub(crate) fn log_capture(
    stream: &RecordingStream,
    capture: &CaptureView<'_>,
) -> RecordingStreamResult<()> {
    let intrinsics = &capture.frame.intrinsics;
    let (width, height) = (
        intrinsics.width / IMAGE_STEP,
        intrinsics.height / IMAGE_STEP,
    );
    let mut pixels = Vec::with_capacity(width * height * 2);
    for row in 0..height {
        for column in 0..width {
            let depth = capture
                .frame
                .depth_at(column * IMAGE_STEP, row * IMAGE_STEP);
            pixels.extend_from_slice(&((depth * 1e4).round() as u16).to_be_bytes());
        }
    }
    let image = encode_png(&pixels, width as u32, height as u32);
    stream.log(
        "world/camera/image/depth",
        &EncodedDepthImage::new(image)
            .with_media_type("image/png")
            .with_meter(1e4)
            .with_colormap(rerun::components::Colormap::Turbo)
            // In stored units, as the meter says: the usual span from a full stack to the floor.
            .with_depth_range([1.8e4, 3.8e4]),
    )?;
    let mut points = Vec::new();
    let mut colors = Vec::new();
    for row in (0..intrinsics.height).step_by(CLOUD_STEP) {
        for column in (0..intrinsics.width).step_by(CLOUD_STEP) {
            let depth = capture.frame.depth_at(column, row);
            if depth > 0.0 {
                let p = capture.world_from_camera
                    * intrinsics.deproject(column as f64, row as f64, f64::from(depth));
                points.push([p.x as f32, p.y as f32, p.z as f32]);
                colors.push(height_color(p.z));
            }
        }
    }
    stream.log(
        "world/cloud",
        &Points3D::new(points)
            .with_colors(colors)
            .with_radii([0.004f32]),
    )?;
    stream.log(
        "vision/estimates",
        &wireframes(&capture.detections, Color::from_rgb(80, 255, 120), 0.005),
    )?;
    let arrows = capture.detections.iter().map(|(pose, _)| {
        let x = pose.rotation * depal_frames::Vector::x() * 0.15;
        [x.x as f32, x.y as f32, x.z as f32]
    });
    stream.log(
        "vision/estimates/x_axis",
        &Arrows3D::from_vectors(arrows)
            .with_origins(capture.detections.iter().map(|(pose, _)| position(pose)))
            .with_colors([Color::from_rgb(255, 90, 90)]),
    )?;
    stream.log(
        "vision/truth",
        &wireframes(&capture.truth, Color::from_rgb(255, 255, 255), 0.002),
    )
}

/// Boxes whose top faces are at the given poses, drawn as lines.
fn wireframes(tops: &[(Pose, [f64; 3])], line: Color, radius: f32) -> Boxes3D {
    let centre =
        |(pose, size): &(Pose, [f64; 3])| pose * Pose::translation(0.0, 0.0, -0.5 * size[2]);
    Boxes3D::from_centers_and_half_sizes(
        tops.iter().map(|top| position(&centre(top))),
        tops.iter()
            .map(|(_, size)| size.map(|side| (side * 0.5) as f32)),
    )
    .with_quaternions(tops.iter().map(|(pose, _)| quaternion(&pose.rotation)))
    .with_colors([line])
    .with_radii([radius])
    .with_fill_mode(FillMode::MajorWireframe)
}

/// Blue on the floor to yellow at two metres.
fn height_color(z: f64) -> Color {
    let t = (z / 2.0).clamp(0.0, 1.0);
    Color::from_rgb(
        (60.0 + 190.0 * t) as u8,
        (90.0 + 130.0 * t) as u8,
        (210.0 - 150.0 * t) as u8,
    )
}

/// 16-bit grey PNG from big-endian pixels.
fn encode_png(pixels: &[u8], width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().expect("a vector takes every byte");
    writer
        .write_image_data(pixels)
        .expect("the buffer has width * height * 2 bytes");
    drop(writer);
    bytes
}
