use serde::{Deserialize, Serialize};

use crate::{Point, Vector};

/// Pinhole intrinsics. Pixel centres are integers: pixel (u, v) looks along
/// ((u - cx) / fx, (v - cy) / fy, 1) in the camera frame (X right, Y down, Z forward).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Focal length along a row, pixels.
    pub fx: f64,
    /// Focal length along a column, pixels.
    pub fy: f64,
    /// Principal point, column.
    pub cx: f64,
    /// Principal point, row.
    pub cy: f64,
}

impl Intrinsics {
    /// Ray through a (sub-)pixel, camera frame, not normalised: its Z is 1.
    pub fn ray(&self, u: f64, v: f64) -> Vector {
        Vector::new((u - self.cx) / self.fx, (v - self.cy) / self.fy, 1.0)
    }

    /// Point at depth `z` metres seen by a (sub-)pixel, camera frame.
    pub fn deproject(&self, u: f64, v: f64, z: f64) -> Point {
        Point::from(self.ray(u, v) * z)
    }

    /// Sub-pixel (u, v) of a point in the camera frame with positive Z.
    pub fn project(&self, point_in_camera: &Point) -> (f64, f64) {
        (
            point_in_camera.x / point_in_camera.z * self.fx + self.cx,
            point_in_camera.y / point_in_camera.z * self.fy + self.cy,
        )
    }
}

/// What a depth camera delivers, and all that vision ever sees: row-major images.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthFrame {
    /// Pinhole model of the image.
    pub intrinsics: Intrinsics,
    /// Depth along Z, metres; 0 = invalid. `width * height` values, row by row.
    pub depth: Vec<f32>,
    /// Grey values 0..=255, row by row; empty when the camera has no intensity image.
    pub intensity: Vec<u8>,
}

impl DepthFrame {
    /// An all-invalid frame with a black intensity image.
    pub fn blank(intrinsics: Intrinsics) -> Self {
        let pixels = intrinsics.width * intrinsics.height;
        Self {
            intrinsics,
            depth: vec![0.0; pixels],
            intensity: vec![0; pixels],
        }
    }

    /// Depth at column `u`, row `v`, metres; 0 = invalid.
    pub fn depth_at(&self, u: usize, v: usize) -> f32 {
        self.depth[v * self.intrinsics.width + u]
    }
}
