use std::sync::Arc;

use super::*;

/// Least distance of the TCP to a point over the whole trajectory, metres.
fn nearest(arm: &Arm, t: &Trajectory, point: &Pose) -> f64 {
    (0..=(t.duration() / 0.001) as i32)
        .map(|i| {
            let tcp = arm.base_from_flange(&t.sample(f64::from(i) * 0.001)) * tool();
            (tcp.translation.vector - point.translation.vector).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

/// An L of two lines of 0.6 and 0.8 m.
fn l_shape(arm: &Arc<Arm>, zone: Zone) -> (Trajectory, Pose) {
    let corner = home_tcp(arm, 0.0, 0.6, 0.0);
    let mut t = Trajectory::new(Arc::clone(arm), home());
    t.append(0.0, &linear_move(corner, 0.5, zone)).unwrap();
    t.append(
        0.0,
        &linear_move(home_tcp(arm, 0.0, 0.6, -0.8), 0.5, Zone::Fine),
    )
    .unwrap();
    (t, corner)
}

#[test]
fn fine_point_is_reached_and_stood_at() {
    let arm = arm();
    let (t, corner) = l_shape(&arm, Zone::Fine);
    let end = t.end_time(crate::SegmentId(0)).unwrap();
    let tcp = arm.base_from_flange(&t.sample(end)) * tool();
    assert!((tcp.translation.vector - corner.translation.vector).norm() < 1e-6);
    assert!(t.sample_speed(end).iter().all(|v| v.abs() < 1e-9));
    assert!(t.corner_failures().is_empty());
}

/// The corner of a parabola lies at a quarter of the sum of the two legs from the programmed point.
#[test]
fn corner_is_cut_within_the_zone() {
    let arm = arm();
    let (fine, _) = l_shape(&arm, Zone::Fine);
    let mut before = fine.duration();
    for zone in [0.01, 0.05, 0.2] {
        let (t, corner) = l_shape(&arm, fly(zone));
        let distance = nearest(&arm, &t, &corner);
        let parabola = zone * std::f64::consts::FRAC_1_SQRT_2 / 2.0;
        assert!(
            (distance - parabola).abs() < 0.15 * parabola,
            "zone {zone}: {distance}, parabola {parabola}"
        );
        assert!(t.corner_failures().is_empty());
        assert!(t.duration() < before, "a larger zone is faster");
        before = t.duration();
    }
}

/// A zone larger than the way is cut to half of the shorter neighbour, here 0.3 m.
#[test]
fn zone_is_cut_to_half_of_the_shorter_neighbour() {
    let arm = arm();
    let (large, corner) = l_shape(&arm, fly(5.0));
    let (half, _) = l_shape(&arm, fly(0.3));
    assert!((nearest(&arm, &large, &corner) - nearest(&arm, &half, &corner)).abs() < 1e-3);
}

#[test]
fn joint_and_linear_moves_blend_into_each_other() {
    let arm = arm();
    let down = home_tcp(&arm, 0.0, 0.0, -0.5);
    let mut t = Trajectory::new(Arc::clone(&arm), joints([60.0, 0.0, 0.0, 0.0, 60.0, 0.0]));
    let home_degrees = [0.0, 10.0, 10.0, 0.0, 70.0, 0.0];
    let over = t.append(0.0, &joint_move(home_degrees, fly(0.1))).unwrap();
    let pick = t.append(0.0, &linear_move(down, 1.0, fly(0.1))).unwrap();
    t.append(
        0.0,
        &joint_move([-60.0, 0.0, 0.0, 0.0, 60.0, 0.0], Zone::Fine),
    )
    .unwrap();
    assert!(t.corner_failures().is_empty());
    for (id, point) in [(over, home_tcp(&arm, 0.0, 0.0, 0.0)), (pick, down)] {
        let distance = nearest(&arm, &t, &point);
        assert!(distance > 0.01 && distance < 0.1, "{distance}");
        let moving = t.sample_speed(t.end_time(id).unwrap());
        assert!(moving.iter().any(|v| v.abs() > 0.01), "does not stop");
    }
}

/// There and back: the corner degenerates to a turn on the spot, still within limits.
#[test]
fn reversal_is_a_corner_too() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    t.append(
        0.0,
        &joint_move([60.0, 10.0, 10.0, 0.0, 70.0, 0.0], fly(0.1)),
    )
    .unwrap();
    t.append(
        0.0,
        &joint_move([0.0, 10.0, 10.0, 0.0, 70.0, 0.0], Zone::Fine),
    )
    .unwrap();
    assert!(t.corner_failures().is_empty());
    let (speed, acceleration) = use_of_limits(&arm, &samples(&t, TICK), TICK);
    assert!(
        speed <= 1.01 && acceleration <= 1.01,
        "{speed} {acceleration}"
    );
}

/// A move to where the arm already stands takes no time and is over at once.
#[test]
fn move_to_the_same_place() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let id = t
        .append(
            0.0,
            &joint_move([0.0, 10.0, 10.0, 0.0, 70.0, 0.0], Zone::Fine),
        )
        .unwrap();
    assert!(t.is_done(id, 0.0));
    assert_eq!(t.duration(), 0.0);
}
