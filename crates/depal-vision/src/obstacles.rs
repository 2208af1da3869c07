//! Stage 10: what no reported carton explains.

use depal_frames::{Intrinsics, Point, Vector};
use nalgebra::Matrix3;

use crate::{DetectedBox, gate::DepthImage, scratch::Kept, widest::with_widest_vectors};

/// Points this close to a reported carton belong to it, metres.
const SLACK: f64 = 0.012;
/// More cubes than any coordinate has on one side of zero (60 m of depth, wide views, 1 mm cubes);
/// twice as many fit into 21 bits.
const SHIFT: f64 = 1_048_576.0;
const BITS: u32 = 21;
/// Samples along the side of a cube at the deepest point.
const SAMPLES_PER_VOXEL: f64 = 3.0;
/// So many samples are passed over at once where none is left.
const PART: usize = 16;
/// Cubes with fewer points are noise at a step.
const LEAST_POINTS: u32 = 3;

/// Middles of the occupied cubes of side `voxel`, ordered by cube index (z, y, x).
pub fn obstacle_points(image: &DepthImage, boxes: &[DetectedBox], voxel: f64) -> Vec<Point> {
    if !(voxel.is_finite() && voxel > 1e-3) {
        return Vec::new();
    }
    let k = &image.intrinsics;
    let solids: Vec<Solid> = boxes.iter().map(|b| Solid::new(b, k)).collect();
    let (top, bottom) = image.window.rows;
    let (left, right) = image.window.columns;
    // Of every eighth pixel: it only decides how many are looked at.
    let mut deepest = 0.0f32;
    for v in (top..bottom).step_by(8) {
        for u in (left..right).step_by(8) {
            let i = v * image.width + u;
            if image.in_region[i] == 1 && image.depth[i] > deepest {
                deepest = image.depth[i];
            }
        }
    }
    let stride = (voxel / SAMPLES_PER_VOXEL * k.fx.max(k.fy) / f64::from(deepest).max(0.1))
        .floor()
        .clamp(1.0, 8.0) as usize;
    let (per_metre, per_column) = (1.0 / voxel, 1.0 / k.fx);
    // Cube and how many neighbouring samples fell into it in a row.
    let mut cubes: Kept<(u64, u32)> = Kept::with_capacity(1 << 16);
    let mut row = Row::new(
        (left..right)
            .step_by(stride)
            .map(|u| (u as f64 - k.cx) * per_column)
            .collect(),
    );
    for v in (top..bottom).step_by(stride) {
        let y = (v as f64 - k.cy) / k.fy;
        let pixels = v * image.width + left..v * image.width + right;
        let (depth, in_region) = (&image.depth[pixels.clone()], &image.in_region[pixels]);
        for (n, (z, open)) in row.z.iter_mut().zip(&mut row.open).enumerate() {
            (*z, *open) = (f64::from(depth[n * stride]), in_region[n * stride]);
        }
        for solid in &solids {
            if solid.rows[0] <= v as f64 && v as f64 <= solid.rows[1] {
                // The first sample not before a column.
                let from = |column: f64| {
                    let samples = ((column - left as f64) / stride as f64).ceil();
                    samples.clamp(0.0, row.x.len() as f64) as usize
                };
                let (first, end) = (from(solid.columns[0]), from(solid.columns[1] + 1.0));
                with_widest_vectors(
                    #[inline(always)]
                    || row.explain(first..end.max(first), y, solid),
                );
            }
        }
        with_widest_vectors(
            #[inline(always)]
            || row.place(y, per_metre),
        );
        row.gather(&mut cubes);
    }
    let mut points = Vec::new();
    crowded(&mut cubes, |at| {
        let [z, y, x] = at.map(|index| (index as f64 - SHIFT + 0.5) * voxel);
        points.push(Point::new(x, y, z));
    });
    points
}

/// Samples of one row of the image.
struct Row {
    /// X of the ray with Z = 1, of every row the same, and depth, metres.
    x: Vec<f64>,
    z: Vec<f64>,
    /// 1 where it is in the region and not explained.
    open: Vec<u8>,
    /// The cube that it lies in.
    cube: Vec<u64>,
    /// Cubes and how many samples in a row lie in them; the first is none.
    runs: Vec<(u64, u32)>,
}

/// Floor of a number of 0..2^51, by pushing its fraction out of the mantissa: casts are made one by one.
#[inline(always)]
fn whole(x: f64) -> u64 {
    const SHIFT: f64 = 4_503_599_627_370_496.0; // 2^52
    let rounded = x + SHIFT;
    let bits = rounded.to_bits() & ((1 << 52) - 1);
    bits - u64::from(rounded - SHIFT > x)
}

impl Row {
    fn new(x: Vec<f64>) -> Self {
        Self {
            z: vec![0.0; x.len()],
            open: vec![0; x.len()],
            cube: vec![0; x.len()],
            runs: vec![(0, 0); x.len() + 1],
            x,
        }
    }

    /// Says in which cube each sample lies; `y` of the rays with Z = 1.
    #[inline(always)]
    fn place(&mut self, y: f64, per_metre: f64) {
        // Shifted to the positive before the cut, which then is floor.
        let cube_of = |c: f64| whole((c * per_metre + SHIFT).clamp(0.0, 2.0 * SHIFT - 1.0));
        for (cube, (&x, &z)) in self.cube.iter_mut().zip(self.x.iter().zip(&self.z)) {
            let [x, y, z] = [x * z, y * z, z].map(cube_of);
            *cube = (z << (2 * BITS)) | (y << BITS) | x;
        }
    }

