//! The blended path and the fastest law along it.

use depal_arm::JointLimit;
use depal_frames::{JointPositions, MAX_JOINTS};

pub(crate) use crate::tree::distance;

/// Cells into which a corner is cut for its time law.
const CORNER_CELLS: usize = 48;
/// ... and for a rough one.
const ROUGH_CELLS: usize = 5;
/// Steps shorter than this, rad, are no motion.
const STILL: f64 = 1e-9;

/// A straight line or a corner, with the way `s` as parameter: its derivative has length 1 on lines
/// and turns evenly from one line's direction into the next one's in corners, so it is continuous between stops.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    from: JointPositions,
    /// dq/ds where the piece begins.
    enters: JointPositions,
    /// dq/ds where it ends.
    leaves: JointPositions,
    /// Range of `s`, rad.
    pub length: f64,
    is_corner: bool,
    /// The arm stands still at its end.
    stops: bool,
}

impl Piece {
    /// Joints after a share 0..1 of its `s`.
    pub fn at(&self, share: f64) -> JointPositions {
        let (own, other) = (
            self.length * (share - 0.5 * share * share),
            self.length * 0.5 * share * share,
        );
        let mut joints = self.from;
        for i in 0..joints.len() {
            joints[i] += self.enters[i] * own + self.leaves[i] * other;
        }
        joints
    }

    /// Largest second derivative of the joints by the share of the piece, summed over the joints with their `gains`, rad;
    /// zero on lines.
    pub fn bend(&self, gains: &[f64]) -> f64 {
        let turn = |i: usize| (self.leaves[i] - self.enters[i]).abs() * gains[i];
        (0..self.from.len()).map(turn).sum::<f64>() * self.length
    }
}

/// Joint-space path through waypoints: straight lines, and at every waypoint with a blend `r` the parabola between
/// the points `r` before and `r` after it (L2 in joint space), tangent to both lines.
#[derive(Debug, Clone)]
pub(crate) struct BlendedPath {
    pub pieces: Vec<Piece>,
}

impl BlendedPath {
    /// `blends` has one entry per point; those of the first and the last do not count.
    pub fn new(points: &[JointPositions], blends: &[f64]) -> Self {
        let mut pieces: Vec<Piece> = Vec::with_capacity(points.len() * 2);
        let mut cut = 0.0;
        for i in 1..points.len() {
            let length = distance(&points[i - 1], &points[i]);
            if length < STILL {
                cut = 0.0;
                continue;
            }
            let direction = heading(&points[i - 1], &points[i], length);
            let after = points.get(i + 1).map_or(0.0, |p| distance(&points[i], p));
            let blend = if after < STILL { 0.0 } else { blends[i] };
            let straight = length - cut - blend;
            if straight > STILL {
                pieces.push(Piece {
                    from: points[i - 1].lerp(&points[i], cut / length),
                    enters: direction,
                    leaves: direction,
                    length: straight,
                    is_corner: false,
                    stops: blend <= STILL,
                });
            }
            if blend > STILL {
                pieces.push(Piece {
                    from: points[i].lerp(&points[i - 1], blend / length),
                    enters: direction,
                    leaves: heading(&points[i], &points[i + 1], after),
                    length: 2.0 * blend,
                    is_corner: true,
                    stops: false,
                });
            } else if let Some(last) = pieces.last_mut() {
                last.stops = true;
            }
            cut = blend;
        }
        Self { pieces }
    }

