//! Transfers: the way at full speed with its own corners. No robot language has such corners, so what flies it is the
//! trajectory that a cabinet drives, handed over as a cabinet does.

use depal_motion::{BlendedPath, Trajectory};

use super::*;
use crate::{TransferGoal, TransferPlan, TransferScene, plan_transfer};

/// Moves that wait behind the one under way, at most; a cabinet lets more of them wait.
const AHEAD: usize = 2;

/// Seconds from the first waypoint to the last, handed over tick by tick.
fn flown(arm: &Arm, plan: &TransferPlan, load: &Load) -> f64 {
    let mut trajectory = Trajectory::new(Arc::new(arm.clone()), plan.waypoints[0].joints);
    trajectory.set_tool_and_load(&Load::NONE, load);
    let mut open = Vec::new();
    let mut now = 0.0;
    for waypoint in &plan.waypoints[1..] {
        loop {
            open.retain(|id| !trajectory.is_done(*id, now));
            if open.len() <= AHEAD {
                break;
            }
            now += TICK.as_secs_f64();
        }
        let segment = Segment::blended(waypoint.joints, waypoint.blend);
        open.push(trajectory.append(now, &segment).unwrap());
    }
    assert!(trajectory.corner_failures().is_empty());
    trajectory.duration()
}

/// Shapes of neighbouring links overlap; here obstacles are what counts.
fn all_pairs(arm: &Arm) -> Vec<(String, String)> {
    let names: Vec<&String> = arm.links().iter().map(|l| &l.name).collect();
    let pairs = names
        .iter()
        .flat_map(|a| names.iter().map(move |b| ((*a).clone(), (*b).clone())));
    pairs.collect()
}

/// Random transfers past a post and a table, with strong axes and with weak ones, light and heavy.
#[test]
fn a_transfer_takes_the_time_that_is_said() {
    let mut random = RandomStreams::new(31).stream("executed");
    let mut postures = Vec::new();
    postures.resize_with(300, || posture(&mut random));
    let weak = weak(&postures, &load(90.0), 0.45);
    let mut scene = TransferScene {
        arm: arm(),
        attached: Vec::new(),
        load: Load::NONE,
        obstacles: vec![
            cuboid(0.0, 0.0, -0.055, 8.0, 8.0, 0.1),
            cuboid(1.6, 0.5, 1.2, 0.15, 0.15, 2.4),
            cuboid(1.8, -0.9, 0.4, 0.8, 0.8, 0.8),
        ],
        allowed_pairs: all_pairs(&arm()),
        tcp_link: None,
    };
    let (mut driven, mut blends, mut wrong_without, mut slower) = (0, 0, 0, 0);
    for ends in postures.chunks(2).take(14) {
        let (start, goal) = (ends[0], TransferGoal::Joints(ends[1]));
        scene.arm = arm();
        scene.load = load(90.0);
        let Ok(free) = plan_transfer(&scene, &start, &goal) else {
            continue;
        };
        driven += 1;
        blends += usize::from(free.waypoints.iter().any(|w| w.blend > 0.0));
        // Axes without torque limits carry everything alike.
        let time = flown(&scene.arm, &free, &load(90.0));
        assert!(
            (free.motion_time - time).abs() < 0.01 * time,
            "said {} s, took {time} s",
            free.motion_time
        );
        assert!((flown(&scene.arm, &free, &load(5.0)) - time).abs() < 1e-9);
        scene.arm = weak.clone();
        let heavy = plan_transfer(&scene, &start, &goal).unwrap();
        let time = flown(&weak, &heavy, &load(90.0));
        assert!(
            (heavy.motion_time - time).abs() < 0.01 * time,
            "said {} s, took {time} s with torque limits",
            heavy.motion_time
        );
        // The same way as without torques, for the search looks at speeds and accelerations.
        assert_eq!(heavy.waypoints, free.waypoints);
        assert_eq!(heavy.lower_bound, free.lower_bound);
        // Counterfactuals: the law without torques, and the load that was not told.
        wrong_without += usize::from((free.motion_time - time).abs() > 0.01 * time);
        scene.load = load(5.0);
        let light = plan_transfer(&scene, &start, &goal).unwrap();
        assert!(light.motion_time < heavy.motion_time * 1.001);
        slower += usize::from(light.motion_time < 0.99 * heavy.motion_time);
        // Blends and times belong together: the path alone says the same.
        let points: Vec<JointPositions> = heavy.waypoints.iter().map(|w| w.joints).collect();
        let corners: Vec<f64> = heavy.waypoints.iter().map(|w| w.blend).collect();
        let path = BlendedPath::new(&points, &corners);
        let again = path.loaded_time(&weak, &Load::NONE, &load(90.0)).unwrap();
        assert_eq!(again, heavy.motion_time);
    }
    assert!(driven >= 8 && blends >= 3, "{driven} {blends}");
    assert!(2 * wrong_without > driven, "{wrong_without} of {driven}");
    assert!(2 * slower > driven, "{slower} of {driven}");
}

/// A load that the axes cannot hold is no way, and the reason names the axis.
#[test]
fn a_transfer_that_cannot_be_held_is_refused() {
    let mut random = RandomStreams::new(32).stream("executed");
    let (start, goal) = (home(), posture(&mut random));
    let mut scene = TransferScene {
        arm: weak(&[start, goal, start.lerp(&goal, 0.5)], &load(50.0), 0.6),
        attached: Vec::new(),
        load: load(50.0),
        obstacles: Vec::new(),
        allowed_pairs: all_pairs(&arm()),
        tcp_link: None,
    };
    let goal = TransferGoal::Joints(goal);
    plan_transfer(&scene, &start, &goal).unwrap();
    scene.load = load(2000.0);
    let refusal = plan_transfer(&scene, &start, &goal).unwrap_err();
    assert!(
        refusal
            .reason
            .contains("N m to hold the arm with a load of 2000.0 kg"),
        "{}",
        refusal.reason
    );
}
