//! The pixels across one side of a top.

use depal_frames::Vector;

use crate::{DetectedBox, gate::DepthImage, patch::pixel_pitch, plane::PlaneFrame};

/// Share of a side's length that is looked at: away from the corners, which are rounded, too.
const LENGTH: f64 = 0.9;

/// Scan lines across one side of a top.
pub(super) struct Strip<'a> {
    image: &'a DepthImage<'a>,
    frame: PlaneFrame,
    outward: Vector,
    tangent: Vector,
    /// From the middle to where the known size puts the side, metres.
    half: f64,
    /// What is looked at of it, metres.
    pub length: f64,
    /// Metres per pixel.
    pub pitch: f64,
}

impl<'a> Strip<'a> {
    /// Across a side: -X, +X, -Y, +Y.
    pub fn new(image: &'a DepthImage<'a>, found: &DetectedBox, side: usize) -> Self {
        let frame = PlaneFrame::of_top(found);
        let extents = [found.size.length, found.size.width];
        let sign = if side.is_multiple_of(2) { -1.0 } else { 1.0 };
        let axes = [frame.x, frame.y];
        Self {
            image,
            frame,
            outward: axes[side / 2] * sign,
            tangent: axes[1 - side / 2],
            half: extents[side / 2] / 2.0,
            length: extents[1 - side / 2] * LENGTH,
            pitch: pixel_pitch(&frame, &image.intrinsics),
        }
    }

    /// Tells of each measured pixel of lines `stride` pixels apart how far beyond the side's known place (-: inside)
    /// it looks at the top's plane, how far beyond it its point lies, and how far under the plane, metres. Returns
    /// the number of lines.
    pub fn walk(
        &self,
        from: f64,
        to: f64,
        stride: f64,
        mut take: impl FnMut(f64, f64, f64),
    ) -> usize {
        let k = &self.image.intrinsics;
        let (width, height) = (self.image.width as f64, self.image.height as f64);
        let coefficient = self.frame.plane.coefficient;
        let normal = self.frame.plane.normal();
        let lines = (self.length / (stride * self.pitch)).floor().max(1.0) as usize;
        for line in 0..lines {
            let along = ((line as f64 + 0.5) / lines as f64 - 0.5) * self.length;
            let base = self.frame.origin + self.outward * self.half + self.tangent * along;
            let (ub, vb) = k.project(&base);
            let [(u0, v0), (u1, v1)] = [from, to].map(|o| k.project(&(base + self.outward * o)));
            // So close by, columns and rows add evenly to the plane's depth and to the place on it.
            let ray = k.ray(ub, vb);
            let z = base.z;
            let deeper = [coefficient.x / k.fx, coefficient.y / k.fy].map(|c| -z * z * c);
            let aside = [
                self.outward.x * z / k.fx + ray.dot(&self.outward) * deeper[0],
                self.outward.y * z / k.fy + ray.dot(&self.outward) * deeper[1],
            ];
            // What is measured deeper along its ray than the plane lies farther out and under it.
            let (out, under) = (ray.dot(&self.outward), -ray.dot(&normal));
            let count = (u1 - u0).abs().max((v1 - v0).abs()).min(1e4);
            let (du, dv) = ((u1 - u0) / count, (v1 - v0) / count);
            for step in 0..=count as usize {
                let s = step as f64;
                let (u, v) = (u0 + du * s + 0.5, v0 + dv * s + 0.5);
                // Also refuses NaN.
                let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
                if !inside {
                    continue;
                }
                let (u, v) = (u as u32, v as u32);
                let depth = self.image.depth[v as usize * self.image.width + u as usize];
                let depth = f64::from(depth);
                if depth > 0.0 {
                    let (across, down) = (f64::from(u) - ub, f64::from(v) - vb);
                    let beyond = depth - (z + deeper[0] * across + deeper[1] * down);
                    let looked_at = aside[0] * across + aside[1] * down;
                    take(looked_at, looked_at + out * beyond, under * beyond);
                }
            }
        }
        lines
    }
}
