use depal_frames::{Point, Vector};

use crate::{
    grasp::grasps,
    group::{Group, fewest_picks},
    refusal::{RejectReason, Rejection},
    request::{PlanRequest, PlannerSettings, SeenBox},
};

/// Picks in the order in which they are tried, and boxes that are left out before any motion is planned.
pub(crate) struct Candidates {
    /// By layer, the highest first.
    pub layers: Vec<Vec<Group>>,
    pub rejected: Vec<Rejection>,
}

impl Candidates {
    pub fn choose(request: &PlanRequest) -> Self {
        let (boxes, settings) = (request.boxes, request.settings);
        let place = Point::from(request.place.base_from_place.translation.vector);
        let mut rejected = Vec::new();
        let mut free = Vec::new();
        for (box_index, seen) in boxes.iter().enumerate() {
            match unfit(boxes, box_index, seen, settings) {
                Some(reason) => rejected.push(Rejection {
                    box_index,
                    with: Vec::new(),
                    reason,
                }),
                None => free.push(box_index),
            }
        }
        let smallest = boxes
            .iter()
            .map(|b| b.size.height)
            .fold(f64::INFINITY, f64::min);
        let tolerance = smallest * settings.layer_share;
        let top = |i: usize| boxes[i].base_from_box.translation.z;
        let far_mm = |group: &Group| {
            let at = group.whole.base_from_box.translation.vector;
            ((at.xy() - place.coords.xy()).norm() * 1e3).round() as i64
        };
        // Layers from the highest top downwards; inside one the nearest to the place first.
        let mut layers = Vec::new();
        while let Some(highest) = free.iter().map(|&i| top(i)).max_by(f64::total_cmp) {
            let (layer, rest): (Vec<usize>, Vec<usize>) =
                free.iter().partition(|&&i| highest - top(i) <= tolerance);
            let single = |&i: &usize| Group::single(i, &boxes[i]);
            let mut picks = if settings.max_group > 1 {
                fewest_picks(boxes, &layer, settings, |group| {
                    load(group, settings) <= settings.max_load
                        && grasps(request.gripper, group, settings).is_ok()
                })
            } else {
                layer.iter().map(single).collect()
            };
            picks.sort_by_key(|group| (far_mm(group), group.members[0]));
            let grouped = picks.iter().filter(|group| group.members.len() > 1);
            let mut again: Vec<Group> =
                grouped.flat_map(|g| g.members.iter().map(single)).collect();
            again.sort_by_key(|group| (far_mm(group), group.members[0]));
            picks.extend(again);
            layers.push(picks);
            free = rest;
        }
        Self { layers, rejected }
    }
}

/// What would hang on the gripper, kg.
pub(crate) fn load(group: &Group, settings: &PlannerSettings) -> f64 {
    group.members.len() as f64 * settings.max_carton_mass
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
