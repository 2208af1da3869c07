use std::sync::Arc;

use depal_frames::nalgebra::Translation3;
use depal_frames::{Pose, Rotation};
use depal_time::{RandomStream, RandomStreams};
use proptest::prelude::*;

use super::*;
use crate::point_to_point_time;

/// A random move: joint or linear, any zone, any speed. Not every one is possible.
pub fn random_segment(arm: &Arm, random: &mut RandomStream) -> Segment {
    let zone = if random.uniform(0.0, 1.0) < 0.3 {
        Zone::Fine
    } else {
        Zone::Fly {
            tcp: random.uniform(0.0, 0.3),
            orientation: random.uniform(0.05, 1.0),
        }
    };
    let speed = Speed {
        tcp: random.uniform(0.1, 5.0),
        orientation: random.uniform(0.5, 8.0),
        joint_fraction: random.uniform(0.2, 1.0),
        acceleration_fraction: random.uniform(0.2, 1.0),
    };
    let mut uniform = |low, high| random.uniform(low, high);
    if uniform(0.0, 1.0) < 0.5 {
        let target = [
            uniform(-120.0, 120.0),
            uniform(-30.0, 60.0),
            uniform(-60.0, 50.0),
            uniform(-150.0, 150.0),
            uniform(-100.0, 100.0),
            uniform(-200.0, 200.0),
        ];
        Segment {
            speed,
            ..joint_move(target, zone)
        }
    } else {
        let home = home_tcp(arm, 0.0, 0.0, 0.0);
        let turn =
            Rotation::from_euler_angles(uniform(-0.4, 0.4), uniform(-0.4, 0.4), uniform(-1.5, 1.5));
        let shift = Translation3::new(uniform(-0.5, 0.6), uniform(-1.2, 1.2), uniform(-0.8, 0.6));
        let target = Pose::from_parts(
            Translation3::from(home.translation.vector + shift.vector),
            turn * home.rotation,
        );
        Segment {
            speed,
            ..linear_move(target, 1.0, zone)
        }
    }
}

