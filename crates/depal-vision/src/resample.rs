//! Stage 6a: the image along one row of cells on a plane.

use std::ops::Range;

use depal_frames::{Point, Vector};

use crate::{gate::DepthImage, plane::PlaneFrame, spaced_points::SpacedPoints};

/// One row of cells: where they lie in the image, then what is there.
pub struct ResampledRow {
    /// Index of the nearest pixel; [`OUTSIDE`] where there is none.
    pixel: Vec<i32>,
    /// Inverse depth of the plane where that pixel looks, per metre.
    inverse: Vec<f32>,
    /// How much deeper than the plane it is there; [`NOTHING`] and [`BEYOND`] where nothing is measured.
    deeper: Vec<f32>,
    /// What each cell is, one bit for each of the following.
    kind: Vec<u32>,
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

/// Stands for the pixel of a cell beyond the image.
const OUTSIDE: i32 = -1;
/// So many cells are looked up together where they lie along a row of pixels, one on each.
const RUN: usize = 64;

/// A plane's inverse depth, which is affine in column and row of the image.
#[derive(Clone, Copy)]
struct Expected {
    /// At the image's first pixel, from column to column and from row to row.
    first: f32,
    across: f32,
    down: f32,
    /// Depth at which the heights are as long as they are, metres.
    at: f32,
}

impl Expected {
    fn new(image: &DepthImage, frame: &PlaneFrame) -> Self {
        let (k, coefficient) = (&image.intrinsics, &frame.plane.coefficient);
        Self {
            first: coefficient.dot(&k.ray(0.0, 0.0)) as f32,
            across: (coefficient.x / k.fx) as f32,
            down: (coefficient.y / k.fy) as f32,
            at: frame.origin.z as f32,
        }
    }

    /// Where the middle of a pixel looks.
    #[inline(always)]
    fn inverse(self, column: i32, row: i32) -> f32 {
        (self.first + self.down * row as f32) + self.across * column as f32
    }

    /// How much deeper than the plane a measured depth is, as the same share of the depth at the frame's origin: by
    /// how much a second plane is nearer than the first goes with the depth on the first, and only as a share of it is
    /// the second one affine in the cells as well.
    #[inline(always)]
    fn beyond(self, z: f32, inverse: f32) -> f32 {
        let deeper = (z * inverse - 1.0) * self.at;
        if z == 0.0 { NOTHING } else { deeper }
    }
}

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
            inverse: vec![0.0; columns],
            deeper: vec![0.0; columns],
            kind: vec![0; columns],
            on: vec![0; columns],
            deep: vec![0; columns],
            height: vec![0.0; columns],
        }
    }

    /// Cells at `first + i step` (camera frame) on the plane of a frame, whose depth is taken where the middle of the
    /// nearest pixel looks: on one that leans, half a pixel beside a cell it is another.
    #[inline(always)]
    pub fn fetch(&mut self, image: &DepthImage, frame: &PlaneFrame, first: Point, step: Vector) {
        let plane = Expected::new(image, frame);
        let points = SpacedPoints::new(&image.intrinsics, first, step);
        let size = (image.width as f32, image.height as f32);
        let columns = self.deeper.len();
        for from in (0..columns).step_by(RUN) {
            let end = columns.min(from + RUN);
            match points.one_on_each(from, end - from, size) {
                Some((column, row)) => {
                    let start = row * image.width + column;
                    let depths = &image.depth[start..start + end - from];
                    let cells = self.deeper[from..end].iter_mut().zip(depths);
                    for (k, (deeper, &z)) in cells.enumerate() {
                        let inverse = plane.inverse(column as i32 + k as i32, row as i32);
                        *deeper = plane.beyond(z, inverse);
                    }
                }
                None => self.fetch_each(image, plane, &points, from..end),
            }
        }
    }

    /// The same wherever the cells lie.
    #[inline(always)]
    fn fetch_each(
        &mut self,
        image: &DepthImage,
        plane: Expected,
        points: &SpacedPoints,
        cells: Range<usize>,
    ) {
        let (width, height) = (image.width as f32, image.height as f32);
        let stride = image.width as i32;
        let (pixels, inverses, deeper) = (
            &mut self.pixel[cells.clone()],
            &mut self.inverse[cells.clone()],
            &mut self.deeper[cells.clone()],
        );
        let places = pixels.iter_mut().zip(&mut *inverses);
        for (i, (pixel, inverse)) in cells.zip(places) {
            let (u, v, _) = points.at(i);
            // False of NaN, too.
            let within = (u >= 0.0) & (v >= 0.0) & (u < width) & (v < height);
            let (u, v) = if within { (u, v) } else { (0.0, 0.0) };
            let (column, row) = (int(u), int(v));
            let place = row * stride + column;
            *pixel = if within { place } else { OUTSIDE };
            *inverse = plane.inverse(column, row);
        }
        for (deeper, &pixel) in deeper.iter_mut().zip(&*pixels) {
            *deeper = image.depth[pixel.max(0) as usize];
        }
        let places = pixels.iter().zip(&*inverses);
        for (deeper, (&pixel, &inverse)) in deeper.iter_mut().zip(places) {
            let there = plane.beyond(*deeper, inverse);
            *deeper = if pixel == OUTSIDE { BEYOND } else { there };
        }
    }

    /// Tells surface, edge and the rest apart. `edge` is set to 1 where the surface ends or is not measured.
    #[inline(always)]
    pub fn classify(&mut self, tolerance: f32, edge: &mut [u8]) {
        // All in one number first: narrowing numbers to bytes is most of the work.
        let cells = self.kind.iter_mut().zip(&mut self.height);
        for (&deeper, (kind, height)) in self.deeper.iter().zip(cells) {
            let surface = deeper.abs() <= tolerance;
            let beyond = deeper > tolerance;
            let kinds = u32::from(surface)
                | (u32::from(beyond) << 1)
                | (u32::from(beyond & (deeper < NOTHING)) << 2);
            *kind = kinds;
            *height = if surface { -deeper } else { 0.0 };
        }
        let out = self.on.iter_mut().zip(&mut self.deep).zip(edge);
        for (&kind, ((on, deep), edge)) in self.kind.iter().zip(out) {
            let kind = kind as u8;
            *on = kind & 1;
            *edge = (kind >> 1) & 1;
            *deep = kind >> 2;
        }
    }

    /// Measured minus expected depth, metres; `None` where nothing was measured.
    pub fn deeper(&self) -> impl Iterator<Item = Option<f32>> {
        let known = |d: &f32| *d != NOTHING && *d != BEYOND;
        self.deeper.iter().map(move |d| Some(*d).filter(known))
    }

    /// 1 where something nearer hides the plane, or nothing was measured.
    #[inline(always)]
    pub fn unknown(&self, tolerance: f32) -> impl Iterator<Item = u8> {
        self.deeper.iter().map(move |&deeper| {
            u8::from((deeper == NOTHING) | ((deeper < -tolerance) & (deeper != BEYOND)))
        })
    }

    /// Heights over the plane, NaN of what is no surface.
    pub fn heights(&self, tolerance: f32) -> impl Iterator<Item = f32> {
        self.deeper.iter().map(move |&deeper| {
            if deeper.abs() <= tolerance {
                -deeper
            } else {
                f32::NAN
            }
        })
    }

    /// Takes cells out of the picture: neither surface nor edge.
    pub fn blank(&mut self, cells: Range<usize>, edge: &mut [u8]) {
        self.on[cells.clone()].fill(0);
        self.deep[cells.clone()].fill(0);
        self.height[cells.clone()].fill(0.0);
        edge[cells].fill(0);
    }
}
