//! Whether a surface is a board of the pallet: bearers come out from under it.
//!
//! What a carton stands on lies as deep beneath its top as it is high. A deck board lies on bearers, which show on both
//! of its sides, at the same places and equally deep, and no deeper than a board is thick. Two lower cartons beside a
//! higher one are seen so as well, but those are found. The outermost boards of a pallet show bearers on one side only,
//! as a carton beside one lower one does: they are boards because others that lie as high on bearers as deep are.

use depal_frames::{Point, Vector};

use crate::{
    DetectedBox, RejectReason, RejectedSurface, VisionSettings, gate::DepthImage,
    patch::pixel_pitch, plane::PlaneFrame, surface::Surface,
};

/// Boards are so thick, metres: deck boards of pallets have 15 to 25 mm.
const THICK: std::ops::Range<f64> = 0.010..0.030;
/// Bearers are so wide, all of a board together, metres: three stringers have 110 mm, two cut ones still this.
const LEAST_WIDTH: f64 = 0.030;
/// On both sides of a board a bearer lies equally deep, and so do all along it, metres.
const EQUALLY: f64 = 0.0025;
/// So far beyond a side is looked, metres: boards lie closer to each other.
const REACH: f64 = 0.050;
/// Where a surface ends, pixels from the bounds of its mask.
const BORDER: std::ops::RangeInclusive<i32> = -5..=5;
/// The next pixel may be a mixed one.
const TORN: i32 = 2;
/// Measured pixels that make one depth, the middle of them.
const PIXELS: usize = 5;
/// Distance of the lines across, pixels.
const SPACING: f64 = 6.0;

/// A surface beneath which bearers come out.
pub struct Board {
    frame: PlaneFrame,
    extents: [f64; 2],
    /// Where bearers are seen.
    places: Vec<Point>,
    /// How deep they lie beneath it, metres.
    drop: f64,
    /// They come out on both sides. The outermost boards of a pallet show them on one only.
    both: bool,
}

impl Board {
    /// Looks beneath all sides of a surface's bounds; `None` with too few bearers.
    pub fn new(
        surface: &mut Surface,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
    ) -> Option<Self> {
        let bounds = surface.bounds(mask, image, settings).ok()?;
        let frame = surface.middle(&bounds);
        let extents = [bounds.x, bounds.y].map(|[low, high]| high - low);
        let tolerance = settings.plane_tolerance;
        let look = Look {
            image,
            frame: &frame,
            tolerance,
            pitch: pixel_pitch(&frame, &image.intrinsics),
        };
        let mut best: Option<Self> = None;
        for axis in 0..2 {
            let [low, high] = [-1.0, 1.0].map(|sign| look.beneath_all(extents, axis, sign));
            let alike = |(a, b): &(&Option<Bearer>, &Option<Bearer>)| match (a, b) {
                (Some(a), Some(b)) => (a.drop - b.drop).abs() < equally(tolerance),
                _ => false,
            };
            let pairs = low.iter().zip(&high).filter(alike);
            let both: Vec<Bearer> = pairs.flat_map(|(a, b)| [*a, *b]).flatten().collect();
            let single = [low, high].map(|side| side.into_iter().flatten().collect());
            let [low, high]: [Vec<Bearer>; 2] = single;
            for (is_both, mut seen) in [(true, both), (false, low), (false, high)] {
                let lines = seen.len() / if is_both { 2 } else { 1 };
                seen.sort_by(|a, b| a.drop.total_cmp(&b.drop));
                // Of a few lines the outermost may err.
                let few = seen.len() / 10;
                let is_level = lines as f64 * SPACING * look.pitch >= LEAST_WIDTH
                    && seen[seen.len() - 1 - few].drop - seen[few].drop < equally(tolerance);
                let is_better = best.as_ref().is_none_or(|b| is_both && !b.both);
                if is_level && is_better {
                    best = Some(Self {
                        frame,
                        extents,
                        drop: seen[seen.len() / 2].drop,
                        places: seen.iter().map(|b| b.place).collect(),
                        both: is_both,
                    });
                }
            }
        }
        best
    }

    /// True when another one lies as high, on bearers as deep.
    fn is_like(&self, other: &Self, tolerance: f64) -> bool {
        let apart = (self.frame.origin - other.frame.origin).dot(&other.frame.plane.normal());
        apart.abs() < 2.0 * tolerance && (self.drop - other.drop).abs() < equally(tolerance)
    }

    /// True when a box lies in its plane and on it, and is higher than two boards.
    fn holds(&self, found: &DetectedBox, tolerance: f64) -> bool {
        let p = Point::from(found.camera_from_box.translation.vector) - self.frame.origin;
        let inside = |axis: &Vector, extent: f64| p.dot(axis).abs() < extent / 2.0;
        found.size.height >= 2.0 * THICK.end
            && p.dot(&self.frame.plane.normal()).abs() < 2.0 * tolerance
            && inside(&self.frame.x, self.extents[0])
            && inside(&self.frame.y, self.extents[1])
    }

