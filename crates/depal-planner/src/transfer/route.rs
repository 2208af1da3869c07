//! The ladder.

use std::collections::VecDeque;

use depal_arm::Arm;
use depal_frames::{JointPositions, Pose, Vector};
use depal_time::{RandomStream, RandomStreams};

use super::{
    certificate::certify,
    law::{BlendedPath, Samples, fitting_blends, lower_bound},
    refine::{Effort, Route, refine},
    request::{TransferGoal, TransferPlan, TransferRefusal, TransferScene, TransferWaypoint},
    scene::{BARE, Contact, PADDINGS, Scene},
    tree::grow,
};

/// Seed of everything random here.
const SEED: u64 = 1;
/// States that may be checked in search of one way.
const MOST_CHECKS: usize = 300_000;
/// Goal postures of a pose that are tried.
const MOST_GOALS: usize = 12;
/// Neighbouring states of a checked path, rad.
const STEP: f64 = 0.05;
/// The same where the padding is thin.
const FINE_STEP: f64 = 0.01;
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

/// Counts checked states and knows the limits of what may be spent.
pub(crate) struct Checker<'a> {
    pub scene: &'a Scene<'a>,
    pub thickness: usize,
    pub checks: usize,
    pub most_checks: usize,
    /// Where along its way the last blocked path was blocked, 0 to 1: the next one is looked at there first.
    pub hint: f64,
    /// Small steps in spite of thick bodies: something thin stands in the way.
    pub careful: bool,
}

impl<'a> Checker<'a> {
    /// For bare bodies, without a limit.
    pub fn bare(scene: &'a Scene<'a>) -> Self {
        Self {
            scene,
            thickness: BARE,
            checks: 0,
            most_checks: usize::MAX,
            hint: 0.5,
            careful: false,
        }
    }

    /// The far end is a state of its own: a line without length has no others.
    pub fn line_is_free(&mut self, from: &JointPositions, to: &JointPositions, step: f64) -> bool {
        let path = BlendedPath::new(&[*from, *to], &[0.0, 0.0]);
        self.all_free(&path.samples(step)) && self.contact(to).is_none()
    }

    pub fn step(&self) -> f64 {
        if self.thickness == 0 && !self.careful {
            STEP
        } else {
            FINE_STEP
        }
    }

    pub fn contact(&mut self, joints: &JointPositions) -> Option<Contact> {
        self.checks += 1;
        self.scene.contact(joints, self.thickness)
    }

    /// Whether all states are free: the middle first, then the middles of the halves, and so on.
    pub fn all_free(&mut self, states: &Samples) -> bool {
        let count = states.count();
        let mut stride = count.next_power_of_two();
        while stride > 1 {
            for i in (stride / 2..count).step_by(stride) {
                if self.contact(&states.at(i)).is_some() {
                    self.hint = i as f64 / (count - 1) as f64;
                    return false;
                }
            }
            stride /= 2;
        }
        count == 0 || self.contact(&states.at(0)).is_none()
    }

    pub fn path_is_free(&mut self, path: &BlendedPath) -> bool {
        let states = path.samples(self.step());
        if states.count() == 0 {
            return true;
        }
        let hint = ((states.count() - 1) as f64 * self.hint).round() as usize;
        self.contact(&states.at(hint)).is_none() && self.all_free(&states)
    }

    pub fn edge_is_free(&mut self, from: &JointPositions, to: &JointPositions) -> bool {
        let path = BlendedPath::new(&[*from, *to], &[0.0, 0.0]);
        self.all_free(&path.samples(self.step()))
    }
}

