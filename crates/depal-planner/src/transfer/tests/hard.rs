//! Cells in which raised vias alone do not do, and cells in which nothing does.

use depal_frames::{JointPositions, PlacedShape, Pose, Rotation, Vector};

use super::{
    cell::{cuboid, furniture, goal, obstacles, scene, transfers},
    pallet::fine_check,
};
use crate::transfer::{
    TransferGoal, plan_transfer,
    scene::{BARE, Scene},
};

fn starts(layers: usize) -> Vec<(usize, JointPositions)> {
    transfers()
        .into_iter()
        .filter(|(_, n, _, _)| *n == layers)
        .map(|(_, _, slot, start)| (slot, start))
        .collect()
}

/// Name of the obstacle and the obstacle.
fn hardships() -> Vec<(&'static str, Vec<PlacedShape>)> {
    vec![
        ("low beam", vec![cuboid([1.0, 0.9, 2.35], [0.2, 2.6, 0.3])]),
        (
            "post in the sweep of joint 1",
            vec![cuboid([1.35, 1.05, 1.4], [0.12, 0.12, 2.8])],
        ),
        (
            "rack on two sides",
            vec![
                cuboid([1.75, -0.75, 1.2], [1.4, 0.06, 2.4]),
                cuboid([2.55, 0.0, 1.2], [0.06, 1.4, 2.4]),
            ],
        ),
        (
            "roll cage",
            vec![
                cuboid([1.75, 0.62, 1.1], [1.25, 0.04, 2.0]),
                cuboid([1.75, -0.62, 1.1], [1.25, 0.04, 2.0]),
                cuboid([2.42, 0.0, 1.1], [0.04, 1.25, 2.0]),
            ],
        ),
        (
            "wall behind",
            vec![cuboid([-0.95, 0.0, 1.5], [0.2, 6.0, 3.0])],
        ),
        (
            "narrow aisle",
            vec![
                cuboid([-0.9, 0.0, 1.5], [0.2, 4.0, 3.0]),
                cuboid([0.4, -1.2, 1.5], [2.4, 0.2, 3.0]),
                cuboid([0.2, 2.4, 1.5], [2.4, 0.2, 3.0]),
            ],
        ),
    ]
}

#[test]
fn nearly_all_hard_cells_are_solved_and_no_way_touches() {
    let (mut tried, mut solved, mut missed) = (0, 0, Vec::new());
    for (name, extra) in hardships() {
        for (slot, start) in starts(4).into_iter().step_by(3) {
            let mut all = obstacles(4, slot);
            all.extend(extra.clone());
            let request = scene(all);
            let bare = Scene::new(&request);
            // Only questions whose ends are free.
            if bare.contact(&start, BARE).is_some() || bare.contact(&goal(), BARE).is_some() {
                continue;
            }
            tried += 1;
            match plan_transfer(&request, &start, &TransferGoal::Joints(goal())) {
                Ok(plan) => {
                    fine_check(&request, &plan, &start);
                    println!(
                        "{name} {slot}: {:.3} s of {:.3} s, {} points, {}",
                        plan.motion_time,
                        plan.lower_bound,
                        plan.waypoints.len(),
                        plan.found_by
                    );
                    assert!(plan.waypoints.len() <= 20);
                    solved += 1;
                }
                Err(refusal) => missed.push(format!("{name} {slot}: {}", refusal.reason)),
            }
        }
    }
    assert!(tried >= 24, "{tried}");
    assert!(
        f64::from(solved) >= 0.95 * f64::from(tried),
        "{solved} of {tried}: {missed:#?}"
    );
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
    fine_check(&request, &plan, &start);
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