    /// States along the path with at most `step` rad between neighbours, both ends included.
    pub fn samples(&self, step: f64) -> Samples<'_> {
        let mut ends = Vec::with_capacity(self.pieces.len());
        let mut count = 0;
        for piece in &self.pieces {
            count += (piece.length / step).ceil().max(1.0) as usize;
            ends.push(count);
        }
        Samples { path: self, ends }
    }

    /// Fastest time from rest to rest with stops where blends are zero, s.
    ///
    /// Speed along the path is found by a backward and a forward pass over its square (Pham and Pham,
    /// IEEE T-RO 34(3), 2018, doi 10.1109/TRO.2018.2819195). Lines are exact; in a corner the acceleration along `s`
    /// is constant in each cell, and because the joint accelerations are then linear in `s`
    /// the limits at both ends of a cell hold in all of it.
    pub fn time(&self, limits: &[JointLimit]) -> f64 {
        self.time_in_cells(limits, CORNER_CELLS)
    }

    /// The same with corners cut into fewer cells: a few thousandths more, in half the effort.
    pub fn rough_time(&self, limits: &[JointLimit]) -> f64 {
        self.time_in_cells(limits, ROUGH_CELLS)
    }

    fn time_in_cells(&self, limits: &[JointLimit], corner_cells: usize) -> f64 {
        let mut cells: Vec<Cell> = Vec::with_capacity(self.pieces.len() * corner_cells);
        for piece in &self.pieces {
            let count = if piece.is_corner { corner_cells } else { 1 };
            for i in 0..count {
                cells.push(Cell::new(piece, i, count, limits));
            }
            if piece.stops
                && let Some(last) = cells.last_mut()
            {
                last.stops = true;
            }
        }
        // Highest squared speed at each cell's begin from which everything ahead can be obeyed.
        let mut ceiling = vec![0.0; cells.len() + 1];
        for k in (0..cells.len()).rev() {
            let after = if cells[k].stops { 0.0 } else { ceiling[k + 1] };
            ceiling[k + 1] = after;
            let before = if k == 0 || cells[k - 1].stops {
                0.0
            } else {
                cells[k - 1].highest
            };
            ceiling[k] = cells[k].controllable(after).min(before);
        }
        let (mut time, mut x) = (0.0, 0.0);
        for (cell, &after) in cells.iter().zip(&ceiling[1..]) {
            let next = cell.fastest(x, after);
            time += cell.time(x, next);
            x = next;
        }
        time
    }
}

/// Evenly spaced states of each piece, worked out when they are asked for.
pub(crate) struct Samples<'a> {
    path: &'a BlendedPath,
    /// Number of states up to the end of each piece, without the start.
    ends: Vec<usize>,
}

impl Samples<'_> {
    /// Number of states; 0 for a path without length.
    pub fn count(&self) -> usize {
        self.ends.last().map_or(0, |last| last + 1)
    }

    pub fn at(&self, index: usize) -> JointPositions {
        if index == 0 {
            return self.path.pieces[0].at(0.0);
        }
        let piece = self.ends.partition_point(|&end| end < index);
        let before = if piece == 0 { 0 } else { self.ends[piece - 1] };
        let share = (index - before) as f64 / (self.ends[piece] - before) as f64;
        self.path.pieces[piece].at(share)
    }
}

fn heading(from: &JointPositions, to: &JointPositions, length: f64) -> JointPositions {
    let mut out = *to;
    for i in 0..out.len() {
        out[i] = (to[i] - from[i]) / length;
    }
    out
}

/// A joint's limit at one end of a cell: `slope * u + bend * x` stays within the acceleration limit.
#[derive(Clone, Copy, Default)]
struct Row {
    /// Middle of the range of `u` per `x`.
    middle: f64,
    /// Half of the range's width.
    half: f64,
}

/// A stretch of the path with one time law.
struct Cell {
    /// For both ends and every joint that moves there.
    rows: [Row; 2 * MAX_JOINTS],
    row_count: usize,
    length: f64,
    /// Squared speed that the joint speeds allow.
    highest: f64,
    /// Squared speed beyond which a joint that turns round at the begin would be bent too fast.
    bend_limit: f64,
    /// Acceleration along a line; none in corners.
    line: Option<f64>,
    stops: bool,
}

impl Cell {
    fn new(piece: &Piece, index: usize, count: usize, limits: &[JointLimit]) -> Self {
        let share = |i: usize| i as f64 / count as f64;
        let (first, last) = (share(index), share(index + 1));
        let length = piece.length / count as f64;
        let mut cell = Self {
            rows: [Row::default(); 2 * MAX_JOINTS],
            row_count: 0,
            length,
            highest: f64::INFINITY,
            bend_limit: f64::INFINITY,
            line: None,
            stops: false,
        };
        let mut along = f64::INFINITY;
        for (i, limit) in limits.iter().enumerate() {
            let (enters, leaves) = (piece.enters[i], piece.leaves[i]);
            let slope = [
                enters + (leaves - enters) * first,
                enters + (leaves - enters) * last,
            ];
            let steepest = slope[0].abs().max(slope[1].abs());
            let speed = limit.max_speed / steepest;
            cell.highest = cell.highest.min(speed * speed);
            let acceleration = limit.max_acceleration;
            if !piece.is_corner {
                along = along.min(acceleration / steepest);
                continue;
            }
            let bend = (leaves - enters) / piece.length;
            let at_end = slope[1] + 2.0 * length * bend;
            for c in [slope[0], at_end] {
                if c.abs() < 1e-12 {
                    continue;
                }
                let inverse = 1.0 / c;
                cell.rows[cell.row_count] = Row {
                    middle: -bend * inverse,
                    half: acceleration * inverse.abs(),
                };
                cell.row_count += 1;
            }
            // Where a joint turns round, only the bend accelerates it.
            if slope[0].abs() < 1e-12 && bend != 0.0 {
                cell.bend_limit = cell.bend_limit.min(acceleration / bend.abs());
            }
        }
        cell.line = (!piece.is_corner).then_some(along);
        cell
    }