fn check_limits(arm: &Arm, trajectory: &Trajectory) -> Result<(), TestCaseError> {
    for step in [TICK, 0.001] {
        let (speed, acceleration) = use_of_limits(arm, &samples(trajectory, step), step);
        prop_assert!(speed <= 1.01, "speed {speed} of the limit at {step} s");
        prop_assert!(
            acceleration <= 1.01,
            "acceleration {acceleration} of the limit at {step} s"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Whatever the program asks for, the joints never exceed their limits.
    #[test]
    fn joints_stay_within_their_limits(seed in any::<u64>()) {
        random_path(seed)?;
    }

    /// The same with moves that come in while the arm is under way, and a stop in the end.
    #[test]
    fn retiming_and_stopping_keep_the_limits(seed in any::<u64>()) {
        random_run(seed)?;
    }
}

/// Lines close to a wrist singularity, where a grid too coarse once hid accelerations of 1.04 times the limit,
/// and a corner taken up on the way that exceeded it by a little over 1 %.
#[test]
fn under_resolved_lines_stay_within_limits() {
    random_path(10_976_410_544_644_583_805).unwrap();
    random_run(10_757_490_155_525_465_145).unwrap();
}

fn random_path(seed: u64) -> Result<(), TestCaseError> {
    let arm = arm();
    let mut random = RandomStreams::new(seed).stream("moves");
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let mut accepted = 0;
    for _ in 0..8 {
        accepted += usize::from(t.append(0.0, &random_segment(&arm, &mut random)).is_ok());
    }
    prop_assert!(t.duration().is_finite());
    prop_assert!(accepted > 0);
    prop_assert!(t.sample(t.duration()).max_distance(&t.end_joints()) < 1e-9);
    check_limits(&arm, &t)
}

fn random_run(seed: u64) -> Result<(), TestCaseError> {
    let arm = arm();
    let mut random = RandomStreams::new(seed).stream("moves");
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let mut now = 0.0;
    let mut seen = vec![home(); 3];
    let stop_at = random.uniform(1.0, 8.0);
    let mut next = 0.0;
    let mut stopped = false;
    for _ in 0..3000 {
        if !stopped && now >= stop_at {
            t.stop(now);
            stopped = true;
        } else if !stopped && now >= next {
            let _ = t.append(now, &random_segment(&arm, &mut random));
            // Sometimes in time, sometimes late.
            next = now.max(t.duration() - random.uniform(-0.2, 1.0));
            t.forget_before(now);
        }
        now += TICK;
        seen.push(t.sample(now));
    }
    prop_assert!(stopped && t.active(now).is_none());
    let (speed, acceleration) = use_of_limits(&arm, &seen, TICK);
    prop_assert!(speed <= 1.01, "speed {speed}");
    prop_assert!(acceleration <= 1.01, "acceleration {acceleration}");
    Ok(())
}

/// A straight joint move takes what the trapezoid says; the cells cost almost nothing.
#[test]
fn joint_move_is_as_fast_as_the_trapezoid() {
    let arm = arm();
    for target in [
        [90.0, 40.0, -20.0, 0.0, 90.0, 30.0],
        [1.0, 10.0, 10.0, 0.0, 70.0, 0.0],
        [0.0, 10.0, 10.0, 180.0, 70.0, 0.0],
    ] {
        let expected = point_to_point_time(arm.limits(), &home(), &joints(target));
        let mut t = Trajectory::new(Arc::clone(&arm), home());
        t.append(0.0, &joint_move(target, Zone::Fine)).unwrap();
        let found = t.duration();
        assert!(
            (expected..expected * 1.01).contains(&(found + 1e-9)),
            "{found} s, trapezoid {expected} s"
        );
    }
}

/// A long enough line is travelled at the programmed speed, straight, with an even turn.
#[test]
fn line_is_straight_and_as_fast_as_programmed() {
    let arm = arm();
    let from = home_tcp(&arm, 0.0, 0.0, 0.0);
    let mut to = home_tcp(&arm, 0.0, 1.0, -0.3);
    to.rotation = Rotation::from_euler_angles(0.1, -0.2, 0.5) * from.rotation;
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    t.append(0.0, &linear_move(to, 0.25, Zone::Fine)).unwrap();
    let way = to.translation.vector - from.translation.vector;
    let angle = from.rotation.angle_to(&to.rotation);
    let mut fastest = 0.0_f64;
    let mut before = from;
    for i in 1..(t.duration() / TICK) as i32 {
        let tcp = arm.base_from_flange(&t.sample(f64::from(i) * TICK)) * tool();
        let travelled = tcp.translation.vector - from.translation.vector;
        let share = travelled.dot(&way) / way.norm_squared();
        let off = (travelled - way * share).norm();
        assert!(off < 2e-5, "{:.4} mm off the line", off * 1e3);
        let turned = from.rotation.angle_to(&tcp.rotation);
        assert!((turned - angle * share).abs() < 1e-4);
        fastest = fastest.max((tcp.translation.vector - before.translation.vector).norm() / TICK);
        before = tcp;
    }
    assert!((0.2495..0.2505).contains(&fastest), "{fastest} m/s");
    // Length over speed, plus ramps of the order of v/a.
    let ideal = way.norm() / 0.25;
    assert!(
        (ideal..ideal + 0.3).contains(&t.duration()),
        "{}",
        t.duration()
    );
}

/// Half the fraction of the joint speeds, half as fast.
#[test]
fn fractions_scale_the_limits() {
    let arm = arm();
    let peak = |speed: Speed| {
        let mut t = Trajectory::new(Arc::clone(&arm), home());
        let target = Segment {
            speed,
            ..joint_move([120.0, 10.0, 10.0, 0.0, 70.0, 0.0], Zone::Fine)
        };
        t.append(0.0, &target).unwrap();
        use_of_limits(&arm, &samples(&t, TICK), TICK)
    };
    let (speed, acceleration) = peak(Speed {
        joint_fraction: 0.5,
        acceleration_fraction: 0.25,
        ..Speed::UNLIMITED
    });
    assert!((speed - 0.5).abs() < 0.005, "{speed}");
    assert!((acceleration - 0.25).abs() < 0.005, "{acceleration}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// The tool keeps the programmed speed and turn, in joint moves and corners too.
    #[test]
    fn tool_keeps_the_programmed_speed(seed in any::<u64>()) {
        let arm = arm();
        let mut random = RandomStreams::new(seed).stream("moves");
        let mut t = Trajectory::new(Arc::clone(&arm), home());
        for _ in 0..6 {
            let segment = random_segment(&arm, &mut random);
            let speed = Speed { tcp: 0.6, orientation: 0.9, ..Speed::UNLIMITED };
            let _ = t.append(0.0, &Segment { speed, ..segment });
        }
        let poses: Vec<Pose> = samples(&t, TICK)
            .iter()
            .map(|joints| arm.base_from_flange(joints) * tool())
            .collect();
        let (mut fastest, mut quickest) = (0.0_f64, 0.0_f64);
        for w in poses.windows(2) {
            let way = w[1].translation.vector - w[0].translation.vector;
            fastest = fastest.max(way.norm() / TICK);
            quickest = quickest.max(w[0].rotation.angle_to(&w[1].rotation) / TICK);
        }
        prop_assert!(fastest <= 0.6 * 1.02, "{fastest} m/s");
        prop_assert!(quickest <= 0.9 * 1.02, "{quickest} rad/s");
        prop_assert!(fastest > 0.59 || quickest > 0.88, "one of them is used: {fastest} {quickest}");
    }
}
