//! Stage 7b: surfaces on which gaps are too small to be seen are covered exactly by known sizes.

use depal_frames::BoxSize;

use crate::{
    gate::DepthImage,
    ink::dark_sides,
    patch::{BLOCK, Patch},
    relief::Relief,
    search::{Candidate, climb, extents, has_seam, measure},
};

/// Placements tried before giving up: far more than any sensible layer needs.
const MOST_TRIES: usize = 4000;
/// Readings compared before deciding.
const MOST_READINGS: usize = 16;
/// A reading is out of the question when its cartons are less plane than those of the best one by this
/// share, and by this many times the mean of a block.
const WORSE_SHARE: f64 = 0.01;
const WORSE_BLOCKS: f64 = 30.0;
/// Each carton more explains so many means of a block of noise, for its plane fits that as well.
const OVERFIT_BLOCKS: f64 = 20.0;
/// A carton may be as uneven as this share of the plane tolerance: 0.13 mm by default.
const UNEVEN: f64 = 1.0 / 30.0;
/// And as this multiple of the noise says.
const MOST_NOISE: f64 = 1.5;
/// A reading must beat every different one by this much edge per box, else it is ambiguous.
const CLEAR_LEAD: f64 = 0.05;
/// The same where heights say nothing: which outer sides a box has is no reason, seams between are.
const CLEAR_LEAD_WHEN_LEVEL: f64 = 0.3;
/// One plane must explain a surface worse by this factor than its cartons do, else it is level.
const UNLEVEL: f64 = 1.3;
/// Fewer cartons than this without a seam between them are doubtful.
const LEAST_WITHOUT_SEAM: usize = 3;

/// Share of edge from which a side between two boxes counts as a seam.
const SEEN_SEAM: f64 = 0.1;
/// Where gaps measure this much (lost pixels at their rims included), all gaps can be seen, metres.
const WIDE_GAP: f64 = 0.0035;
/// The same in cells: one for a gap that fills a pixel, 0.4 lost at each rim, and noise.
const WIDE_GAP_CELLS: f64 = 2.2;

/// Share of dark line from which on it is one.
const LEAST_LINE: f64 = 0.6;
/// A reading of whose inner sides so many show a seam needs no other proof.
const MOST_SEAMS: f64 = 0.7;

/// What covers a surface.
pub struct Arrangement {
    /// The new boxes (those given as fixed are not repeated).
    pub boxes: Vec<Candidate>,
    /// Other coverings explain the surface equally well; `boxes` is what all of them share.
    pub ambiguous: bool,
    /// The heights show that this is more than one plane, or no other reading fits the outline.
    pub unique: bool,
}

