//! The pieces of a run as waypoints: poses become joints, offsets become poses.

use depal_frames::{JointPositions, Pose};
use depal_interface::{CustomPort, Motion, PathPoint, Status};
use depal_workflow::{Move, MoveMotion, Piece, Reference, Target};

use crate::planning::{Carried, PlannedPick, TOOL};
use crate::spec::CellSpec;
use crate::standing::Aim;

/// A finished path.
#[derive(Debug, Clone, Default)]
pub(crate) struct Joined {
    /// Waypoints in order.
    pub(crate) points: Vec<PathPoint>,
    /// Numbers of the gripper's outputs, by round.
    pub(crate) rounds: Vec<Vec<u16>>,
    /// Data of the vision projects' own, a row for each Vision Move.
    pub(crate) custom_ports: Vec<CustomPort>,
    /// What the plans aim at, by round.
    pub(crate) aims: Vec<Aim>,
    /// Where each waypoint comes from.
    pub(crate) origins: Vec<Origin>,
}

/// Where a waypoint comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A move of the project's own.
    Move {
        /// The step.
        step: i32,
        /// It puts a carton on its place of a pattern.
        is_place: bool,
        /// It waits for the waypoint after it: the way towards something.
        is_approach: bool,
    },
    /// A plan's.
    Planned {
        /// The Vision Move step.
        step: i32,
        /// Index of the piece.
        piece: usize,
        /// Index in the plan.
        index: usize,
    },
}

/// A waypoint, or a move that waits for the one after it.
enum Slot<'a> {
    Point(Box<PathPoint>),
    Open(&'a Move, &'a Pose, depal_workflow::OffsetFrame),
}

/// Joins the pieces of a path that begins at `start`, radians.
///
/// Of several joint positions for a pose the one nearest to the waypoint before is taken; a move that is relative to
/// the next waypoint stays near that one, so that the straight way between them keeps its branch.
///
/// # Errors
/// A waypoint is out of reach, or a place has no carton to put there.
pub(crate) fn join(
    spec: &CellSpec,
    start: &JointPositions,
    pieces: &[Piece<PlannedPick>],
) -> Result<Joined, Status> {
    let mut joined = Joined::default();
    let mut slots: Vec<Slot> = Vec::new();
    let mut before = *start;
    let mut carried: Option<Carried> = None;
    for (index, piece) in pieces.iter().enumerate() {
        let next = match piece {
            Piece::Planned { plan, step } => {
                let (step, piece) = (*step, index);
                let count = plan.points.len();
                joined
                    .origins
                    .extend((0..count).map(|index| Origin::Planned { step, piece, index }));
                carried = plan.carried;
                joined.rounds.extend(plan.rounds.iter().cloned());
                for port in &plan.custom_ports {
                    let known = joined.custom_ports.iter_mut().find(|p| p.name == port.name);
                    match known {
                        Some(known) => known.rows.extend(port.rows.iter().cloned()),
                        None => joined.custom_ports.push(port.clone()),
                    }
                }
                joined.aims.extend(plan.cartons.iter().map(|cartons| Aim {
                    cartons: cartons.clone(),
                    place: None,
                }));
                slots.extend(
                    plan.points
                        .iter()
                        .cloned()
                        .map(|ready| Slot::Point(Box::new(ready))),
                );
                before = plan.points.last().map_or(before, |point| point.joints);
                continue;
            }
            Piece::Move(next) => next,
        };
        joined.origins.push(Origin::Move {
            step: next.step,
            is_place: matches!(next.target, Target::Carton(_)),
            is_approach: is_approach(next),
        });
        let pose = match &next.target {
            Target::Joints(joints) => {
                if joints.len() != start.len() || !spec.arm.within_limits(joints) {
                    return Err(Status::VizUnreachable);
                }
                before = *joints;
                slots.push(Slot::Point(Box::new(point(spec, next, *joints))));
                continue;
            }
            Target::Relative {
                offset,
                frame,
                reference: Reference::Next,
            } => {
                slots.push(Slot::Open(next, offset, *frame));
                continue;
            }
            Target::Relative { offset, frame, .. } => {
                Target::offset_pose(&tool(spec, &before), offset, *frame)
            }
            Target::Tool(base_from_tcp) => *base_from_tcp,
            Target::Carton(base_from_place) => {
                if let Some(aim) = joined.aims.last_mut() {
                    aim.place = Some(*base_from_place);
                }
                let carried = carried.ok_or(Status::VizRuntimeError)?;
                carried.base_from_tcp(base_from_place, spec.planner.place_gap)
            }
        };
        before = reach(spec, &pose, &before)?;
        slots.push(Slot::Point(Box::new(point(spec, next, before))));
    }
    // From behind: what waits for the waypoint after it.
    let mut after: Option<PathPoint> = None;
    for slot in slots.into_iter().rev() {
        let ready = match slot {
            Slot::Point(ready) => *ready,
            Slot::Open(next, offset, frame) => {
                let reference = after.as_ref().ok_or(Status::VizRuntimeError)?;
                let pose = Target::offset_pose(&reference.base_from_tcp, offset, frame);
                point(spec, next, reach(spec, &pose, &reference.joints)?)
            }
        };
        joined.points.push(ready.clone());
        after = Some(ready);
    }
    joined.points.reverse();
    Ok(joined)
}

/// Joints at the end of a path that begins at `start`; moves that wait for a waypoint after it do not count.
pub(crate) fn end_of(
    spec: &CellSpec,
    start: &JointPositions,
    pieces: &[Piece<PlannedPick>],
) -> Result<JointPositions, Status> {
    let waits =
        |piece: &Piece<PlannedPick>| matches!(piece, Piece::Move(next) if is_approach(next));
    let count = pieces
        .iter()
        .rposition(|piece| !waits(piece))
        .map_or(0, |last| last + 1);
    let joined = join(spec, start, &pieces[..count])?;
    Ok(joined.points.last().map_or(*start, |point| point.joints))
}

/// Whether a move waits for the waypoint after it.
fn is_approach(next: &Move) -> bool {
    matches!(
        next.target,
        Target::Relative {
            reference: Reference::Next,
            ..
        }
    )
}

fn tool(spec: &CellSpec, joints: &JointPositions) -> Pose {
    spec.arm.base_from_flange(joints) * spec.gripper.flange_from_tcp
}

fn reach(
    spec: &CellSpec,
    base_from_tcp: &Pose,
    near: &JointPositions,
) -> Result<JointPositions, Status> {
    let base_from_flange = base_from_tcp * spec.gripper.flange_from_tcp.inverse();
    spec.arm
        .inverse_nearest(&base_from_flange, near)
        .ok_or(Status::VizUnreachable)
}

fn point(spec: &CellSpec, next: &Move, joints: JointPositions) -> PathPoint {
    PathPoint {
        joints,
        base_from_tcp: tool(spec, &joints),
        motion: match next.motion {
            MoveMotion::Joint => Motion::Joint,
            MoveMotion::Linear => Motion::Linear,
        },
        tool: TOOL,
        velocity_percent: next.velocity_percent,
        label: 0,
        vision_move: None,
    }
}
