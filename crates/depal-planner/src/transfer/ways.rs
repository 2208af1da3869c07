//! Raised ways, and how a found way becomes a quick one.

use std::collections::VecDeque;

use depal_arm::Arm;
use depal_frames::{JointPositions, Vector};
use depal_motion::slowest_joint_time;
use depal_time::RandomStream;

use super::{
    checker::Checker,
    refine::{Effort, Route, refine},
    tree::grow,
};

/// Heights by which the tool is raised, m.
const HEIGHTS_M: [f64; 6] = [0.1, 0.2, 0.35, 0.55, 0.8, 1.1];
/// Shares of the turn at which a single raised via lies.
const TURNED: [f64; 3] = [0.25, 0.5, 0.75];
/// A way that takes this much longer than the bound is a long way round.
const LONG: f64 = 1.25;
/// One that takes only this much longer ends the looking for others.
const SHORT: f64 = 1.12;
/// Other raised ways tried then ...
const OTHER_RAISED: usize = 3;
/// ... and ways searched for, ...
const OTHER_WAYS: usize = 12;
/// ... each with at most so many states checked.
const OTHER_CHECKS: usize = 6000;
/// Effort of bending: the first way, each other one, and the best of them once more.
const FIRST_EFFORT: Effort = Effort {
    changes: 300,
    checks: 1200,
};
const OTHER_EFFORT: Effort = Effort {
    changes: 150,
    checks: 1000,
};
const LAST_EFFORT: Effort = Effort {
    changes: 500,
    checks: 4000,
};
/// Shares of the way to the base by which the raised tool is drawn in.
const DRAWN_IN: [f64; 3] = [0.0, 0.15, 0.35];

/// Bends a found way; where it stays a long way round, looks for others and bends the best of them further.
/// Gives the routes met on the way to the best, which comes last.
pub(crate) fn improve(
    checker: &mut Checker,
    found: &Route,
    mut found_by: &'static str,
    others: &mut VecDeque<Route>,
    random: &mut RandomStream,
) -> (Vec<Route>, &'static str) {
    let limits = checker.scene.arm.limits();
    let (start, goal) = (found.points[0], found.points[found.points.len() - 1]);
    let bound = slowest_joint_time(limits, &start, &goal);
    let time_of = |trail: &[Route]| trail[trail.len() - 1].rough_time(limits);
    let mut trail = refine(checker, found.clone(), FIRST_EFFORT, random);
    let mut time = time_of(&trail);
    if time <= bound * LONG {
        return (trail, found_by);
    }
    let most_checks = checker.most_checks;
    for turn in 0..OTHER_RAISED + OTHER_WAYS {
        if time <= bound * SHORT {
            break;
        }
        let (route, by) = if turn < OTHER_RAISED {
            (first_free(checker, others), "raised vias")
        } else {
            checker.most_checks = most_checks.min(checker.checks + OTHER_CHECKS);
            let way = grow(checker, &start, &goal, random, &mut 0);
            (way.map(Route::new), "search")
        };
        let Some(route) = route else {
            continue;
        };
        let other = refine(checker, route, OTHER_EFFORT, random);
        let other_time = time_of(&other);
        if other_time < time {
            (trail, time, found_by) = (other, other_time, by);
        }
    }
    checker.most_checks = most_checks;
    let best = trail[trail.len() - 1].clone();
    let last = refine(checker, best, LAST_EFFORT, random);
    trail.extend(last.into_iter().skip(1));
    (trail, found_by)
}

/// The first free one; those before it are blocked and leave the list with it.
pub(crate) fn first_free(checker: &mut Checker, routes: &mut VecDeque<Route>) -> Option<Route> {
    while let Some(route) = routes.pop_front() {
        if checker.path_is_free(&route.path()) {
            return Some(route);
        }
    }
    None
}

/// Raised ways, fastest first; all that go straight up before those that draw in.
pub(crate) fn raised(arm: &Arm, start: &JointPositions, goal: &JointPositions) -> VecDeque<Route> {
    let limits = arm.limits();
    let via = |at: &JointPositions, height: f64, drawn_in: f64| {
        let mut pose = arm.base_from_flange(at);
        let flat = pose.translation.vector.xy() * -drawn_in;
        pose.translation.vector += Vector::new(flat.x, flat.y, height);
        let near = arm.inverse_nearest(&pose, at)?;
        // Another branch is another way.
        (near.max_distance(at) < 1.2).then_some(near)
    };
    let mut all = VecDeque::new();
    for drawn_in in DRAWN_IN {
        let mut routes = Vec::new();
        for height in HEIGHTS_M {
            let (up, over) = (via(start, height, drawn_in), via(goal, height, drawn_in));
            if let (Some(up), Some(over)) = (up, over) {
                routes.push(Route::new(vec![*start, up, over, *goal]));
                for share in TURNED {
                    let high = up.lerp(&over, share);
                    routes.push(Route::new(vec![*start, high, *goal]));
                }
            }
            for via in [up, over].into_iter().flatten() {
                routes.push(Route::new(vec![*start, via, *goal]));
            }
        }
        let mut timed: Vec<(f64, Route)> = routes
            .into_iter()
            .map(|r| (r.rough_time(limits), r))
            .collect();
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.extend(timed.into_iter().map(|(_, route)| route));
    }
    all
}