    /// True when most of what comes out beneath it are tops of cartons.
    fn is_between(&self, cartons: &[DetectedBox], tolerance: f64) -> bool {
        let is_top = |place: &&Point| {
            cartons.iter().any(|b| {
                let p = b.camera_from_box.inverse_transform_point(place);
                p.x.abs() < b.size.length / 2.0 + tolerance
                    && p.y.abs() < b.size.width / 2.0 + tolerance
                    && p.z.abs() < tolerance
            })
        };
        2 * self.places.iter().filter(is_top).count() > self.places.len()
    }
}

/// Takes out what was found on boards.
pub fn refuse_boards(
    found: &mut Vec<DetectedBox>,
    boards: &[Board],
    tolerance: f64,
) -> Vec<RejectedSurface> {
    let free = boards.iter().filter(|b| !b.is_between(found, tolerance));
    let (certain, others): (Vec<&Board>, Vec<&Board>) = free.partition(|b| b.both);
    let alike = |b: &&Board| certain.iter().any(|c| b.is_like(c, tolerance));
    let boards: Vec<&Board> = others.into_iter().filter(alike).collect();
    let boards = [certain, boards].concat();
    let refused = |b: &DetectedBox| boards.iter().any(|board| board.holds(b, tolerance));
    let rejected = found
        .iter()
        .filter(|b| refused(b))
        .map(|b| RejectedSurface {
            reason: RejectReason::NoKnownSize,
            centre_in_camera: Point::from(b.camera_from_box.translation.vector),
            area: b.size.length * b.size.width,
        });
    let rejected = rejected.collect();
    found.retain(|b| !refused(b));
    rejected
}

fn equally(tolerance: f64) -> f64 {
    EQUALLY.max(0.5 * tolerance)
}

/// A bearer where a line across a side meets it.
#[derive(Debug, Clone, Copy, Default)]
struct Bearer {
    place: Point,
    /// How deep beneath the surface, metres.
    drop: f64,
}

struct Look<'a> {
    image: &'a DepthImage<'a>,
    frame: &'a PlaneFrame,
    tolerance: f64,
    pitch: f64,
}

impl Look<'_> {
    /// What lines across a side, evenly spaced, meet beside it.
    fn beneath_all(&self, extents: [f64; 2], axis: usize, sign: f64) -> Vec<Option<Bearer>> {
        let length = extents[1 - axis];
        let lines = (length / (SPACING * self.pitch)) as usize;
        let along = |n: usize| ((n as f64 + 0.5) / lines as f64 - 0.5) * length;
        (0..lines)
            .map(|n| self.beneath(extents, axis, sign, along(n)))
            .collect()
    }

    /// What is seen right beside the surface, and how deep beneath it, if that is a board's thickness.
    fn beneath(&self, extents: [f64; 2], axis: usize, sign: f64, along: f64) -> Option<Bearer> {
        let side = sign * extents[axis] / 2.0;
        let from = if axis == 0 {
            self.frame.point(side, along)
        } else {
            self.frame.point(along, side)
        };
        let outward = [self.frame.x, self.frame.y][axis] * sign;
        let normal = self.frame.plane.normal();
        let k = &self.image.intrinsics;
        let (width, height) = (self.image.width as f64, self.image.height as f64);
        // Outside the image; not measured; measured.
        let at = |steps: i32| -> Option<Option<Bearer>> {
            let (u, v) = k.project(&(from + outward * (f64::from(steps) * self.pitch)));
            let (u, v) = (u + 0.5, v + 0.5);
            let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
            inside.then(|| {
                let (u, v) = (u as u32, v as u32);
                let z = self.image.depth[v as usize * self.image.width + u as usize];
                (z > 0.0).then(|| {
                    let place = k.deproject(f64::from(u), f64::from(v), f64::from(z));
                    let drop = (self.frame.origin - place).dot(&normal);
                    Bearer { place, drop }
                })
            })
        };
        let is_on =
            |steps: i32| matches!(at(steps), Some(Some(b)) if b.drop.abs() <= self.tolerance);
        let last = BORDER.rev().find(|&steps| is_on(steps))?;
        let end = last + (REACH / self.pitch) as i32;
        let mut seen = [Bearer::default(); PIXELS];
        let (mut count, mut level) = (0, 0);
        for steps in last + TORN..=end {
            let Some(measured) = at(steps)? else {
                continue;
            };
            // Where most of them lie as high as the surface, so does the middle one.
            level += usize::from(measured.drop < THICK.start);
            if level > PIXELS / 2 {
                return None;
            }
            seen[count] = measured;
            count += 1;
            if count == PIXELS {
                seen.sort_by(|a, b| a.drop.total_cmp(&b.drop));
                let middle = seen[PIXELS / 2];
                // The wall of a neighbour, seen through a gap, falls by millimetres from pixel to pixel.
                let [above, below] = [1, PIXELS - 2].map(|n| seen[n].drop);
                let is_level = below - above < equally(self.tolerance);
                return (is_level && THICK.contains(&middle.drop)).then_some(middle);
            }
        }
        None
    }
}
