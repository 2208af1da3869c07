//! Moves that somebody else has given: nothing is planned, but nothing may touch.

use std::fmt;

use depal_arm::Arm;
use depal_frames::{JointPositions, PlacedShape};

use crate::{
    bodies::{Body, Robot},
    contact::{Check, Measured},
    path::corner_states,
    plan::Motion,
    refusal::{Obstacle, Stage, Touch},
    request::PlanRequest,
    world::World,
};

/// Spacing of the joint states that stand for a straight line of the tool, m; the joints move evenly between them.
const LINE_SPACING: f64 = 0.02;
/// ... and of its turns, rad.
const LINE_TURN: f64 = 0.05;
/// A straight line may turn a joint by this much per step; more means that it runs into a singularity, rad.
const LINE_JUMP: f64 = 0.25;
/// Distances beyond this are not measured, m.
const CAP: f32 = 0.5;
/// Neighbouring states differ by at most this, rad, so that a body's way is close to its displacement.
const WIDEST: f64 = 0.15;
/// Intervals in which no body point moves farther than this are not split any more, m.
const FINEST: f32 = 0.002;

/// One move of a way that was taught or computed elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenMove {
    /// Where it ends, rad.
    pub joints: JointPositions,
    /// How it gets there.
    pub motion: Motion,
    /// The carton on the gripper meanwhile, tool frame.
    pub carried: Option<PlacedShape>,
    /// The carton comes out of a stack or is put down: as in planned picks it counts as smaller by
    /// `PlannerSettings::stack_tolerance` on every side.
    pub is_beside_others: bool,
    /// Boxes of the request that are no obstacles to this move: those that hang on the gripper, or that it goes down to.
    pub without: Vec<usize>,
    /// The arm stands at the end of this move; else the corner to the next one may be cut by `PlannerSettings::corner_zone`.
    pub stops: bool,
    /// It is checked; else it only leads to the next one.
    pub is_checked: bool,
}

/// Why given moves cannot be gone.
#[derive(Debug, Clone, PartialEq)]
pub enum MoveRefusal {
    /// Something meets something.
    Touches {
        /// Index of the move; a corner counts to the move before it.
        at: usize,
        /// Name of the moving body: a link, `gripper` or `carton`.
        body: String,
        /// What it meets.
        obstacle: Obstacle,
    },
    /// The arm cannot follow the straight line of a move.
    LeavesReach {
        /// Index of the move.
        at: usize,
    },
}

impl MoveRefusal {
    /// Index of the move.
    pub fn at(&self) -> usize {
        let (Self::Touches { at, .. } | Self::LeavesReach { at }) = self;
        *at
    }

    /// The same with box `i` called `numbers[i]`: the request's boxes were taken out of a longer list.
    #[must_use]
    pub fn renumbered(mut self, numbers: &[usize]) -> Self {
        if let Self::Touches {
            obstacle: Obstacle::Box(i) | Obstacle::BelowBox(i),
            ..
        } = &mut self
        {
            *i = numbers.get(*i).copied().unwrap_or(*i);
        }
        self
    }
}

impl fmt::Display for MoveRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Touches { body, obstacle, .. } => write!(f, "{body} meets {obstacle}"),
            Self::LeavesReach { .. } => f.write_str("the arm cannot follow the straight line"),
        }
    }
}

impl std::error::Error for MoveRefusal {}

/// Proves that nothing touches along given moves, one after another from the request's start, by measuring the bare bodies:
/// between two states nothing can touch when no body point moves farther than the sum of both distances; otherwise the
/// interval is halved. Corners that may be cut are looked at in six states each.
///
/// Of the request, `place` does not matter.
///
/// # Errors
/// The first move that touches something, or that the arm cannot follow.
pub fn check_moves(request: &PlanRequest, moves: &[GivenMove]) -> Result<(), MoveRefusal> {
    if moves.iter().all(|given| !given.is_checked) {
        return Ok(());
    }
    let robot = Robot::new(request.arm, request.gripper);
    let world = World::new(request, 0.0);
    let tool =
        |q: &JointPositions| request.arm.base_from_flange(q) * request.gripper.flange_from_tcp;
    let mut from = request.start;
    for (at, given) in moves.iter().enumerate() {
        let start = std::mem::replace(&mut from, given.joints);
        if !given.is_checked {
            continue;
        }
        let shrink = if given.is_beside_others {
            request.settings.stack_tolerance
        } else {
            0.0
        };
        let carton: Option<Body> = given.carried.as_ref().map(|c| robot.carton(c, shrink));
        let check = Check {
            robot: &robot,
            world: &world,
            carton: carton.as_ref(),
            without: &given.without,
            stage: Stage::Certificate,
        };
        let touches = |touch: Touch| MoveRefusal::Touches {
            at,
            body: touch.body,
            obstacle: touch.obstacle,
        };
        let states = match given.motion {
            Motion::Joint => Some(vec![start, given.joints]),
            Motion::Linear => straight_line(request.arm, &start, &given.joints),
        };
        let states = states.ok_or(MoveRefusal::LeavesReach { at })?;
        prove(&check, &states).map_err(touches)?;
        if let Some(next) = moves.get(at + 1).filter(|_| !given.stops) {
            let zone = request.settings.corner_zone;
            let corner = corner_states(tool, &start, &given.joints, &next.joints, zone);
            if let Some(touch) = corner.iter().find_map(|q| check.touch(q)) {
                return Err(touches(touch));
            }
        }
    }
    Ok(())
}

/// Joint states along the straight line of the tool between two states; none when the arm cannot follow it.
fn straight_line(
    arm: &Arm,
    from: &JointPositions,
    to: &JointPositions,
) -> Option<Vec<JointPositions>> {
    let (first, last) = (arm.base_from_flange(from), arm.base_from_flange(to));
    let way = (last.translation.vector - first.translation.vector).norm();
    let turn = first.rotation.angle_to(&last.rotation);
    let steps = (way / LINE_SPACING).max(turn / LINE_TURN).ceil().max(1.0) as usize;
    let mut states = vec![*from];
    for step in 1..=steps {
        let share = step as f64 / steps as f64;
        let pose = first.try_lerp_slerp(&last, share, 1e-9)?;
        let before = states[states.len() - 1];
        let next = arm.inverse_nearest(&pose, &before)?;
        if next.max_distance(&before) > LINE_JUMP {
            return None;
        }
        states.push(next);
    }
    Some(states)
}

/// A state and what was measured there.
type Known = (JointPositions, Measured);

fn prove(check: &Check, states: &[JointPositions]) -> Result<(), Touch> {
    let mut before = measured(check, &states[0])?;
    for next in &states[1..] {
        let after = measured(check, next)?;
        between(check, &before, &after)?;
        before = after;
    }
    Ok(())
}

fn measured(check: &Check, joints: &JointPositions) -> Result<Known, Touch> {
    let found = check.measure(joints, CAP);
    match found.nearest {
        Some(touch) if found.distance <= 0.0 => Err(touch),
        _ => Ok((*joints, found)),
    }
}

fn between(check: &Check, from: &Known, to: &Known) -> Result<(), Touch> {
    let way = check.displacement(&from.1.poses, &to.1.poses);
    let is_near = from.0.max_distance(&to.0) <= WIDEST;
    if way <= FINEST || (is_near && way < (from.1.distance + to.1.distance) * 0.9) {
        return Ok(());
    }
    let middle = measured(check, &from.0.lerp(&to.0, 0.5))?;
    between(check, from, &middle)?;
    between(check, &middle, to)
}
