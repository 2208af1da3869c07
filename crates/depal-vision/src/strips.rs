//! Stage 1: where lost pixels line up. A gap between cartons is a line of them, whatever its direction.

/// Side of the cells that strips are made of, pixels: single pixels would take four times as long to count.
const CELL: usize = 2;
/// Cells along a strip; two to the power of [`DOUBLINGS`].
const LENGTH: usize = 16;
const DOUBLINGS: u32 = 4;
/// Cells across a strip, so that a line may lie between two of them.
const ACROSS: usize = 2;
/// Pixels of a strip.
pub const STRIP: f64 = (LENGTH * ACROSS * CELL * CELL) as f64;
/// How far strips reach beyond the cell they belong to, and a little more.
const MARGIN: usize = LENGTH / 2 + ACROSS;

/// Counts lost pixels in strips through each cell of a tile.
#[derive(Default)]
pub struct Strips {
    /// Cells of a row of the tile, its margins included.
    stride: usize,
    /// Lost pixels of each cell.
    lost: Vec<u8>,
    /// Each with the next one across the strips at hand.
    pairs: Vec<u8>,
    sums: [Vec<u8>; 2],
    most: Vec<u8>,
}

impl Strips {
    /// Takes the rows and columns of an image (first ones even, last excluded) and the margins around them; beyond the
    /// image nothing is lost.
    pub fn look(
        &mut self,
        depth: &[f32],
        width: usize,
        rows: std::ops::Range<usize>,
        columns: std::ops::Range<usize>,
    ) {
        let height = depth.len() / width;
        self.stride = columns.len().div_ceil(CELL) + 2 * MARGIN;
        let count = rows.len().div_ceil(CELL) + 2 * MARGIN;
        self.lost.clear();
        self.lost.resize(self.stride * count, 0);
        let margin = CELL * MARGIN;
        let first = columns.start.saturating_sub(margin);
        let last = (columns.end + margin).min(width);
        let shift = (first + margin - columns.start) / CELL;
        pulp::Arch::new().dispatch(|| {
            let lines = self.lost.chunks_exact_mut(self.stride);
            for (n, line) in lines.enumerate() {
                for v in CELL * n..CELL * (n + 1) {
                    let Some(v) = (rows.start + v).checked_sub(margin).filter(|v| *v < height)
                    else {
                        continue;
                    };
                    let row = &depth[v * width + first..v * width + last];
                    let cells = row.as_chunks::<CELL>().0;
                    for (lost, [a, b]) in line[shift..].iter_mut().zip(cells) {
                        *lost += u8::from(*a == 0.0) + u8::from(*b == 0.0);
                    }
                }
            }
            self.count();
        });
    }

    /// The most lost pixels of any strip whose middle is the cell of a pixel, by row and column of the tile without
    /// margins; twice those of the half that has fewer.
    pub fn most(&self, row: usize, column: usize) -> u8 {
        self.most[(row / CELL + MARGIN) * self.stride + column / CELL + MARGIN]
    }

    /// Directions are a quarter of a cell per cell apart: at the ends of a strip a line between two of them is one cell
    /// off.
    #[inline(always)]
    fn count(&mut self) {
        const QUARTERS: isize = 4;
        let cells = self.lost.len();
        for buffer in [&mut self.pairs, &mut self.most] {
            buffer.clear();
            buffer.resize(cells, 0);
        }
        for sums in &mut self.sums {
            sums.resize(cells, 0);
        }
        let stride = self.stride as isize;
        for upright in [true, false] {
            let (across, along) = if upright { (1, stride) } else { (stride, 1) };
            add_shifted(&self.lost, across, &mut self.pairs);
            for quarters in -QUARTERS..=QUARTERS {
                // Both diagonals are among the upright ones.
                if !upright && quarters.abs() == QUARTERS {
                    continue;
                }
                let aside = |steps: isize| (quarters * steps + QUARTERS / 2).div_euclid(QUARTERS);
                let [a, b] = &mut self.sums;
                let (mut from, mut to) = (&mut self.pairs, a);
                let mut spare = Some(b);
                for k in 0..DOUBLINGS - 1 {
                    let steps = 1 << k;
                    add_shifted(from, steps * along + aside(steps) * across, to);
                    match spare.take() {
                        // The pairs are needed again.
                        Some(second) => (from, to) = (to, second),
                        None => std::mem::swap(&mut from, &mut to),
                    }
                }
                let half = LENGTH as isize / 2;
                let middle = half * along + aside(half) * across;
                // The cell may be either one of its pair.
                raise(from, middle, 0, &mut self.most);
                raise(from, middle, across as usize, &mut self.most);
            }
        }
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
/// lies on one side only, like a shadow, is no line through it. The cell lies `aside` from the first of the half behind.
#[inline(always)]
fn raise(halves: &[u8], half: isize, aside: usize, most: &mut [u8]) {
    let n = halves.len() - half.unsigned_abs() - aside;
    let (before, behind) = ((-half).max(0) as usize, half.max(0) as usize);
    let middle = &mut most[behind + aside..][..n];
    for (most, (a, b)) in middle
        .iter_mut()
        .zip(halves[before..][..n].iter().zip(&halves[behind..][..n]))
    {
        *most = (*most).max(2 * *a.min(b));
    }
}
