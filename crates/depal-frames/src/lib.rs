//! Poses, shapes, depth frames and unit conversions shared by all crates.
//!
//! Everything inside the house is SI and f64: metres, radians, seconds, kilograms, pascals.
//! Millimetres and degrees exist at the borders only ([`Mm`], [`Deg`], scene files, the wire).
//! A pose is named `a_from_b`: it takes coordinates of frame `b` to coordinates of frame `a`,
//! so that `base_from_box = base_from_camera * camera_from_box` reads by matching neighbours.
//!
//! This is the one place that converts between linear-algebra libraries
//! (nalgebra here, glam in the physics and collision library, an older nalgebra in the URDF chain).
//!
//! ```
//! use depal_frames::{EulerConvention, Pose, Vector};
//! let base_from_tool = EulerConvention::AbbZyx.pose_from_mm_deg([600.0, 100.0, 450.0, 30.0, 0.0, 180.0]);
//! let tool_z = base_from_tool.rotation * Vector::z();
//! assert!(tool_z.z < -0.999); // the tool looks down
//! ```

mod box_size;
pub mod convert;
mod depth_frame;
mod euler;
mod joints;
mod shape;
mod units;

pub use box_size::BoxSize;
pub use depth_frame::{DepthFrame, Intrinsics};
pub use euler::EulerConvention;
pub use joints::{JointPositions, MAX_JOINTS};
pub use nalgebra;
pub use shape::{ConvexHull, PlacedShape, Shape};
pub use units::{Deg, Mm};

/// A rigid transform, metres. `a_from_b * point_in_b = point_in_a`.
pub type Pose = nalgebra::Isometry3<f64>;
/// A position, metres.
pub type Point = nalgebra::Point3<f64>;
/// A free vector: direction, velocity, force.
pub type Vector = nalgebra::Vector3<f64>;
/// A rotation.
pub type Rotation = nalgebra::UnitQuaternion<f64>;

#[cfg(test)]
mod tests;
