//! Stage 1: which pixels are valid, and which may belong to a carton.

use depal_frames::{DepthFrame, Intrinsics, Point};

use crate::{
    RegionOfInterest, VisionSettings, average::averaged, lost::mended, outliers::without_outliers,
    scratch::Kept, smear::sharpened, widest::with_widest_vectors,
};

/// Depths beyond this are no measurement of any depth camera for cartons.
pub(crate) const LARGEST_DEPTH: f32 = 60.0;

/// Steps narrower than this are left as they are, pixels.
pub(crate) const LEAST_SMEAR: usize = 5;

/// What is measured around a lost pixel differs by no more on one surface, metres: noise, and the slope of a carton
/// that leans.
const LEVEL: f32 = 0.01;

/// A checked depth image.
pub struct DepthImage<'a> {
    pub intrinsics: Intrinsics,
    pub width: usize,
    pub height: usize,
    /// Metres; 0 = invalid. Never NaN or negative.
    pub depth: &'a [f32],
    /// Grey values; empty without an intensity image of the same size.
    pub intensity: &'a [u8],
    /// 1 where the pixel is valid, in the depth range and in the region.
    pub in_region: Kept<u8>,
    pub window: Window,
    pub points_in_region: usize,
}

/// `None` when the frame contradicts itself (lengths, intrinsics) or is empty. `cleaned` holds the
/// depths where the frame's own ones must be put right first.
pub fn gate<'a>(
    frame: &'a DepthFrame,
    cleaned: &'a mut Vec<f32>,
    settings: &VisionSettings,
) -> Option<DepthImage<'a>> {
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
    let near = settings.min_depth.max(1e-3) as f32;
    let far = (settings.max_depth as f32).min(LARGEST_DEPTH);
    let mut in_region = Kept::of_any(pixels, 0u8);
    let mut odd = 0u32;
    with_widest_vectors(|| {
        let rows = frame.depth.chunks_exact(width);
        for (row, inside) in rows.zip(in_region.chunks_exact_mut(width)) {
            for (&z, inside) in row.iter().zip(inside) {
                *inside = u8::from((z >= near) & (z <= far));
            }
            for &z in row {
                // Also true of NaN.
                odd |= u32::from(!((z >= 0.0) & (z < LARGEST_DEPTH)));
            }
        }
    });
    let smeared = settings.is_smeared();
    let noisy = settings.average_px > 0;
    if odd != 0 || smeared || noisy {
        cleaned.extend(
            frame
                .depth
                .iter()
                .map(|&z| if z > 0.0 && z < LARGEST_DEPTH { z } else { 0.0 }),
        );
        if noisy {
            let within = settings.average_within as f32;
            *cleaned = averaged(cleaned, width, settings.average_px, within);
        }
        if smeared {
            let noise = 0.5 * settings.plane_tolerance as f32;
            *cleaned = sharpened(cleaned, width, settings.smear_px, noise.max(0.0));
        }
    }
    // A camera that smears, or whose depths are averaged, has put in what it lost by chance.
    if !smeared && !noisy {
        let given = if odd == 0 { &frame.depth } else { &*cleaned };
        if let Some(kept) = without_outliers(given, width, LEVEL) {
            mark(&mut in_region, &kept, near, far);
            *cleaned = kept;
        }
        let given = if cleaned.is_empty() {
            &frame.depth
        } else {
            &*cleaned
        };
        if let Some(mended) = mended(given, &in_region, width, LEVEL) {
            *cleaned = mended;
        }
    }
    let depth: &[f32] = if cleaned.is_empty() {
        &frame.depth
    } else {
        mark(&mut in_region, cleaned, near, far);
        cleaned
    };
    let mut window = Window {
        rows: (0, height),
        columns: (0, width),
    };
    if let Some(region) = &settings.region {
        window = window_of(region, &intrinsics);
        cut(&mut in_region, depth, &intrinsics, region, &window);
    }
    let points_in_region = in_region
        .chunks(255)
        .map(|chunk| usize::from(chunk.iter().sum::<u8>()))
        .sum();
    Some(DepthImage {
        intrinsics,
        width,
        height,
        depth,
        intensity: if frame.intensity.len() == pixels {
            &frame.intensity
        } else {
            &[]
        },
        in_region,
        window,
        points_in_region,
    })
}

/// 1 where a depth is measured and in range.
fn mark(in_region: &mut [u8], depth: &[f32], near: f32, far: f32) {
    for (inside, &z) in in_region.iter_mut().zip(depth) {
        *inside = u8::from(z >= near && z <= far);
    }
}

