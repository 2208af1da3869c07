//! Stage 1: which pixels are valid, and which may belong to a carton.

use depal_frames::{DepthFrame, Intrinsics};

use crate::VisionSettings;

/// Depths beyond this are no measurement of any depth camera for cartons.
const LARGEST_DEPTH: f32 = 60.0;

/// A checked depth image.
pub struct DepthImage {
    pub intrinsics: Intrinsics,
    pub width: usize,
    pub height: usize,
    /// Metres; 0 = invalid. Never NaN or negative.
    pub depth: Vec<f32>,
    /// 1 where the pixel is valid, in the depth range and in the region.
    pub in_region: Vec<u8>,
    pub points_in_region: usize,
}

/// `None` when the frame contradicts itself (lengths, intrinsics) or is empty.
pub fn gate(frame: &DepthFrame, settings: &VisionSettings) -> Option<DepthImage> {
    let intrinsics = frame.intrinsics;
    let (width, height) = (intrinsics.width, intrinsics.height);
    let pixels = width.checked_mul(height)?;
    let usable = |f: f64| f.is_finite() && f > 0.0;
    if pixels == 0
        || frame.depth.len() != pixels
        || !usable(intrinsics.fx)
        || !usable(intrinsics.fy)
        || !intrinsics.cx.is_finite()
        || !intrinsics.cy.is_finite()
    {
        return None;
    }
    let depth: Vec<f32> = frame
        .depth
        .iter()
        .map(|&z| if z > 0.0 && z < LARGEST_DEPTH { z } else { 0.0 })
        .collect();
    let (near, far) = (
        settings.min_depth.max(1e-3) as f32,
        settings.max_depth as f32,
    );
    let mut in_region: Vec<u8> = depth
        .iter()
        .map(|&z| u8::from(z >= near && z <= far))
        .collect();
    if let Some(region) = &settings.region {
        let region_from_camera = region.camera_from_region.inverse();
        let rotation = region_from_camera.rotation.to_rotation_matrix();
        let shift = region_from_camera.translation.vector;
        let half = region.half_extents;
        for v in 0..height {
            // The ray in the region's axes is affine along a row.
            let first = rotation * intrinsics.ray(0.0, v as f64);
            let next = rotation * intrinsics.ray(1.0, v as f64) - first;
            for u in 0..width {
                let i = v * width + u;
                let p = (first + next * u as f64) * f64::from(depth[i]) + shift;
                let inside = (p.x.abs() <= half.x) & (p.y.abs() <= half.y) & (p.z.abs() <= half.z);
                in_region[i] &= u8::from(inside);
            }
        }
    }
    let points_in_region = in_region.iter().map(|&b| usize::from(b)).sum();
    Some(DepthImage {
        intrinsics,
        width,
        height,
        depth,
        in_region,
        points_in_region,
    })
}

impl DepthImage {
    /// A copy for labelling in which lone invalid pixels take the mean of their neighbours.
    /// Gaps between cartons are lines of invalid pixels and stay.
    pub fn with_lone_holes_filled(&self) -> (Vec<f32>, Vec<u8>) {
        let (mut depth, mut inside) = (self.depth.clone(), self.in_region.clone());
        let w = self.width;
        for v in 1..self.height.saturating_sub(1) {
            for u in 1..w.saturating_sub(1) {
                let i = v * w + u;
                if self.depth[i] != 0.0 {
                    continue;
                }
                let around = [
                    i - w - 1,
                    i - w,
                    i - w + 1,
                    i - 1,
                    i + 1,
                    i + w - 1,
                    i + w,
                    i + w + 1,
                ];
                let (mut sum, mut count, mut low, mut high) = (0.0f32, 0u8, f32::MAX, 0.0f32);
                for j in around {
                    if self.in_region[j] == 1 {
                        sum += self.depth[j];
                        count += 1;
                        low = low.min(self.depth[j]);
                        high = high.max(self.depth[j]);
                    }
                }
                if count >= 7 && high - low < 0.01 {
                    depth[i] = sum / f32::from(count);
                    inside[i] = 1;
                }
            }
        }
        (depth, inside)
    }
}
