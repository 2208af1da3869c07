//! Stage 6a: the image along one row of cells on a plane.

use depal_frames::{Point, Vector};

use crate::{gate::DepthImage, spaced_points::SpacedPoints};

/// One row of cells: where they lie in the image, then what is there.
pub struct ResampledRow {
    /// Index of the nearest pixel; 0 where there is none.
    pixel: Vec<i32>,
    /// 1 where the cell lies in the image.
    inside: Vec<u32>,
    expected: Vec<f32>,
    /// Measured minus expected depth; [`NOTHING`] and [`BEYOND`] where there is none.
    deeper: Vec<f32>,
    /// 1 where it is so, else 0.
    pub on: Vec<u8>,
    pub deep: Vec<u8>,
    /// Height over the plane of surface cells, else 0.
    pub height: Vec<f32>,
}

/// Stands for the depth of a hole; larger than any depth.
const NOTHING: f32 = 1e6;
/// Stands for the depth beyond the image; nearer than any plane.
const BEYOND: f32 = -1e6;

/// Floor of a number of 0..2^22, by pushing its fraction out of the mantissa: a plain cast is checked
/// number by number.
#[inline(always)]
pub fn int(x: f32) -> i32 {
    const SHIFT: f32 = 8_388_608.0; // 2^23
    let rounded = x + SHIFT;
    let whole = (rounded.to_bits() & 0x007f_ffff) as i32;
    whole - i32::from(rounded - SHIFT > x)
}

impl ResampledRow {
    pub fn new(columns: usize) -> Self {
        Self {
            pixel: vec![0; columns],
            inside: vec![0; columns],
            expected: vec![0.0; columns],
            deeper: vec![0.0; columns],
            on: vec![0; columns],
            deep: vec![0; columns],
            height: vec![0.0; columns],
        }
    }

    /// Cells at `first + i step` (camera frame).
    #[inline(always)]
    pub fn fetch(&mut self, image: &DepthImage, first: Point, step: Vector) {
        let points = SpacedPoints::new(&image.intrinsics, first, step);
        let (width, height) = (image.width as f32, image.height as f32);
        let stride = image.width as i32;
        let cells = self
            .pixel
            .iter_mut()
            .zip(&mut self.expected)
            .zip(&mut self.inside);
        for (i, ((pixel, expected), inside)) in cells.enumerate() {
            let (u, v, z) = points.at(i);
            // False of NaN, too.
            let within = (u >= 0.0) & (v >= 0.0) & (u < width) & (v < height);
            let (u, v) = if within { (u, v) } else { (0.0, 0.0) };
            *expected = z;
            *pixel = int(v) * stride + int(u);
            *inside = u32::from(within);
        }
        for (&pixel, depth) in self.pixel.iter().zip(&mut self.deeper) {
            *depth = image.depth[pixel as usize];
        }
        let cells = self.expected.iter().zip(&self.inside);
        for (deeper, (&expected, &inside)) in self.deeper.iter_mut().zip(cells) {
            let z = *deeper;
            let there = if z == 0.0 { NOTHING } else { z - expected };
            *deeper = if inside == 1 { there } else { BEYOND };
        }
    }

    /// Tells surface, edge and the rest apart. `edge` is set to 1 where the surface ends or is not measured.
    #[inline(always)]
    pub fn classify(&mut self, tolerance: f32, edge: &mut [u8]) {
        let out = self
            .on
            .iter_mut()
            .zip(&mut self.deep)
            .zip(edge)
            .zip(&mut self.height);
        for (&deeper, (((on, deep), edge), height)) in self.deeper.iter().zip(out) {
            let surface = deeper.abs() <= tolerance;
            *on = u8::from(surface);
            *edge = u8::from(deeper > tolerance);
            *deep = u8::from((deeper > tolerance) & (deeper < NOTHING));
            *height = if surface { -deeper } else { 0.0 };
        }
    }

    /// Measured minus expected depth, metres; `None` where nothing was measured.
    pub fn deeper(&self) -> impl Iterator<Item = Option<f32>> {
        let known = |d: &f32| *d != NOTHING && *d != BEYOND;
        self.deeper.iter().map(move |d| Some(*d).filter(known))
    }

    /// 1 where something nearer hides the plane, or nothing was measured.
    pub fn unknown(&self, tolerance: f32) -> impl Iterator<Item = u8> {
        self.deeper.iter().map(move |&deeper| {
            u8::from((deeper == NOTHING) | ((deeper < -tolerance) & (deeper != BEYOND)))
        })
    }

    /// Takes cells out of the picture: neither surface nor edge.
    pub fn blank(&mut self, cells: std::ops::Range<usize>, edge: &mut [u8]) {
        self.on[cells.clone()].fill(0);
        self.deep[cells.clone()].fill(0);
        self.height[cells.clone()].fill(0.0);
        edge[cells].fill(0);
    }
}
