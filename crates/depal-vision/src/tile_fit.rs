//! Where the tiles of a reading lie, all at once: outer sides are where the surface ends, neighbours stand close, and
//! one camera shows all outlines too wide, or too narrow, by the same.

use depal_frames::Vector;
use nalgebra::{DMatrix, DVector};

use crate::{
    DetectedBox,
    level::{Cell, Level},
    plane::PlaneFrame,
    tiling::Tile,
};

/// Outer sides are known to so much, metres, and so many cells.
const SIDE: f64 = 0.003;
const SIDE_CELLS: f64 = 1.0;
/// Outlines seem too wide or too narrow by so many cells.
const FAT_CELLS: f64 = 1.5;
/// A side that something nearer hides is not far behind it where the rest is seen, in slacks.
const HIDDEN_SIDE: f64 = 0.7;
/// Gaps of a layer are alike to so much, metres.
const GAP_ALIKE: f64 = 0.002;
/// Packed tightly: gap and its spread, metres.
const GAP: (f64, f64) = (0.002, 0.002);

/// A reading with every tile in its place.
pub struct Fitted {
    pub tiles: Vec<Tile>,
    /// Deviation of each tile's place along both axes, metres.
    pub spread: Vec<[f64; 2]>,
    /// Outer sides seen of each tile.
    pub sides: Vec<u32>,
    /// Sum of squared errors, in deviations; of the outer sides alone, and the greatest of those.
    pub squares: f64,
    pub outer: f64,
    pub worst: f64,
    pub outer_sides: usize,
    /// Outer sides that something nearer hides.
    pub hidden_sides: usize,
    /// Share of the outer sides' length, as far as it is not hidden, beyond which the surface ends.
    pub ends: f64,
    pub seams: Vec<Seam>,
    /// How deep it is beyond the outer sides, metres: upper quartile.
    pub drop: f64,
    /// By how much outlines seem too wide, and how wide gaps are, as deviations from what is usual.
    pub fat_deviations: f64,
    pub gap_deviations: f64,
}

impl Fitted {
    /// True when a box is one of its tiles, roughly; `frame` holds the tiles.
    pub fn is_one_of(&self, found: &DetectedBox, frame: &PlaneFrame) -> bool {
        self.tiles.iter().any(|tile| {
            let at = frame.point(tile.centre[0], tile.centre[1]);
            let apart = found.camera_from_box.translation.vector - at.coords;
            let along = if tile.turned { frame.y } else { frame.x };
            let turn = (found.camera_from_box.rotation * Vector::x()).dot(&along);
            let square = found.size.length - found.size.width < 0.01;
            found.label == tile.label
                && apart.norm() < 0.15 * found.size.width
                && (square || turn.abs() > 0.8)
        })
    }
}

/// Where two tiles meet.
#[derive(Debug, Clone, Copy)]
pub struct Seam {
    /// The one before and the one after it along `axis`.
    pub tiles: [usize; 2],
    pub axis: usize,
    /// Range across.
    pub range: [f64; 2],
}

/// An outer side as it is seen.
struct Side {
    tile: usize,
    axis: usize,
    sign: f64,
    at: f64,
    /// Deviation, metres.
    spread: f64,
}

/// `None` where nothing holds the tiles, or the surface goes on beyond them.
pub fn fit(level: &Level, tiles: &[Tile], slack: f64) -> Option<Fitted> {
    let seams = seams(tiles, 2.0 * slack);
    let mut ends = [0usize; 2];
    let mut drops = Vec::new();
    let mut seen = Vec::new();
    let mut hidden = Vec::new();
    for tile in 0..tiles.len() {
        for (axis, sign) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
            let lines = look(level, tiles, tile, (axis, sign), slack);
            ends[0] += lines.ends.len();
            ends[1] += lines.ends.len() + lines.on;
            let side = |at| Side {
                tile,
                axis,
                sign,
                at,
                spread: SIDE.hypot(SIDE_CELLS * level.cell),
            };
            drops.extend(&lines.drops);
            if lines.hidden.len() > lines.ends.len() + lines.on {
                hidden.extend(median(lines.hidden).map(side));
            } else if lines.ends.len() > lines.on && lines.ends.len() as f64 * level.cell > LEAST {
                seen.extend(median(lines.ends).map(side));
            }
        }
    }
    if seen.is_empty() {
        return None;
    }
    let n = 2 * tiles.len();
    let (fat, gap) = (n, n + 1);
    let mut matrix = DMatrix::<f64>::zeros(n + 2, n + 2);
    let mut right = DVector::<f64>::zeros(n + 2);
    let mut add = |terms: &[(usize, f64)], target: f64, spread: f64| {
        let weight = 1.0 / (spread * spread);
        for &(a, x) in terms {
            right[a] += weight * x * target;
            for &(b, y) in terms {
                matrix[(a, b)] += weight * x * y;
            }
        }
    };
    for s in &seen {
        let off = s.sign * tiles[s.tile].half[s.axis];
        add(
            &[(2 * s.tile + s.axis, 1.0), (fat, s.sign)],
            s.at - off,
            s.spread,
        );
    }
    for s in &hidden {
        let off = s.sign * tiles[s.tile].half[s.axis];
        add(
            &[(2 * s.tile + s.axis, 1.0)],
            s.at - off,
            HIDDEN_SIDE * slack,
        );
    }
    for s in &seams {
        let [a, b] = s.tiles;
        let apart = tiles[a].half[s.axis] + tiles[b].half[s.axis];
        add(
            &[(2 * b + s.axis, 1.0), (2 * a + s.axis, -1.0), (gap, -1.0)],
            apart,
            GAP_ALIKE,
        );
    }
    let usual = FAT_CELLS * level.cell;
    add(&[(fat, 1.0)], 0.0, usual);
    add(&[(gap, 1.0)], GAP.0, GAP.1);
    for (k, tile) in tiles.iter().enumerate() {
        for axis in 0..2 {
            add(&[(2 * k + axis, 1.0)], tile.centre[axis], 0.1);
        }
    }
    let factor = matrix.cholesky()?;
    let found = factor.solve(&right);
    let inverse = factor.inverse();
    let mut moved = tiles.to_vec();
    for (k, tile) in moved.iter_mut().enumerate() {
        tile.centre = [found[2 * k], found[2 * k + 1]];
    }
    let (mut outer, mut worst) = (0.0, 0.0f64);
    let mut sides = vec![0; tiles.len()];
    for s in &seen {
        let tile = &moved[s.tile];
        let error =
            (s.at - tile.centre[s.axis] - s.sign * (tile.half[s.axis] + found[fat])) / s.spread;
        outer += error * error;
        worst = worst.max(error.abs());
        sides[s.tile] += 1;
    }
    let mut squares = outer + ((found[gap] - GAP.0) / GAP.1).powi(2) + (found[fat] / usual).powi(2);
    for s in &seams {
        let [a, b] = s.tiles;
        let free = moved[b].low(s.axis) - moved[a].high(s.axis);
        squares += ((free - found[gap]) / GAP_ALIKE).powi(2);
    }
    drops.sort_by(f64::total_cmp);
    Some(Fitted {
        spread: (0..tiles.len())
            .map(|k| [0, 1].map(|axis| inverse[(2 * k + axis, 2 * k + axis)].sqrt()))
            .collect(),
        tiles: moved,
        sides,
        squares,
        outer,
        worst,
        outer_sides: seen.len(),
        hidden_sides: hidden.len(),
        ends: ends[0] as f64 / ends[1].max(1) as f64,
        seams,
        drop: drops.get(drops.len() * 3 / 4).copied().unwrap_or(0.0),
        fat_deviations: found[fat] / usual,
        gap_deviations: (found[gap] - GAP.0) / GAP.1,
    })
}