/// Clears what lies outside the region.
fn cut(
    in_region: &mut [u8],
    depth: &[f32],
    intrinsics: &Intrinsics,
    region: &RegionOfInterest,
    window: &Window,
) {
    let region_from_camera = region.camera_from_region.inverse();
    let rotation = region_from_camera.rotation.to_rotation_matrix();
    let shift = region_from_camera.translation.vector.cast::<f32>();
    let half = region.half_extents.cast::<f32>();
    let (left, right) = window.columns;
    let width = intrinsics.width;
    let rows = in_region
        .chunks_exact_mut(width)
        .zip(depth.chunks_exact(width));
    for (v, (inside, depth)) in rows.enumerate() {
        if v < window.rows.0 || v >= window.rows.1 {
            inside.fill(0);
            continue;
        }
        inside[..left].fill(0);
        inside[right..].fill(0);
        // The ray in the region's axes is affine along a row.
        let first = rotation * intrinsics.ray(left as f64, v as f64);
        let next = (rotation * intrinsics.ray(left as f64 + 1.0, v as f64) - first).cast::<f32>();
        let first = first.cast::<f32>();
        let (inside, depth) = (&mut inside[left..right], &depth[left..right]);
        with_widest_vectors(
            #[inline(always)]
            || {
                for (k, (inside, &z)) in inside.iter_mut().zip(depth).enumerate() {
                    let u = k as i32 as f32;
                    let x = (first.x + next.x * u) * z + shift.x;
                    let y = (first.y + next.y * u) * z + shift.y;
                    let depth = (first.z + next.z * u) * z + shift.z;
                    let holds = (x.abs() <= half.x) & (y.abs() <= half.y) & (depth.abs() <= half.z);
                    *inside &= u8::from(holds);
                }
            },
        );
    }
}

/// Rows and columns in which a region can show; all of them when it reaches the camera's plane.
fn window_of(region: &RegionOfInterest, k: &Intrinsics) -> Window {
    let (mut u, mut v) = ([f64::MAX, f64::MIN], [f64::MAX, f64::MIN]);
    for corner in 0..8 {
        let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
        let half = region.half_extents;
        let p = region.camera_from_region
            * Point::new(half.x * sign(1), half.y * sign(2), half.z * sign(4));
        if p.z.is_nan() || p.z < 0.05 {
            return Window {
                rows: (0, k.height),
                columns: (0, k.width),
            };
        }
        let (pu, pv) = k.project(&p);
        u = [u[0].min(pu), u[1].max(pu)];
        v = [v[0].min(pv), v[1].max(pv)];
    }
    let range = |r: [f64; 2], count: usize| {
        let low = (r[0] - 1.0).clamp(0.0, count as f64) as usize;
        let high = (r[1] + 2.0).clamp(0.0, count as f64) as usize;
        (low, high.max(low))
    };
    Window {
        rows: range(v, k.height),
        columns: range(u, k.width),
    }
}

/// Rows and columns (last excluded) outside which no pixel is in the region.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub rows: (usize, usize),
    pub columns: (usize, usize),
}

impl DepthImage<'_> {
    /// Lone invalid pixels with the mean of their neighbours, which stands for them when surfaces are
    /// labelled. In order of their index. Gaps between cartons are lines of invalid pixels and stay.
    pub fn lone_holes(&self) -> Vec<(usize, f32)> {
        let mut holes = Vec::new();
        let w = self.width;
        let (left, right) = (
            self.window.columns.0.max(1),
            self.window.columns.1.min(w - 1),
        );
        let (low, high) = (
            self.window.rows.0.max(1),
            self.window.rows.1.min(self.height - 1),
        );
        if left >= right {
            return holes;
        }
        let mut found: Vec<usize> = Vec::new();
        for v in low..high {
            let row = &self.in_region[v * w..(v + 1) * w];
            found.clear();
            beside_measured(&row[left - 1..=right], &mut found);
            for i in found.iter().map(|k| v * w + left + k) {
                if self.depth[i] != 0.0 {
                    continue;
                }
                let around = [i - w - 1, i - 1, i + w - 1];
                // The hole itself is not in the region.
                let count = around.map(|j| {
                    let three = &self.in_region[j..j + 3];
                    three[0] + three[1] + three[2]
                });
                let count = count[0] + count[1] + count[2];
                if count < 7 {
                    continue;
                }
                let (mut sum, mut low, mut high) = (0.0f32, f32::MAX, 0.0f32);
                let around = around.into_iter().flat_map(|j| j..j + 3);
                for j in around.filter(|&j| self.in_region[j] == 1) {
                    sum += self.depth[j];
                    low = low.min(self.depth[j]);
                    high = high.max(self.depth[j]);
                }
                if high - low < 0.01 {
                    holes.push((i, sum / f32::from(count)));
                }
            }
        }
        holes
    }
}

/// Places of the zeros in a row of zeros and ones beside which, before or behind, there is a one; counted from the
/// row's second byte, as its first and last are only looked at. Sixteen at a time: they are rare.
fn beside_measured(row: &[u8], found: &mut Vec<usize>) {
    let (before, here, behind) = (row, &row[1..], &row[2..]);
    let (chunks, rest) = behind.as_chunks::<16>();
    for (n, chunk) in chunks.iter().enumerate() {
        let from = 16 * n;
        let sixteen = |bytes: &[u8]| {
            bytes[from..]
                .first_chunk()
                .map_or(0, |bytes| u128::from_le_bytes(*bytes))
        };
        let ones = sixteen(before) | u128::from_le_bytes(*chunk);
        let mut places = ones & !sixteen(here);
        while places != 0 {
            found.push(from + places.trailing_zeros() as usize / 8);
            places &= places - 1;
        }
    }
    let from = 16 * chunks.len();
    let is_one = |k: &usize| here[*k] == 0 && before[*k] + behind[*k] > 0;
    found.extend((from..from + rest.len()).filter(is_one));
}
