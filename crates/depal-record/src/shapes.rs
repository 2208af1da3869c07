//! Our solids and poses as rerun archetypes.

use depal_frames::{PlacedShape, Pose, Rotation, Shape};
use rerun::{
    Boxes3D, Capsules3D, Color, Cylinders3D, Ellipsoids3D, FillMode, Mesh3D, Quaternion,
    RecordingStream, RecordingStreamResult, Transform3D,
};

/// Position as f32 triple, metres.
pub(crate) fn position(pose: &Pose) -> [f32; 3] {
    let t = pose.translation.vector;
    [t.x as f32, t.y as f32, t.z as f32]
}

/// Rotation as a rerun quaternion.
pub(crate) fn quaternion(rotation: &Rotation) -> Quaternion {
    let q = rotation.coords;
    Quaternion::from_xyzw([q.x as f32, q.y as f32, q.z as f32, q.w as f32])
}

/// A pose as a transform of the child entity in its parent.
pub(crate) fn transform(pose: &Pose) -> Transform3D {
    Transform3D::update_fields()
        .with_translation(position(pose))
        .with_quaternion(quaternion(&pose.rotation))
}

pub(crate) fn color(rgb: [u8; 3]) -> Color {
    Color::from_rgb(rgb[0], rgb[1], rgb[2])
}

/// Logs solids as static geometry below `entity`, one child entity per kind of solid.
pub(crate) fn log_static_shapes(
    stream: &RecordingStream,
    entity: &str,
    shapes: &[(PlacedShape, [u8; 3])],
) -> RecordingStreamResult<()> {
    let mut boxes = (vec![], vec![], vec![], vec![]);
    let mut capsules = (vec![], vec![], vec![], vec![], vec![]);
    let mut cylinders = (vec![], vec![], vec![], vec![], vec![]);
    let mut spheres = (vec![], vec![], vec![]);
    let mut hulls = (vec![], vec![], vec![]);
    for (placed, rgb) in shapes {
        let rotation = quaternion(&placed.pose.rotation);
        match &placed.shape {
            &Shape::Cuboid { half_extents: h } => {
                boxes.0.push([h.x as f32, h.y as f32, h.z as f32]);
                boxes.1.push(position(&placed.pose));
                boxes.2.push(rotation);
                boxes.3.push(color(*rgb));
            }
            &Shape::Capsule {
                half_length,
                radius,
            } => {
                // Ours is centred; rerun's starts at its translation and extends along +Z.
                let start = placed.pose * Pose::translation(0.0, 0.0, -half_length);
                capsules.0.push(2.0 * half_length as f32);
                capsules.1.push(radius as f32);
                capsules.2.push(position(&start));
                capsules.3.push(rotation);
                capsules.4.push(color(*rgb));
            }
            &Shape::Cylinder {
                half_length,
                radius,
            } => {
                cylinders.0.push(2.0 * half_length as f32);
                cylinders.1.push(radius as f32);
                cylinders.2.push(position(&placed.pose));
                cylinders.3.push(rotation);
                cylinders.4.push(color(*rgb));
            }
            Shape::Hull(hull) => {
                let first = hulls.0.len() as u32;
                for corner in hull.vertices() {
                    let at = placed.pose * corner;
                    hulls.0.push([at.x as f32, at.y as f32, at.z as f32]);
                    hulls.2.push(color(*rgb));
                }
                let shifted = |t: &[u32; 3]| t.map(|i| i + first);
                hulls.1.extend(hull.triangles().iter().map(shifted));
            }
            &Shape::Sphere { radius } => {
                spheres.0.push(position(&placed.pose));
                spheres.1.push([radius as f32; 3]);
                spheres.2.push(color(*rgb));
            }
        }
    }
    if !boxes.0.is_empty() {
        stream.log_static(
            format!("{entity}/boxes"),
            &Boxes3D::from_centers_and_half_sizes(boxes.1, boxes.0)
                .with_quaternions(boxes.2)
                .with_colors(boxes.3)
                .with_fill_mode(FillMode::Solid),
        )?;
    }
    if !capsules.0.is_empty() {
        stream.log_static(
            format!("{entity}/capsules"),
            &Capsules3D::from_lengths_and_radii(capsules.0, capsules.1)
                .with_translations(capsules.2)
                .with_quaternions(capsules.3)
                .with_colors(capsules.4)
                .with_fill_mode(FillMode::Solid),
        )?;
    }
    if !cylinders.0.is_empty() {
        stream.log_static(
            format!("{entity}/cylinders"),
            &Cylinders3D::from_lengths_and_radii(cylinders.0, cylinders.1)
                .with_centers(cylinders.2)
                .with_quaternions(cylinders.3)
                .with_colors(cylinders.4)
                .with_fill_mode(FillMode::Solid),
        )?;
    }
    if !hulls.0.is_empty() {
        stream.log_static(
            format!("{entity}/hulls"),
            &Mesh3D::new(hulls.0)
                .with_triangle_indices(hulls.1)
                .with_vertex_colors(hulls.2),
        )?;
    }
    if !spheres.0.is_empty() {
        stream.log_static(
            format!("{entity}/spheres"),
            &Ellipsoids3D::from_centers_and_half_sizes(spheres.0, spheres.1)
                .with_colors(spheres.2)
                .with_fill_mode(FillMode::Solid),
        )?;
    }
    Ok(())
}