    /// Adds the cubes in which open samples lie, each with how many in a row.
    fn gather(&mut self, cubes: &mut Vec<(u64, u32)>) {
        let (mut run, mut count) = ((u64::MAX, 0), 0);
        for (part, open) in self.cube.chunks(PART).zip(self.open.chunks(PART)) {
            // Most of a picture is explained.
            if open.iter().fold(0, |any, open| any | open) == 0 {
                continue;
            }
            // Each is written where it would stand, and the place only left when another cube begins: without a jump.
            for (&cube, &open) in part.iter().zip(open) {
                let begins = (open == 1) & (cube != run.0);
                count += usize::from(begins);
                run = if begins { (cube, 0) } else { run };
                run.1 += u32::from(open);
                self.runs[count] = run;
            }
        }
        cubes.extend_from_slice(&self.runs[1..=count]);
    }

    /// Takes out what belongs to a carton; `y` of the rays with Z = 1.
    #[inline(always)]
    fn explain(&mut self, samples: std::ops::Range<usize>, y: f64, solid: &Solid) {
        let places = self.x[samples.clone()].iter().zip(&self.z[samples.clone()]);
        for (open, (&x, &z)) in self.open[samples].iter_mut().zip(places) {
            *open &= u8::from(!solid.holds(&Point::new(x * z, y * z, z)));
        }
    }
}

/// Calls `found` with the indices (z, y, x) of each cube that has enough points, in order.
fn crowded(cubes: &mut [(u64, u32)], mut found: impl FnMut([u64; 3])) {
    /// Counted in a table up to that size, which is many times what a picture of a pallet spans.
    const LARGEST_TABLE: u64 = 1 << 23;
    let of = |cube: u64| [2 * BITS, BITS, 0].map(|bits| (cube >> bits) & ((1 << BITS) - 1));
    let (mut low, mut high) = ([u64::MAX; 3], [0; 3]);
    for (cube, _) in cubes.iter() {
        for (k, index) in of(*cube).into_iter().enumerate() {
            low[k] = low[k].min(index);
            high[k] = high[k].max(index);
        }
    }
    if cubes.is_empty() {
        return;
    }
    let size = [0, 1, 2].map(|k| high[k] - low[k] + 1);
    let cells = size[0].saturating_mul(size[1]).saturating_mul(size[2]);
    if cells > LARGEST_TABLE {
        cubes.sort_unstable();
        for group in cubes.chunk_by(|a, b| a.0 == b.0) {
            if group.iter().map(|g| g.1).sum::<u32>() >= LEAST_POINTS {
                found(of(group[0].0));
            }
        }
        return;
    }
    let mut counts = Kept::of(cells as usize, 0u8);
    for (cube, count) in cubes.iter() {
        let [z, y, x] = of(*cube);
        let place = ((z - low[0]) * size[1] + y - low[1]) * size[2] + x - low[2];
        let here = &mut counts[place as usize];
        *here = here.saturating_add((*count).min(LEAST_POINTS) as u8);
    }
    for (n, line) in counts.chunks(size[2] as usize).enumerate() {
        let (z, y) = (n as u64 / size[1], n as u64 % size[1]);
        // Most lines are empty.
        if line.iter().fold(0, |any, count| any | count) == 0 {
            continue;
        }
        for (x, _) in (0..)
            .zip(line)
            .filter(|(_, c)| u32::from(**c) >= LEAST_POINTS)
        {
            found([z + low[0], y + low[1], x + low[2]]);
        }
    }
}

/// A reported carton with its slack.
struct Solid {
    /// `box_from_camera` as a matrix and a shift.
    turn: Matrix3<f64>,
    shift: Vector,
    half_length: f64,
    half_width: f64,
    bottom: f64,
    /// Where it can show in the image.
    columns: [f64; 2],
    rows: [f64; 2],
}

impl Solid {
    fn new(found: &DetectedBox, k: &Intrinsics) -> Self {
        let box_from_camera = found.camera_from_box.inverse();
        let mut solid = Self {
            turn: *box_from_camera.rotation.to_rotation_matrix().matrix(),
            shift: box_from_camera.translation.vector,
            half_length: found.size.length / 2.0 + SLACK,
            half_width: found.size.width / 2.0 + SLACK,
            bottom: -found.size.height - SLACK,
            columns: [f64::MAX, f64::MIN],
            rows: [f64::MAX, f64::MIN],
        };
        for corner in 0..8 {
            let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
            let z = if corner & 4 == 0 { SLACK } else { solid.bottom };
            let p = found.camera_from_box
                * Point::new(sign(1) * solid.half_length, sign(2) * solid.half_width, z);
            if p.z < 0.01 {
                solid.columns = [f64::MIN, f64::MAX];
                solid.rows = solid.columns;
                break;
            }
            let (u, v) = k.project(&p);
            solid.columns = [solid.columns[0].min(u), solid.columns[1].max(u)];
            solid.rows = [solid.rows[0].min(v), solid.rows[1].max(v)];
        }
        solid
    }

    #[inline(always)]
    fn holds(&self, point_in_camera: &Point) -> bool {
        let p = self.turn * point_in_camera.coords + self.shift;
        // Without a jump: most are far from all borders, but which ones is not foreseen.
        (p.z < SLACK)
            & (p.z > self.bottom)
            & (p.x.abs() < self.half_length)
            & (p.y.abs() < self.half_width)
    }
}
