//! What lies beyond the sides of a top whose size is not known: it ends only where the depth falls away.

use depal_frames::Vector;

use crate::{gate::DepthImage, patch::pixel_pitch, plane::PlaneFrame};

/// What the scan lines across one side meet beyond it, as shares 0..1 of all lines.
#[derive(Debug, Clone, Copy, Default)]
pub struct Beyond {
    /// The surface ends: something deeper, or a gap.
    pub open: f64,
    /// Pixels are missing, but one that is surface comes already within a pixel beyond the side: a narrow gap with
    /// the neighbour behind it shows so, and so do lost pixels on a surface that goes on.
    pub narrow: f64,
    /// Something nearer comes next, but after more unmeasured pixels than an edge loses: in them there is a gap, or a
    /// shadow that what is nearer throws on the surface. From one place that looks the same.
    pub beside: f64,
    /// Part of `hidden`: the foot of what is nearer is within the side, so it stands over the surface.
    pub over: f64,
    /// Something nearer comes first, or next after what was not measured: where the surface ends is unknown.
    pub hidden: f64,
    /// Part of `open`: what is measured there lies only a little deeper, and stays so.
    pub thin: f64,
}

/// What lies no deeper than this beneath a top is what a sheet lies on, metres: no carton is so low.
pub const THIN: f64 = 0.015;
/// A gap in a layer in which nothing was measured is at most so wide, metres: wider, and it shows its bottom; then it is
/// a shadow or a strip of glossy tape, and the surface goes on behind it.
pub const WIDEST_BLIND_GAP: f64 = 0.015;
/// The longest shadow that is followed, pixels.
const LONGEST_SHADOW: usize = 300;

enum End {
    Open {
        thin: bool,
    },
    Narrow,
    Beside,
    Hidden {
        over: bool,
    },
    /// The surface goes on, or the image ends.
    None,
}

/// Looks across the side `(axis, sign)` of a rectangle in a plane. What lies level behind so much that was not measured
/// (`blind`, metres) is a neighbour behind a gap; behind more it is the same surface.
pub fn beyond(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    (axis, sign): (usize, f64),
    tolerance: f64,
    blind: f64,
) -> Beyond {
    let pitch = pixel_pitch(frame, &image.intrinsics);
    let (outward, tangent) = if axis == 0 {
        (frame.x * sign, frame.y)
    } else {
        (frame.y * sign, frame.x)
    };
    let length = extents[1 - axis] * 0.96;
    let lines = (length / (2.0 * pitch)).floor().max(1.0) as usize;
    let mut result = Beyond::default();
    let share = 1.0 / lines as f64;
    for line in 0..lines {
        let along = ((line as f64 + 0.5) / lines as f64 - 0.5) * length;
        let on_side = frame.origin + tangent * along + outward * (extents[axis] / 2.0);
        let look = Look {
            image,
            frame,
            outward,
            tolerance,
            pitch,
            blind,
        };
        match look.along(&on_side.coords) {
            End::Open { thin } => {
                result.open += share;
                result.thin += if thin { share } else { 0.0 };
            }
            End::Narrow => result.narrow += share,
            End::Beside => result.beside += share,
            End::Hidden { over } => {
                result.hidden += share;
                result.over += if over { share } else { 0.0 };
            }
            End::None => {}
        }
    }
    result
}

/// A look across a side.
struct Look<'a> {
    image: &'a DepthImage<'a>,
    frame: &'a PlaneFrame,
    outward: Vector,
    tolerance: f64,
    pitch: f64,
    blind: f64,
}

/// A pixel on the way.
#[derive(Clone, Copy)]
struct Seen {
    /// Measured depth, metres, 0 for none, and that of the plane there.
    z: f64,
    expected: f64,
}

