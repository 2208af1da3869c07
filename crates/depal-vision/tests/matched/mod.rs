//! What stereo matching makes of a scene: two views of it under a pattern of random dots, matched patch by patch. Its
//! errors are those of a matcher: fattened edges, holes where only one eye sees, depths in steps of disparity, tops
//! that undulate with the pattern.
#![allow(dead_code)]

use depal_camera::{RenderShape, SensorSpec, render, sense};
use depal_frames::{DepthFrame, Intrinsics, Pose, Vector};
use depal_time::RandomStreams;

use crate::cheap::cheap;

/// Distance of the eyes, metres.
const BASELINE: f64 = 0.055;
/// Disparities are looked for up to this, pixels: as near as 0.85 m.
const DISPARITIES: usize = 40;
/// Half of the square of a census word (7 x 7) and of the patch over which costs are summed.
const WORD: usize = 3;
const PATCH: usize = 6;
/// Parts of a pixel in which disparities are given.
const PARTS: f32 = 32.0;
/// A match with more differing bits of 48 is none.
const MOST_BITS: f32 = 18.0;

/// A number of 0..1 for a place of a lattice.
fn hash(x: i64, y: i64, seed: u64) -> f32 {
    let mut h = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ seed.wrapping_mul(0x1656_67b1_9e37_79f9);
    h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((h ^ (h >> 32)) >> 40) as f32 / 16_777_216.0
}

/// The lattice with what lies between, and bright dots where its numbers are high.
fn dots(x: f64, y: f64, seed: u64) -> f32 {
    let (i, j) = (x.floor(), y.floor());
    let (a, b) = ((x - i) as f32, (y - j) as f32);
    let at = |di: i64, dj: i64| {
        let value = hash(i as i64 + di, j as i64 + dj, seed);
        if value > 0.75 { 1.0 } else { 0.1 * value }
    };
    let low = at(0, 0) * (1.0 - a) + at(1, 0) * a;
    let high = at(0, 1) * (1.0 - a) + at(1, 1) * a;
    low * (1.0 - b) + high * b
}

/// What one eye sees; `shift` is its place along the camera's X.
fn view(at: &Pose, shapes: &[RenderShape], shift: f64, seed: u64) -> Vec<f32> {
    let ideal = cheap(SensorSpec::ideal());
    let eye = Pose::from_parts(
        (at.translation.vector + at.rotation * Vector::new(shift, 0.0, 0.0)).into(),
        at.rotation,
    );
    let frame = sense(&ideal, &render(&ideal, &eye, shapes), seed).frame;
    let k: Intrinsics = frame.intrinsics;
    let mut noise = RandomStreams::new(seed).stream(if shift > 0.0 { "right" } else { "left" });
    frame
        .depth
        .iter()
        .enumerate()
        .map(|(n, &z)| {
            let (u, v) = ((n % k.width) as f64, (n / k.width) as f64);
            let p = k.deproject(u, v, f64::from(z)).coords + Vector::new(shift, 0.0, 0.0);
            // The projector stands between the eyes; its dots are half as large again as a pixel.
            let pattern = |x: f64| (p.x - 0.5 * BASELINE) / p.z * x;
            let scale = k.fx / 1.5;
            let light = dots(pattern(scale) + 4000.0, p.y / p.z * scale + 4000.0, seed);
            let world = eye * (p - Vector::new(shift, 0.0, 0.0));
            let paper = dots(world.x / 0.004 + 4000.0, world.y / 0.004 + 4000.0, seed + 1);
            60.0 * (0.4 + light) * (0.9 + 0.2 * paper) + noise.normal(2.0) as f32
        })
        .collect()
}

/// For each pixel one bit per neighbour that is darker.
fn words(image: &[f32], width: usize) -> Vec<u64> {
    let height = image.len() / width;
    let mut words = vec![0u64; image.len()];
    for v in WORD..height - WORD {
        for u in WORD..width - WORD {
            let own = image[v * width + u];
            let mut word = 0;
            for y in v - WORD..=v + WORD {
                for other in &image[y * width + u - WORD..=y * width + u + WORD] {
                    word = word << 1 | u64::from(*other < own);
                }
            }
            words[v * width + u] = word;
        }
    }
    words
}

/// Means over squares of `2 PATCH + 1` pixels.
fn patch_means(costs: &[f32], width: usize) -> Vec<f32> {
    let height = costs.len() / width;
    let mean = |line: &[f32], out: &mut Vec<f32>| {
        let mut sum = 0.0;
        out.clear();
        for n in 0..line.len() + PATCH {
            sum += line.get(n).copied().unwrap_or(64.0);
            if n > 2 * PATCH {
                sum -= line[n - 2 * PATCH - 1];
            }
            if n >= PATCH {
                out.push(sum / (2 * PATCH + 1) as f32);
            }
        }
    };
    let mut out = Vec::new();
    let mut rows = vec![0.0; costs.len()];
    for v in 0..height {
        mean(&costs[v * width..(v + 1) * width], &mut out);
        rows[v * width..(v + 1) * width].copy_from_slice(&out);
    }
    let mut column = vec![0.0; height];
    for u in 0..width {
        for v in 0..height {
            column[v] = rows[v * width + u];
        }
        mean(&column, &mut out);
        for v in 0..height {
            rows[v * width + u] = out[v];
        }
    }
    rows
}

/// The depth that matching both eyes gives, in steps of one millimetre; without intensity.
pub fn matched(at: &Pose, shapes: &[RenderShape], seed: u64) -> DepthFrame {
    let k = cheap(SensorSpec::ideal()).intrinsics;
    let [left, right] = [0.0, BASELINE].map(|shift| words(&view(at, shapes, shift, seed), k.width));
    let costs: Vec<Vec<f32>> = (0..DISPARITIES)
        .map(|d| {
            let bits = |n: usize| {
                if n % k.width < d {
                    64.0
                } else {
                    (left[n] ^ right[n - d]).count_ones() as f32
                }
            };
            patch_means(&(0..left.len()).map(bits).collect::<Vec<_>>(), k.width)
        })
        .collect();
    let best = |cost: &dyn Fn(usize) -> f32| {
        (1..DISPARITIES - 1)
            .min_by(|a, b| cost(*a).total_cmp(&cost(*b)))
            .unwrap_or(1)
    };
    let depth = (0..left.len())
        .map(|n| {
            let u = n % k.width;
            let d = best(&|d| costs[d][n]);
            // The other eye must agree.
            let from_right = |o: usize| {
                if u + o < d + k.width {
                    costs[o].get(n + o - d).copied().unwrap_or(64.0)
                } else {
                    64.0
                }
            };
            if d > u || best(&from_right).abs_diff(d) > 1 || costs[d][n] > MOST_BITS {
                return 0.0;
            }
            let (a, b, c) = (costs[d - 1][n], costs[d][n], costs[d + 1][n]);
            let bend = a - 2.0 * b + c;
            let part = if bend > 1e-6 {
                0.5 * (a - c) / bend
            } else {
                0.0
            };
            let disparity = ((d as f32 + part) * PARTS).round() / PARTS;
            let z = (k.fx * BASELINE) as f32 / disparity;
            (z * 1e3).round() * 1e-3
        })
        .collect();
    DepthFrame {
        intrinsics: k,
        depth,
        intensity: Vec::new(),
    }
}
