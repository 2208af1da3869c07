//! Cells in which raised vias alone do not do, and cells in which nothing does.

use depal_frames::{JointPositions, Pose, Rotation, Vector};
use depal_planner::{TransferGoal, plan_transfer};

use super::{
    cell::{cuboid, furniture, goal, obstacles, scene, transfers},
    hard_set::{questions, unsolvable},
    oracle::Oracle,
};

fn starts(layers: usize) -> Vec<(usize, JointPositions)> {
    transfers()
        .into_iter()
        .filter(|(_, n, _, _)| *n == layers)
        .map(|(_, _, slot, start)| (slot, start))
        .collect()
}

/// A share of the set; the benches have it in full.
#[test]
fn nearly_all_hard_cells_are_solved_and_no_way_touches() {
    let (mut tried, mut solved, mut missed) = (0, 0, Vec::new());
    for question in questions(1, 3) {
        tried += 1;
        let goal = TransferGoal::Joints(question.goal);
        match plan_transfer(&question.scene, &question.start, &goal) {
            Ok(plan) => {
                let checked = Oracle::new(&question.scene, 0.0).check(&plan);
                checked.unwrap_or_else(|touch| panic!("{}: {touch}", question.name));
                println!(
                    "{}: {:.3} s of {:.3} s, {} points, {:.1} mm, {}",
                    question.name,
                    plan.motion_time,
                    plan.lower_bound,
                    plan.waypoints.len(),
                    plan.min_clearance * 1e3,
                    plan.found_by
                );
                assert!(plan.waypoints.len() <= 20);
                solved += 1;
            }
            Err(refusal) => missed.push(format!("{}: {}", question.name, refusal.reason)),
        }
    }
    assert!(
        f64::from(solved) >= 0.95 * f64::from(tried),
        "{solved} of {tried}: {missed:#?}"
    );
}

#[test]
fn closed_cells_are_refused_with_what_stands_in_the_way() {
    for question in unsolvable(1, 4) {
        let goal = TransferGoal::Joints(question.goal);
        let refusal = plan_transfer(&question.scene, &question.start, &goal).unwrap_err();
        let said = &refusal.reason;
        assert!(
            said.contains("touches obstacle"),
            "{}: {said}",
            question.name
        );
    }
}

/// A closed wall between pallet and conveyor from floor to far above, and around the whole arm.
#[test]
fn walled_in_is_refused_in_words() {
    let (slot, start) = starts(3)[5];
    let mut all = obstacles(3, slot);
    all.push(cuboid([2.0, 1.2, 2.5], [8.0, 0.06, 5.0]));
    all.push(cuboid([-1.9, 1.2, 2.5], [4.0, 0.06, 5.0]));
    let refusal = plan_transfer(&scene(all), &start, &TransferGoal::Joints(goal())).unwrap_err();
    assert!(
        refusal.reason.contains("touches obstacle"),
        "{}",
        refusal.reason
    );
    assert!(refusal.lower_bound.is_some());
}

#[test]
fn ends_that_cannot_be_are_refused_in_words() {
    let (slot, start) = starts(3)[5];
    let request = scene(obstacles(3, slot));
    let refuse = |start: &JointPositions, goal: TransferGoal| {
        plan_transfer(&request, start, &goal).unwrap_err().reason
    };
    let mut beyond = goal();
    beyond[1] = 1.6;
    let said = refuse(&start, TransferGoal::Joints(beyond));
    assert!(
        said.contains("goal: joint 'j2' at 1.6000 rad is outside its limits"),
        "{said}"
    );
    let mut sunk = start;
    sunk[1] += 0.5;
    let said = refuse(&sunk, TransferGoal::Joints(goal()));
    assert!(
        said.starts_with("at the start 'tcp' touches obstacle"),
        "{said}"
    );
    let far = Pose::translation(5.0, 0.0, 1.0);
    let said = refuse(&start, TransferGoal::Tcp(far));
    assert!(said.contains("out of reach"), "{said}");
    let inside = Pose::from_parts(
        Vector::new(0.2, 1.85, 0.4).into(),
        Rotation::from_euler_angles(std::f64::consts::PI, 0.0, 0.0),
    );
    let said = refuse(&start, TransferGoal::Tcp(inside));
    assert!(said.contains("at the goal"), "{said}");
}

#[test]
fn a_pose_is_reached_with_whatever_posture_is_fastest() {
    let (slot, start) = starts(3)[5];
    let request = scene(obstacles(3, slot));
    let arm = &request.arm;
    let tcp = request.tcp_link.unwrap();
    let pose = arm.base_from_links(&goal())[tcp];
    let plan = plan_transfer(&request, &start, &TransferGoal::Tcp(pose)).unwrap();
    let last = plan.waypoints[plan.waypoints.len() - 1].joints;
    let reached = arm.base_from_links(&last)[tcp];
    assert!((reached.translation.vector - pose.translation.vector).norm() < 1e-6);
    Oracle::new(&request, 0.0).check(&plan).unwrap();
    let fixed = plan_transfer(&request, &start, &TransferGoal::Joints(goal())).unwrap();
    assert!(plan.motion_time <= fixed.motion_time * 1.05);
}

/// Bodies that never move against each other are checked like any other pair, unless they are allowed.
#[test]
fn a_tool_that_overlaps_its_load_must_be_allowed_to() {
    let (_, start) = starts(3)[5];
    let mut request = scene(furniture());
    request.attached[0].1 = cuboid([0.0, 0.0, 0.1], [0.3, 0.3, 0.25]);
    assert!(plan_transfer(&request, &start, &TransferGoal::Joints(goal())).is_ok());
    request
        .allowed_pairs
        .retain(|(a, b)| !(a == "tool0" && b == "tcp"));
    let refusal = plan_transfer(&request, &start, &TransferGoal::Joints(goal())).unwrap_err();
    assert!(
        refusal.reason.contains("in every posture"),
        "{}",
        refusal.reason
    );
}
