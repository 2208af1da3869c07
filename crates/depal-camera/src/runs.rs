//! Neighbours of the same value.

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
