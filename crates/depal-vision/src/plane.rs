//! Stage 4: planes. A plane in space is exactly affine in inverse depth: 1/z = a u + b v + c.

use depal_frames::{Intrinsics, Point, Vector};
use nalgebra::Matrix3;

use crate::DetectedBox;

/// A plane as `1/z = coefficient · ray(u, v)`; `coefficient` = unit normal / distance.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    pub coefficient: Vector,
}

/// Robust least squares over samples `(u, v, z)`; also the root mean square distance in depth,
/// metres, of the samples within the tolerance. `None` when the samples do not span a plane.
pub fn fit_plane(
    samples: &[(f64, f64, f64)],
    intrinsics: &Intrinsics,
    tolerance: f64,
) -> Option<(Plane, f64)> {
    if samples.len() < 12 {
        return None;
    }
    let (per_fx, per_fy) = (1.0 / intrinsics.fx, 1.0 / intrinsics.fy);
    // Ray (x, y, 1), depth and its inverse.
    let rays: Vec<[f64; 4]> = samples
        .iter()
        .map(|&(u, v, z)| {
            [
                (u - intrinsics.cx) * per_fx,
                (v - intrinsics.cy) * per_fy,
                z,
                1.0 / z,
            ]
        })
        .collect();
    let mut plane: Option<Plane> = None;
    let mut rms = 0.0;
    for _ in 0..3 {
        let (mut xx, mut xy, mut yy, mut x1, mut y1) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let mut right = Vector::zeros();
        let mut squares = 0.0;
        let mut count = 0.0;
        for &[x, y, z, inverse] in &rays {
            if let Some(Plane { coefficient: c }) = plane {
                // z minus the plane's depth there, to first order.
                let error = (z * (c.x * x + c.y * y + c.z) - 1.0) * z;
                if error.abs() > tolerance {
                    continue;
                }
                squares += error * error;
            }
            count += 1.0;
            xx += x * x;
            xy += x * y;
            yy += y * y;
            x1 += x;
            y1 += y;
            right += Vector::new(x, y, 1.0) * inverse;
        }
        if count < 12.0 {
            return None;
        }
        rms = (squares / count).sqrt();
        let normal = Matrix3::new(xx, xy, x1, xy, yy, y1, x1, y1, count);
        let coefficient = normal.cholesky()?.solve(&right);
        if !coefficient.iter().all(|c| c.is_finite()) || coefficient.z <= 1e-6 {
            return None;
        }
        plane = Some(Plane { coefficient });
    }
    plane.map(|plane| (plane, rms))
}

impl Plane {
    /// Depth along Z where a ray (Z = 1) meets the plane.
    pub fn depth(&self, ray: &Vector) -> f64 {
        1.0 / self.coefficient.dot(ray)
    }

    /// Where a ray (Z = 1) meets the plane.
    pub fn meet(&self, ray: &Vector) -> Point {
        Point::from(ray * self.depth(ray))
    }

    /// Unit normal towards the camera.
    pub fn normal(&self) -> Vector {
        -self.coefficient.normalize()
    }
}

/// Axes on a plane: `x`, `y` lie in it, `z` points towards the camera.
#[derive(Debug, Clone, Copy)]
pub struct PlaneFrame {
    pub plane: Plane,
    pub origin: Point,
    pub x: Vector,
    pub y: Vector,
}

impl PlaneFrame {
    /// Origin where the ray meets the plane, X as close as can be to the camera's X.
    pub fn new(plane: Plane, ray: &Vector) -> Self {
        let z = plane.normal();
        let x = (Vector::x() - z * z.x).normalize();
        Self {
            plane,
            origin: plane.meet(ray),
            x,
            y: z.cross(&x),
        }
    }

    /// Origin in the middle of a found top, X along its long side.
    pub fn of_top(found: &DetectedBox) -> Self {
        let pose = &found.camera_from_box;
        let origin = Point::from(pose.translation.vector);
        let axis = |k: usize| pose.rotation * Vector::ith(k, 1.0);
        let normal = axis(2);
        Self {
            plane: Plane {
                coefficient: normal / normal.dot(&origin.coords),
            },
            origin,
            x: axis(0),
            y: axis(1),
        }
    }

    /// Turned by `yaw` about the normal.
    pub fn turned(&self, yaw: f64) -> Self {
        let (s, c) = yaw.sin_cos();
        Self {
            x: self.x * c + self.y * s,
            y: self.y * c - self.x * s,
            ..*self
        }
    }

    /// The same origin and X direction, carried along the viewing ray onto another plane.
    pub fn on_plane(&self, plane: Plane) -> Self {
        let origin = plane.meet(&(self.origin.coords / self.origin.z));
        let z = plane.normal();
        let x = (self.x - z * z.dot(&self.x)).normalize();
        Self {
            plane,
            origin,
            x,
            y: z.cross(&x),
        }
    }

    /// Coordinates of a pixel's ray on the plane, metres.
    pub fn of_pixel(&self, intrinsics: &Intrinsics, u: f64, v: f64) -> (f64, f64) {
        let offset = self.plane.meet(&intrinsics.ray(u, v)) - self.origin;
        (offset.dot(&self.x), offset.dot(&self.y))
    }

    /// What [`Self::of_pixel`] tells of the pixels of row `v`, for many of them.
    pub fn of_row(&self, intrinsics: &Intrinsics, v: f64) -> OnRow {
        let first = intrinsics.ray(0.0, v);
        let along = |axis: &Vector| [first.dot(axis), axis.x / intrinsics.fx];
        OnRow {
            inverse: along(&self.plane.coefficient),
            axes: [self.x, self.y].map(|axis| (along(&axis), self.origin.coords.dot(&axis))),
        }
    }

    /// The point at plane coordinates.
    pub fn point(&self, x: f64, y: f64) -> Point {
        self.origin + self.x * x + self.y * y
    }
}

/// A row of pixels seen on a plane: 1/z is affine in the column, and so is a coordinate times it.
pub struct OnRow {
    /// At column 0 and from column to column.
    inverse: [f64; 2],
    /// The same of rays along each axis, and what is to be taken off, metres.
    axes: [([f64; 2], f64); 2],
}

impl OnRow {
    /// Coordinates on the plane and depth, metres, where column `u` looks.
    pub fn at(&self, u: f64) -> ([f64; 2], f64) {
        let depth = 1.0 / (self.inverse[0] + self.inverse[1] * u);
        let place = self
            .axes
            .map(|([first, per_column], off)| (first + per_column * u) * depth - off);
        (place, depth)
    }
}
