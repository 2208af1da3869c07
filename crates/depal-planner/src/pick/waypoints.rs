use depal_frames::JointPositions;
use depal_motion::MotionError;

use super::way::{Lifted, States};
use crate::{
    candidate::load,
    plan::{Motion, PickPlan, Waypoint},
    situation::Situation,
    suction::{along, loaded_percent, vertical_percent},
    timing::{Trapezoid, predicted_time},
};

/// A proven way as waypoints, with the velocities that the suction bears.
///
/// # Errors
/// Where the law that moves the arm cannot make the moves.
pub(super) fn finished(
    situation: &Situation,
    lifted: &Lifted,
    states: &States,
    min_clearance: f64,
) -> Result<PickPlan, MotionError> {
    let &Lifted { group, grasp, .. } = lifted;
    let request = situation.request;
    let (arm, settings) = (request.arm, request.settings);
    let mut waypoints: Vec<Waypoint> = Vec::new();
    let mut add = |joints: &JointPositions, motion, percent: f64, is_pick| {
        waypoints.push(Waypoint {
            joints: *joints,
            base_from_tcp: situation.tool(joints),
            motion,
            velocity_percent: percent,
            is_pick,
        });
    };
    let end = |states: &[JointPositions]| states[states.len() - 1];
    let States {
        there,
        approach,
        lift,
        back,
        set_down,
    } = states;
    for w in there.windows(2) {
        add(&w[1], Motion::Joint, 100.0, false);
    }
    add(&end(approach), Motion::Linear, 100.0, true);
    let upwards = vertical_percent(&grasp.hold, settings);
    add(&end(lift), Motion::Linear, upwards, false);
    let carton_in_tcp = grasp.carried.pose.translation.vector;
    for w in back.windows(2) {
        let profile = Trapezoid::joints(&w[0], &w[1], arm.limits());
        let percent = loaded_percent(
            &profile,
            along(|q| situation.tool(q), &w[0], &w[1]),
            &carton_in_tcp,
            &grasp.hold,
            settings,
        );
        add(&w[1], Motion::Joint, percent, false);
    }
    add(&end(set_down), Motion::Linear, upwards, false);
    let size = group.whole.size;
    let mass = load(group, settings);
    let estimated_time = predicted_time(request, &waypoints, mass, &carton_in_tcp)?;
    Ok(PickPlan {
        pick_index: there.len() - 1,
        estimated_time,
        waypoints,
        box_index: group.members[0],
        box_indices: group.members.clone(),
        base_from_group: situation.base_from_group(group),
        sections: grasp.sections.clone(),
        tcp_offset: grasp.tcp_offset,
        edge_corner_id: grasp.edge_corner_id,
        group_orientation: u8::from(grasp.across),
        box_orientation: u8::from(group.is_across),
        group_size: [size.length, size.width, size.height],
        carried: grasp.carried.clone(),
        min_clearance,
        rejected: Vec::new(),
    })
}
