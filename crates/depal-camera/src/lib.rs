//! Depth camera: software rasteriser and sensor model.
//!
//! Shapes with an id and a material go in; a [`DepthFrame`](depal_frames::DepthFrame) as a
//! structured-light camera would deliver it comes out, together with the truth for the score.
//! It must never know what a carton, a pallet or an arm is.
//!
//! Boxes (sharp or with rounded edges), balls, tubes and plates are drawn exactly: every row of such a surface is a span in closed
//! form, so nothing is tessellated and nothing is clipped. Meshes are drawn triangle by triangle, flat pairs of them at
//! once.
//! A second pass from the projector finds what the pattern does not reach.
//! The image is worked on in bands of rows, and every random number depends on seed and pixel only,
//! so the result has the same bits for any number of threads and any vector width.
//!
//! ```
//! use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, capture};
//! use depal_frames::{Intrinsics, Pose, Shape};
//! let intrinsics = Intrinsics { width: 64, height: 48, fx: 60.0, fy: 60.0, cx: 31.5, cy: 23.5 };
//! let spec = CameraSpec { intrinsics, near: 0.3, far: 5.0, baseline: 0.3, sensor: SensorSpec::ideal() };
//! let block = RenderShape {
//!     world_from_shape: Pose::translation(0.0, 0.0, 2.1),
//!     shape: Shape::cuboid(0.4, 0.4, 0.2),
//!     id: 7,
//!     material: Material::KRAFT,
//!     edge_radius: 0.0,
//! };
//! let shot = capture(&spec, &Pose::identity(), &[block], 1);
//! assert!((shot.frame.depth_at(32, 24) - 2.0).abs() < 1e-6);
//! assert_eq!(shot.ids[24 * 64 + 32], 7);
//! assert_eq!(shot.frame.depth_at(0, 0), 0.0); // nothing there
//! ```
//!
//! Units and frames: metres and radians; camera frame X right, Y down, Z forward; depth is Z, not
//! range; pixel centres are integers. The projector stands at (baseline, 0, 0) of the camera frame.
//!
//! Limitations: one ray per pixel, so a gap narrower than a pixel is hit or missed as a whole;
//! no multiple reflections, no lens distortion; of all solids only boxes have rounded edges;
//! a camera or projector inside a solid does not see that solid; one light, no ambient occlusion.

// The loops over pixels are compiled once for each instruction set: all that they call must be inlined
// into them, and what they decide must be decided without a jump.
#![allow(
    clippy::inline_always,
    clippy::needless_bitwise_bool,
    clippy::needless_range_loop
)]

mod capture;
mod decal;
mod facets;
mod light;
mod mesh;
mod mounting;
mod noise;
mod raster;
mod render;
mod rounded;
mod row;
mod sensor;
mod shape;
mod spec;
mod surface;
mod view;

pub use capture::{Capture, NOTHING, capture};
pub use decal::{Decal, capture_with_decals};
pub use mesh::{RenderMesh, TriangleMesh};
pub use mounting::Mounting;
pub use render::{Rendering, render, render_with_meshes};
pub use sensor::{sense, sense_frame, sense_into};
pub use shape::{Material, RenderShape};
pub use spec::{CameraError, CameraSpec, SensorSpec};

#[cfg(test)]
mod tests;
