//! Conversions to and from glam (f32, physics and collision) and the URDF chain's older nalgebra.

use glamx::{Pose3, Quat, Vec3};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};

use crate::{Point, Pose, Vector};

/// To the physics library's f32 pose.
pub fn to_glam(pose: &Pose) -> Pose3 {
    let t = pose.translation.vector;
    let q = pose.rotation.coords;
    Pose3::from_parts(
        Vec3::new(t.x as f32, t.y as f32, t.z as f32),
        Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32).normalize(),
    )
}

/// From the physics library's f32 pose; the rotation is normalised again in f64.
pub fn from_glam(pose: &Pose3) -> Pose {
    let (t, q) = (pose.translation, pose.rotation);
    Pose::from_parts(
        Translation3::new(t.x as f64, t.y as f64, t.z as f64),
        UnitQuaternion::from_quaternion(Quaternion::new(
            q.w as f64, q.x as f64, q.y as f64, q.z as f64,
        )),
    )
}

/// To an f32 vector.
pub fn vector_to_glam(v: &Vector) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// From an f32 vector.
pub fn vector_from_glam(v: Vec3) -> Vector {
    Vector::new(v.x as f64, v.y as f64, v.z as f64)
}

/// To an f32 position.
pub fn point_to_glam(p: &Point) -> Vec3 {
    vector_to_glam(&p.coords)
}

/// From an f32 position.
pub fn point_from_glam(v: Vec3) -> Point {
    Point::from(vector_from_glam(v))
}

/// From the URDF chain's pose.
pub fn from_nalgebra_030(pose: &nalgebra_030::Isometry3<f64>) -> Pose {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    Pose::from_parts(
        Translation3::new(t.x, t.y, t.z),
        UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z)),
    )
}

/// To the URDF chain's pose.
pub fn to_nalgebra_030(pose: &Pose) -> nalgebra_030::Isometry3<f64> {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    nalgebra_030::Isometry3::from_parts(
        nalgebra_030::Translation3::new(t.x, t.y, t.z),
        nalgebra_030::UnitQuaternion::from_quaternion(nalgebra_030::Quaternion::new(
            q.w, q.x, q.y, q.z,
        )),
    )
}
