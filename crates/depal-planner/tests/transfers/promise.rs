//! What is said of a plan is true of the very path it promises.

use depal_frames::{JointPositions, PlacedShape};
use depal_planner::{TransferChecker, TransferGoal, TransferPlan, plan_transfer};
use depal_time::{RandomStream, RandomStreams};

use super::{
    cell::{cuboid, furniture, scene},
    oracle::{Oracle, fastest, stretches},
};

fn blocks(random: &mut RandomStream) -> Vec<PlacedShape> {
    let mut solids = furniture();
    for _ in 0..6 {
        let mut r = |low: f64, high: f64| random.uniform(low, high);
        let centre = [r(-1.5, 2.5), r(-2.0, 2.0), r(0.2, 2.4)];
        solids.push(cuboid(centre, [r(0.1, 0.5), r(0.1, 0.5), r(0.1, 0.5)]));
    }
    solids
}

/// Random cells and random ends, so that wrists turn and the arm folds.
fn plans(count: usize) -> Vec<(depal_planner::TransferScene, TransferPlan)> {
    let mut random = RandomStreams::new(11).stream("promises");
    let mut found = Vec::new();
    while found.len() < count {
        let request = scene(blocks(&mut random));
        let oracle = Oracle::new(&request, 0.01);
        let mut posture = || {
            for _ in 0..200 {
                let mut joints = JointPositions::zeros(6);
                for (q, limit) in joints.iter_mut().zip(request.arm.limits()) {
                    *q = random.uniform(limit.lower.max(-2.5), limit.upper.min(2.5));
                }
                if oracle.touch(&joints).is_none() {
                    return Some(joints);
                }
            }
            None
        };
        let (Some(start), Some(goal)) = (posture(), posture()) else {
            continue;
        };
        if let Ok(plan) = plan_transfer(&request, &start, &TransferGoal::Joints(goal)) {
            assert_eq!(plan.waypoints[0].joints, start);
            assert_eq!(plan.waypoints[plan.waypoints.len() - 1].joints, goal);
            found.push((request, plan));
        }
    }
    found
}

#[test]
fn a_blended_way_stays_clear_and_takes_the_time_that_is_said() {
    let mut blended = 0;
    for (request, plan) in plans(40) {
        Oracle::new(&request, 0.0).check(&plan).unwrap();
        let time = fastest(&plan, request.arm.limits());
        assert!(
            (plan.motion_time - time).abs() < 0.01 * time,
            "said {} s, is {time} s",
            plan.motion_time
        );
        assert!(plan.motion_time >= plan.lower_bound * (1.0 - 1e-9));
        blended += usize::from(plan.waypoints.iter().any(|w| w.blend > 0.0));
    }
    assert!(blended >= 10, "only {blended} ways have corners");
}

/// The least clearance is that of the worst state, within a tenth and half a millimetre.
#[test]
fn the_clearance_that_is_said_is_met_and_not_undercut() {
    for (request, plan) in plans(12) {
        let checker = TransferChecker::new(&request);
        let mut least = f64::INFINITY;
        for state in samples(&plan, 0.01) {
            least = least.min(checker.clearance(&state));
        }
        let said = plan.min_clearance;
        assert!(
            said <= least * 1.12 + 6e-4 && said >= least * 0.88 - 6e-4,
            "said {said} m, is {least} m"
        );
    }
}

fn samples(plan: &TransferPlan, step: f64) -> Vec<JointPositions> {
    stretches(plan)
        .iter()
        .flat_map(|s| s.samples(step))
        .map(|q| JointPositions::from_slice(&q))
        .collect()
}
