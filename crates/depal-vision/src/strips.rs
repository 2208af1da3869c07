//! Stage 1: where lost pixels line up. A gap between cartons is a line of them, whatever its direction.

/// Pixels along a strip; two to the power of [`DOUBLINGS`].
const LENGTH: usize = 32;
const DOUBLINGS: u32 = 5;
/// Pixels of a strip: it is three wide, so that a line may lie between two of the directions.
pub const STRIP: f64 = 3.0 * LENGTH as f64;
/// How far strips reach beyond the pixel they belong to, and a little more.
const MARGIN: usize = LENGTH;

/// Counts lost pixels in strips through each pixel of a tile.
#[derive(Default)]
pub struct Strips {
    /// Pixels of a row of the tile, its margins included.
    stride: usize,
    /// 1 where a pixel is lost.
    lost: Vec<u8>,
    three: Vec<u8>,
    sums: [Vec<u8>; 2],
    most: Vec<u8>,
}

impl Strips {
    /// Takes the rows and columns of an image (last excluded) and the margins around them; beyond the image nothing
    /// is lost.
    pub fn look(
        &mut self,
        depth: &[f32],
        width: usize,
        rows: std::ops::Range<usize>,
        columns: std::ops::Range<usize>,
    ) {
        let height = depth.len() / width;
        self.stride = columns.len() + 2 * MARGIN;
        let cells = self.stride * (rows.len() + 2 * MARGIN);
        self.lost.clear();
        self.lost.resize(cells, 0);
        let first = columns.start.saturating_sub(MARGIN);
        let last = (columns.end + MARGIN).min(width);
        let shift = first + MARGIN - columns.start;
        pulp::Arch::new().dispatch(|| {
            for (n, line) in self.lost.chunks_exact_mut(self.stride).enumerate() {
                let Some(v) = (rows.start + n).checked_sub(MARGIN).filter(|v| *v < height) else {
                    continue;
                };
                let row = &depth[v * width + first..v * width + last];
                for (lost, &z) in line[shift..].iter_mut().zip(row) {
                    *lost = u8::from(z == 0.0);
                }
            }
            self.count();
        });
    }

    /// The most lost pixels of any strip whose middle is the pixel, by row and column of the tile without margins; twice
    /// those of the half that has fewer.
    pub fn most(&self, row: usize, column: usize) -> u8 {
        self.most[(row + MARGIN) * self.stride + column + MARGIN]
    }

    /// Directions are an eighth of a pixel per pixel apart: at the ends of a strip a line between two of them is one
    /// pixel off.
    #[inline(always)]
    fn count(&mut self) {
        const EIGHTHS: isize = 8;
        let cells = self.lost.len();
        for buffer in [&mut self.three, &mut self.most] {
            buffer.clear();
            buffer.resize(cells, 0);
        }
        for sums in &mut self.sums {
            sums.resize(cells, 0);
        }
        let stride = self.stride as isize;
        for upright in [true, false] {
            let (across, along) = if upright { (1, stride) } else { (stride, 1) };
            three(&self.lost, across as usize, &mut self.three);
            for eighths in -EIGHTHS..=EIGHTHS {
                // Both diagonals are among the upright ones.
                if !upright && eighths.abs() == EIGHTHS {
                    continue;
                }
                let aside = |steps: isize| (eighths * steps + EIGHTHS / 2).div_euclid(EIGHTHS);
                let [a, b] = &mut self.sums;
                let (mut from, mut to) = (&mut self.three, a);
                let mut spare = Some(b);
                for k in 0..DOUBLINGS - 1 {
                    let steps = 1 << k;
                    add_shifted(from, steps * along + aside(steps) * across, to);
                    match spare.take() {
                        // The threes are needed again.
                        Some(second) => (from, to) = (to, second),
                        None => std::mem::swap(&mut from, &mut to),
                    }
                }
                let half = LENGTH as isize / 2;
                let middle = half * along + aside(half) * across;
                raise(from, middle, &mut self.most);
            }
        }
    }
}

/// Sum of each cell and those `step` before and behind it.
#[inline(always)]
fn three(cells: &[u8], step: usize, out: &mut [u8]) {
    let n = cells.len() - 2 * step;
    let (before, here, behind) = (&cells[..n], &cells[step..][..n], &cells[2 * step..]);
    for (out, ((a, b), c)) in out[step..][..n]
        .iter_mut()
        .zip(before.iter().zip(here).zip(behind))
    {
        *out = a + b + c;
    }
}

/// Sum of each cell and that `shift` farther on.
#[inline(always)]
fn add_shifted(cells: &[u8], shift: isize, out: &mut [u8]) {
    let n = cells.len() - shift.unsigned_abs();
    let from = (-shift).max(0) as usize;
    let other = shift.max(0) as usize;
    for (out, (a, b)) in out[from..][..n]
        .iter_mut()
        .zip(cells[from..][..n].iter().zip(&cells[other..][..n]))
    {
        *out = a + b;
    }
}

/// Raises each cell to twice the lesser of the sums of the halves before and behind it, which are `half` apart: what
/// lies on one side only, like a shadow, is no line through it.
#[inline(always)]
fn raise(halves: &[u8], half: isize, most: &mut [u8]) {
    let n = halves.len() - half.unsigned_abs();
    let (before, behind) = ((-half).max(0) as usize, half.max(0) as usize);
    // The middle is the first pixel of the half behind it.
    let middle = &mut most[behind..][..n];
    for (most, (a, b)) in middle
        .iter_mut()
        .zip(halves[before..][..n].iter().zip(&halves[behind..][..n]))
    {
        *most = (*most).max(2 * *a.min(b));
    }
}
