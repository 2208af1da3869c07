//! Whether the project's own moves touch anything: the planner is asked, with what was known when it planned the pick.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use depal_frames::{JointPositions, PlacedShape, Point};
use depal_interface::{Motion, Status};
use depal_planner::{GivenMove, MoveRefusal, PlanRequest, SeenBox, check_moves};
use depal_workflow::Piece;

use crate::event::FailureReason;
use crate::picture::Picture;
use crate::planning::{PlannedPick, seen_boxes, seen_points};
use crate::spec::CellSpec;
use crate::waypoints::{Joined, Origin};

/// What stands around a pick, base frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Surroundings {
    /// Reports of the picture that no pick has taken before.
    boxes: Vec<SeenBox>,
    /// Their numbers in the picture.
    numbers: Vec<usize>,
    /// What the picture shows besides.
    points: Vec<Point>,
    /// Indices into `boxes`: what the pick takes away.
    picked: Vec<usize>,
    /// What then hangs on the gripper, tool frame.
    carried: Option<PlacedShape>,
    /// The plan leads on to the place; else the project's own moves lead to the pick and away from it.
    pub(crate) is_placed: bool,
}

impl Surroundings {
    /// Before a pick out of a picture.
    pub(crate) fn new(picture: &Picture, taken: &BTreeSet<usize>) -> Self {
        let all = 0..picture.detection.boxes.len();
        let numbers: Vec<usize> = all.filter(|index| !taken.contains(index)).collect();
        Self {
            boxes: seen_boxes(picture, &numbers),
            points: seen_points(picture),
            numbers,
            ..Self::default()
        }
    }

    /// A round of the pick takes these reports of the picture.
    pub(crate) fn take(&mut self, detections: &[usize], carried: &PlacedShape) {
        let index_of = |number: &usize| self.numbers.iter().position(|n| n == number);
        self.picked.extend(detections.iter().filter_map(index_of));
        self.carried = Some(carried.clone());
    }
}

/// Why a path is not flown.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blocked {
    /// For the robot.
    pub(crate) status: Status,
    /// For the report.
    pub(crate) reason: FailureReason,
    /// In words, with the step.
    pub(crate) words: String,
}

/// Waypoints that are flown in the same surroundings.
struct Leg {
    points: Range<usize>,
    around: Arc<Surroundings>,
}

/// Checks the moves of a joined path that no plan has proven: arm, gripper and the held carton against themselves, the
/// known cell, and what vision saw. A carton counts as held from the pick until it is put on its place of a pattern;
/// without one, until the last waypoint before the way to the next pick begins.
///
/// `picture` is for paths without a pick; `taken` are its reports that other paths have taken.
///
/// # Errors
/// The first move that touches something, or a straight one that the arm cannot follow.
pub(crate) fn check_path(
    spec: &CellSpec,
    start: &JointPositions,
    pieces: &[Piece<PlannedPick>],
    joined: &Joined,
    picture: Option<(&Picture, &BTreeSet<usize>)>,
) -> Result<(), Blocked> {
    let has_own = |origin: &Origin| matches!(origin, Origin::Move { .. });
    let picks = |piece: &Piece<PlannedPick>| matches!(piece, Piece::Planned { plan, .. } if !plan.surroundings.is_placed);
    if !joined.origins.iter().any(has_own) && !pieces.iter().any(picks) {
        return Ok(());
    }
    let mut from = *start;
    for leg in legs(pieces, joined, picture) {
        let moves = given(joined, &leg);
        let Leg { points, around } = leg;
        let request = PlanRequest {
            arm: &spec.arm,
            gripper: &spec.gripper,
            boxes: &around.boxes,
            known_obstacles: &spec.known_obstacles,
            obstacle_points: &around.points,
            start: from,
            place: &spec.place,
            settings: &spec.planner,
        };
        check_moves(&request, &moves).map_err(|refusal| {
            let (Origin::Move { step, .. } | Origin::Planned { step, .. }) =
                joined.origins[points.start + refusal.at()];
            blocked(step, refusal.renumbered(&around.numbers))
        })?;
        from = joined.points[points.end - 1].joints;
    }
    Ok(())
}

fn blocked(step: i32, refusal: MoveRefusal) -> Blocked {
    let (status, reason) = match refusal {
        MoveRefusal::Touches { .. } => (Status::VizCollision, FailureReason::PlanCollision),
        MoveRefusal::LeavesReach { .. } => (Status::VizUnreachable, FailureReason::IkUnreachable),
    };
    let words = format!("the move to step {step}: {refusal}");
    Blocked {
        status,
        reason,
        words,
    }
}

/// Each plan opens a leg; what comes before the first one belongs to it.
fn legs(
    pieces: &[Piece<PlannedPick>],
    joined: &Joined,
    picture: Option<(&Picture, &BTreeSet<usize>)>,
) -> Vec<Leg> {
    let mut legs: Vec<Leg> = Vec::new();
    for (at, origin) in joined.origins.iter().enumerate() {
        if let Origin::Planned {
            piece, index: 0, ..
        } = origin
            && let Piece::Planned { plan, .. } = &pieces[*piece]
        {
            let start = if legs.is_empty() { 0 } else { at };
            if let Some(before) = legs.last_mut() {
                before.points.end = at;
            }
            legs.push(Leg {
                points: start..joined.points.len(),
                around: Arc::clone(&plan.surroundings),
            });
        }
    }
    if legs.is_empty() && !joined.points.is_empty() {
        let around = picture.map(|(picture, taken)| Surroundings::new(picture, taken));
        legs.push(Leg {
            points: 0..joined.points.len(),
            around: Arc::new(around.unwrap_or_default()),
        });
    }
    legs
}

/// The moves of a leg as the planner takes them.
fn given(joined: &Joined, leg: &Leg) -> Vec<GivenMove> {
    let origins = &joined.origins[leg.points.clone()];
    let is_planned = |origin: &Origin| matches!(origin, Origin::Planned { .. });
    let is_approach = |origin: &Origin| {
        matches!(
            origin,
            Origin::Move {
                is_approach: true,
                ..
            }
        )
    };
    let is_place = |origin: &Origin| matches!(origin, Origin::Move { is_place: true, .. });
    let around = &leg.around;
    // Of a plan that ends at its pick, the moves behind it carry the carton up to the one that releases it.
    let picked_at = origins.iter().rposition(is_planned);
    let first_after = picked_at.map_or(origins.len(), |at| at + 1);
    let after = &origins[first_after..];
    let released_at = after
        .iter()
        .position(is_place)
        .or_else(|| after.iter().rposition(|origin| !is_approach(origin)))
        .filter(|_| !around.is_placed)
        .map(|place| first_after + place);
    let moves = origins.iter().enumerate().map(|(at, origin)| {
        let is_carrying = at >= first_after && released_at.is_some_and(|release| at <= release);
        let is_at_pick = is_planned(origin) && !around.is_placed;
        let follows_approach = at > 0 && is_approach(&origins[at - 1]);
        let point = &joined.points[leg.points.start + at];
        GivenMove {
            joints: point.joints,
            motion: match point.motion {
                Motion::Joint => depal_planner::Motion::Joint,
                Motion::Linear => depal_planner::Motion::Linear,
            },
            carried: around.carried.clone().filter(|_| is_carrying),
            is_beside_others: at == first_after || released_at == Some(at),
            without: if is_at_pick || at >= first_after {
                around.picked.clone()
            } else {
                Vec::new()
            },
            stops: is_planned(origin) || released_at == Some(at),
            is_checked: !is_planned(origin) || is_at_pick || follows_approach,
        }
    });
    moves.collect()
}