/// Covers what `fixed` leaves uncovered. `None` when the known sizes cannot cover it. `beside`: the
/// sizes that stand proven beside the patch.
pub fn arrange(
    patch: &Patch,
    tolerance: f64,
    sizes: &[BoxSize],
    fixed: &[Candidate],
    beside: &[u32],
    image: &DepthImage,
) -> Option<Arrangement> {
    let mut search = Cover {
        patch,
        sizes,
        blocks: surface_blocks(patch),
        relief: Relief::new(patch),
        tries: 0,
        least: None,
        readings: Vec::new(),
    };
    let mut placed = fixed.to_vec();
    search.descend(&mut placed, 0, Misfit::default());
    if search.tries >= MOST_TRIES {
        return None;
    }
    let least = search.least?;
    // Even the best reading leaves steps in the middle of cartons: the right one is not among them.
    let uneven = tolerance * UNEVEN;
    let noise = lags(patch).iter().map(|&lag| search.relief.noise(lag));
    let most = MOST_NOISE * noise.fold(0.0, f64::max) + uneven * uneven;
    if least.squares > most * least.blocks as f64 {
        return None;
    }
    let best_fitting = &search.readings.first()?.1;
    let (squares, count) = search.relief.misfit(best_fitting);
    let mean = least.squares / least.blocks.max(1) as f64;
    let level = squares < UNLEVEL * mean * count as f64;
    let lead = if level {
        CLEAR_LEAD_WHEN_LEVEL
    } else {
        CLEAR_LEAD
    };
    let mut unique = !level || search.readings.len() == 1;
    let mut readings: Vec<Vec<Candidate>> = search
        .readings
        .into_iter()
        .filter(|(misfit, _)| !least.rules_out(misfit))
        .map(|(_, r)| r[fixed.len()..].to_vec())
        .filter(|r| !r.is_empty())
        .collect();
    // Lines in the intensity image are seams as well.
    let mut lined: Vec<(Candidate, [f64; 4])> = Vec::new();
    for b in readings.iter_mut().flatten() {
        let same =
            |known: &&(Candidate, [f64; 4])| known.0.first == b.first && known.0.cells == b.cells;
        let dark = if let Some(known) = lined.iter().find(same) {
            known.1
        } else {
            let dark = dark_sides(patch, image, b);
            lined.push((*b, dark));
            dark
        };
        for (side, dark) in b.sides.iter_mut().zip(dark) {
            if dark >= LEAST_LINE {
                *side = side.max(dark);
            }
        }
    }
    readings.sort_by(|a, b| merit(b).total_cmp(&merit(a)));
    let best = readings.first()?.clone();
    unique |= seams_seen(&best, patch.pitch) >= MOST_SEAMS;
    let rivals: Vec<&Vec<Candidate>> = readings[1..]
        .iter()
        .filter(|r| merit(r) > merit(&best) - lead && !same(&best, r))
        .collect();
    if !rivals.is_empty() {
        // A level sheet can be covered in several ways, of which only some were tried: no proof.
        let shared = best
            .iter()
            .filter(|_| !level)
            .filter(|b| rivals.iter().all(|r| r.iter().any(|o| alike(b, o))))
            .copied()
            .collect();
        return Some(Arrangement {
            boxes: shared,
            ambiguous: true,
            unique: false,
        });
    }
    // Cartons joined without any seam seen may as well be one larger carton, unless one of that
    // size stands proven beside them, or there are many of them and the gaps that are seen are so
    // narrow that others may well be invisible.
    let islands = islands(&best, patch.pitch);
    let narrow = widest_gap(patch, &best) < WIDE_GAP.max(WIDE_GAP_CELLS * patch.pitch);
    let believable = |b: usize| {
        let together = islands.iter().filter(|&&i| i == islands[b]).count();
        together == 1
            || narrow && best.len() >= LEAST_WITHOUT_SEAM
            || fixed.iter().any(|f| f.label == best[b].label)
            || beside.contains(&best[b].label)
    };
    let kept: Vec<Candidate> = (0..best.len())
        .filter(|&b| believable(b))
        .map(|b| best[b])
        .collect();
    if kept.len() < best.len() {
        return Some(Arrangement {
            boxes: kept,
            ambiguous: true,
            unique: false,
        });
    }
    Some(Arrangement {
        boxes: best,
        ambiguous: false,
        unique,
    })
}

