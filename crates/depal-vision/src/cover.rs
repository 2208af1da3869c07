//! Coverings of a surface by cartons of the known sizes, found by trying, the most plane carton first.

use std::collections::BTreeMap;

use depal_frames::BoxSize;

use crate::{
    breaks::Breaks,
    misfit::{Misfit, OVERFIT_BLOCKS, WORSE_BLOCKS, WORSE_SHARE, apart},
    parts::is_part,
    patch::{BLOCK, Patch},
    relief::Relief,
    search::{Candidate, climb, extents, has_seam, measure},
};

/// Placements tried before giving up: far more than any sensible layer needs.
const MOST_TRIES: usize = 20_000;
/// The same for cartons of several sizes, for which a layer of thirty needs a hundred: more mean that it can be read in
/// too many ways.
const MOST_TRIES_MIXED: usize = 2_000;
/// Readings compared before deciding.
const MOST_READINGS: usize = 16;
/// While only a part is covered: a covering that is so far worse than the best one on the same blocks by so many
/// means of a block will not make up for it.
const HOPELESS_BLOCKS: f64 = 90.0;

/// The coverings that come into question.
pub struct Covering {
    /// The one whose cartons are the most plane.
    pub least: Misfit,
    /// Each with the boxes given as fixed first; the most plane one first, those out of the question left out.
    pub readings: Vec<Vec<Candidate>>,
}

/// Covers what `fixed` leaves uncovered; `None` when the known sizes cannot, or in too many ways.
/// `uneven`: height breaks by more than that (metres) part two cartons; `None`: cartons may have them.
pub fn cover(
    patch: &Patch,
    sizes: &[BoxSize],
    fixed: &[Candidate],
    uneven: Option<f64>,
) -> Option<Covering> {
    let relief = patch.relief();
    let mut search = Search {
        patch,
        kinds: kinds(patch, sizes),
        mixed: sizes.len() > 1,
        blocks: surface_blocks(patch),
        noise: relief.noise(1),
        relief,
        known: BTreeMap::new(),
        tries: 0,
        uneven,
        least: None,
        expected: Vec::new(),
        readings: Vec::new(),
    };
    search.descend(&mut fixed.to_vec(), 0, Misfit::default(), 0.0);
    if search.tries >= search.most_tries() {
        return None;
    }
    let least = search.least?;
    Some(Covering {
        least,
        readings: search
            .readings
            .iter()
            .filter(|(_, reading)| {
                let [ours, theirs] = apart(search.relief, &search.readings[0].1, reading);
                !ours.rules_out(&theirs, &least, patch.lump)
            })
            .map(|(_, reading)| reading.clone())
            .collect(),
    })
}

/// Each size and way round that can be told from the pixels: label, turned, cells.
pub fn kinds(patch: &Patch, sizes: &[BoxSize]) -> Vec<(u32, bool, [usize; 2])> {
    let mut kinds = Vec::new();
    for (label, size) in sizes.iter().enumerate() {
        for turned in [false, true] {
            if turned && size.length - size.width < patch.pitch {
                continue;
            }
            let cells = extents(size, turned).map(|s| (s / patch.pitch).round() as usize);
            if cells.iter().all(|&n| n >= 24) {
                kinds.push((label as u32, turned, cells));
            }
        }
    }
    kinds
}

/// Middles of the blocks that are surface, row by row.
fn surface_blocks(patch: &Patch) -> Vec<[usize; 2]> {
    /// Cells of a block.
    const MOST_OF_IT: u32 = (BLOCK * BLOCK * 9 / 10) as u32;
    let (bx, by) = (patch.columns / BLOCK, patch.rows / BLOCK);
    let mut blocks = Vec::new();
    for j in 0..by {
        for i in 0..bx {
            if patch.surface_cells_of_block(i, j) > MOST_OF_IT {
                blocks.push([i * BLOCK + BLOCK / 2, j * BLOCK + BLOCK / 2]);
            }
        }
    }
    blocks
}

/// True when a block belongs to one of the boxes, or to its rim.
fn is_covered(block: &[usize; 2], boxes: &[Candidate]) -> bool {
    boxes.iter().any(|b| {
        (0..2).all(|k| block[k] + 5 >= b.first[k] && block[k] <= b.first[k] + b.cells[k] + 5)
    })
}

