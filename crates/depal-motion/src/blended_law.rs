//! How long a blended path takes.

use std::sync::Arc;

use depal_arm::{Arm, JointLimit, Load};

use crate::blended::{BlendedPath, Piece};
use crate::curve::{Derivatives, cells_for, combine};
use crate::passes::{Band, Bounds, Cells, Limit, run};
use crate::shape::divided;
use crate::torque::TorqueLimits;
use crate::{MotionError, Trajectory};

/// Cells into which a corner is cut for its time law ...
const CORNER_CELLS: usize = 48;
/// ... and for a rough one.
const ROUGH_CELLS: usize = 5;

/// Places on each of the two moves into a corner where the arm must be able to stand.
const HELD_PLACES: usize = 8;

impl BlendedPath {
    /// Fastest time from rest to rest with stops where blends are zero under speed and acceleration limits alone, s.
    ///
    /// Lines are exact; in a corner the acceleration along `s` is constant in each cell, and because the joint
    /// accelerations are then linear in `s` the limits at both ends of a cell hold in all of it.
    pub fn time(&self, limits: &[JointLimit]) -> f64 {
        self.profile(limits, CORNER_CELLS).time()
    }

    /// The same with corners cut into fewer cells: a few thousandths more, in half the effort.
    pub fn rough_time(&self, limits: &[JointLimit]) -> f64 {
        self.profile(limits, ROUGH_CELLS).time()
    }

    /// [`time`](Self::time) under the limits of the arm, its torques among them where its file has them, with the tool
    /// alone and with the tool and what it carries, as [`Trajectory::set_tool_and_load`] has it.
    ///
    /// # Errors
    /// [`MotionError::Overload`] where the arm could hardly stand on the way.
    pub fn loaded_time(&self, arm: &Arm, tool: &Load, load: &Load) -> Result<f64, MotionError> {
        if arm.torque_limits().is_none() {
            return Ok(self.time(arm.limits()));
        }
        match TorqueLimits::new(&Arc::new(arm.clone()), tool, load) {
            None => Ok(self.time(arm.limits())),
            Some(torque) => Ok(self.profile_with_torques(arm.limits(), &torque)?.time()),
        }
    }

    fn profile(&self, limits: &[JointLimit], corner_cells: usize) -> Profile {
        let corners = self.pieces().iter().filter(|p| p.is_corner).count();
        let lines = self.pieces().len() - corners;
        let cells = corners * corner_cells + lines;
        let mut profile = Profile {
            bands: Vec::with_capacity(corners * corner_cells * 2 * limits.len()),
            cells: Vec::with_capacity(cells),
        };
        let mut stands = true;
        for piece in self.pieces() {
            if piece.is_corner {
                for i in 0..corner_cells {
                    let share = |i: usize| i as f64 / corner_cells as f64;
                    profile.push(piece, (share(i), share(i + 1)), stands, limits);
                    stands = false;
                }
            } else {
                profile.push_line(piece, stands, limits);
            }
            stands = piece.stops;
        }
        profile
    }

    fn profile_with_torques(
        &self,
        limits: &[JointLimit],
        torque: &TorqueLimits,
    ) -> Result<Profile, MotionError> {
        let mut profile = Profile {
            bands: Vec::new(),
            cells: Vec::new(),
        };
        let mut stands = true;
        let last = self.pieces().len().saturating_sub(1);
        for corner in self.pieces().iter().filter(|piece| piece.is_corner) {
            // Cabinets look at moves as they are programmed, without the corner.
            let legs = (0..=2 * HELD_PLACES).map(|i| i as f64 / HELD_PLACES as f64);
            for leg in legs {
                torque.check_holding(&corner.on_tangents(leg))?;
            }
        }
        for (index, piece) in self.pieces().iter().enumerate() {
            // As a trajectory is cut.
            let travel = |leg: [f64; 2]| {
                let [from, to] = leg.map(|at| piece.on_tangents(at));
                from.max_distance(&to)
            };
            let count = cells_for(travel([0.0, 1.0]) + travel([1.0, 2.0]));
            let even = (0..count).map(|i| {
                let share = |i: usize| i as f64 / count as f64;
                ((share(i), share(i + 1)), ())
            });
            let will_stand = piece.stops || index == last;
            for (range, ()) in divided(even.collect(), stands, will_stand) {
                profile.push(piece, range, stands, limits);
                profile.limit_torques(piece, range, torque)?;
                stands = false;
            }
            stands = piece.stops;
        }
        Ok(profile)
    }
}

/// A stretch of the path with one acceleration, or with a ramp up, a cruise and a ramp down on a line.
struct Cell {
    /// Where the bands of this cell begin.
    bands: usize,
    width: f64,
    /// Squared speed that the joint speeds allow.
    fastest: f64,
    /// Squared speed beyond which a joint that turns round at the begin would be bent too fast.
    highest: f64,
    /// Acceleration along a line; none where the limits change on the way.
    even: Option<f64>,
    /// The arm stands before it.
    stands: bool,
}

struct Profile {
    /// Of all cells, one after the other.
    bands: Vec<Band>,
    cells: Vec<Cell>,
}

