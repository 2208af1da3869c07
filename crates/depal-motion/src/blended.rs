//! Straight joint moves whose corners are flown as parabolas.

use depal_frames::{JointPositions, MAX_JOINTS};

/// Steps shorter than this, rad, are no motion.
const STILL: f64 = 1e-9;

/// A straight line or a corner of a [`BlendedPath`], with the way `s` as parameter: its derivative has length 1 on lines
/// and turns evenly from one line's direction into the next one's in corners, so it is continuous between stops.
#[derive(Debug, Clone)]
pub struct Piece {
    from: JointPositions,
    /// dq/ds where the piece begins.
    pub(crate) enters: JointPositions,
    /// dq/ds where it ends.
    pub(crate) leaves: JointPositions,
    /// Range of `s`, rad.
    length: f64,
    pub(crate) is_corner: bool,
    /// The arm stands still at its end.
    pub(crate) stops: bool,
}

impl Piece {
    /// Range of the way `s`, radians (L2 in joint space).
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Joints after a share 0..1 of the way, radians.
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

    /// On the two lines that a corner rounds: 0 at its begin, 1 at the waypoint, 2 at its end.
    pub(crate) fn on_tangents(&self, leg: f64) -> JointPositions {
        let half = 0.5 * self.length;
        let mut joints = self.from;
        for i in 0..joints.len() {
            joints[i] +=
                half * (self.enters[i] * leg.min(1.0) + self.leaves[i] * (leg - 1.0).max(0.0));
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
/// the points `r` before and `r` after it (L2 in joint space, radians), tangent to both lines:
/// `(1-u)^2 A + 2u(1-u) P + u^2 B`. It is also what a [`Trajectory`](crate::Trajectory) flies through
/// [`Zone::Blend`](crate::Zone::Blend).
#[derive(Debug, Clone)]
pub struct BlendedPath {
    pieces: Vec<Piece>,
}

impl BlendedPath {
    /// `blends` has one entry per point; those of the first and the last do not count.
    /// Neighbouring blends together must not exceed the segment between them.
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

    /// Lines and corners in order; none for a path without length.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
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
}

/// Evenly spaced states of each piece of a [`BlendedPath`], worked out when they are asked for.
#[derive(Debug)]
pub struct Samples<'a> {
    path: &'a BlendedPath,
    /// Number of states up to the end of each piece, without the start.
    ends: Vec<usize>,
}

impl Samples<'_> {
    /// Number of states; 0 for a path without length.
    pub fn count(&self) -> usize {
        self.ends.last().map_or(0, |last| last + 1)
    }

    /// Joints of one state, radians; 0 is the start.
    ///
    /// # Panics
    /// If there are not so many states.
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

/// L2 in joint space.
pub(crate) fn distance(a: &JointPositions, b: &JointPositions) -> f64 {
    let square = |(x, y): (&f64, &f64)| (x - y) * (x - y);
    a.iter().zip(b.iter()).map(square).sum::<f64>().sqrt()
}

fn heading(from: &JointPositions, to: &JointPositions, length: f64) -> JointPositions {
    let mut out = *to;
    for i in 0..out.len().min(MAX_JOINTS) {
        out[i] = (to[i] - from[i]) / length;
    }
    out
}
