use std::sync::Arc;

use depal_arm::{Arm, JointLimit, Load};
use depal_frames::{JointPositions, Point};
use proptest::prelude::*;

use super::arm;
use crate::{BlendedPath, Piece, Trajectory, slowest_joint_time};

fn limits() -> Vec<JointLimit> {
    let limit = |max_speed, max_acceleration| JointLimit {
        lower: -10.0,
        upper: 10.0,
        max_speed,
        max_acceleration,
    };
    vec![limit(1.5, 3.0), limit(2.0, 4.0)]
}

fn joints(a: f64, b: f64) -> JointPositions {
    JointPositions::from_slice(&[a, b])
}

/// By hand: 3 rad at 1.5 rad/s and 3 rad/s2 take 3/1.5 + 1.5/3 s; 0.48 rad never reach full speed: 2 sqrt(0.48/3) s.
#[test]
fn a_line_is_a_trapezoid() {
    let far = BlendedPath::new(&[joints(0.0, 0.0), joints(3.0, 1.0)], &[0.0; 2]);
    assert!((far.time(&limits()) - 2.5).abs() < 1e-12);
    let near = BlendedPath::new(&[joints(0.0, 0.0), joints(0.48, 0.1)], &[0.0; 2]);
    assert!((near.time(&limits()) - 0.8).abs() < 1e-12);
    assert!(
        (slowest_joint_time(&limits(), &joints(0.0, 0.0), &joints(3.0, 1.0)) - 2.5).abs() < 1e-12
    );
}

#[test]
fn stops_add_up_and_blends_save_time() {
    let points = [joints(0.0, 0.0), joints(1.5, 0.0), joints(1.5, 1.5)];
    let stopping = BlendedPath::new(&points, &[0.0; 3]).time(&limits());
    let legs: f64 = points
        .windows(2)
        .map(|w| BlendedPath::new(w, &[0.0; 2]).time(&limits()))
        .sum();
    assert!((stopping - legs).abs() < 1e-12);
    let mut last = stopping;
    for blend in [0.1, 0.4, 0.8, 1.2, 1.5] {
        let time = BlendedPath::new(&points, &[0.0, blend, 0.0]).time(&limits());
        assert!(time < last, "blend {blend}: {time} s, before {last} s");
        last = time;
    }
    assert!(last > slowest_joint_time(&limits(), &points[0], &points[2]));
}

/// A corner of a straight line is no corner: the time is that of the line.
#[test]
fn a_blend_on_a_straight_line_changes_nothing() {
    let points = [joints(0.0, 0.0), joints(1.0, 0.5), joints(3.0, 1.5)];
    let blended = BlendedPath::new(&points, &[0.0, 0.8, 0.0]).time(&limits());
    let straight = BlendedPath::new(&[points[0], points[2]], &[0.0; 2]).time(&limits());
    assert!(
        (blended - straight).abs() < 1e-3 * straight,
        "{blended} {straight}"
    );
}

/// The parabola (1-u)^2 A + 2u(1-u) P + u^2 B, point by point.
#[test]
fn a_corner_is_the_promised_parabola() {
    let points = [joints(0.0, 0.0), joints(2.0, 0.0), joints(2.0, 1.0)];
    let path = BlendedPath::new(&points, &[0.0, 0.6, 0.0]);
    let (a, p, b) = (joints(1.4, 0.0), points[1], joints(2.0, 0.6));
    let corner = &path.pieces()[1];
    for u in [0.0_f64, 0.25, 0.5, 0.9, 1.0] {
        let at = corner.at(u);
        for i in 0..2 {
            let expected = (1.0 - u).powi(2) * a[i] + 2.0 * u * (1.0 - u) * p[i] + u * u * b[i];
            assert!((at[i] - expected).abs() < 1e-12);
        }
    }
}

/// An independent law on the same path: many small steps, each bound checked numerically, cannot be faster.
/// Speeds and accelerations of the sampled motion stay inside the limits, and some limit is reached.
#[test]
fn time_agrees_with_a_finely_cut_path() {
    let points = [
        joints(0.0, 0.0),
        joints(1.2, -0.9),
        joints(2.6, 0.4),
        joints(2.0, 1.5),
    ];
    let path = BlendedPath::new(&points, &[0.0, 0.95, 0.62, 0.0]);
    let time = path.time(&limits());
    let peer = brute_force(&path, &limits());
    assert!((time - peer).abs() < 0.01 * peer, "{time} s, {peer} s");
}