impl Profile {
    fn push_line(&mut self, piece: &Piece, stands: bool, limits: &[JointLimit]) {
        let (mut along, mut speed) = (f64::INFINITY, f64::INFINITY);
        for (slope, limit) in piece.enters.iter().zip(limits) {
            along = along.min(limit.max_acceleration / slope.abs());
            speed = speed.min(limit.max_speed / slope.abs());
        }
        self.cells.push(Cell {
            bands: self.bands.len(),
            width: piece.length(),
            fastest: speed * speed,
            highest: f64::INFINITY,
            even: Some(along),
            stands,
        });
    }

    /// Limits at both ends of a cell of a corner, or of a line that is to be cut.
    fn push(
        &mut self,
        piece: &Piece,
        (first, last): (f64, f64),
        stands: bool,
        limits: &[JointLimit],
    ) {
        let width = piece.length() * (last - first);
        let bands = self.bands.len();
        let (mut speed, mut highest) = (f64::INFINITY, f64::INFINITY);
        for (i, limit) in limits.iter().enumerate() {
            let (enters, leaves) = (piece.enters[i], piece.leaves[i]);
            let turn = leaves - enters;
            let begin = enters + turn * first;
            let end = enters + turn * last;
            let bend = turn / piece.length();
            let steepest = begin.abs().max(end.abs());
            speed = speed.min(limit.max_speed / steepest);
            for of_a in [begin, end + 2.0 * width * bend] {
                let limit = Limit {
                    of_a,
                    of_x: bend,
                    rest: 0.0,
                    limit: limit.max_acceleration,
                };
                match limit.band() {
                    Some(band) => self.bands.push(band),
                    // Where a joint turns round, only the bend accelerates it.
                    None => highest = highest.min(limit.highest()),
                }
            }
        }
        self.cells.push(Cell {
            bands,
            width,
            fastest: speed * speed,
            highest,
            even: None,
            stands,
        });
    }

    /// Adds the torque limits at three places of the last cell.
    fn limit_torques(
        &mut self,
        piece: &Piece,
        (first, last): (f64, f64),
        torque: &TorqueLimits,
    ) -> Result<(), MotionError> {
        let Some(cell) = self.cells.last_mut() else {
            return Ok(());
        };
        let bend = 1.0 / piece.length();
        for part in [0.0, 0.5, 1.0] {
            let share = first + part * (last - first);
            let joints = piece.at(share);
            torque.check_holding(&joints)?;
            let ends = [&piece.enters, &piece.leaves];
            let at = Derivatives {
                first: combine(&[1.0 - share, share], &ends),
                second: combine(&[-bend, bend], &ends),
            };
            for limit in torque.rows(&joints, &at, 2.0 * part * cell.width) {
                match limit.band() {
                    Some(band) => self.bands.push(band),
                    None => cell.highest = cell.highest.min(limit.highest()),
                }
            }
        }
        Ok(())
    }

    fn time(&self) -> f64 {
        let mut time = 0.0;
        run(self, 0.0, 0.0, |index, x, _, end| {
            time += self.cells[index].time(x, end);
        });
        time
    }
}

impl Cell {
    fn time(&self, x: f64, end: f64) -> f64 {
        let Some(along) = self.even else {
            return 2.0 * self.width / (x.sqrt() + end.sqrt()).max(1e-9);
        };
        let peak = self
            .fastest
            .min(0.5 * (x + end) + along * self.width)
            .max(x.max(end));
        let ramps = (2.0 * peak.sqrt() - x.sqrt() - end.sqrt()) / along;
        let cruise = self.width - (2.0 * peak - x - end) / (2.0 * along);
        ramps + cruise.max(0.0) / peak.sqrt()
    }
}

impl Cells for Profile {
    fn count(&self) -> usize {
        self.cells.len()
    }

    fn width(&self, cell: usize) -> f64 {
        self.cells[cell].width
    }

    fn speed_bounds(&self, cell: usize) -> (f64, f64) {
        let fastest = self.cells[cell].fastest;
        (fastest, fastest)
    }

    fn link(&self, cell: usize) -> f64 {
        if self.cells[cell].stands { 0.0 } else { 1.0 }
    }

    fn even(&self, cell: usize) -> Option<f64> {
        self.cells[cell].even
    }

    fn highest(&self, cell: usize) -> f64 {
        self.cells[cell].highest
    }

    fn narrow(&self, cell: usize, bounds: &mut Bounds) {
        let to = self
            .cells
            .get(cell + 1)
            .map_or(self.bands.len(), |next| next.bands);
        for band in &self.bands[self.cells[cell].bands..to] {
            bounds.narrow(band);
        }
    }
}

impl Trajectory {
    /// The whole of a path between stands that is flown through [`Zone::Blend`](crate::Zone::Blend), in the order of
    /// its waypoints: the trajectory of an arm that stands at the first of them at time 0.
    ///
    /// # Errors
    /// Those of [`append`](Self::append).
    pub fn through(
        arm: &Arc<Arm>,
        points: &[depal_frames::JointPositions],
        blends: &[f64],
        tool: &Load,
        load: &Load,
    ) -> Result<Self, MotionError> {
        let mut trajectory = Self::new(Arc::clone(arm), points[0]);
        trajectory.set_tool_and_load(tool, load);
        for (point, blend) in points.iter().zip(blends).skip(1) {
            trajectory.append(0.0, &crate::Segment::blended(*point, *blend))?;
        }
        Ok(trajectory)
    }
}
