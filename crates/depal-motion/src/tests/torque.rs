use std::sync::Arc;

use depal_arm::{Arm, Load};
use depal_frames::{JointPositions, Point};
use proptest::prelude::*;

use super::{arm, fly, home, home_tcp, joint_move, joints, linear_move};
use crate::curve::combine;
use crate::{MotionError, Segment, Trajectory, Zone};

fn load(mass: f64) -> Load {
    Load::point(mass, Point::new(0.1, 0.0, 0.4))
}

/// Largest torque of each axis along the cells with a load, N m, at nine places of each cell.
fn peaks(t: &Trajectory, load: &Load, standing: bool) -> JointPositions {
    let mut peaks = JointPositions::zeros(6);
    for cell in &t.cells {
        for i in 0..=8 {
            let elapsed = cell.law.duration * f64::from(i) / 8.0;
            let u = cell.parameter(cell.law.start + elapsed);
            let at = cell.curve.derivatives(u, 0.5 * (cell.from + cell.to));
            let rate = cell.law.rate + cell.law.acceleration * elapsed;
            let speeds = combine(&[rate], &[&at.first]);
            let rise = combine(
                &[cell.law.acceleration, rate * rate],
                &[&at.first, &at.second],
            );
            let q = cell.curve.position(u);
            let torques = if standing {
                t.arm().holding_torques(&q, load)
            } else {
                t.arm().joint_torques(&q, &speeds, &rise, load)
            };
            for (peak, torque) in peaks.iter_mut().zip(torques.iter()) {
                *peak = peak.max(torque.abs());
            }
        }
    }
    peaks
}

fn drive(arm: &Arc<Arm>, load: &Load, segments: &[Segment]) -> Trajectory {
    let mut t = Trajectory::new(Arc::clone(arm), home());
    t.set_load(load);
    for segment in segments {
        t.append(0.0, segment).unwrap();
    }
    t
}

/// The same arm with torques that hold the load, and give each axis `share` of what the motion would ask for.
fn weakened(segments: &[Segment], load: &Load, share: f64) -> Arc<Arm> {
    let free = drive(&arm(), load, segments);
    let mut limits = Vec::new();
    for j in 0..6 {
        let asked = peaks(&free, load, false)[j].max(peaks(&free, &Load::NONE, false)[j]);
        let held = peaks(&free, load, true)[j].max(peaks(&free, &Load::NONE, true)[j]);
        limits.push((share * asked).max(1.25 * held).max(1.0));
    }
    Arc::new((*arm()).clone().with_torque_limits(&limits).unwrap())
}

/// Largest use of the torque limits with the load and without; 1 is the limit.
fn torque_use(t: &Trajectory, load: &Load, limits: &JointPositions) -> f64 {
    [load, &Load::NONE]
        .into_iter()
        .flat_map(|load| {
            let peaks = peaks(t, load, false);
            (0..6).map(move |j| peaks[j]).collect::<Vec<_>>()
        })
        .zip(limits.iter().chain(limits.iter()))
        .fold(0.0, |most, (peak, limit)| most.max(peak / limit))
}

fn path(a: [f64; 6], b: [f64; 6]) -> Vec<Segment> {
    let arm = arm();
    vec![
        joint_move(a, fly(0.1)),
        joint_move(b, fly(0.2)),
        joint_move([0.0, 10.0, 10.0, 0.0, 70.0, 0.0], Zone::Fine),
        linear_move(home_tcp(&arm, 0.1, 0.3, 0.3), 3.0, fly(0.05)),
        linear_move(home_tcp(&arm, 0.0, -0.4, 0.1), 3.0, Zone::Fine),
    ]
}

