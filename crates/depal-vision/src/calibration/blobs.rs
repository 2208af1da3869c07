//! Dark round spots of about a disc's size.

use depal_frames::{DepthFrame, Point};

use super::board::CircleBoard;

/// A pixel darker than this share of its neighbourhood's mean is dark.
const DARK: f64 = 0.65;
/// Neighbourhoods darker than this grey hold nothing to be seen.
const LEAST_MEAN: f64 = 8.0;
/// Smaller spots have no outline worth fitting, pixels.
const LEAST_PIXELS: usize = 20;
/// More spots than this are a texture, not boards.
const MOST_SPOTS: usize = 4000;

/// A dark spot that may be a disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Middle of its pixels.
    pub u: f64,
    /// Middle of its pixels.
    pub v: f64,
    /// Covariance of its pixels (uu, uv, vv): an ellipse of this covariance has the same shape.
    pub covariance: [f64; 3],
    /// Median depth on and around it, metres.
    pub depth: f64,
    /// Its middle in space, roughly.
    pub point: Point,
}

impl Spot {
    /// Radius of the ellipse of the same covariance in a direction of the image, pixels.
    pub fn radius(&self, cos: f64, sin: f64) -> f64 {
        // x^T (4 C)^-1 x = 1 on the ellipse.
        let [a, b, c] = self.covariance;
        let determinant = a * c - b * b;
        let form = (c * cos * cos - 2.0 * b * cos * sin + a * sin * sin) / determinant;
        2.0 / form.sqrt()
    }
}

/// Pixels of one connected dark piece, summed up.
#[derive(Clone, Copy)]
struct Piece {
    pixels: usize,
    sums: [f64; 5],
    columns: (usize, usize),
    rows: (usize, usize),
}

/// All spots whose size and shape fit a disc of the board, in image order.
pub fn spots(frame: &DepthFrame, board: &CircleBoard) -> Vec<Spot> {
    let (width, height) = (frame.intrinsics.width, frame.intrinsics.height);
    let dark = dark_mask(frame, board);
    let mut found = Vec::new();
    for piece in pieces(&dark, width) {
        let at_border = piece.columns.0 == 0
            || piece.rows.0 == 0
            || piece.columns.1 + 1 == width
            || piece.rows.1 + 1 == height;
        if piece.pixels >= LEAST_PIXELS
            && !at_border
            && let Some(spot) = as_spot(frame, board, &piece)
        {
            found.push(spot);
            if found.len() == MOST_SPOTS {
                break;
            }
        }
    }
    found
}

fn as_spot(frame: &DepthFrame, board: &CircleBoard, piece: &Piece) -> Option<Spot> {
    let n = piece.pixels as f64;
    let [su, sv, suu, suv, svv] = piece.sums;
    let (u, v) = (su / n, sv / n);
    // A pixel is a square, not a point: its own variance is 1/12.
    let covariance = [
        suu / n - u * u + 1.0 / 12.0,
        suv / n - u * v,
        svv / n - v * v + 1.0 / 12.0,
    ];
    let determinant = covariance[0] * covariance[2] - covariance[1] * covariance[1];
    let ellipse = 4.0 * std::f64::consts::PI * determinant.max(0.0).sqrt();
    let half_trace = f64::midpoint(covariance[0], covariance[2]);
    let root = (half_trace * half_trace - determinant).max(0.0).sqrt();
    let roundness = ((half_trace - root).max(0.0) / (half_trace + root)).sqrt();
    if !(0.85..1.15).contains(&(n / ellipse)) || roundness < 0.4 {
        return None;
    }
    let depth = median_depth(frame, piece)?;
    let diameter = 2.0 * (half_trace + root).sqrt() * 2.0 * depth
        / (frame.intrinsics.fx * frame.intrinsics.fy).sqrt();
    let sizes = 0.6 * board.disc_diameter..1.6 * CircleBoard::MARK_FACTOR * board.disc_diameter;
    sizes.contains(&diameter).then(|| Spot {
        u,
        v,
        covariance,
        depth,
        point: frame.intrinsics.deproject(u, v, depth),
    })
}

fn median_depth(frame: &DepthFrame, piece: &Piece) -> Option<f64> {
    let (width, height) = (frame.intrinsics.width, frame.intrinsics.height);
    let columns = piece.columns.0.saturating_sub(2)..(piece.columns.1 + 3).min(width);
    let rows = piece.rows.0.saturating_sub(2)..(piece.rows.1 + 3).min(height);
    let mut depths: Vec<f32> = rows
        .flat_map(|v| &frame.depth[v * width + columns.start..v * width + columns.end])
        .copied()
        .filter(|z| *z > 0.0 && z.is_finite())
        .collect();
    if depths.is_empty() {
        return None;
    }
    let middle = depths.len() / 2;
    Some(f64::from(
        *depths.select_nth_unstable_by(middle, f32::total_cmp).1,
    ))
}

