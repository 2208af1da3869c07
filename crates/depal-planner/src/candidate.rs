use depal_frames::{Point, Vector};

use crate::{
    refusal::{RejectReason, Rejection},
    request::{PlannerSettings, SeenBox},
};

/// Boxes in the order in which they are tried, and those that are left out before any motion is planned.
pub(crate) struct Candidates {
    pub order: Vec<usize>,
    pub rejected: Vec<Rejection>,
}

impl Candidates {
    pub fn choose(boxes: &[SeenBox], place: &Point, settings: &PlannerSettings) -> Self {
        let mut rejected = Vec::new();
        let mut free = Vec::new();
        for (box_index, seen) in boxes.iter().enumerate() {
            match unfit(boxes, box_index, seen, settings) {
                Some(reason) => rejected.push(Rejection { box_index, reason }),
                None => free.push(box_index),
            }
        }
        let smallest = boxes
            .iter()
            .map(|b| b.size.height)
            .fold(f64::INFINITY, f64::min);
        let tolerance = smallest * settings.layer_share;
        let top = |i: usize| boxes[i].base_from_box.translation.z;
        let far_mm = |i: usize| {
            let at = boxes[i].base_from_box.translation.vector;
            ((at.xy() - place.coords.xy()).norm() * 1e3).round() as i64
        };
        // Layers from the highest top downwards; inside one the nearest to the place first.
        let mut order = Vec::new();
        while let Some(highest) = free.iter().map(|&i| top(i)).max_by(f64::total_cmp) {
            let (mut layer, rest): (Vec<usize>, Vec<usize>) =
                free.iter().partition(|&&i| highest - top(i) <= tolerance);
            layer.sort_by_key(|&i| (far_mm(i), i));
            order.extend(layer);
            free = rest;
        }
        Self { order, rejected }
    }
}

fn unfit(
    boxes: &[SeenBox],
    index: usize,
    seen: &SeenBox,
    settings: &PlannerSettings,
) -> Option<RejectReason> {
    if seen.confidence < settings.min_confidence {
        return Some(RejectReason::LowConfidence {
            confidence: seen.confidence,
            minimum: settings.min_confidence,
        });
    }
    let up = seen.base_from_box.rotation * Vector::z();
    let tilt = up.z.clamp(-1.0, 1.0).acos();
    if tilt > settings.max_tilt {
        return Some(RejectReason::Tilted {
            tilt,
            limit: settings.max_tilt,
        });
    }
    let top = seen.base_from_box.translation.z;
    boxes.iter().enumerate().find_map(|(by, other)| {
        // Only what begins above this top can lie on it: a taller neighbour beside it does not.
        let bottom = other.base_from_box.translation.z - other.size.height;
        if by == index || bottom < top - 0.5 * seen.size.height.min(other.size.height) {
            return None;
        }
        let overlap = footprint_overlap(seen, other);
        (overlap > settings.cover_tolerance).then_some(RejectReason::Covered { by, overlap })
    })
}

/// How deep two footprints overlap, m: the smallest overlap over the four side directions; negative is a gap.
pub(crate) fn footprint_overlap(a: &SeenBox, b: &SeenBox) -> f64 {
    let between = b.base_from_box.translation.vector - a.base_from_box.translation.vector;
    let sides = |s: &SeenBox| {
        [
            s.base_from_box.rotation * Vector::x() * (s.size.length * 0.5),
            s.base_from_box.rotation * Vector::y() * (s.size.width * 0.5),
        ]
    };
    let (sides_a, sides_b) = (sides(a), sides(b));
    sides_a
        .iter()
        .chain(&sides_b)
        .map(|side| {
            let axis = Vector::new(side.x, side.y, 0.0).normalize();
            let reach: f64 = sides_a
                .iter()
                .chain(&sides_b)
                .map(|s| s.dot(&axis).abs())
                .sum();
            reach - between.dot(&axis).abs()
        })
        .fold(f64::INFINITY, f64::min)
}
