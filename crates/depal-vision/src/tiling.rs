//! Ways to cover one height of a stack with whole cartons, where outlines are only roughly known.

use std::cmp::Reverse;

use depal_frames::BoxSize;

use crate::{
    level::{Cell, Level},
    search::extents,
    valleys::Valleys,
};

/// Placements tried for one start: layers of two dozen cartons need some hundred.
const MOST_TRIES: usize = 4_000;
/// Readings that are kept.
const MOST_READINGS: usize = 48;
/// Of a tile's inside so much may be deep: valleys that are too wide to be bridged.
const MOST_DEEP: f64 = 0.04;
/// So much of it must be seen,
const LEAST_ON: f64 = 0.3;
/// and from so much unknown on it counts as partly hidden.
const PARTLY_HIDDEN: f64 = 0.15;

/// A carton's top on a level.
#[derive(Debug, Clone, Copy)]
pub struct Tile {
    pub label: u32,
    /// True when the long side lies along the level's Y.
    pub turned: bool,
    /// Middle and half of the sides, metres along the level's axes.
    pub centre: [f64; 2],
    pub half: [f64; 2],
    /// Something nearer hides a part of it.
    pub hidden: bool,
}

impl Tile {
    pub fn low(&self, axis: usize) -> f64 {
        self.centre[axis] - self.half[axis]
    }

    pub fn high(&self, axis: usize) -> f64 {
        self.centre[axis] + self.half[axis]
    }

    /// True for a place inside, or up to `beyond` metres outside.
    pub fn holds(&self, place: [f64; 2], beyond: f64) -> bool {
        (0..2).all(|k| (place[k] - self.centre[k]).abs() <= self.half[k] + beyond)
    }

    /// True when both are the same carton.
    pub fn is_like(&self, other: &Self) -> bool {
        self.label == other.label
            && (0..2).all(|k| {
                let least = self.half[k].min(other.half[k]);
                (self.half[k] - other.half[k]).abs() < 1e-6
                    && (self.centre[k] - other.centre[k]).abs() < 0.35 * least
            })
    }
}

/// Searches coverings of one level.
struct Tiling<'a> {
    level: &'a Level,
    valleys: &'a Valleys<'a>,
    /// Label, turned, sides.
    kinds: Vec<(u32, bool, [f64; 2])>,
    /// How far off an outline may be, metres.
    slack: f64,
    /// By how much the outline seems to lie outside the real one, metres.
    fat: f64,
    /// Places well inside the surface that must be covered, row by row.
    seeds: Vec<[f64; 2]>,
    tries: usize,
    readings: Vec<Vec<Tile>>,
}

/// Where a walk along a row or a column of cells ended.
#[derive(Debug, Clone, Copy)]
struct End {
    at: f64,
    /// Beyond it nobody knows.
    hidden: bool,
}

/// What a search found.
pub struct Readings {
    pub readings: Vec<Vec<Tile>>,
    /// All were tried.
    pub complete: bool,
}

/// All ways, up to a number, to cover a level with tops of the sizes.
pub fn readings(
    level: &Level,
    valleys: &Valleys,
    sizes: &[BoxSize],
    slack: f64,
    fat: f64,
) -> Readings {
    let mut kinds = Vec::new();
    for (label, size) in sizes.iter().enumerate() {
        for turned in [false, true] {
            if !turned || size.length - size.width > 0.01 {
                kinds.push((label as u32, turned, extents(size, turned)));
            }
        }
    }
    let shortest = kinds.iter().map(|k| k.2[0].min(k.2[1])).fold(1.0, f64::min);
    let mut tiling = Tiling {
        level,
        valleys,
        kinds,
        slack,
        fat,
        seeds: seeds(level, shortest, slack + fat.max(0.0)),
        tries: 0,
        readings: Vec::new(),
    };
    if !tiling.seeds.is_empty() {
        tiling.descend(&mut Vec::new(), 0);
    }
    Readings {
        complete: tiling.tries < MOST_TRIES && tiling.readings.len() < MOST_READINGS,
        readings: tiling.readings,
    }
}

