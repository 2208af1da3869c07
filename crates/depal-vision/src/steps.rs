//! Stage 2: the step mask. A pixel is surface when nothing within two pixels is much nearer.

use crate::{gate::DepthImage, lean::Lean, scratch::Kept};

/// Half of the window: 5 x 5 pixels, so that a line of gap pixels parts two surfaces even where
/// noise has closed it for up to four pixels.
const REACH: usize = 2;
const WINDOW: usize = 2 * REACH + 1;

/// 1 for surface pixels at least two pixels away from every step, hole and border of the region.
///
/// Two running minima of 5 x 5, one over depth and one over what is surface, go down the image
/// together, so that only a dozen rows are in use at a time. Where the camera leans against the
/// level faces, depths are counted along their common direction.
///
/// A step is `step` high, metres, and at least `noise` times the square of depth.
pub fn surface_mask(image: &DepthImage, holes: &[(usize, f32)], step: f64, noise: f64) -> Kept<u8> {
    pulp::Arch::new().dispatch(MaskJob {
        image,
        holes,
        step: step as f32,
        noise: noise as f32,
    })
}

/// The mask's loops for the widest vectors that the machine has; the same bits with any.
struct MaskJob<'a> {
    image: &'a DepthImage<'a>,
    holes: &'a [(usize, f32)],
    step: f32,
    noise: f32,
}

impl pulp::WithSimd for MaskJob<'_> {
    type Output = Kept<u8>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Kept<u8> {
        mask(self.image, self.holes, self.step, self.noise)
    }
}

#[inline(always)]
fn mask(image: &DepthImage, holes: &[(usize, f32)], step: f32, noise: f32) -> Kept<u8> {
    let (width, height) = (image.width, image.height);
    let lean = Lean::of(image, f64::from(step));
    let (top, bottom) = rows_in_region(image);
    // Each of these rows is written below.
    let mut mask = Kept::of_any(width * height, 0u8);
    mask[..top * width].fill(0);
    mask[bottom * width..].fill(0);
    let mut nearest = RollingMin::new(width, f32::MAX);
    let mut eroded = RollingMin::new(width, 0u8);
    let mut filled = vec![FilledRow::new(width); WINDOW];
    let mut low = vec![f32::MAX; width];
    let mut surface = vec![0u8; width + 2 * REACH];
    let mut holes = holes.iter().peekable();
    for v in top.saturating_sub(REACH)..bottom + 2 * REACH {
        // Row v comes in; the depth window is complete for row v - 2, the surface window for v - 4.
        if v < height {
            let row = &mut filled[v % WINDOW];
            row.fetch(image, v);
            while let Some((i, z)) = holes.next_if(|(i, _)| *i < (v + 1) * width) {
                if *i >= v * width {
                    row.depth[REACH + i - v * width] = *z;
                    row.inside[i - v * width] = 1;
                }
            }
            if let Some(lean) = lean {
                row.flatten(lean.factors(image, v));
            }
            nearest.push(v, &row.depth);
        } else {
            nearest.push_outside(v);
        }
        let Some(middle) = v.checked_sub(REACH) else {
            continue;
        };
        if middle >= top && middle < bottom {
            nearest.minimum(&mut low);
            let row = &filled[middle % WINDOW];
            let places = row.depth[REACH..].iter().zip(&low).zip(&row.inside);
            for (out, ((&z, &low), &inside)) in surface[REACH..].iter_mut().zip(places) {
                let noise = noise * low * low;
                let step = if noise > step { noise } else { step };
                *out = inside & u8::from(z - low < step);
            }
            eroded.push(middle, &surface);
        } else {
            eroded.push_outside(middle);
        }
        if let Some(done) = middle.checked_sub(REACH)
            && done >= top
            && done < bottom
        {
            eroded.minimum(&mut mask[done * width..(done + 1) * width]);
        }
    }
    mask
}

/// The first row in which a pixel is in the region, and the one after the last.
fn rows_in_region(image: &DepthImage) -> (usize, usize) {
    let (top, bottom) = image.window.rows;
    let is_any = |row: &[u8]| row.iter().fold(0, |any, inside| any | inside) != 0;
    let rows = || image.in_region.chunks_exact(image.width);
    let first = rows().position(is_any).unwrap_or(bottom);
    let last = rows().rposition(is_any).unwrap_or(first);
    let end = image.height.min(bottom);
    (top.max(first).min(end), end.min(last + 1))
}

#[derive(Clone)]
struct FilledRow {
    /// Metres, `f32::MAX` where nothing was measured, and in a margin at both ends.
    depth: Vec<f32>,
    inside: Vec<u8>,
}

impl FilledRow {
    fn new(width: usize) -> Self {
        Self {
            depth: vec![f32::MAX; width + 2 * REACH],
            inside: vec![0; width],
        }
    }

    #[inline(always)]
    fn fetch(&mut self, image: &DepthImage, v: usize) {
        let range = v * image.width..(v + 1) * image.width;
        let places = self.depth[REACH..].iter_mut();
        for (out, &z) in places.zip(&image.depth[range.clone()]) {
            *out = if z > 0.0 { z } else { f32::MAX };
        }
        self.inside.copy_from_slice(&image.in_region[range]);
    }

    /// Multiplies each depth by a factor that grows from column to column.
    #[inline(always)]
    fn flatten(&mut self, (first, more): (f32, f32)) {
        let width = self.inside.len();
        for (u, z) in self.depth[REACH..][..width].iter_mut().enumerate() {
            *z *= first + more * u as f32;
        }
    }
}

/// Minimum over the last five rows pushed and five columns.
struct RollingMin<T> {
    /// Row minima over five columns, by row number modulo five.
    rows: Vec<Vec<T>>,
    outside: T,
}

impl<T: Copy + PartialOrd> RollingMin<T> {
    /// `outside` stands for pixels beyond the image.
    fn new(width: usize, outside: T) -> Self {
        Self {
            rows: vec![vec![outside; width]; WINDOW],
            outside,
        }
    }

    /// A row with a margin of what lies beyond the image at both ends.
    #[inline(always)]
    fn push(&mut self, v: usize, row: &[T]) {
        let min = |a: T, b: T| if b < a { b } else { a };
        let width = row.len() - 2 * REACH;
        let shifted: [&[T]; WINDOW] = std::array::from_fn(|k| &row[k..k + width]);
        let out = &mut self.rows[v % WINDOW];
        for (u, out) in out.iter_mut().enumerate() {
            *out = min(
                min(
                    min(shifted[0][u], shifted[1][u]),
                    min(shifted[2][u], shifted[3][u]),
                ),
                shifted[4][u],
            );
        }
    }

    #[inline(always)]
    fn push_outside(&mut self, v: usize) {
        self.rows[v % WINDOW].fill(self.outside);
    }

    #[inline(always)]
    fn minimum(&self, out: &mut [T]) {
        let min = |a: T, b: T| if b < a { b } else { a };
        let width = out.len();
        let rows: [&[T]; WINDOW] = std::array::from_fn(|k| &self.rows[k][..width]);
        for (u, out) in out.iter_mut().enumerate() {
            *out = min(
                min(min(rows[0][u], rows[1][u]), min(rows[2][u], rows[3][u])),
                rows[4][u],
            );
        }
    }
}
