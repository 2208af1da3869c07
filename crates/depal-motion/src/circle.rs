use depal_frames::{Point, Vector};

use crate::MotionError;

/// Shortest distance between two of the three points of a circular move, metres.
/// 0.1 mm: below it large cabinets refuse the move.
const SHORTEST: f64 = 1e-4;
/// Smallest angle at the start between the other two points, radians (1 degree): below it the arc is a line.
const SMALLEST_ANGLE: f64 = 0.017_453_3;

/// The arc from one point through a second to a third, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    centre: Vector,
    /// From the centre to the start, and a quarter turn further.
    to_start: Vector,
    to_quarter: Vector,
    angle: f64,
}

impl Circle {
    /// Through three points that are apart and not in line.
    ///
    /// # Errors
    /// [`MotionError::NoCircle`] otherwise.
    pub fn through(start: &Point, via: &Point, end: &Point) -> Result<Self, MotionError> {
        let (u, v) = (via - start, end - start);
        let normal = u.cross(&v);
        let lengths = [u.norm(), v.norm(), (end - via).norm()];
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let sine = normal.norm() / (lengths[0] * lengths[1]);
        let finite = lengths.iter().all(|l| l.is_finite());
        if !finite || shortest < SHORTEST || sine < SMALLEST_ANGLE.sin() {
            return Err(MotionError::NoCircle {
                shortest_mm: shortest * 1e3,
                angle_deg: sine.min(1.0).asin().to_degrees(),
            });
        }
        // Centre of the circle around a triangle, seen from its first corner.
        let centre = (v * u.norm_squared() - u * v.norm_squared()).cross(&normal)
            / (2.0 * normal.norm_squared());
        let to_start = -centre;
        let to_quarter = normal.normalize().cross(&to_start);
        let to_end = v - centre;
        let angle = to_end.dot(&to_quarter).atan2(to_end.dot(&to_start));
        Ok(Self {
            centre: start.coords + centre,
            to_start,
            to_quarter,
            angle: angle.rem_euclid(std::f64::consts::TAU),
        })
    }

    /// Length of the arc, metres.
    pub fn length(&self) -> f64 {
        self.to_start.norm() * self.angle
    }

    /// The point after a share (0 to 1) of the arc.
    pub fn at(&self, share: f64) -> Vector {
        let (sine, cosine) = (self.angle * share).sin_cos();
        self.centre + self.to_start * cosine + self.to_quarter * sine
    }
}