/// Middles of the blocks that are surface, row by row.
fn surface_blocks(patch: &Patch) -> Vec<[usize; 2]> {
    let (bx, by) = (patch.columns / BLOCK, patch.rows / BLOCK);
    let mut blocks = Vec::new();
    for j in 0..by {
        for i in 0..bx {
            let (i0, j0) = ((i * BLOCK) as isize, (j * BLOCK) as isize);
            if patch.surface(i0, j0, i0 + BLOCK as isize, j0 + BLOCK as isize) > 0.9 {
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

/// Distances in blocks over which noise is measured: that of a camera that smears goes on over many pixels.
fn lags(patch: &Patch) -> &'static [usize] {
    if patch.is_smeared() { &[1, 2, 4] } else { &[1] }
}

/// Mean edge seen per box.
fn merit(boxes: &[Candidate]) -> f64 {
    boxes
        .iter()
        .map(|b| b.sides.iter().sum::<f64>())
        .sum::<f64>()
        / boxes.len().max(1) as f64
}

fn alike(a: &Candidate, b: &Candidate) -> bool {
    a.label == b.label
        && a.turned == b.turned
        && (0..2).all(|k| a.first[k].abs_diff(b.first[k]) <= 6)
}

fn same(a: &[Candidate], b: &[Candidate]) -> bool {
    a.len() == b.len() && a.iter().all(|x| b.iter().any(|y| alike(x, y)))
}

/// Share of the sides between two boxes that show a seam; 0 where no two touch.
fn seams_seen(boxes: &[Candidate], pitch: f64) -> f64 {
    let (mut inner, mut seen) = (0, 0);
    for a in boxes {
        for side in 0..4 {
            let meets = |b: &Candidate| b.first != a.first && touches(a, b, side, pitch);
            if boxes.iter().any(meets) {
                inner += 1;
                seen += usize::from(a.sides[side] >= LEAST_LINE);
            }
        }
    }
    seen as f64 / f64::from(inner.max(1))
}

/// The widest measured gap between two neighbours, metres; 0 when no two have a seam seen.
fn widest_gap(patch: &Patch, boxes: &[Candidate]) -> f64 {
    const BESIDE: isize = 3;
    let mut widest = 0.0f64;
    for a in boxes {
        for b in boxes {
            for side in [1, 3] {
                if !touches(a, b, side, patch.pitch) || a.sides[side] < SEEN_SEAM {
                    continue;
                }
                let (axis, across) = (side / 2, 1 - side / 2);
                let from = (a.first[axis] + a.cells[axis]) as isize - BESIDE;
                let to = b.first[axis] as isize + BESIDE;
                let low = a.first[across].max(b.first[across]) as isize;
                let high = (a.first[across] + a.cells[across])
                    .min(b.first[across] + b.cells[across]) as isize;
                let surface = if axis == 0 {
                    patch.surface(from, low, to, high)
                } else {
                    patch.surface(low, from, high, to)
                };
                widest = widest.max((1.0 - surface) * (to - from) as f64 * patch.pitch);
            }
        }
    }
    widest
}

/// For each box the lowest index among the boxes it hangs together with, without a seam between.
fn islands(boxes: &[Candidate], pitch: f64) -> Vec<usize> {
    let mut island: Vec<usize> = (0..boxes.len()).collect();
    for _ in 0..boxes.len() {
        for a in 0..boxes.len() {
            for b in 0..boxes.len() {
                let joined = a != b
                    && (0..4).any(|side| {
                        touches(&boxes[a], &boxes[b], side, pitch)
                            && boxes[a].sides[side] < SEEN_SEAM
                    });
                if joined {
                    let low = island[a].min(island[b]);
                    island[a] = low;
                    island[b] = low;
                }
            }
        }
    }
    island
}

/// True when `other` lies directly beyond side `side` (-X, +X, -Y, +Y) of `b`, within 10 mm, along
/// at least a third of it.
pub fn touches(b: &Candidate, other: &Candidate, side: usize, pitch: f64) -> bool {
    let axis = side / 2;
    let reach = (0.010 / pitch).ceil() as isize;
    let (first, last) = (
        b.first[axis] as isize,
        (b.first[axis] + b.cells[axis]) as isize,
    );
    let (other_first, other_last) = (
        other.first[axis] as isize,
        (other.first[axis] + other.cells[axis]) as isize,
    );
    let distance = if side.is_multiple_of(2) {
        first - other_last
    } else {
        other_first - last
    };
    let across = 1 - axis;
    let low = b.first[across].max(other.first[across]);
    let high = (b.first[across] + b.cells[across]).min(other.first[across] + other.cells[across]);
    distance.abs() <= reach
        && high.saturating_sub(low) * 3 >= b.cells[across].min(other.cells[across])
}

/// How little plane the cartons of a reading are.
#[derive(Debug, Clone, Copy, Default)]
struct Misfit {
    squares: f64,
    blocks: usize,
    cartons: usize,
}

impl Misfit {
    /// True when another reading, or the part of one, is out of the question beside this one.
    fn rules_out(&self, other: &Self) -> bool {
        let mean = self.squares / self.blocks.max(1) as f64;
        let fewer = self.cartons as f64 - other.cartons as f64;
        let limit = self.squares * (1.0 + WORSE_SHARE)
            + (WORSE_BLOCKS + OVERFIT_BLOCKS * fewer.max(0.0)) * mean;
        other.squares > limit
    }
}

struct Cover<'a> {
    patch: &'a Patch,
    sizes: &'a [BoxSize],
    blocks: Vec<[usize; 2]>,
    relief: Relief,
    tries: usize,
    /// The best complete reading so far.
    least: Option<Misfit>,
    readings: Vec<(Misfit, Vec<Candidate>)>,
}

impl Cover<'_> {
    /// `from`: all blocks before it are covered. The first uncovered block (lowest row, then
    /// column) holds the low corner of some box. The most plane box is tried first.
    fn descend(&mut self, placed: &mut Vec<Candidate>, from: usize, misfit: Misfit) {
        if self.tries >= MOST_TRIES || self.least.is_some_and(|l| l.rules_out(&misfit)) {
            return;
        }
        let Some(next) = (from..self.blocks.len()).find(|&b| !is_covered(&self.blocks[b], placed))
        else {
            if self.least.is_none_or(|l| misfit.squares < l.squares) {
                self.least = Some(misfit);
            }
            self.readings.push((misfit, placed.clone()));
            self.readings
                .sort_by(|a, b| a.0.squares.total_cmp(&b.0.squares));
            self.readings.truncate(MOST_READINGS);
            return;
        };
        let corner = self.corner(self.blocks[next], placed);
        let mut options: Vec<(Misfit, Candidate)> = Vec::new();
        for label in 0..self.sizes.len() {
            for turned in [false, true] {
                let size = &self.sizes[label];
                if turned && size.length - size.width < self.patch.pitch {
                    continue;
                }
                let cells = extents(size, turned).map(|s| (s / self.patch.pitch).round() as usize);
                if cells.iter().any(|&n| n < 24) {
                    continue;
                }
                self.tries += 1;
                if let Some(candidate) = self.place(corner, label as u32, turned, cells, placed) {
                    let (squares, blocks) = self.relief.misfit(&[candidate]);
                    let alone = Misfit {
                        squares,
                        blocks,
                        cartons: 1,
                    };
                    options.push((alone, candidate));
                }
            }
        }
        let mean = |m: &Misfit| m.squares / m.blocks.max(1) as f64;
        options.sort_by(|a, b| mean(&a.0).total_cmp(&mean(&b.0)));
        for (more, candidate) in options {
            placed.push(candidate);
            let together = Misfit {
                squares: misfit.squares + more.squares,
                blocks: misfit.blocks + more.blocks,
                cartons: misfit.cartons + more.cartons,
            };
            self.descend(placed, next, together);
            placed.pop();
        }
    }

    /// The low corner of the box that holds a block: down and left until the surface or the free
    /// space ends.
    fn corner(&self, block: [usize; 2], placed: &[Candidate]) -> [usize; 2] {
        let taken = |i: isize, j: isize| {
            placed.iter().any(|p| {
                let inside = |k: usize, v: isize| {
                    v >= p.first[k] as isize && v < (p.first[k] + p.cells[k]) as isize
                };
                inside(0, i) && inside(1, j)
            })
        };
        let (mut i, mut j) = (block[0] as isize, block[1] as isize);
        while i > 0
            && !taken(i - 1, block[1] as isize)
            && self.patch.surface(i - 1, j - 2, i, j + 3) > 0.5
        {
            i -= 1;
        }
        let column = block[0] as isize;
        while j > 0
            && !taken(column, j - 1)
            && self.patch.surface(column - 2, j - 1, column + 3, j) > 0.5
        {
            j -= 1;
        }
        [i as usize, j as usize]
    }

    fn place(
        &self,
        corner: [usize; 2],
        label: u32,
        turned: bool,
        cells: [usize; 2],
        placed: &[Candidate],
    ) -> Option<Candidate> {
        const WHOLE: f64 = 0.96;
        // Well above what lone holes add to a line, or a row of boxes would drift with the noise.
        const LEAST_GAIN: f64 = 0.04;
        let exact = measure(self.patch, label, turned, corner, cells, WHOLE);
        // The corner may be a cell or two off; edges that are seen settle it.
        let start = exact.or_else(|| {
            let inward = corner.map(|c| c + 1);
            measure(self.patch, label, turned, inward, cells, WHOLE)
        })?;
        let moved = climb(self.patch, start, WHOLE, LEAST_GAIN);
        let near = (0..2).all(|k| moved.first[k].abs_diff(start.first[k]) <= 4);
        let candidate = if near && moved.score > start.score + 0.15 {
            moved
        } else {
            start
        };
        let clear = placed
            .iter()
            .all(|p| p.overlap(&candidate) < 0.04 && candidate.overlap(p) < 0.04);
        (clear && !has_seam(self.patch, &candidate)).then_some(candidate)
    }
}
