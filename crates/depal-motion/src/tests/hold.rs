use super::*;

fn two_moves(arm: &Arc<Arm>) -> Trajectory {
    let mut t = Trajectory::new(Arc::clone(arm), home());
    let line = linear_move(home_tcp(arm, 0.3, 0.3, 0.0), 1.0, fly(0.05));
    t.append(0.0, &line).unwrap();
    let line = linear_move(home_tcp(arm, 0.3, -0.3, 0.1), 1.0, Zone::Fine);
    t.append(0.0, &line).unwrap();
    t
}

/// Held at any time, the arm stands, waits, goes on over the same places, and keeps its limits.
#[test]
fn a_held_path_is_taken_up_where_it_was_left() {
    let arm = arm();
    let free = two_moves(&arm);
    let whole = free.duration();
    for share in [0.02, 0.3, 0.5, 0.55, 0.9, 0.99] {
        let mut t = two_moves(&arm);
        let at = share * whole;
        let mut trace: Vec<_> = (0..10_000)
            .map(|i| f64::from(i) * TICK)
            .take_while(|time| *time < at)
            .map(|time| t.sample(time))
            .collect();
        let begin = trace.len() as f64 * TICK;
        t.hold(begin);
        assert!(t.is_held() && !t.is_done(crate::SegmentId(1), 1e6));
        let stand = t.stand_time();
        assert!(stand - begin < 1.0, "stands within a second");
        let resume = begin + 2.0;
        while (trace.len() as f64) * TICK < resume {
            trace.push(t.sample(trace.len() as f64 * TICK));
        }
        let waited = t.sample(stand + 0.01);
        assert_eq!(waited, t.sample(resume), "it does not move while held");
        t.resume(resume);
        assert!(!t.is_held());
        let end = t.duration();
        assert!(
            end < resume + whole - begin + 1.0,
            "{share}: {end}, held from {begin} to {resume}, {whole} in all"
        );
        while (trace.len() as f64) * TICK < end + 0.02 {
            trace.push(t.sample(trace.len() as f64 * TICK));
        }
        let (speed, acceleration) = use_of_limits(&arm, &trace, TICK);
        assert!(
            speed < 1.01 && acceleration < 1.02,
            "{share}: {speed} {acceleration}"
        );
        assert!(t.sample(end).max_distance(&free.end_joints()) < 1e-9);
        // Every place of the held path lies on the free one.
        let places: Vec<_> = (0..=4000)
            .map(|i| free.sample(whole * f64::from(i) / 4000.0))
            .collect();
        for joints in trace.iter().step_by(7) {
            let off = places
                .iter()
                .map(|p| p.max_distance(joints))
                .fold(f64::INFINITY, f64::min);
            assert!(off < 2e-3, "{share}: {off} rad beside the path");
        }
    }
}

#[test]
fn segments_that_come_while_held_wait_too() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let ahead = |degrees| joint_move([degrees, 10.0, 10.0, 0.0, 70.0, 0.0], fly(0.1));
    t.append(0.0, &ahead(30.0)).unwrap();
    t.hold(0.2);
    let second = t.append(0.5, &ahead(60.0)).unwrap();
    let stand = t.sample(1.0);
    assert_eq!(t.sample(5.0), stand);
    t.resume(5.0);
    assert!(t.corner_failures().is_empty(), "the corner is still ahead");
    let end = t.end_time(second).unwrap();
    assert!(end > 5.2 && end < 10.0, "{end}");
    assert!((t.sample(end)[0] - 60f64.to_radians()).abs() < 1e-9);
    // Dropped while held: nothing is left.
    let mut t = two_moves(&arm);
    t.hold(0.3);
    t.stop(2.0);
    assert!(!t.is_held() && t.duration() < 2.0);
    assert!(t.end_joints().max_distance(&t.sample(3.0)) < 1e-12);
}
