use super::*;
use crate::Circle;
use depal_frames::{Point, Vector};

fn point(arm: &Arm, dx: f64, dy: f64, dz: f64) -> Point {
    Point::from(home_tcp(arm, dx, dy, dz).translation.vector)
}

fn arc(arm: &Arm, through: Point, to: Pose) -> Segment {
    let _ = arm;
    Segment {
        target: SegmentTarget::Arc { through, to },
        ..linear_move(to, 0.5, Zone::Fine)
    }
}

/// The TCP keeps the distance from the centre, passes the point between, and ends at the target.
#[test]
fn the_tcp_travels_the_arc_at_its_speed() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let (through, to) = (point(&arm, 0.2, 0.2, 0.0), home_tcp(&arm, 0.4, 0.0, 0.0));
    t.append(0.0, &arc(&arm, through, to)).unwrap();
    let centre = point(&arm, 0.2, 0.0, 0.0);
    let tcp = |time: f64| arm.base_from_flange(&t.sample(time)) * tool();
    let mut nearest = f64::INFINITY;
    let mut fastest = 0.0_f64;
    let mut before = tcp(0.0).translation.vector;
    let steps = (t.duration() / TICK) as i32;
    for i in 1..=steps {
        let at = tcp(f64::from(i) * TICK).translation.vector;
        let radius = (at - centre.coords).norm();
        assert!((radius - 0.2).abs() < 2e-4, "radius {radius}");
        nearest = nearest.min((at - through.coords).norm());
        fastest = fastest.max((at - before).norm() / TICK);
        before = at;
    }
    assert!(nearest < 0.002, "passes the point between by {nearest}");
    assert!((0.45..0.505).contains(&fastest), "{fastest} m/s");
    let end = tcp(t.duration());
    assert!((end.translation.vector - to.translation.vector).norm() < 1e-6);
}

#[test]
fn more_than_half_a_turn_goes_the_long_way() {
    let start = Point::new(1.0, 0.0, 0.0);
    let via = Point::new(-1.0, 0.0, 0.0);
    let end = Point::new(0.0, -1.0, 0.0);
    let circle = Circle::through(&start, &via, &end).unwrap();
    assert!((circle.length() - 1.5 * std::f64::consts::PI).abs() < 1e-12);
    assert!((circle.at(2.0 / 3.0) - via.coords).norm() < 1e-12);
    assert!((circle.at(1.0) - end.coords).norm() < 1e-12);
    assert!((circle.at(1.0 / 3.0) - Vector::new(0.0, 1.0, 0.0)).norm() < 1e-12);
}

#[test]
fn points_in_line_or_on_each_other_make_no_arc() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    for through in [point(&arm, 0.2, 0.0, 0.0), point(&arm, 0.0, 0.0, 0.0)] {
        let to = home_tcp(&arm, 0.4, 0.0, 0.0);
        let error = t.append(0.0, &arc(&arm, through, to)).unwrap_err();
        assert!(matches!(error, MotionError::NoCircle { .. }), "{error}");
    }
    assert_eq!(t.duration(), 0.0);
}

/// The same pose in its own configuration, with another quarter of joint 6, and in one that does not exist.
#[test]
fn a_configuration_chooses_the_solution_or_refuses() {
    let arm = arm();
    let target = joints([20.0, 10.0, 10.0, 15.0, 60.0, 30.0]);
    let tcp = arm.base_from_flange(&target) * tool();
    let to = |interpolation, quarters| {
        let mut t = Trajectory::new(Arc::clone(&arm), home());
        let segment = Segment {
            interpolation,
            quarters: Some(quarters),
            ..linear_move(tcp, 0.5, Zone::Fine)
        };
        t.append(0.0, &segment).map(|_| t.end_joints())
    };
    let end = to(Interpolation::Joint, [0, 0, 0]).unwrap();
    assert!(end.max_distance(&target) < 1e-6);
    // The flipped wrist: joints 4 and 6 half a turn away, joint 5 negative.
    let flipped = to(Interpolation::Joint, [0, -2, -2]).unwrap();
    assert!(flipped[4] < 0.0 && (flipped[3] + 165f64.to_radians()).abs() < 1e-6);
    let error = to(Interpolation::Joint, [1, 0, 0]).unwrap_err();
    assert!(
        matches!(error, MotionError::Configuration { joint: 1, quarter: 1, found_deg } if (found_deg - 20.0).abs() < 1e-3),
        "{error}"
    );
    // A line cannot choose: it ends in the configuration that its way leads to.
    assert!(to(Interpolation::Linear, [0, 0, 0]).is_ok());
    assert!(matches!(
        to(Interpolation::Linear, [0, -2, -2]),
        Err(MotionError::Configuration { joint: 4, .. })
    ));
}
