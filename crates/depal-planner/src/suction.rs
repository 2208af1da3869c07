use depal_frames::{JointPositions, Pose, Vector};
use depal_gripper::{CupSpec, GripperSpec};

use crate::{request::PlannerSettings, timing::Trapezoid};

/// Standard gravity, m/s2.
const GRAVITY: f64 = 9.80665;
/// Samples of one move when its acceleration is measured.
const SAMPLES: usize = 24;
/// Slowest velocity that is ever asked for, percent.
const SLOWEST_PERCENT: f64 = 5.0;

/// Force with which some sealed cups are pressed onto their carton at full vacuum, N.
pub(crate) fn holding_force<'a>(
    gripper: &GripperSpec,
    cups: impl Iterator<Item = &'a CupSpec>,
) -> f64 {
    let mut reached = std::collections::BTreeMap::new();
    cups.map(|cup| {
        let vacuum = reached
            .entry(cup.section)
            .or_insert_with(|| gripper.sealed_vacuum(cup.section));
        std::f64::consts::PI * 0.25 * cup.diameter * cup.diameter * *vacuum
    })
    .sum()
}

/// Force needed to hold the assumed carton at rest, with the safety factor, N.
pub(crate) fn needed_at_rest(settings: &PlannerSettings) -> f64 {
    settings.max_carton_mass * GRAVITY * settings.suction_safety
}

/// Velocity at which a loaded joint move keeps inside the suction limit, percent of the full one.
///
/// Lift: `S m (g + a_z) <= N`. Shear: `S m a_h <= mu (N - m (g + a_z))`.
/// The whole move is taken to be slowed in time: at a fraction `p` of the velocity the acceleration is `p^2` of the full one.
pub(crate) fn loaded_percent(
    profile: &Trapezoid,
    base_from_tcp_at: impl Fn(f64) -> Pose,
    carton_in_tcp: &Vector,
    force: f64,
    friction: f64,
    settings: &PlannerSettings,
) -> f64 {
    if profile.duration <= 0.0 {
        return 100.0;
    }
    let step = profile.duration / SAMPLES as f64;
    let position = |k: usize| {
        let pose = base_from_tcp_at(profile.at(k as f64 * step));
        pose.rotation * carton_in_tcp + pose.translation.vector
    };
    let points: Vec<Vector> = (0..=SAMPLES).map(position).collect();
    let mut fraction: f64 = 1.0;
    for at in points.windows(3) {
        let acceleration = (at[2] - at[1] * 2.0 + at[0]) / (step * step);
        fraction = fraction.min(largest_fraction(&acceleration, force, friction, settings));
    }
    (fraction * 100.0).clamp(SLOWEST_PERCENT, 100.0)
}

/// Largest `p` for which `p^2` times this acceleration is held.
fn largest_fraction(
    acceleration: &Vector,
    force: f64,
    friction: f64,
    settings: &PlannerSettings,
) -> f64 {
    let (mass, safety) = (settings.max_carton_mass, settings.suction_safety);
    let horizontal = acceleration.xy().norm();
    let mut square: f64 = 1.0;
    // Both conditions are linear in p^2: left * p^2 <= right.
    let mut limit = |left: f64, right: f64| {
        if left > 0.0 {
            square = square.min((right / left).max(0.0));
        }
    };
    limit(
        safety * mass * acceleration.z,
        force - safety * mass * GRAVITY,
    );
    limit(
        safety * mass * horizontal + friction * mass * acceleration.z,
        friction * (force - mass * GRAVITY),
    );
    square.sqrt()
}

/// The same for a straight vertical move, whose acceleration is given.
pub(crate) fn vertical_percent(force: f64, friction: f64, settings: &PlannerSettings) -> f64 {
    let up = Vector::new(0.0, 0.0, settings.linear_acceleration);
    let fraction = largest_fraction(&up, force, friction, settings);
    (fraction * 100.0).clamp(SLOWEST_PERCENT, 100.0)
}

/// Pose of the tool along a joint move.
pub(crate) fn along<'a>(
    forward: impl Fn(&JointPositions) -> Pose + 'a,
    from: &'a JointPositions,
    to: &'a JointPositions,
) -> impl Fn(f64) -> Pose + 'a {
    move |fraction| forward(&from.lerp(to, fraction))
}