/// Area of the surface that no box covers, square metres.
pub fn uncovered(patch: &Patch, boxes: &[Candidate]) -> f64 {
    let open = surface_blocks(patch)
        .iter()
        .filter(|block| !is_covered(block, boxes))
        .count();
    (open * BLOCK * BLOCK) as f64 * patch.pitch * patch.pitch
}

struct Search<'a> {
    patch: &'a Patch,
    kinds: Vec<(u32, bool, [usize; 2])>,
    mixed: bool,
    blocks: Vec<[usize; 2]>,
    relief: &'a Relief,
    /// Variance of a block's height, square metres.
    noise: f64,
    /// What was found at a corner (column, row) for a kind, with how little plane it is.
    known: BTreeMap<(usize, usize, usize), Option<(Candidate, Misfit)>>,
    tries: usize,
    uneven: Option<f64>,
    /// The best complete covering so far.
    least: Option<Misfit>,
    /// Of that one: what each block adds to its misfit, summed over all blocks below and left.
    expected: Vec<f64>,
    readings: Vec<(Misfit, Vec<Candidate>)>,
}

impl Search<'_> {
    fn most_tries(&self) -> usize {
        if self.mixed {
            MOST_TRIES_MIXED
        } else {
            MOST_TRIES
        }
    }

    /// `from`: all blocks before it are covered. The first uncovered block (lowest row, then
    /// column) holds the low corner of some box. The most plane box is tried first. `excess`: how much
    /// less plane than the best covering this one is on the same blocks, square metres.
    fn descend(&mut self, placed: &mut Vec<Candidate>, from: usize, misfit: Misfit, excess: f64) {
        if self.tries >= self.most_tries() || self.is_hopeless(excess) {
            return;
        }
        let Some(next) = (from..self.blocks.len()).find(|&b| !is_covered(&self.blocks[b], placed))
        else {
            self.keep(misfit, placed);
            return;
        };
        let block = self.blocks[next];
        let mut options: Vec<(Candidate, Misfit)> = Vec::new();
        let corner = self.corner(block, placed);
        for kind in 0..self.kinds.len() {
            self.tries += 1;
            let key = (corner[0], corner[1], kind);
            let found = if let Some(known) = self.known.get(&key) {
                *known
            } else {
                let found = self.place(corner, kind).filter(|(candidate, _)| {
                    self.uneven.is_none_or(|uneven| {
                        !Breaks::new(self.relief, self.noise, uneven).within(candidate)
                    })
                });
                self.known.insert(key, found);
                found
            };
            options.extend(found.filter(|(candidate, _)| {
                placed
                    .iter()
                    .all(|p| p.overlap(candidate) < 0.04 && candidate.overlap(p) < 0.04)
            }));
        }
        // Where cartons are told apart by their heights, a part of one is none: each of n cartons that two smaller ones
        // would cover as well would double the number of readings.
        if self.uneven.is_some() && self.mixed {
            let all: Vec<Candidate> = options.iter().map(|(candidate, _)| *candidate).collect();
            let breaks = Breaks::new(self.relief, self.noise, 0.0);
            options.retain(|(part, _)| {
                !all.iter()
                    .any(|whole| is_part(part, whole) && breaks.is_one_plane(whole))
            });
        }
        options.sort_by(|a, b| a.1.mean().total_cmp(&b.1.mean()));
        // What the best covering has changes with every complete one: sums are taken anew.
        for (candidate, more) in options {
            let excess = match self.least {
                Some(_) => placed.iter().chain([&candidate]).fold(0.0, |sum, c| {
                    sum + self.relief.misfit(&[*c]).squares - self.expected_within(c)
                }),
                None => 0.0,
            };
            placed.push(candidate);
            let together = Misfit {
                squares: misfit.squares + more.squares,
                blocks: misfit.blocks + more.blocks,
                cartons: misfit.cartons + more.cartons,
            };
            self.descend(placed, next, together, excess);
            placed.pop();
        }
    }

    fn is_hopeless(&self, excess: f64) -> bool {
        self.least.is_some_and(|least| {
            let fewer = if self.mixed {
                OVERFIT_BLOCKS * least.cartons as f64
            } else {
                0.0
            };
            excess
                > least.squares * WORSE_SHARE
                    + (WORSE_BLOCKS + HOPELESS_BLOCKS + fewer) * least.mean() * self.patch.lump
        })
    }

    fn keep(&mut self, misfit: Misfit, placed: &[Candidate]) {
        let noise = self.noise;
        let price = |m: &Misfit| m.price(noise);
        if self.least.is_none_or(|l| price(&misfit) < price(&l)) {
            self.least = Some(misfit);
            self.expect(misfit.mean(), placed);
        }
        self.readings.push((misfit, placed.to_vec()));
        self.readings
            .sort_by(|a, b| price(&a.0).total_cmp(&price(&b.0)));
        self.readings.truncate(MOST_READINGS);
    }

    /// Remembers what each block adds to the misfit of a covering; `mean` where it crosses a side.
    fn expect(&mut self, mean: f64, placed: &[Candidate]) {
        let [columns, rows] = self.relief.size();
        let mut squares = vec![mean; columns * rows];
        for (at, square) in placed.iter().flat_map(|c| self.relief.residuals(c)) {
            squares[at] = square;
        }
        let mut sums = vec![0.0; (columns + 1) * (rows + 1)];
        for j in 0..rows {
            let mut row = 0.0;
            for i in 0..columns {
                row += squares[j * columns + i];
                sums[(j + 1) * (columns + 1) + i + 1] = sums[j * (columns + 1) + i + 1] + row;
            }
        }
        self.expected = sums;
    }

    fn expected_within(&self, candidate: &Candidate) -> f64 {
        let [i, j] = self.relief.blocks_of(candidate);
        let at = |i: usize, j: usize| self.expected[j * (self.relief.size()[0] + 1) + i];
        at(i.end, j.end) - at(i.start, j.end) - at(i.end, j.start) + at(i.start, j.start)
    }

    /// The low corner of the box that holds a block: down and left until the surface or the free
    /// space ends.
    fn corner(&self, block: [usize; 2], placed: &[Candidate]) -> [usize; 2] {
        let is_surface =
            |i0: isize, j0: isize, i1: isize, j1: isize| self.patch.surface(i0, j0, i1, j1) > 0.5;
        let taken = |i: isize, j: isize| {
            placed.iter().any(|p| {
                let inside = |k: usize, v: isize| {
                    v >= p.first[k] as isize && v < (p.first[k] + p.cells[k]) as isize
                };
                inside(0, i) && inside(1, j)
            })
        };
        let (mut i, mut j) = (block[0] as isize, block[1] as isize);
        while i > 0 && !taken(i - 1, block[1] as isize) && is_surface(i - 1, j - 2, i, j + 3) {
            i -= 1;
        }
        let column = block[0] as isize;
        while j > 0 && !taken(column, j - 1) && is_surface(column - 2, j - 1, column + 3, j) {
            j -= 1;
        }
        [i as usize, j as usize]
    }

    /// The best whole box of a kind at a corner, whatever else is placed.
    fn place(&self, corner: [usize; 2], kind: usize) -> Option<(Candidate, Misfit)> {
        const WHOLE: f64 = 0.96;
        // Well above what lone holes add to a line, or a row of boxes would drift with the noise.
        const LEAST_GAIN: f64 = 0.04;
        let (label, turned, cells) = self.kinds[kind];
        let exact = measure(self.patch, label, turned, corner, cells, WHOLE);
        // The corner may be a cell or two off; edges that are seen settle it.
        let whole = exact.or_else(|| {
            let inward = corner.map(|c| c + 1);
            measure(self.patch, label, turned, inward, cells, WHOLE)
        });
        let start = whole?;
        let moved = climb(self.patch, start, WHOLE, LEAST_GAIN);
        let near = (0..2).all(|k| moved.first[k].abs_diff(start.first[k]) <= 4);
        let candidate = if near && moved.score > start.score + 0.15 {
            moved
        } else {
            start
        };
        let alone = self.relief.misfit(&[candidate]);
        let misfit = Misfit {
            squares: alone.squares,
            blocks: alone.blocks,
            cartons: 1,
        };
        (!has_seam(self.patch, &candidate)).then_some((candidate, misfit))
    }
}
