use depal_planner::{TransferGoal, plan_transfer};

use super::{
    cell::{goal, obstacles, scene, transfers},
    oracle::Oracle,
};

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn all_transfers_from_the_pallet_are_solved_quickly_and_never_touch() {
    let mut ratios = Vec::new();
    for (name, layers, slot, start) in transfers() {
        let request = scene(obstacles(layers, slot));
        let plan = plan_transfer(&request, &start, &TransferGoal::Joints(goal()));
        let plan = plan.unwrap_or_else(|refusal| panic!("{name}: {}", refusal.reason));
        println!(
            "{name} {:.3} s / {:.3} s, {} points, {:.1} mm, {}",
            plan.motion_time,
            plan.lower_bound,
            plan.waypoints.len(),
            plan.min_clearance * 1e3,
            plan.found_by
        );
        assert_eq!(plan.waypoints[0].joints, start);
        assert_eq!(plan.waypoints[plan.waypoints.len() - 1].joints, goal());
        assert!(plan.waypoints.len() <= 9);
        Oracle::new(&request, 0.0).check(&plan).unwrap();
        ratios.push(plan.motion_time / plan.lower_bound);
    }
    assert_eq!(ratios.len(), 44);
    assert!(median(ratios) <= 1.25);
}

/// The straight joint move is blocked for every one of them, so that the ladder has work to do.
#[test]
fn no_straight_move_is_free() {
    for (name, layers, slot, start) in transfers() {
        let request = scene(obstacles(layers, slot));
        let touch = Oracle::new(&request, 0.0).touch_on_polyline(&[start, goal()]);
        assert!(touch.is_some(), "{name}");
    }
}

#[test]
fn the_same_question_gets_the_same_bits() {
    let (_, layers, slot, start) = transfers().swap_remove(3);
    let request = scene(obstacles(layers, slot));
    let goal = TransferGoal::Joints(goal());
    let first = plan_transfer(&request, &start, &goal).unwrap();
    let on_a_thread = std::thread::scope(|threads| {
        let again = threads.spawn(|| plan_transfer(&request, &start, &goal).unwrap());
        again.join().unwrap()
    });
    assert_eq!(first, on_a_thread);
}