/// Places of a lattice around which all is surface.
fn seeds(level: &Level, shortest: f64, slack: f64) -> Vec<[f64; 2]> {
    const PER_SIDE: f64 = 8.0;
    const ALL: f64 = 0.95;
    let step = shortest / PER_SIDE;
    let [x, y] = [0, 1].map(|k| level.range(k));
    let around = slack.min(0.3 * shortest);
    let mut found = Vec::new();
    let count = |r: [f64; 2]| ((r[1] - r[0]) / step) as usize;
    for j in 0..count(y) {
        for i in 0..count(x) {
            let at = [
                x[0] + (i as f64 + 0.5) * step,
                y[0] + (j as f64 + 0.5) * step,
            ];
            let [on, _] = level.shares(at.map(|v| v - around), at.map(|v| v + around));
            if on > ALL {
                found.push(at);
            }
        }
    }
    found
}

impl Tiling<'_> {
    fn descend(&mut self, placed: &mut Vec<Tile>, from: usize) {
        if self.tries >= MOST_TRIES || self.readings.len() >= MOST_READINGS {
            return;
        }
        let open = |seed: &[f64; 2]| !placed.iter().any(|p| p.holds(*seed, 0.6 * self.slack));
        let Some(next) = (from..self.seeds.len()).find(|&s| open(&self.seeds[s])) else {
            let known = |r: &Vec<Tile>| {
                r.len() == placed.len() && placed.iter().all(|p| r.iter().any(|o| o.is_like(p)))
            };
            if !self.readings.iter().any(known) {
                self.readings.push(placed.clone());
            }
            return;
        };
        let mut options = self.options(self.seeds[next], placed);
        self.tries += options.len().max(1);
        // As the one before first: layers are regular.
        let turned = placed.last().is_some_and(|p| p.turned);
        options.sort_by_key(|o| (o.hidden, Reverse(self.seams_seen(o)), o.turned != turned));
        for option in options {
            placed.push(option);
            self.descend(placed, next);
            placed.pop();
        }
    }

    /// How many of the sides of a tile show a valley.
    fn seams_seen(&self, tile: &Tile) -> usize {
        const SEEN: f64 = 9.0;
        (0..2)
            .flat_map(|axis| {
                let range = [tile.low(1 - axis), tile.high(1 - axis)];
                [tile.low(axis), tile.high(axis)].map(|at| self.valleys.evidence(axis, at, range))
            })
            .filter(|e| *e > SEEN)
            .count()
    }

    /// Tiles that may hold a seed, the lowest and leftmost open one.
    fn options(&self, seed: [f64; 2], placed: &[Tile]) -> Vec<Tile> {
        let mut found: Vec<Tile> = Vec::new();
        for &(label, turned, sides) in &self.kinds {
            let ends = self.ends(seed, placed, sides);
            let starts = [0, 1].map(|axis| {
                let [low, high] = ends[axis];
                let mut starts = vec![low.at];
                if low.hidden && !high.hidden {
                    let side = sides[axis];
                    let steps = ((high.at - seed[axis]) / side).ceil().max(1.0);
                    starts.push(high.at - steps * side);
                }
                starts
            });
            for &x in &starts[0] {
                for &y in &starts[1] {
                    let half = sides.map(|s| s / 2.0);
                    let mut tile = Tile {
                        label,
                        turned,
                        centre: [x + half[0], y + half[1]],
                        half,
                        hidden: false,
                    };
                    if tile.holds(seed, 0.5 * self.slack)
                        && self.fits(&mut tile, placed)
                        && !found.iter().any(|f| f.is_like(&tile))
                    {
                        found.push(tile);
                    }
                }
            }
        }
        found
    }

    /// Where the surface or the free space around a seed ends, for a tile with such sides: -X, +X; -Y, +Y. Single
    /// lines are ragged: it is looked for along all of the side.
    fn ends(&self, seed: [f64; 2], placed: &[Tile], sides: [f64; 2]) -> [[End; 2]; 2] {
        const LINES: [f64; 5] = [0.15, 0.325, 0.5, 0.675, 0.85];
        let mut ends =
            [0, 1].map(|axis| [-1.0, 1.0].map(|sign| self.walk(seed, placed, axis, sign)));
        for axis in [1, 0, 1, 0] {
            let across = 1 - axis;
            // From where the tile would lie by what is known so far.
            let low = ends[across][0].at.max(seed[across] - sides[across]);
            let around = |sign: f64| {
                let mut walks: Vec<End> = LINES
                    .iter()
                    .filter_map(|share| {
                        let mut from = seed;
                        from[across] = low + share * sides[across];
                        let open = self.level.at(from) == Cell::On
                            && !placed.iter().any(|p| p.holds(from, 0.0));
                        open.then(|| self.walk(from, placed, axis, sign))
                    })
                    .collect();
                walks.sort_by(|a, b| a.at.total_cmp(&b.at));
                let hidden = 2 * walks.iter().filter(|w| w.hidden).count() > walks.len();
                let same: Vec<&End> = walks.iter().filter(|w| w.hidden == hidden).collect();
                same.get(same.len() / 2).map(|w| **w)
            };
            for (end, sign) in ends[axis].iter_mut().zip([-1.0, 1.0]) {
                if let Some(better) = around(sign) {
                    *end = better;
                }
            }
        }
        ends
    }

    fn fits(&self, tile: &mut Tile, placed: &[Tile]) -> bool {
        let shrink = |k: usize| self.slack.min(0.6 * tile.half[k]);
        let low = [0, 1].map(|k| tile.low(k) + shrink(k));
        let high = [0, 1].map(|k| tile.high(k) - shrink(k));
        let [on, deep] = self.level.shares(low, high);
        if on < LEAST_ON || deep > MOST_DEEP {
            return false;
        }
        tile.hidden = 1.0 - on - deep > PARTLY_HIDDEN;
        placed.iter().all(|p| {
            let common = |k: usize| tile.high(k).min(p.high(k)) - tile.low(k).max(p.low(k));
            common(0).min(common(1)) < 0.6 * self.slack
        })
    }

    /// From a seed along an axis to where the surface or the free space ends.
    fn walk(&self, seed: [f64; 2], placed: &[Tile], axis: usize, sign: f64) -> End {
        let cell = self.level.cell;
        let mut place = seed;
        let [least, most] = self.level.range(axis);
        let is_on = |place: [f64; 2]| {
            let beside = |off: f64| {
                let mut p = place;
                p[1 - axis] += off * cell;
                u8::from(self.level.at(p) == Cell::On)
            };
            beside(-3.0) + beside(0.0) + beside(3.0) >= 2
        };
        loop {
            place[axis] += sign * cell;
            if let Some(p) = placed.iter().find(|p| p.holds(place, 0.0)) {
                let at = if sign < 0.0 {
                    p.high(axis)
                } else {
                    p.low(axis)
                };
                return End { at, hidden: false };
            }
            if place[axis] < least || place[axis] > most {
                return End {
                    at: place[axis],
                    hidden: true,
                };
            }
            if !is_on(place) {
                break;
            }
        }
        // What comes next, up to the slack, tells whether it ends or is hidden.
        let cells = (self.slack / cell).ceil().max(2.0) as usize;
        let deep = (0..cells)
            .filter(|n| {
                let mut p = place;
                p[axis] += sign * *n as f64 * cell;
                self.level.at(p) == Cell::Deep
            })
            .count();
        let hidden = 3 * deep < cells;
        let fat = if hidden { 0.0 } else { self.fat };
        End {
            at: place[axis] - sign * (0.5 * cell + fat),
            hidden,
        }
    }
}