impl Look<'_> {
    /// The pixel `steps` pixels beyond a point; `None` outside the image.
    fn pixel(&self, from: &Vector, steps: f64) -> Option<Seen> {
        let k = &self.image.intrinsics;
        let (u, v) = k.project(&(from + self.outward * (steps * self.pitch)).into());
        let (u, v) = (u.round(), v.round());
        let inside =
            u >= 0.0 && v >= 0.0 && u < self.image.width as f64 && v < self.image.height as f64;
        inside.then(|| Seen {
            z: f64::from(self.image.depth[v as usize * self.image.width + u as usize]),
            expected: self.frame.plane.depth(&k.ray(u, v)),
        })
    }

    /// Follows one line outwards from a point on the side.
    fn along(&self, on_side: &Vector) -> End {
        /// Where the last pixel of the surface is looked for, pixels from the side: it is known to one.
        const WINDOW: std::ops::RangeInclusive<i32> = -4..=1;
        /// Where, if that goes on: beyond the narrowest gap that shows, less than two pixels wide, it is the
        /// neighbour's.
        const BEFORE: std::ops::RangeInclusive<i32> = -2..=0;
        let is_on = |s: i32| {
            self.pixel(on_side, f64::from(s))
                .is_some_and(|p| self.is_on(&p))
        };
        let Some(last) = WINDOW.rev().find(|&s| is_on(s)) else {
            return End::None;
        };
        let end = self.after(on_side, f64::from(last));
        if !matches!(end, End::None) {
            return end;
        }
        let before = BEFORE
            .rev()
            .find(|&s| s < last && is_on(s) && !is_on(s + 1));
        match before.map(|last| self.after(on_side, f64::from(last))) {
            Some(End::Open { .. }) => End::Narrow,
            _ => End::None,
        }
    }

    /// True for a pixel of the surface.
    fn is_on(&self, s: &Seen) -> bool {
        s.z > 0.0 && (s.z - s.expected).abs() <= self.tolerance
    }

    /// What comes after the last pixel of the surface.
    fn after(&self, on_side: &Vector, last: f64) -> End {
        for n in 1..=LONGEST_SHADOW {
            let steps = last + n as f64;
            let Some(seen) = self.pixel(on_side, steps) else {
                // With nothing but missing pixels before it the border of the image hides no carton's end.
                return if n > 1 {
                    End::Open { thin: false }
                } else {
                    End::None
                };
            };
            if seen.z == 0.0 {
                continue;
            }
            if seen.z > seen.expected + self.tolerance {
                return End::Open {
                    thin: self.stays_close(on_side, steps),
                };
            }
            if self.is_on(&seen) {
                let blind = n as f64 * self.pitch;
                let gap = n > 1 && blind <= self.blind;
                return if gap {
                    End::Open { thin: false }
                } else {
                    End::None
                };
            }
            // It may stand on the surface as well as behind a gap.
            if self.is_taller(on_side, steps) {
                return self.beside(on_side, last, steps);
            }
        }
        End::Open { thin: false }
    }

    /// True when what measures nearer than the plane is no lone mixed pixel.
    fn is_taller(&self, on_side: &Vector, steps: f64) -> bool {
        /// Of the next pixels so many must be nearer, too.
        const NEXT: usize = 6;
        const LEAST: usize = 3;
        (0..NEXT)
            .filter_map(|n| self.pixel(on_side, steps + n as f64))
            .filter(|s| s.z > 0.0 && s.z < s.expected - self.tolerance)
            .count()
            >= LEAST
    }

    /// What is nearer at `steps` stands beside the surface where between the last pixel of that and it there is room
    /// for a gap: to its foot, where it shows its wall to the camera, and to its border in the image, where that hides
    /// its foot.
    fn beside(&self, on_side: &Vector, last: f64, steps: f64) -> End {
        /// An edge loses one pixel of its own surface and one of the next, pixels.
        const LOST: f64 = 1.5;
        let k = &self.image.intrinsics;
        let (u, v) = k.project(&(on_side + self.outward * (steps * self.pitch)).into());
        // The first pixel may be a mixed one.
        let mut depths: Vec<f64> = (0..3)
            .filter_map(|n| self.pixel(on_side, steps + f64::from(n)))
            .filter(|s| s.z > 0.0)
            .map(|s| s.z)
            .collect();
        let middle = depths.len() / 2;
        let depth = *depths.select_nth_unstable_by(middle, f64::total_cmp).1;
        let ray = k.ray(u.round(), v.round());
        let foot = (ray * depth - on_side).dot(&self.outward) / self.pitch;
        let free = steps.min(foot) - last - 1.0;
        if free >= LOST && free * self.pitch <= WIDEST_BLIND_GAP {
            End::Beside
        } else {
            End::Hidden { over: foot < 0.0 }
        }
    }

    /// True when beyond a side, as far as the widest gap, nearly everything is measured, a little deeper.
    fn stays_close(&self, on_side: &Vector, steps: f64) -> bool {
        /// Share of the pixels that must be so.
        const NEARLY: f64 = 0.7;
        let count = (WIDEST_BLIND_GAP / self.pitch).ceil().clamp(3.0, 60.0) as usize;
        let close = (1..=count)
            .filter_map(|n| self.pixel(on_side, steps + n as f64))
            .filter(|s| {
                let drop = s.z - s.expected;
                s.z > 0.0 && drop > 0.5 * self.tolerance && drop < THIN
            })
            .count();
        close as f64 >= NEARLY * count as f64
    }
}