/// Plans a way from rest at `start` to rest at `goal`.
///
/// Same question, same bits: no clock is read and all random draws have one seed.
///
/// # Errors
/// [`TransferRefusal`] with the reason in words.
pub fn plan_transfer(
    request: &TransferScene,
    start: &JointPositions,
    goal: &TransferGoal,
) -> Result<TransferPlan, TransferRefusal> {
    let arm = &request.arm;
    let mut bound = match goal {
        TransferGoal::Joints(joints) if joints.len() == start.len() => {
            Some(lower_bound(start, joints, arm.limits()))
        }
        _ => None,
    };
    let refuse = |reason: String, lower_bound| {
        Err(TransferRefusal {
            reason,
            lower_bound,
        })
    };
    if let Err(reason) = inside_limits(request, "start", start) {
        return refuse(reason, bound);
    }
    let goals = match goal {
        TransferGoal::Joints(joints) => match inside_limits(request, "goal", joints) {
            Err(reason) => return refuse(reason, bound),
            Ok(()) => vec![*joints],
        },
        TransferGoal::Tcp(pose) => match postures(request, start, pose) {
            Err(reason) => return refuse(reason, bound),
            Ok(found) => found,
        },
    };
    bound = Some(lower_bound(start, &goals[0], arm.limits()));
    let scene = Scene::new(request);
    if let Some((distance, contact)) = scene.rigid_distance()
        && distance <= 0.0
    {
        let words = scene.words(contact);
        return refuse(
            format!("{words} in every posture; list them in allowed_pairs if that is meant"),
            bound,
        );
    }
    if let Some(contact) = scene.contact(start, BARE) {
        return refuse(format!("at the start {}", scene.words(contact)), bound);
    }
    let mut touched = None;
    let free: Vec<JointPositions> = goals
        .iter()
        .filter(|g| match scene.contact(g, BARE) {
            None => true,
            Some(contact) => {
                touched = touched.or(Some(contact));
                false
            }
        })
        .copied()
        .collect();
    if free.is_empty() {
        let contact = touched.expect("a goal that is not free touches something");
        let words = scene.words(contact);
        return refuse(
            match goals.len() {
                1 => format!("at the goal {words}"),
                n => format!("at the goal, in each of {n} postures, something touches: {words}"),
            },
            bound,
        );
    }
    let mut best: Option<TransferPlan> = None;
    let mut reason = String::new();
    let most_checks = MOST_CHECKS / free.len().min(3);
    for (tried, goal) in free.iter().take(MOST_GOALS).enumerate() {
        let bound = lower_bound(start, goal, arm.limits());
        if best.as_ref().is_some_and(|b| b.motion_time <= bound) || (best.is_none() && tried >= 3) {
            break;
        }
        match plan_to(&scene, start, goal, most_checks) {
            Ok(plan) => {
                if best
                    .as_ref()
                    .is_none_or(|b| plan.motion_time < b.motion_time)
                {
                    best = Some(plan);
                }
            }
            Err(why) if reason.is_empty() => reason = why,
            Err(_) => {}
        }
    }
    match best {
        Some(plan) => Ok(plan),
        None => refuse(reason, bound),
    }
}

fn inside_limits(
    request: &TransferScene,
    what: &str,
    joints: &JointPositions,
) -> Result<(), String> {
    let arm = &request.arm;
    if joints.len() != arm.joint_count() {
        return Err(format!(
            "{what} has {} joints, the arm has {}",
            joints.len(),
            arm.joint_count()
        ));
    }
    for ((&q, limit), name) in joints.iter().zip(arm.limits()).zip(arm.joint_names()) {
        if !(q >= limit.lower - 1e-9 && q <= limit.upper + 1e-9) {
            return Err(format!(
                "{what}: joint '{name}' at {q:.4} rad is outside its limits {:.4} to {:.4} rad",
                limit.lower, limit.upper
            ));
        }
    }
    Ok(())
}

/// Postures that bring the tool link there, nearest in time first.
fn postures(
    request: &TransferScene,
    start: &JointPositions,
    base_from_tcp: &Pose,
) -> Result<Vec<JointPositions>, String> {
    let arm = &request.arm;
    let flange_from_tcp = match request.tcp_link {
        None => Pose::identity(),
        Some(link) => {
            let offset = |q: &JointPositions| {
                arm.base_from_flange(q).inverse() * arm.base_from_links(q)[link]
            };
            let (here, zero) = (offset(start), offset(&JointPositions::zeros(start.len())));
            if (here.translation.vector - zero.translation.vector).norm() > 1e-9 {
                let name = &arm.links()[link].name;
                return Err(format!("tcp_link '{name}' is not fixed to the flange"));
            }
            here
        }
    };
    let mut found = arm.inverse(&(base_from_tcp * flange_from_tcp.inverse()));
    let time = |q: &JointPositions| lower_bound(start, q, arm.limits());
    found.sort_by(|a, b| time(a).total_cmp(&time(b)));
    if found.is_empty() {
        let at = base_from_tcp.translation.vector;
        return Err(format!(
            "the goal pose at ({:.3}, {:.3}, {:.3}) m is out of reach: no posture inside the joint limits",
            at.x, at.y, at.z
        ));
    }
    Ok(found)
}