/// Phase plane on a fine grid, with slopes by finite differences: backward, then forward, 4000 steps.
fn brute_force(path: &BlendedPath, limits: &[JointLimit]) -> f64 {
    let total: f64 = path.pieces().iter().map(Piece::length).sum();
    let at = |s: f64| {
        let mut rest = s.clamp(0.0, total);
        for piece in path.pieces() {
            if rest <= piece.length() {
                return piece.at(rest / piece.length());
            }
            rest -= piece.length();
        }
        path.pieces()[path.pieces().len() - 1].at(1.0)
    };
    let count = 4000;
    let step = total / f64::from(count);
    let h = step * 0.25;
    let derivatives: Vec<Vec<(f64, f64)>> = (0..count)
        .map(|k| {
            let s = (f64::from(k) + 0.5) * step;
            let (l, m, r) = (at(s - h), at(s), at(s + h));
            (0..limits.len())
                .map(|i| {
                    (
                        (r[i] - l[i]) / (2.0 * h),
                        (r[i] - 2.0 * m[i] + l[i]) / (h * h),
                    )
                })
                .collect()
        })
        .collect();
    let top = |k: usize| {
        let mut x = f64::INFINITY;
        for ((d, dd), limit) in derivatives[k].iter().zip(limits) {
            x = x.min((limit.max_speed / d).powi(2));
            x = x.min(limit.max_acceleration / dd.abs().max(1e-9) * 4.0);
        }
        x
    };
    // Range of the acceleration along the path at squared speed x; empty when x is too fast.
    let range = |k: usize, x: f64| {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for ((d, dd), limit) in derivatives[k].iter().zip(limits) {
            let a = limit.max_acceleration;
            let (p, q) = ((-a - dd * x) / d, (a - dd * x) / d);
            low = low.max(p.min(q));
            high = high.min(p.max(q));
        }
        (low, high)
    };
    let mut ceiling = vec![0.0; derivatives.len() + 1];
    for k in (0..derivatives.len()).rev() {
        // The highest x from which the braking reaches the ceiling behind.
        let (mut good, mut bad) = (0.0, top(k));
        for _ in 0..50 {
            let x = 0.5 * (good + bad);
            let (low, high) = range(k, x);
            if low <= high && x + 2.0 * step * low <= ceiling[k + 1] {
                good = x;
            } else {
                bad = x;
            }
        }
        ceiling[k] = good;
    }
    let (mut x, mut time) = (0.0_f64, 0.0);
    for k in 0..derivatives.len() {
        let (_, high) = range(k, x);
        let next = (x + 2.0 * step * high).clamp(0.0, ceiling[k + 1]);
        time += 2.0 * step / (x.sqrt() + next.sqrt());
        x = next;
    }
    time
}

fn load(mass: f64) -> Load {
    Load::point(mass, Point::new(0.1, 0.0, 0.4))
}

/// Waypoints, and how much of the room at each is rounded.
fn way() -> impl Strategy<Value = (Vec<JointPositions>, Vec<f64>)> {
    let point = (
        -90.0..90.0,
        -20.0..40.0,
        -20.0..30.0,
        -60.0..60.0,
        30.0..90.0,
        -120.0..120.0,
    )
        .prop_map(|(a, b, c, d, e, f): (f64, f64, f64, f64, f64, f64)| {
            JointPositions::from_degrees(&[a, b, c, d, e, f])
        });
    let corner = prop_oneof![Just(0.0), 0.02..1.0f64, Just(1.0 - 1e-9)];
    (
        prop::collection::vec(point, 2..6),
        prop::collection::vec(corner, 6),
    )
        .prop_map(|(points, shares)| {
            let length = |i: usize| crate::blended::distance(&points[i], &points[i + 1]);
            let last = points.len() - 1;
            // Outer moves may belong to their one corner alone, inner ones are halved.
            let room = |i: usize| if i == 0 || i + 1 == last { 1.0 } else { 0.5 } * length(i);
            let blends = (0..=last)
                .map(|i| {
                    if i == 0 || i == last {
                        0.0
                    } else {
                        shares[i] * room(i - 1).min(room(i))
                    }
                })
                .collect();
            (points, blends)
        })
}

fn through(arm: &Arc<Arm>, points: &[JointPositions], blends: &[f64], load: &Load) -> Trajectory {
    let t = Trajectory::through(arm, points, blends, &Load::NONE, load).unwrap();
    assert!(t.corner_failures().is_empty());
    t
}

