//! Stage 3: connected pieces of surface, as runs of pixels.

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

/// All pieces of a mask in order of their first pixel.
pub fn components(mask: &[u8], width: usize) -> Vec<Component> {
    let mut runs: Vec<Run> = Vec::new();
    let mut parent: Vec<usize> = Vec::new();
    let mut above = 0..0;
    for (row, line) in mask.chunks_exact(width).enumerate() {
        let start = runs.len();
        let mut u = 0;
        while let Some(offset) = first_not::<0>(&line[u..]) {
            let first = u + offset;
            let length = first_not::<1>(&line[first..]).unwrap_or(width - first);
            parent.push(runs.len());
            runs.push(Run {
                row,
                first,
                last: first + length - 1,
            });
            u = first + length;
        }
        let mut upper = above.start;
        for lower in start..runs.len() {
            while upper < above.end && runs[upper].last < runs[lower].first {
                upper += 1;
            }
            let mut touching = upper;
            while touching < above.end && runs[touching].first <= runs[lower].last {
                let (a, b) = (root(&mut parent, touching), root(&mut parent, lower));
                parent[a.max(b)] = a.min(b);
                touching += 1;
            }
        }
        above = start..runs.len();
    }
    let mut slot = vec![usize::MAX; runs.len()];
    let mut found: Vec<Component> = Vec::new();
    for (i, &run) in runs.iter().enumerate() {
        let r = root(&mut parent, i);
        if slot[r] == usize::MAX {
            slot[r] = found.len();
            found.push(Component::default());
        }
        let component = &mut found[slot[r]];
        component.pixels += run.last - run.first + 1;
        component.runs.push(run);
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
    let tail = if skipped < chunks.len() {
        &chunks[skipped][..]
    } else {
        rest
    };
    tail.iter().position(|&b| b != SAME).map(|k| from + k)
}

/// Calls `found` with the place of each zero in a line of zeros and ones, sixteen at a time.
pub fn each_zero(line: &[u8], mut found: impl FnMut(usize)) {
    let (chunks, rest) = line.as_chunks::<16>();
    let places = chunks
        .iter()
        .enumerate()
        .filter(|(_, chunk)| **chunk != [1; 16])
        .map(|(n, chunk)| (16 * n, &chunk[..]))
        .chain(std::iter::once((16 * chunks.len(), rest)));
    for (from, bytes) in places {
        for (k, _) in bytes.iter().enumerate().filter(|(_, b)| **b == 0) {
            found(from + k);
        }
    }
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}