fn plan_to(
    scene: &Scene,
    start: &JointPositions,
    goal: &JointPositions,
    most_checks: usize,
) -> Result<TransferPlan, String> {
    let arm = scene.arm;
    let mut failed = String::new();
    let mut rounds = 0;
    let usable: Vec<usize> = (0..PADDINGS.len())
        .filter(|&t| scene.contact(start, t).is_none() && scene.contact(goal, t).is_none())
        .collect();
    for (turn, &thickness) in usable.iter().enumerate() {
        let mut checker = Checker {
            scene,
            thickness,
            checks: 0,
            most_checks: most_checks / usable.len().max(1),
            hint: 0.5,
            careful: false,
        };
        if turn > 0 {
            // What the thick bodies could not pass needs the search more than the vias.
            checker.most_checks += checker.most_checks / 4;
        }
        let mut random = RandomStreams::new(SEED).stream("transfer");
        let direct = Route::new(vec![*start, *goal]);
        let direct_is_free = checker.all_free(&direct.path().samples(checker.step()));
        let mut others = if direct_is_free {
            VecDeque::new()
        } else {
            raised(arm, start, goal)
        };
        let (route, found_by) = if direct_is_free {
            (Some(direct), "direct")
        } else if let Some(route) = first_free(&mut checker, &mut others) {
            (Some(route), "raised vias")
        } else {
            let way = grow(&mut checker, start, goal, &mut random, &mut rounds);
            (way.map(Route::new), "search")
        };
        let Some(found) = route else {
            continue;
        };
        let (trail, found_by) = improve(&mut checker, &found, found_by, &mut others, &mut random);
        match proved(scene, start, &trail[trail.len() - 1], found_by) {
            Ok(plan) => return Ok(plan),
            Err(why) => failed = why,
        }
        if thickness == 0 {
            // Thick bodies in large steps may still graze something: back to where that began, or to another way,
            // and on from there in small steps.
            checker.careful = true;
            let good = trail.iter().rev().find(|r| checker.path_is_free(&r.path()));
            let (begin, found_by) = if let Some(good) = good {
                (Some(good.clone()), found_by)
            } else if let Some(route) = first_free(&mut checker, &mut others) {
                (Some(route), "raised vias")
            } else {
                let way = grow(&mut checker, start, goal, &mut random, &mut rounds);
                (way.map(Route::new), "search")
            };
            if let Some(begin) = begin {
                let (trail, found_by) =
                    improve(&mut checker, &begin, found_by, &mut others, &mut random);
                for route in [&trail[trail.len() - 1], &begin] {
                    if let Ok(plan) = proved(scene, start, route, found_by) {
                        return Ok(plan);
                    }
                }
            }
        }
        // The search may leave corners out between its checks; a way that stops at every point is the safer one.
        for candidate in [&found, &found.stopping()] {
            match proved(scene, start, candidate, found_by) {
                Ok(plan) => return Ok(plan),
                Err(why) => failed = why,
            }
        }
    }
    if !failed.is_empty() {
        return Err(failed);
    }
    if usable.is_empty() {
        return Err(format!(
            "start or goal leaves less than {} mm of room",
            PADDINGS[PADDINGS.len() - 1] * 1e3
        ));
    }
    let path = BlendedPath::new(&[*start, *goal], &[0.0; 2]);
    let states = path.samples(FINE_STEP);
    let blocked = (0..states.count()).find_map(|i| {
        scene
            .contact(&states.at(i), BARE)
            .map(|contact| (i, contact))
    });
    let straight = match blocked {
        Some((i, contact)) => format!(
            "on the straight move {} after {} % of the way",
            scene.words(contact),
            i * 100 / (states.count() - 1)
        ),
        None => "the straight move passes too close".to_owned(),
    };
    Err(format!(
        "no free way found: {straight}; no raised way is free; the search gave up after {rounds} random postures"
    ))
}

/// The plan of a route, when the certificate agrees.
fn proved(
    scene: &Scene,
    start: &JointPositions,
    route: &Route,
    found_by: &'static str,
) -> Result<TransferPlan, String> {
    match certify(scene, start, &route.path()) {
        Ok(clearance) => {
            let clearance = match scene.rigid_distance() {
                Some((rigid, _)) => clearance.min(rigid),
                None => clearance,
            };
            Ok(plan(scene, route, clearance, found_by))
        }
        Err(Some(contact)) => Err(format!(
            "a way was found but its fine check says: {}",
            scene.words(contact)
        )),
        Err(None) => Err("a way was found but comes too close to be proved free".to_owned()),
    }
}

/// Bends a found way; where it stays a long way round, looks for others and bends the best of them further.
/// Gives the routes met on the way to the best, which comes last.
fn improve(
    checker: &mut Checker,
    found: &Route,
    mut found_by: &'static str,
    others: &mut VecDeque<Route>,
    random: &mut RandomStream,
) -> (Vec<Route>, &'static str) {
    let limits = checker.scene.arm.limits();
    let (start, goal) = (found.points[0], found.points[found.points.len() - 1]);
    let bound = lower_bound(&start, &goal, limits);
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
fn first_free(checker: &mut Checker, routes: &mut VecDeque<Route>) -> Option<Route> {
    while let Some(route) = routes.pop_front() {
        if checker.path_is_free(&route.path()) {
            return Some(route);
        }
    }
    None
}

/// Raised ways, fastest first; all that go straight up before those that draw in.
fn raised(arm: &Arm, start: &JointPositions, goal: &JointPositions) -> VecDeque<Route> {
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

fn plan(scene: &Scene, route: &Route, clearance: f64, found_by: &'static str) -> TransferPlan {
    let limits = scene.arm.limits();
    let points = &route.points;
    let blends = if route.stops {
        vec![0.0; points.len()]
    } else {
        fitting_blends(points, &route.shares)
    };
    TransferPlan {
        waypoints: points
            .iter()
            .zip(blends)
            .map(|(&joints, blend)| TransferWaypoint { joints, blend })
            .collect(),
        motion_time: route.time(limits),
        lower_bound: lower_bound(&points[0], &points[points.len() - 1], limits),
        min_clearance: clearance,
        found_by,
    }
}