/// What the lines across a side show where no other tile follows.
#[derive(Default)]
struct Lines {
    /// Where the surface ends.
    ends: Vec<f64>,
    /// Where something hides it.
    hidden: Vec<f64>,
    /// Lines on which it goes on.
    on: usize,
    /// How much deeper it is beyond the ends, metres.
    drops: Vec<f64>,
}

/// Of a side less than this may be chance, metres.
const LEAST: f64 = 0.04;

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn look(
    level: &Level,
    tiles: &[Tile],
    tile: usize,
    (axis, sign): (usize, f64),
    slack: f64,
) -> Lines {
    let own = &tiles[tile];
    let across = 1 - axis;
    let cell = level.cell;
    let side = own.centre[axis] + sign * own.half[axis];
    let reach = 2.0 * slack;
    let count = (1.8 * own.half[across] / cell) as usize;
    let mut lines = Lines::default();
    for n in 0..count {
        let t =
            own.centre[across] + ((n as f64 + 0.5) / count as f64 - 0.5) * 1.8 * own.half[across];
        let place = |out: f64| {
            let mut p = [0.0; 2];
            p[axis] = side + sign * out;
            p[across] = t;
            p
        };
        let taken = |p: [f64; 2]| {
            tiles
                .iter()
                .enumerate()
                .any(|(k, o)| k != tile && o.holds(p, 0.0))
        };
        if taken(place(slack)) || taken(place(2.0 * slack)) {
            continue;
        }
        let steps = (2.0 * reach / cell) as usize;
        let mut last = None;
        let mut ended = None;
        for k in 0..steps {
            let out = -reach + k as f64 * cell;
            match level.at(place(out)) {
                Cell::On => last = Some(out),
                what => {
                    // Two in a row, so that a lone hole is none.
                    if let Some(last) = last
                        && out - last > 1.5 * cell
                    {
                        ended = Some((last, what));
                        break;
                    }
                }
            }
        }
        match ended {
            Some((out, Cell::Deep)) => {
                lines.ends.push(side + sign * (out + 0.5 * cell));
                if let Some(drop) = level.depth_below(place(out + level.foot)) {
                    lines.drops.push(drop);
                }
            }
            Some(_) => {
                // A few cells not measured beside a step, then deep: it ends all the same.
                let (out, _) = ended.unwrap_or((0.0, Cell::Unknown));
                let soon = (2..2 + (slack / cell) as usize)
                    .map(|k| level.at(place(out + k as f64 * cell)))
                    .find(|c| *c != Cell::Unknown);
                if soon == Some(Cell::Deep) {
                    lines.ends.push(side + sign * (out + 0.5 * cell));
                } else {
                    lines.hidden.push(side + sign * (out + 0.5 * cell));
                }
            }
            None if last.is_some() => lines.on += 1,
            None => {}
        }
    }
    lines
}

/// Where tiles lie side by side, no farther apart than `apart`.
fn seams(tiles: &[Tile], apart: f64) -> Vec<Seam> {
    let mut found = Vec::new();
    for (a, p) in tiles.iter().enumerate() {
        for (b, q) in tiles.iter().enumerate() {
            for axis in 0..2 {
                let across = 1 - axis;
                let free = q.low(axis) - p.high(axis);
                let range = [
                    p.low(across).max(q.low(across)),
                    p.high(across).min(q.high(across)),
                ];
                let least = 0.4 * p.half[across].min(q.half[across]);
                if a != b
                    && q.centre[axis] > p.centre[axis]
                    && free.abs() < apart
                    && range[1] - range[0] > least
                {
                    found.push(Seam {
                        tiles: [a, b],
                        axis,
                        range,
                    });
                }
            }
        }
    }
    found
}
