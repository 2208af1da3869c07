use std::sync::atomic::{AtomicBool, Ordering};

use depal_frames::JointPositions;

use super::{
    attempt::Attempt,
    free::{FreeMove, free_way},
    notes::Notes,
    waypoints::finished,
};
use crate::{
    certificate::{Stretch, certify},
    contact::Check,
    grasp::Grasp,
    group::Group,
    path::{touch_on_states, vertical_line},
    plan::PickPlan,
    refusal::Stage,
    situation::{Situation, Worlds},
};

/// An attempt with a height to lift to.
pub(super) struct Lifted<'a> {
    pub group: &'a Group,
    pub grasp: &'a Grasp,
    pub attempt: &'a Attempt,
    /// Straight up from the pick, m.
    pub lift: f64,
    /// How much higher that is than the neighbours ask for, m.
    pub beyond: f64,
}

/// The five stretches of a way, as joint states.
pub(super) struct States {
    pub there: Vec<JointPositions>,
    pub approach: Vec<JointPositions>,
    pub lift: Vec<JointPositions>,
    pub back: Vec<JointPositions>,
    pub set_down: Vec<JointPositions>,
}

/// The whole way of one attempt, or what hinders it.
pub(super) fn way(situation: &Situation, lifted: &Lifted, search: bool) -> Result<PickPlan, Notes> {
    let mut notes = Notes::default();
    let Some((states, clearance)) = states(situation, lifted, search, &mut notes) else {
        return Err(notes);
    };
    finished(situation, lifted, &states, clearance).map_err(|error| {
        notes.driving = Some(Box::new(error));
        notes
    })
}

fn states(
    situation: &Situation,
    lifted: &Lifted,
    search: bool,
    notes: &mut Notes,
) -> Option<(States, f64)> {
    let request = situation.request;
    let (arm, settings, robot) = (request.arm, request.settings, &situation.robot);
    let &Lifted { grasp, attempt, .. } = lifted;
    let carton = robot.carton(&grasp.carried, 0.0);
    let shrunk = robot.carton(&grasp.carried, settings.stack_tolerance);
    let check = |stage, world, carton, without| Check {
        robot,
        world,
        carton,
        without,
        stage,
    };
    let Worlds { far, close, bare } = &situation.worlds;
    let target = &lifted.group.members[..];

    // The straight moves.
    let mut line = |start: &JointPositions, rise: f64, stage: Stage| {
        let states = vertical_line(arm, start, rise);
        if states.is_none() {
            notes.straight = Some(stage);
        }
        states
    };
    let rise = settings.approach_height.max(lifted.beyond);
    let mut approach = line(&attempt.pick, rise, Stage::Approach)?;
    approach.reverse();
    let lift = line(&attempt.pick, lifted.lift, Stage::Lift)?;
    let mut set_down = line(&attempt.place, settings.place_height, Stage::SetDown)?;
    set_down.reverse();
    let down = check(Stage::Approach, close, None, target);
    let up = check(Stage::Lift, close, Some(&shrunk), target);
    let lower = check(Stage::SetDown, close, Some(&shrunk), target);
    let lower_bare = check(Stage::SetDown, bare, Some(&carton), target);
    for (check, states) in [
        (&down, &approach),
        (&up, &lift),
        (&lower, &set_down),
        (&lower_bare, &set_down),
    ] {
        if let Some(touch) = touch_on_states(check, states) {
            notes.touched(touch);
            return None;
        }
    }

    // The free moves, side by side; what the second one meets does not count where the first one fails.
    let first_world = if situation.starts_far { far } else { close };
    let to_pick = FreeMove {
        check: check(Stage::TransferToPick, first_world, None, &[]),
        beside: close,
        from: request.start,
        before: None,
        after: &approach,
        upright: None,
        search,
    };
    let to_place = FreeMove {
        check: check(Stage::TransferToPlace, far, Some(&carton), target),
        beside: close,
        from: lift[lift.len() - 1],
        before: Some(&lift),
        after: &set_down,
        upright: Some(settings.max_carry_tilt),
        search,
    };
    let has_failed = AtomicBool::new(false);
    let (there, back) = rayon::join(
        || {
            let there = free_way(situation, &to_pick);
            has_failed.store(there.is_err(), Ordering::Relaxed);
            there
        },
        || (!has_failed.load(Ordering::Relaxed)).then(|| free_way(situation, &to_place)),
    );
    let mut noted = |way: Result<_, Notes>| way.map_err(|met| notes.append(met)).ok();
    let there = noted(there)?;
    let back = noted(back.expect("left out only when the first fails"))?;

    // The certificate: true bodies, all of the way.
    let fine = |carton, without| check(Stage::Certificate, bare, carton, without);
    let (empty, aside, loaded) = (
        fine(None, &[]),
        fine(None, target),
        fine(Some(&carton), target),
    );
    let stretches = [
        Stretch::new(&empty, &there),
        Stretch::new(&aside, &approach),
        Stretch::new(&aside, &lift),
        Stretch::new(&loaded, &back),
        Stretch::new(&aside, &set_down),
    ];
    match certify(&stretches) {
        Ok(clearance) => {
            let states = States {
                there,
                approach,
                lift,
                back,
                set_down,
            };
            Some((states, clearance))
        }
        Err(touch) => {
            notes.touched(touch);
            None
        }
    }
}
