//! Stage 6b: sums over rows of cells, made row after row.

use crate::scratch::Kept;

/// Weight of an edge cell that lies exactly on the line; one cell beside it counts 3, two count 1.
pub const FULL: u16 = 4;

/// Weight of five cells across a line, the middle one on it.
#[inline(always)]
fn weight(cells: [u8; 5]) -> u8 {
    let full = cells[2] * FULL as u8;
    let near = (cells[1] | cells[3]) * 3;
    full.max(near).max(cells[0] | cells[4])
}

/// Weights of a line of cells; five rows of edge cells lie across it.
#[inline(always)]
fn weigh(edge: [&[u8]; 5], weights: &mut [u8]) {
    let count = weights.len();
    let edge = edge.map(|row| &row[..count]);
    for (i, w) in weights.iter_mut().enumerate() {
        *w = weight([edge[0][i], edge[1][i], edge[2][i], edge[3][i], edge[4][i]]);
    }
}

/// Cells on both sides of a line that count as edge on it.
pub const AROUND: usize = 2;

/// The sums over edge cells, row after row.
pub struct EdgeSums {
    columns: usize,
    /// The last five rows of edge cells, in turn, each with a margin at both ends.
    last: [Vec<u8>; 2 * AROUND + 1],
    weights: Vec<u8>,
    nothing: Vec<u16>,
    /// Edge weight of vertical lines, summed over the rows below; wraps around.
    pub vertical: Kept<u16>,
    /// Edge weight of horizontal lines, summed over the columns to the left; wraps around.
    pub horizontal: Kept<u16>,
}

impl EdgeSums {
    #[inline(always)]
    pub fn new(columns: usize, rows: usize) -> Self {
        // All but the first row and column is written by and by.
        let mut vertical = Kept::of_any(columns * (rows + 1), 0);
        vertical[..columns].fill(0);
        Self {
            columns,
            last: std::array::from_fn(|_| vec![0; columns + 2 * AROUND]),
            weights: vec![0; columns],
            nothing: vec![0; columns],
            vertical,
            horizontal: Kept::of_any((columns + 1) * rows, 0),
        }
    }

    /// Where the edge cells of row `j` are put, after those of all rows before.
    #[inline(always)]
    pub fn row(&mut self, j: usize) -> &mut [u8] {
        let place = j % self.last.len();
        &mut self.last[place][AROUND..AROUND + self.columns]
    }

    /// Sums up row `j`, once the two rows behind it are put.
    #[inline(always)]
    pub fn sum(&mut self, j: usize) {
        let columns = self.columns;
        let here = &self.last[j % self.last.len()];
        let across: [&[u8]; 5] = std::array::from_fn(|k| &here[k..k + columns]);
        weigh(across, &mut self.weights);
        let (before, next) = row_and_next(&mut self.vertical, j, columns);
        for ((sum, &before), &w) in next.iter_mut().zip(before).zip(&self.weights) {
            *sum = before.wrapping_add(u16::from(w));
        }
        // From two rows before to two behind.
        let around: [&[u8]; 5] = std::array::from_fn(|k| {
            let row = &self.last[(j + k + 1 + AROUND) % self.last.len()];
            &row[AROUND..AROUND + columns]
        });
        weigh(around, &mut self.weights);
        let row = &mut self.horizontal[j * (columns + 1)..(j + 1) * (columns + 1)];
        row[0] = 0;
        // The rows are summed up each by itself: of the one before nothing is needed.
        sums_along(&self.weights, &self.nothing, &mut row[1..], |sum, _| {
            sum as u16
        });
    }
}

/// Puts to each place what `put` makes of the sum of the cells up to there and of what stands there in the row before.
/// Cells are at most 31, so that eight of them, summed up by one multiplication, stay below 256.
#[inline(always)]
pub fn sums_along<T: Copy>(
    cells: &[u8],
    before: &[T],
    totals: &mut [T],
    put: impl Fn(u32, T) -> T,
) {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let (chunks, rest) = cells.as_chunks::<8>();
    let (places, last) = totals.split_at_mut(8 * chunks.len());
    let (earlier, last_earlier) = before.split_at(8 * chunks.len());
    let mut sum = 0u32;
    for ((chunk, places), earlier) in chunks
        .iter()
        .zip(places.as_chunks_mut::<8>().0)
        .zip(earlier.as_chunks::<8>().0)
    {
        // Byte k of the product is the sum of bytes 0 to k.
        let sums = u64::from_le_bytes(*chunk).wrapping_mul(ONES).to_le_bytes();
        *places = std::array::from_fn(|k| put(sum + u32::from(sums[k]), earlier[k]));
        sum += u32::from(sums[7]);
    }
    for ((place, &before), &cell) in last.iter_mut().zip(last_earlier).zip(rest) {
        sum += u32::from(cell);
        *place = put(sum, before);
    }
}

/// Row `j` of a list of rows, and the one after it to be written.
#[inline(always)]
pub fn row_and_next<T>(rows: &mut [T], j: usize, width: usize) -> (&[T], &mut [T]) {
    let (before, next) = rows[j * width..(j + 2) * width].split_at_mut(width);
    (before, next)
}
