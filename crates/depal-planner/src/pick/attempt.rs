use depal_frames::{JointPositions, Pose, Rotation, Vector};
use rayon::prelude::*;

use super::notes::Notes;
use crate::{
    contact::Check, grasp::Grasp, group::Group, refusal::Stage, situation::Situation,
    timing::Trapezoid,
};

/// One combination of grasp, joints at the pick and joints at the place.
pub(super) struct Attempt {
    /// Index among the grasps that were asked for.
    pub grasp: usize,
    pub pick: JointPositions,
    pub place: JointPositions,
    /// Obstacle-free, s.
    time: f64,
}

/// The fastest combinations whose pick and place are reachable and free, in order of obstacle-free time;
/// equally fast ones in the order of grasps, turns at the place and joints.
pub(super) fn attempts(
    situation: &Situation,
    group: &Group,
    grasps: &[Grasp],
    notes: &mut Notes,
) -> Vec<Attempt> {
    let by_grasp: Vec<(Vec<Attempt>, Notes)> = grasps
        .par_iter()
        .enumerate()
        .map(|(index, grasp)| of_grasp(situation, group, index, grasp))
        .collect();
    let mut attempts = Vec::new();
    for (mut found, noted) in by_grasp {
        attempts.append(&mut found);
        notes.append(noted);
    }
    attempts.sort_by(|a, b| a.time.total_cmp(&b.time));
    attempts.truncate(situation.request.settings.attempts_per_grasp);
    attempts
}

fn of_grasp(
    situation: &Situation,
    group: &Group,
    index: usize,
    grasp: &Grasp,
) -> (Vec<Attempt>, Notes) {
    let request = situation.request;
    let (arm, settings) = (request.arm, request.settings);
    let tcp_from_flange = request.gripper.flange_from_tcp.inverse();
    let mut attempts = Vec::new();
    let mut notes = Notes::default();
    let at_pick = situation.base_from_group(group) * grasp.box_from_tcp * tcp_from_flange;
    let empty = Check {
        robot: &situation.robot,
        world: &situation.worlds.close,
        carton: None,
        without: &group.members,
        stage: Stage::Pick,
    };
    let picks = arm.inverse(&at_pick);
    notes.poses += 1;
    notes.reached_pick |= !picks.is_empty();
    let picks = free_states(&empty, picks, &mut notes);
    if picks.is_empty() {
        return (attempts, notes);
    }
    let shrunk = situation
        .robot
        .carton(&grasp.carried, settings.stack_tolerance);
    let loaded = Check {
        carton: Some(&shrunk),
        stage: Stage::Place,
        ..empty
    };
    for &yaw in &request.place.yaws {
        let turn = Rotation::from_axis_angle(&Vector::z_axis(), yaw);
        let up = Pose::translation(0.0, 0.0, group.whole.size.height + settings.place_gap);
        let base_from_placed = request.place.base_from_place * turn * up;
        let places = arm.inverse(&(base_from_placed * grasp.box_from_tcp * tcp_from_flange));
        notes.poses += 1;
        notes.reached_place |= !places.is_empty();
        for place in free_states(&loaded, places, &mut notes) {
            for pick in &picks {
                let there = Trapezoid::joints(&request.start, pick, arm.limits());
                let back = Trapezoid::joints(pick, &place, arm.limits());
                attempts.push(Attempt {
                    grasp: index,
                    pick: *pick,
                    place,
                    time: there.duration + back.duration,
                });
            }
        }
    }
    (attempts, notes)
}

/// The states that touch nothing; what the others touch is noted.
fn free_states(
    check: &Check,
    states: Vec<JointPositions>,
    notes: &mut Notes,
) -> Vec<JointPositions> {
    states
        .into_iter()
        .filter(|q| match check.touch(q) {
            None => true,
            Some(touch) => {
                notes.touched(touch);
                false
            }
        })
        .collect()
}