/// Largest torque of each axis on the way, N m: moving, and standing.
fn torques(t: &Trajectory, load: &Load) -> [JointPositions; 2] {
    let mut most = [JointPositions::zeros(6); 2];
    for i in 0..=400 {
        let time = t.duration() * f64::from(i) / 400.0;
        let (before, q, after) = (t.sample(time - 1e-3), t.sample(time), t.sample(time + 1e-3));
        let (mut speed, mut rise) = (q, q);
        for j in 0..6 {
            speed[j] = (after[j] - before[j]) / 2e-3;
            rise[j] = (after[j] - 2.0 * q[j] + before[j]) / 1e-6;
        }
        for load in [load, &Load::NONE] {
            let moving = t.arm().joint_torques(&q, &speed, &rise, load);
            let standing = t.arm().holding_torques(&q, load);
            for (most, now) in most.iter_mut().zip([moving, standing]) {
                for j in 0..6 {
                    most[j] = most[j].max(now[j].abs());
                }
            }
        }
    }
    most
}

/// The arm with axes that hold this load and have a share of what the free motion asks for.
fn weak(points: &[JointPositions], blends: &[f64], load: &Load, share: f64) -> Arc<Arm> {
    let [asked, _] = torques(&through(&arm(), points, blends, load), load);
    // The moves without their corners are looked at as well.
    let [_, held] = torques(&through(&arm(), points, &[0.0; 8], load), load);
    let limits: Vec<f64> = (0..6)
        .map(|j| (share * asked[j]).max(1.25 * held[j]).max(1.0))
        .collect();
    Arc::new(Arm::clone(&arm()).with_torque_limits(&limits).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The time that is said of a blended path is that of the trajectory through it, and both lead along one curve.
    #[test]
    fn a_trajectory_flies_the_path_in_its_time((points, blends) in way()) {
        let path = BlendedPath::new(&points, &blends);
        let t = through(&arm(), &points, &blends, &Load::NONE);
        let said = path.time(arm().limits());
        prop_assert!((t.duration() - said).abs() < 5e-3 * said, "{said} {}", t.duration());
        prop_assert!(path.rough_time(arm().limits()) > said * (1.0 - 1e-6));
        let states = path.samples(2e-3);
        for i in 0..=60 {
            let at = t.sample(t.duration() * f64::from(i) / 60.0);
            let off = (0..states.count())
                .map(|k| crate::blended::distance(&states.at(k), &at))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(off < 1.1e-3, "{off}");
        }
    }

    /// So it is where torques limit; a law without them says something else.
    #[test]
    fn torques_count_in_the_time_of_a_path((points, blends) in way(), share in 0.3..0.8f64) {
        let path = BlendedPath::new(&points, &blends);
        let weak = weak(&points, &blends, &load(80.0), share);
        let flown = through(&weak, &points, &blends, &load(80.0)).duration();
        let said = path.loaded_time(&weak, &Load::NONE, &load(80.0)).unwrap();
        prop_assert!((flown - said).abs() < 5e-3 * flown, "{said} {flown}");
        let light = path.loaded_time(&weak, &Load::NONE, &load(5.0)).unwrap();
        prop_assert!(light <= said * (1.0 + 1e-3));
        let without = path.time(weak.limits());
        prop_assert!(said > without * (1.0 - 2e-3), "{said} {without}");
        // The tool counts whether it carries or not.
        let tool = path.loaded_time(&weak, &load(80.0), &Load::NONE).unwrap();
        prop_assert!(tool <= said * (1.0 + 1e-3));
    }
}

/// The counterfactual: with half of what the motion asks for, a law without torques is wrong by more than 1 %.
#[test]
fn a_law_without_torques_would_be_wrong() {
    let points = [
        [-60.0, 30.0, 0.0, 0.0, 60.0, -60.0],
        [0.0, -15.0, 10.0, 20.0, 70.0, 0.0],
        [70.0, 25.0, 5.0, 0.0, 60.0, 70.0],
    ]
    .map(|degrees| JointPositions::from_degrees(&degrees));
    let blends = [0.0, 0.7, 0.0];
    let path = BlendedPath::new(&points, &blends);
    let weak = weak(&points, &blends, &load(80.0), 0.5);
    let flown = through(&weak, &points, &blends, &load(80.0)).duration();
    let said = path.loaded_time(&weak, &Load::NONE, &load(80.0)).unwrap();
    let without = path.time(weak.limits());
    assert!((said - flown).abs() < 0.005 * flown, "{said} {flown}");
    assert!(without < 0.97 * flown, "{without} {flown}");
    let light = path.loaded_time(&weak, &Load::NONE, &load(5.0)).unwrap();
    assert!(light < 0.97 * said, "{light} {said}");
    let error = path
        .loaded_time(&weak, &Load::NONE, &load(2000.0))
        .unwrap_err();
    assert!(
        matches!(error, crate::MotionError::Overload { .. }),
        "{error}"
    );
}
