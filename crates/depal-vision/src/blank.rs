//! Rectangles that are left out of a patch: cartons that were found before.

use depal_frames::{Point, Vector};

use crate::{DetectedBox, plane::PlaneFrame};

/// A rectangle in the axes of a grid that is no part of the surface.
#[derive(Debug, Clone, Copy)]
pub struct Blank {
    /// Middle and half sides, metres.
    pub middle: [f64; 2],
    pub half: [f64; 2],
    /// Turn of the first side against the grid's X, radians.
    pub turn: f64,
}

impl Blank {
    /// A found box in the axes of a grid's frame.
    pub fn of(found: &DetectedBox, frame: &PlaneFrame) -> Self {
        let pose = &found.camera_from_box;
        let offset = Point::from(pose.translation.vector) - frame.origin;
        let x = pose.rotation * Vector::x();
        Self {
            middle: [offset.dot(&frame.x), offset.dot(&frame.y)],
            half: [found.size.length / 2.0, found.size.width / 2.0],
            turn: x.dot(&frame.y).atan2(x.dot(&frame.x)),
        }
    }

    /// True of a point inside, metres along the grid's axes.
    pub fn holds(&self, x: f64, y: f64) -> bool {
        let (s, c) = self.turn.sin_cos();
        let (dx, dy) = (x - self.middle[0], y - self.middle[1]);
        (dx * c + dy * s).abs() < self.half[0] && (dy * c - dx * s).abs() < self.half[1]
    }

    /// The columns of a row (`y` metres) that lie inside.
    pub fn cells(&self, y: f64, left: f64, pitch: f64, columns: usize) -> std::ops::Range<usize> {
        let (s, c) = self.turn.sin_cos();
        let dy = y - self.middle[1];
        let (mut low, mut high) = (f64::MIN, f64::MAX);
        // |dx c + dy s| < half[0] and |dy c - dx s| < half[1], as bounds of dx.
        for (slope, shift, half) in [(c, dy * s, self.half[0]), (-s, dy * c, self.half[1])] {
            if slope.abs() < 1e-9 {
                if shift.abs() > half {
                    return 0..0;
                }
                continue;
            }
            let (a, b) = ((-half - shift) / slope, (half - shift) / slope);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        let column = |x: f64| {
            ((x + self.middle[0] - left) / pitch)
                .round()
                .clamp(0.0, columns as f64) as usize
        };
        if high <= low {
            0..0
        } else {
            column(low)..column(high)
        }
    }
}