/// Pixels clearly darker than the mean of a window of one pitch around them.
fn dark_mask(frame: &DepthFrame, board: &CircleBoard) -> Vec<bool> {
    let (width, height) = (frame.intrinsics.width, frame.intrinsics.height);
    let mut valid: Vec<f32> = frame
        .depth
        .iter()
        .step_by((frame.depth.len() / 10_000).max(1))
        .copied()
        .filter(|z| *z > 0.0 && z.is_finite())
        .collect();
    if valid.is_empty() {
        return vec![false; width * height];
    }
    // The board is what stands nearer than most: its window may be larger than a pitch, never smaller than half.
    let nearer = valid.len() / 10;
    let depth = f64::from(*valid.select_nth_unstable_by(nearer, f32::total_cmp).1);
    let half = (0.5 * board.pitch * frame.intrinsics.fx / depth)
        .round()
        .clamp(6.0, 200.0) as usize;
    let stride = width + 1;
    let mut sums = vec![0u64; stride * (height + 1)];
    for v in 0..height {
        let mut row = 0u64;
        for u in 0..width {
            row += u64::from(frame.intensity[v * width + u]);
            sums[(v + 1) * stride + u + 1] = sums[v * stride + u + 1] + row;
        }
    }
    let mut dark = vec![false; width * height];
    for v in 0..height {
        let (top, bottom) = (v.saturating_sub(half), (v + half + 1).min(height));
        for u in 0..width {
            let (left, right) = (u.saturating_sub(half), (u + half + 1).min(width));
            let sum = sums[bottom * stride + right] + sums[top * stride + left]
                - sums[top * stride + right]
                - sums[bottom * stride + left];
            let mean = sum as f64 / ((bottom - top) * (right - left)) as f64;
            let value = f64::from(frame.intensity[v * width + u]);
            dark[v * width + u] = mean > LEAST_MEAN && value < DARK * mean;
        }
    }
    dark
}

/// Connected pieces (by sides) of a mask.
fn pieces(mask: &[bool], width: usize) -> Vec<Piece> {
    let mut parents: Vec<usize> = Vec::new();
    let mut list: Vec<Piece> = Vec::new();
    let mut above: Vec<(usize, usize, usize)> = Vec::new();
    for (v, row) in mask.chunks_exact(width.max(1)).enumerate() {
        let mut here = Vec::new();
        let mut u = 0;
        while u < width {
            if !row[u] {
                u += 1;
                continue;
            }
            let first = u;
            while u < width && row[u] {
                u += 1;
            }
            let label = parents.len();
            parents.push(label);
            list.push(run(first, u - 1, v));
            for &(other_first, other_last, other) in &above {
                if other_first < u && other_last >= first {
                    let (a, b) = (root(&mut parents, label), root(&mut parents, other));
                    if a != b {
                        let (keep, merged) = (a.min(b), a.max(b));
                        parents[merged] = keep;
                        let piece = list[merged];
                        list[keep].add(&piece);
                    }
                }
            }
            here.push((first, u - 1, label));
        }
        above = here;
    }
    (0..list.len())
        .filter(|&k| parents[k] == k)
        .map(|k| list[k])
        .collect()
}

fn root(parents: &mut [usize], mut label: usize) -> usize {
    while parents[label] != label {
        parents[label] = parents[parents[label]];
        label = parents[label];
    }
    label
}

fn run(first: usize, last: usize, v: usize) -> Piece {
    let mut sums = [0.0; 5];
    let y = v as f64;
    for u in first..=last {
        let x = u as f64;
        for (sum, term) in sums.iter_mut().zip([x, y, x * x, x * y, y * y]) {
            *sum += term;
        }
    }
    Piece {
        pixels: last - first + 1,
        sums,
        columns: (first, last),
        rows: (v, v),
    }
}

impl Piece {
    fn add(&mut self, other: &Self) {
        self.pixels += other.pixels;
        for (a, b) in self.sums.iter_mut().zip(other.sums) {
            *a += b;
        }
        self.columns = (
            self.columns.0.min(other.columns.0),
            self.columns.1.max(other.columns.1),
        );
        self.rows = (self.rows.0.min(other.rows.0), self.rows.1.max(other.rows.1));
    }
}
