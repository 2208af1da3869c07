//! The ladder.

use std::collections::VecDeque;

use depal_frames::{JointPositions, Pose};
use depal_motion::{BlendedPath, slowest_joint_time};
use depal_time::RandomStreams;

use super::{
    certificate::certify,
    checker::{Checker, FINE_STEP},
    refine::Route,
    request::{TransferGoal, TransferPlan, TransferRefusal, TransferScene, TransferWaypoint},
    scene::{BARE, PADDINGS, Scene},
    tree::grow,
    ways::{first_free, improve, raised},
};

/// Seed of everything random here.
const SEED: u64 = 1;
/// States that may be checked in search of one way.
const MOST_CHECKS: usize = 200_000;
/// Goal postures of a pose that are tried.
const MOST_GOALS: usize = 12;
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
            Some(slowest_joint_time(arm.limits(), start, joints))
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
    bound = Some(slowest_joint_time(arm.limits(), start, &goals[0]));
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
        let bound = slowest_joint_time(arm.limits(), start, goal);
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
    let time = |q: &JointPositions| slowest_joint_time(arm.limits(), start, q);
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
    let path = route.path();
    let clearance = certify(scene, start, &path).map_err(|touch| match touch {
        Some(contact) => format!(
            "a way was found but its fine check says: {}",
            scene.words(contact)
        ),
        None => "a way was found but comes too close to be proved free".to_owned(),
    })?;
    let motion_time = scene
        .time(&path)
        .map_err(|overload| format!("a way was found but on it {overload}"))?;
    let points = &route.points;
    let waypoints = points.iter().zip(route.blends());
    Ok(TransferPlan {
        waypoints: waypoints
            .map(|(&joints, blend)| TransferWaypoint { joints, blend })
            .collect(),
        motion_time,
        lower_bound: slowest_joint_time(scene.arm.limits(), &points[0], &points[points.len() - 1]),
        min_clearance: match scene.rigid_distance() {
            Some((rigid, _)) => clearance.min(rigid),
            None => clearance,
        },
        found_by,
    })
}
