use std::sync::Arc;

use super::*;

fn first() -> Segment {
    joint_move([90.0, 10.0, 10.0, 0.0, 70.0, 0.0], fly(0.2))
}

fn second() -> Segment {
    joint_move([90.0, 50.0, 10.0, 0.0, 70.0, 0.0], Zone::Fine)
}

/// A segment that comes while the first is under way: no step in position or speed, and the corner is blended.
#[test]
fn appending_under_way_is_continuous() {
    let arm = arm();
    for share in [0.05, 0.3, 0.6] {
        let mut t = Trajectory::new(Arc::clone(&arm), home());
        t.append(0.0, &first()).unwrap();
        let now = t.duration() * share;
        let (place, speed) = (t.sample(now), t.sample_speed(now));
        t.append(now, &second()).unwrap();
        assert!(t.corner_failures().is_empty(), "at {share}");
        assert!(t.sample(now).max_distance(&place) < 1e-9);
        assert!(t.sample_speed(now).max_distance(&speed) < 1e-6);
        let (speed, acceleration) = use_of_limits(&arm, &samples(&t, TICK), TICK);
        assert!(speed <= 1.01 && acceleration <= 1.01);
    }
}

/// Moves that are all known before the start need no more time when they come one by one, but in time.
#[test]
fn run_ahead_costs_nothing() {
    let arm = arm();
    let mut known = Trajectory::new(Arc::clone(&arm), home());
    known.append(0.0, &first()).unwrap();
    known.append(0.0, &second()).unwrap();
    let mut late = Trajectory::new(Arc::clone(&arm), home());
    late.append(0.0, &first()).unwrap();
    late.append(0.3, &second()).unwrap();
    assert!((known.duration() - late.duration()).abs() < 0.01);
}

/// A segment that comes when the arm already brakes for its stop makes the corner a stop, and says so.
#[test]
fn too_late_for_the_corner_is_a_stop() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let id = t.append(0.0, &first()).unwrap();
    let end = t.duration();
    t.append(end - 0.02, &second()).unwrap();
    assert_eq!(t.corner_failures(), [id]);
    assert!((t.end_time(id).unwrap() - end).abs() < 1e-9);
    assert!(
        t.sample(end)
            .max_distance(&joints([90.0, 10.0, 10.0, 0.0, 70.0, 0.0]))
            < 1e-9
    );
    assert!(t.sample_speed(end).iter().all(|v| v.abs() < 1e-9));
    assert!(t.sample(end + 0.3).max_distance(&t.sample(end)) > 0.01);
}

/// A stop brakes on the path with full acceleration and forgets the rest.
#[test]
fn stop_brakes_on_the_path() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    t.append(0.0, &first()).unwrap();
    t.append(0.0, &second()).unwrap();
    let before = t.clone();
    t.stop(0.5);
    // J1 runs at 90 deg/s2 * 0.5 s at most and stands after that speed over 180 deg/s2.
    let speed = before.sample_speed(0.5)[0];
    let expected = 0.5 + speed / 180f64.to_radians();
    assert!(
        (t.duration() - expected).abs() < 0.01,
        "{} {expected}",
        t.duration()
    );
    let stand = t.end_joints();
    assert!(t.sample(t.duration() + 1.0).max_distance(&stand) < 1e-12);
    assert!(stand[0] > before.sample(0.5)[0]);
    assert!(
        (stand[1] - home()[1]).abs() < 1e-12,
        "still on the first line"
    );
    assert!(t.active(t.duration() + 0.001).is_none());
    // And on again.
    t.append(t.duration() + 1.0, &second()).unwrap();
    assert!(t.corner_failures().is_empty());
}

#[test]
fn forgetting_the_past_changes_nothing_ahead() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    t.append(0.0, &first()).unwrap();
    t.append(0.0, &second()).unwrap();
    let whole = t.clone();
    t.forget_before(0.7);
    for i in 0..300 {
        let time = 0.7 + f64::from(i) * TICK;
        assert_eq!(t.sample(time), whole.sample(time));
    }
    t.forget_before(100.0);
    assert_eq!(t.sample(100.0), whole.end_joints());
}

#[test]
fn same_calls_same_bits() {
    let arm = arm();
    let run = || {
        let mut random = depal_time::RandomStreams::new(3).stream("moves");
        let mut t = Trajectory::new(Arc::clone(&arm), home());
        for _ in 0..10 {
            let _ = t.append(0.0, &laws::random_segment(&arm, &mut random));
        }
        samples(&t, TICK)
    };
    assert_eq!(run(), run());
}
