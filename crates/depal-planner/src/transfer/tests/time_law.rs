use depal_arm::JointLimit;
use depal_frames::JointPositions;

use crate::transfer::law::{BlendedPath, fitting_blends, lower_bound};

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
    assert!((lower_bound(&joints(0.0, 0.0), &joints(3.0, 1.0), &limits()) - 2.5).abs() < 1e-12);
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
    assert!(last > lower_bound(&points[0], &points[2], &limits()));
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
    let corner = &path.pieces[1];
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
    let blends = fitting_blends(&points, &[0.5, 0.5, 0.5, 0.5]);
    let path = BlendedPath::new(&points, &blends);
    let time = path.time(&limits());
    let peer = brute_force(&path, &limits());
    assert!((time - peer).abs() < 0.01 * peer, "{time} s, {peer} s");
}

/// Phase plane on a fine grid, with slopes by finite differences: backward, then forward, 4000 steps.
fn brute_force(path: &BlendedPath, limits: &[JointLimit]) -> f64 {
    let total: f64 = path.pieces.iter().map(|p| p.length).sum();
    let at = |s: f64| {
        let mut rest = s.clamp(0.0, total);
        for piece in &path.pieces {
            if rest <= piece.length {
                return piece.at(rest / piece.length);
            }
            rest -= piece.length;
        }
        path.pieces[path.pieces.len() - 1].at(1.0)
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