fn place() -> impl Strategy<Value = [f64; 6]> {
    (
        -90.0..90.0,
        -20.0..40.0,
        -20.0..30.0,
        -60.0..60.0,
        30.0..90.0,
        -120.0..120.0,
    )
        .prop_map(|(a, b, c, d, e, f): (f64, f64, f64, f64, f64, f64)| [a, b, c, d, e, f])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn no_axis_gives_more_than_it_has(a in place(), b in place(), share in 0.3..0.9f64) {
        let segments = path(a, b);
        let free = drive(&arm(), &load(80.0), &segments);
        let weak = weakened(&segments, &load(80.0), share);
        let limits = *weak.torque_limits().unwrap();
        let t = drive(&weak, &load(80.0), &segments);
        let used = torque_use(&t, &load(80.0), &limits);
        prop_assert!(used < 1.01, "{used}");
        prop_assert!(t.duration() > free.duration() * (1.0 - 1e-3));
        // Without the limit the same motion breaks it, and the limit is made use of.
        if torque_use(&free, &load(80.0), &limits) > 1.02 {
            prop_assert!(t.duration() > free.duration());
            prop_assert!(used > 0.97, "{used}");
        }
        // What is timed anew on the way, and braking, obey it too.
        let mut late = Trajectory::new(Arc::clone(&weak), home());
        late.set_load(&load(80.0));
        late.append(0.0, &segments[0]).unwrap();
        let now = 0.4 * late.duration();
        late.append(now, &segments[1]).unwrap();
        prop_assert!(torque_use(&late, &load(80.0), &limits) < 1.01);
        let mut stopped = t.clone();
        stopped.stop(0.3 * t.duration());
        prop_assert!(torque_use(&stopped, &load(80.0), &limits) < 1.015);
        let mut held = t.clone();
        held.hold(0.6 * t.duration());
        let stand = held.stand_time() + 1.0;
        held.resume(stand);
        prop_assert!(torque_use(&held, &load(80.0), &limits) < 1.015);
        prop_assert!(held.sample(held.duration()).max_distance(&t.end_joints()) < 1e-9);
    }

    #[test]
    fn a_heavier_load_is_never_faster(a in place(), b in place(), share in 0.3..0.9f64) {
        let segments = path(a, b);
        let weak = weakened(&segments, &load(80.0), share);
        let mut before = 0.0;
        for mass in [0.0, 5.0, 20.0, 40.0, 80.0] {
            let t = drive(&weak, &load(mass), &segments);
            prop_assert!(t.duration() > before * (1.0 - 1e-3), "{mass}: {} {before}", t.duration());
            before = t.duration();
        }
    }

    /// Limits that nothing reaches change nothing.
    #[test]
    fn strong_axes_move_as_unlimited_ones(a in place(), b in place()) {
        let segments = path(a, b);
        let strong = Arc::new((*arm()).clone().with_torque_limits(&[1e9; 6]).unwrap());
        let (free, strong) = (drive(&arm(), &load(80.0), &segments), drive(&strong, &load(80.0), &segments));
        prop_assert!((free.duration() - strong.duration()).abs() < 1e-6 * free.duration());
    }
}

#[test]
fn a_heavy_load_slows_a_weak_arm_and_leaves_an_unlimited_one_alone() {
    let segments = path(
        [60.0, 30.0, -10.0, 40.0, 60.0, 90.0],
        [-50.0, -10.0, 20.0, -40.0, 80.0, -90.0],
    );
    let weak = weakened(&segments, &load(80.0), 0.5);
    let light = drive(&weak, &load(5.0), &segments).duration();
    let heavy = drive(&weak, &load(80.0), &segments).duration();
    assert!(heavy > 1.02 * light, "{light} {heavy}");
    let free = |mass| drive(&arm(), &load(mass), &segments);
    assert_eq!(
        free(0.0).duration().to_bits(),
        free(500.0).duration().to_bits()
    );
    assert!(free(80.0).sample_torques(0.5).is_none());
    let torques = drive(&weak, &load(80.0), &segments).sample_torques(0.5);
    assert!(torques.unwrap()[1].abs() > 100.0);
}

#[test]
fn a_load_that_cannot_be_held_is_refused_with_the_axis() {
    let weak = Arc::new(
        (*arm())
            .clone()
            .with_torque_limits(&[0.0, 9e3, 0.0, 0.0, 0.0, 0.0])
            .unwrap(),
    );
    let mut t = Trajectory::new(weak, home());
    t.set_load(&load(5000.0));
    let target = joint_move([20.0, 40.0, 0.0, 0.0, 30.0, 0.0], Zone::Fine);
    let error = t.append(0.0, &target).unwrap_err();
    assert!(
        matches!(error, MotionError::Overload { joint: 2, load_kg, .. } if load_kg == 5000.0),
        "{error}"
    );
    assert_eq!(t.end_joints(), home());
    t.set_load(&Load::NONE);
    t.append(0.0, &target).unwrap();
    assert!(
        t.end_joints()
            .max_distance(&joints([20.0, 40.0, 0.0, 0.0, 30.0, 0.0]))
            < 1e-12
    );
}
