use depal_frames::JointPositions;

use super::cell::{goal, obstacles, scene, transfers};
use crate::transfer::{
    TransferGoal, TransferPlan, TransferScene,
    law::{BlendedPath, distance},
    plan_transfer,
    scene::{BARE, Scene},
};

pub fn path(plan: &TransferPlan) -> BlendedPath {
    let points: Vec<JointPositions> = plan.waypoints.iter().map(|w| w.joints).collect();
    let blends: Vec<f64> = plan.waypoints.iter().map(|w| w.blend).collect();
    for i in 1..points.len() {
        let room = distance(&points[i - 1], &points[i]);
        assert!(blends[i - 1] + blends[i] <= room, "blends overlap at {i}");
    }
    assert_eq!((blends[0], blends[blends.len() - 1]), (0.0, 0.0));
    BlendedPath::new(&points, &blends)
}

/// The path as promised, every 0.002 rad, with bare bodies: nothing touches, and nothing is nearer than was said.
pub fn fine_check(request: &TransferScene, plan: &TransferPlan, start: &JointPositions) {
    let scene = Scene::new(request);
    let mut least = f64::INFINITY;
    for (i, state) in path(plan).states(0.002, start).iter().enumerate() {
        let contact = scene.contact(state, BARE);
        assert!(contact.is_none(), "{}", scene.words(contact.unwrap()));
        if i % 4 == 0 {
            least = least.min(scene.distances(state, 2.5).least);
        }
    }
    assert!(
        (plan.min_clearance - least).abs() < 1e-3 + 0.1 * least,
        "said {} m, is {least} m",
        plan.min_clearance
    );
}

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
        fine_check(&request, &plan, &start);
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
        let scene = Scene::new(&request);
        let states = BlendedPath::new(&[start, goal()], &[0.0; 2]).states(0.01, &start);
        assert!(
            states.iter().any(|q| scene.contact(q, BARE).is_some()),
            "{name}"
        );
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
