//! Pieces of rows whose length the compiler knows: loops over them need no rest.

use crate::raster::TILE;

/// A tile and one more value on each side.
pub(crate) const WIDE: usize = TILE + 2;

/// All bits where a condition holds.
#[inline(always)]
pub(crate) fn mask(holds: bool) -> u32 {
    u32::from(holds).wrapping_neg()
}

/// `yes` where the mask is set, `no` elsewhere. Of an `if` around what is stored the compiler makes jumps,
/// pixel by pixel.
#[inline(always)]
pub(crate) fn choose(mask: u32, yes: u32, no: u32) -> u32 {
    no ^ ((yes ^ no) & mask)
}

/// How many values at the start of a row are the same.
#[inline(always)]
pub(crate) fn run_length(row: &[u32]) -> usize {
    let first = row[0];
    let (chunks, rest) = row.as_chunks::<16>();
    let mut length = 0;
    for chunk in chunks {
        let different = chunk.iter().fold(0, |d, s| d | (s ^ first));
        if different != 0 {
            return length + chunk.iter().take_while(|s| **s == first).count();
        }
        length += 16;
    }
    length + rest.iter().take_while(|s| **s == first).count()
}

/// The values of a tile, all of which are there.
#[inline(always)]
pub(crate) fn chunk<T>(row: &[T], from: usize) -> &[T; TILE] {
    row[from..]
        .first_chunk()
        .expect("rows are as long as their tiles")
}

/// The same, to be written to.
#[inline(always)]
pub(crate) fn chunk_mut<T>(row: &mut [T], from: usize) -> &mut [T; TILE] {
    row[from..]
        .first_chunk_mut()
        .expect("rows are as long as their tiles")
}

/// The values of a tile; `other` behind the row's end.
#[inline(always)]
pub(crate) fn chunk_or<T: Copy>(row: &[T], from: usize, other: T) -> [T; TILE] {
    if let Some(values) = row[from..].first_chunk() {
        return *values;
    }
    let mut values = [other; TILE];
    for (to, value) in values.iter_mut().zip(&row[from..]) {
        *to = *value;
    }
    values
}

/// A tile's values and one more on each side. Beside the row its ends go on: then they are put together
/// in `spare`.
#[inline(always)]
pub(crate) fn wide<'a, T: Copy>(
    row: &'a [T],
    from: usize,
    spare: &'a mut [T; WIDE],
) -> &'a [T; WIDE] {
    if from > 0
        && let Some(values) = row[from - 1..].first_chunk()
    {
        return values;
    }
    for (k, value) in spare.iter_mut().enumerate() {
        *value = row[(from + k).clamp(1, row.len()) - 1];
    }
    spare
}