    /// Limits of the acceleration `u` at squared speed `x`: (low, high), each as `(value, change per x)`.
    fn bounds(&self, x: f64, after: f64) -> [(f64, f64); 2] {
        // The speed at the end lies between 0 and `after`.
        let per = 0.5 / self.length;
        let mut low = (-x * per, -per);
        let mut high = ((after - x) * per, -per);
        for row in &self.rows[..self.row_count] {
            let middle = row.middle * x;
            if middle - row.half > low.0 {
                low = (middle - row.half, row.middle);
            }
            if middle + row.half < high.0 {
                high = (middle + row.half, row.middle);
            }
        }
        [low, high]
    }

    /// Highest squared speed at the begin from which `after` or less can be reached at the end.
    fn controllable(&self, after: f64) -> f64 {
        let after = after.min(self.highest);
        if let Some(along) = self.line {
            return self.highest.min(after + 2.0 * along * self.length);
        }
        let mut x = self.highest.min(self.bend_limit);
        // The gap between the bounds is convex in x and open at 0: Newton's steps from above end at its root.
        for _ in 0..32 {
            let [low, high] = self.bounds(x, after);
            let gap = low.0 - high.0;
            if gap <= 1e-12 {
                break;
            }
            x = (x - gap / (low.1 - high.1)).max(0.0);
        }
        x
    }

    /// Highest squared speed at the end.
    fn fastest(&self, x: f64, after: f64) -> f64 {
        let after = after.min(self.highest);
        if let Some(along) = self.line {
            return after.min(x + 2.0 * along * self.length);
        }
        let [low, high] = self.bounds(x, after);
        (x + 2.0 * self.length * high.0.max(low.0)).clamp(0.0, after)
    }

    fn time(&self, x: f64, next: f64) -> f64 {
        let Some(along) = self.line else {
            return 2.0 * self.length / (x.sqrt() + next.sqrt()).max(1e-9);
        };
        let peak = self
            .highest
            .min(0.5 * (x + next) + along * self.length)
            .max(x.max(next));
        let ramps = (2.0 * peak.sqrt() - x.sqrt() - next.sqrt()) / along;
        let cruise = self.length - (2.0 * peak - x - next) / (2.0 * along);
        ramps + cruise.max(0.0) / peak.sqrt()
    }
}

/// Time of the slowest joint alone from rest to rest, s: no way between the two is faster.
pub(crate) fn lower_bound(
    from: &JointPositions,
    to: &JointPositions,
    limits: &[JointLimit],
) -> f64 {
    from.iter()
        .zip(to.iter())
        .zip(limits)
        .map(|((a, b), limit)| {
            let way = (b - a).abs();
            let (v, acceleration) = (limit.max_speed, limit.max_acceleration);
            if way * acceleration <= v * v {
                2.0 * (way / acceleration).sqrt()
            } else {
                way / v + v / acceleration
            }
        })
        .fold(0.0, f64::max)
}

/// The largest blends that fit: `shares[j]` of segment `j` goes to the corner at its begin, the rest to that at its end;
/// outer segments belong wholly to their one corner.
pub(crate) fn fitting_blends(points: &[JointPositions], shares: &[f64]) -> Vec<f64> {
    let last = points.len() - 1;
    let mut blends = vec![0.0; points.len()];
    for i in 1..last {
        let before = distance(&points[i - 1], &points[i]);
        let after = distance(&points[i], &points[i + 1]);
        let before = if i == 1 {
            before
        } else {
            before * (1.0 - shares[i - 1])
        };
        let after = if i + 1 == last {
            after
        } else {
            after * shares[i]
        };
        // A hair less than what fits, so that the sum holds after rounding.
        blends[i] = before.min(after) * (1.0 - 1e-9);
    }
    blends
}
