//! Stage 3: connected pieces of surface, as runs of pixels.

use crate::scratch::Kept;

/// Pixels `first..=last` of one row.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    pub row: usize,
    pub first: usize,
    pub last: usize,
}

/// One connected piece (4-neighbourhood), runs in row order.
#[derive(Debug, Clone, Default)]
pub struct Component {
    pub runs: Vec<Run>,
    pub pixels: usize,
}

/// All pieces of a mask that have at least so many pixels, in order of their first one.
pub fn components(mask: &[u8], width: usize, least_pixels: usize) -> Vec<Component> {
    let mut runs: Kept<Run> = Kept::with_capacity(8192);
    for (row, line) in mask.chunks_exact(width).enumerate() {
        let mut u = 0;
        while let Some(offset) = first_not::<0>(&line[u..]) {
            let first = u + offset;
            let length = first_not::<1>(&line[first..]).unwrap_or(width - first);
            runs.push(Run {
                row,
                first,
                last: first + length - 1,
            });
            u = first + length;
        }
    }
    connected(&runs, least_pixels)
}

/// All pieces that runs in order make, of those with at least so many pixels, in order of their first one.
pub fn connected(runs: &[Run], least_pixels: usize) -> Vec<Component> {
    let mut parent: Kept<usize> = Kept::with_capacity(runs.len());
    parent.extend(0..runs.len());
    let mut above = 0..0;
    for line in runs.chunk_by(|a, b| a.row == b.row) {
        let here = above.end..above.end + line.len();
        let mut upper = above.start;
        for lower in here.clone() {
            let run = runs[lower];
            while upper < above.end
                && (runs[upper].row + 1 < run.row || runs[upper].last < run.first)
            {
                upper += 1;
            }
            let mut touching = upper;
            while touching < above.end && runs[touching].first <= run.last {
                let (a, b) = (root(&mut parent, touching), root(&mut parent, lower));
                parent[a.max(b)] = a.min(b);
                touching += 1;
            }
        }
        above = here;
    }
    // Pixels and runs of each piece, at its first run.
    let mut sizes = vec![[0u32; 2]; runs.len()];
    for (i, run) in runs.iter().enumerate() {
        // No run has a parent behind it, and all before are done.
        let first = parent[parent[i]];
        parent[i] = first;
        sizes[first][0] += (run.last - run.first + 1) as u32;
        sizes[first][1] += 1;
    }
    let mut found: Vec<Component> = Vec::new();
    for (i, &run) in runs.iter().enumerate() {
        let first = parent[i];
        let [pixels, count] = sizes[first];
        if (pixels as usize) < least_pixels {
            continue;
        }
        if first == i {
            // From now on where it stands among those found.
            sizes[i][1] = found.len() as u32;
            found.push(Component {
                runs: Vec::with_capacity(count as usize),
                pixels: pixels as usize,
            });
        }
        found[sizes[first][1] as usize].runs.push(run);
    }
    found
}

/// Where a line of bytes first differs from `SAME`, sixteen at a time.
fn first_not<const SAME: u8>(line: &[u8]) -> Option<usize> {
    let (chunks, rest) = line.as_chunks::<16>();
    let skipped = chunks
        .iter()
        .position(|chunk| *chunk != [SAME; 16])
        .unwrap_or(chunks.len());
    let from = 16 * skipped;
    if let Some(chunk) = chunks.get(skipped) {
        let differing = u128::from_le_bytes(*chunk) ^ u128::from_le_bytes([SAME; 16]);
        return Some(from + differing.trailing_zeros() as usize / 8);
    }
    rest.iter().position(|&b| b != SAME).map(|k| from + k)
}

/// Calls `found` with each place at which one line of zeros and ones holds 0 and the other one, where there is one,
/// holds 1; sixteen at a time.
pub fn each_zero(line: &[u8], other: Option<&[u8]>, mut found: impl FnMut(usize)) {
    let Some(last) = line.len().checked_sub(16) else {
        for (k, &byte) in line.iter().enumerate() {
            if byte == 0 && other.is_none_or(|other| other[k] == 1) {
                found(k);
            }
        }
        return;
    };
    let sixteen = |line: &[u8], from: usize| {
        line[from..]
            .first_chunk()
            .map_or(0, |bytes| u128::from_le_bytes(*bytes))
    };
    let mut next = 0;
    while next < line.len() {
        // At the end some of them were looked at before.
        let from = next.min(last);
        let mut zeros = sixteen(line, from) ^ u128::from_le_bytes([1; 16]);
        if zeros != 0 {
            if let Some(other) = other {
                zeros &= sixteen(other, from);
            }
            zeros &= u128::MAX << (8 * (next - from));
            while zeros != 0 {
                found(from + zeros.trailing_zeros() as usize / 8);
                zeros &= zeros - 1;
            }
        }
        next = from + 16;
    }
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(row: usize, first: usize, last: usize) -> Run {
        Run { row, first, last }
    }

    #[test]
    fn runs_of_neighbouring_rows_that_overlap_are_one_piece() {
        // Two arms of a U, then one two rows below, and one that only touches by its corner.
        let runs = [
            run(0, 0, 3),
            run(0, 6, 9),
            run(1, 2, 7),
            run(3, 2, 7),
            run(4, 8, 9),
        ];
        let found = connected(&runs, 1);
        let sizes: Vec<usize> = found.iter().map(|c| c.pixels).collect();
        assert_eq!(sizes, [14, 6, 2]);
        assert_eq!(connected(&runs, 3).len(), 2);
    }

    #[test]
    fn zeros_are_found_once_each_wherever_they_lie() {
        for length in [0, 5, 16, 17, 31, 32, 45] {
            let line: Vec<u8> = (0..length).map(|k| u8::from(k % 5 != 1)).collect();
            let other: Vec<u8> = (0..length).map(|k| u8::from(k % 3 != 0)).collect();
            let (mut all, mut some) = (Vec::new(), Vec::new());
            each_zero(&line, None, |k| all.push(k));
            each_zero(&line, Some(&other), |k| some.push(k));
            let expected: Vec<usize> = (0..length).filter(|k| k % 5 == 1).collect();
            assert_eq!(all, expected, "{length}");
            let expected: Vec<usize> = expected.into_iter().filter(|k| k % 3 != 0).collect();
            assert_eq!(some, expected, "{length}");
        }
    }
}
