//! Something that stands over a part of a top, however small.

use crate::{gate::DepthImage, plane::PlaneFrame};

/// What stands over a top reaches at least so far inside its outline, metres: that much an outline, the edge of a
/// higher neighbour and a leaning wall may be off.
const MARGIN: f64 = 0.003;
/// It stands at least so high, metres,
const HIGH: f64 = 0.010;
/// and at most so high: what hangs farther above touches nothing, metres.
const HIGHEST: f64 = 0.6;
/// Fewer flat pixels may be noise.
const LEAST_PIXELS: usize = 4;

/// True when something flat stands over a rectangle in a plane once it is put down on it along the normal, wherever
/// it shows in the image: from aside a corner over the top is seen beyond the outline. Pixels between two depths
/// (mixed ones, smeared steps) are not flat; a taller neighbour stands outside. `rim`: how uncertain both edges are
/// besides where steps were smeared, metres.
pub fn is_overhung(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    tolerance: f64,
    rim: f64,
) -> bool {
    /// Pixels left out in a first look.
    const SPARSE: usize = 4;
    let over = Over::new(image, frame, extents, tolerance);
    let mut any = false;
    over.each(SPARSE, |z, at| any |= over.inside(at, z, 0.0));
    if !any {
        return false;
    }
    let mut flat = 0;
    over.each(1, |z, at| {
        if over.inside(at, z, MARGIN + 2.0 * rim) && over.is_flat(at, z) {
            flat += 1;
        }
    });
    flat >= LEAST_PIXELS
}

struct Over<'a> {
    image: &'a DepthImage<'a>,
    frame: &'a PlaneFrame,
    half: [f64; 2],
    tolerance: f64,
    rows: std::ops::Range<usize>,
    columns: std::ops::Range<usize>,
}

impl<'a> Over<'a> {
    fn new(
        image: &'a DepthImage<'a>,
        frame: &'a PlaneFrame,
        extents: [f64; 2],
        tolerance: f64,
    ) -> Self {
        let half = extents.map(|e| e / 2.0);
        let normal = frame.plane.normal();
        // Not up to the camera itself.
        let highest = HIGHEST.min(0.6 * frame.origin.z);
        let (mut u, mut v) = ([f64::MAX, f64::MIN], [f64::MAX, f64::MIN]);
        for corner in 0..8 {
            let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
            let height = if corner & 4 == 0 { 0.0 } else { highest };
            let point = frame.point(sign(1) * half[0], sign(2) * half[1]) + normal * height;
            let (pu, pv) = image.intrinsics.project(&point);
            u = [u[0].min(pu), u[1].max(pu)];
            v = [v[0].min(pv), v[1].max(pv)];
        }
        // The outermost pixels have no neighbours on all sides.
        let range = |r: [f64; 2], count: usize| {
            let last = count.saturating_sub(1).max(1);
            let clip = |c: f64| (c.max(0.0) as usize).clamp(1, last);
            clip(r[0])..clip(r[1] + 1.0)
        };
        Self {
            image,
            frame,
            half,
            tolerance,
            rows: range(v, image.height),
            columns: range(u, image.width),
        }
    }

    /// Calls `found` with depth and place of each pixel that is nearer than the plane by [`HIGH`].
    fn each(&self, stride: usize, mut found: impl FnMut(f32, (usize, usize))) {
        let k = &self.image.intrinsics;
        let c = self.frame.plane.coefficient;
        let high = HIGH.max(2.5 * self.tolerance);
        // 1/z is affine in the pixels; a height above the plane is a share of the depth.
        let most = (1.0 - high / self.frame.origin.z) as f32;
        for v in self.rows.clone().step_by(stride) {
            let first = c.dot(&k.ray(self.columns.start as f64, v as f64)) as f32;
            let per_pixel = (c.x / k.fx) as f32;
            let row = &self.image.depth[v * self.image.width..][..self.image.width];
            for (n, &z) in row[self.columns.clone()].iter().enumerate().step_by(stride) {
                if z > 0.0 && z * (first + per_pixel * n as f32) < most {
                    found(z, (self.columns.start + n, v));
                }
            }
        }
    }

    /// True when a measured point lies `margin` metres inside the outline.
    fn inside(&self, (u, v): (usize, usize), z: f32, margin: f64) -> bool {
        let k = &self.image.intrinsics;
        let point = k.deproject(u as f64, v as f64, f64::from(z));
        let from_middle = point - self.frame.origin;
        let height = from_middle.dot(&self.frame.plane.normal());
        height < HIGHEST
            && from_middle.dot(&self.frame.x).abs() < self.half[0] - margin
            && from_middle.dot(&self.frame.y).abs() < self.half[1] - margin
    }

    /// True when nearly all pixels around lie at the same depth.
    fn is_flat(&self, (u, v): (usize, usize), z: f32) -> bool {
        /// Of the nine, itself included: a pixel of two at a corner may be lost.
        const MOST: usize = 7;
        let tolerance = self.tolerance as f32;
        let level = (v - 1..=v + 1)
            .flat_map(|v| {
                &self.image.depth[v * self.image.width + u - 1..=v * self.image.width + u + 1]
            })
            .filter(|near| (**near - z).abs() <= tolerance)
            .count();
        level >= MOST
    }
}
