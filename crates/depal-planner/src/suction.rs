use depal_frames::{JointPositions, Pose, Vector};
use depal_gripper::{CupSpec, GripperSpec};

use crate::{request::PlannerSettings, timing::Trapezoid};

/// Standard gravity, m/s2.
pub(crate) const GRAVITY: f64 = 9.80665;
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

/// How a carton hangs: what its sealed cups can do against pull, shear and tipping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hold {
    /// Holding force at full vacuum, N.
    pub force: f64,
    /// Friction between lips and carton.
    pub friction: f64,
    /// Lever of the cups against tipping, m: a moment `M` loads the outermost cup as `M / lever` more weight would.
    pub lever: f64,
    /// From the middle of the cups to the middle of the face, m.
    pub eccentricity: f64,
    /// From the face down to the centre of mass, m.
    pub depth: f64,
}

/// Lever of cups in a single row, m: only their lips keep the carton from swinging.
const LEAST_LEVER: f64 = 0.01;
/// More than any arm does with a load, m/s2: beyond it holds are equally good.
const ENOUGH: f64 = 8.0;

impl Hold {
    /// The cups of one face, whose middle is at `middle` in the tool frame; the carton is `height` high.
    pub fn of(gripper: &GripperSpec, cups: &[&CupSpec], middle: [f64; 2], height: f64) -> Self {
        let count = cups.len().max(1) as f64;
        let centre = [0, 1].map(|k| cups.iter().map(|c| c.position[k]).sum::<f64>() / count);
        let lever = |k: usize| {
            let away = || cups.iter().map(|c| (c.position[k] - centre[k]).abs());
            let farthest = away().fold(0.0, f64::max);
            if farthest < 1e-9 {
                return LEAST_LEVER;
            }
            (away().map(|a| a * a).sum::<f64>() / (count * farthest)).max(LEAST_LEVER)
        };
        Self {
            force: holding_force(gripper, cups.iter().copied()),
            friction: gripper.vacuum.friction,
            lever: lever(0).min(lever(1)),
            eccentricity: (centre[0] - middle[0]).hypot(centre[1] - middle[1]),
            depth: height * 0.5,
        }
    }

    /// Largest share of this acceleration that the hold bears, up to 1.
    ///
    /// Lift: `S m (g + a_z) <= N`. Shear: `S m a_h <= mu (N - m (g + a_z))`. Tipping, with the lever `r` of the cups, the
    /// depth `h` of the centre of mass and the eccentricity `e`: `S m ((g + a_z) (1 + e / r) + a_h h / r) <= N`,
    /// which is the load of the outermost cup.
    fn share(&self, acceleration: &Vector, settings: &PlannerSettings) -> f64 {
        let (mass, safety) = (settings.max_carton_mass, settings.suction_safety);
        let horizontal = acceleration.xy().norm();
        let lean = 1.0 + self.eccentricity / self.lever;
        let mut share: f64 = 1.0;
        // All conditions are linear in the share: left * share <= right.
        let mut limit = |left: f64, right: f64| {
            if left > 0.0 {
                share = share.min((right / left).max(0.0));
            }
        };
        limit(
            safety * mass * acceleration.z,
            self.force - safety * mass * GRAVITY,
        );
        limit(
            safety * mass * horizontal + self.friction * mass * acceleration.z,
            self.friction * (self.force - mass * GRAVITY),
        );
        limit(
            safety * mass * (acceleration.z * lean + horizontal * self.depth / self.lever),
            self.force - safety * mass * GRAVITY * lean,
        );
        share
    }

    /// Horizontal acceleration that it bears, m/s2, no more than an arm ever asks for.
    pub fn sideways(&self, settings: &PlannerSettings) -> f64 {
        ENOUGH * self.share(&Vector::new(ENOUGH, 0.0, 0.0), settings)
    }
}

/// Force needed to hold the assumed carton at rest, with the safety factor, N.
pub(crate) fn needed_at_rest(settings: &PlannerSettings) -> f64 {
    settings.max_carton_mass * GRAVITY * settings.suction_safety
}

/// Velocity at which a loaded joint move keeps inside the suction limit, percent of the full one.
///
/// The whole move is taken to be slowed in time: at a fraction `p` of the velocity the acceleration is `p^2` of the full one.
pub(crate) fn loaded_percent(
    profile: &Trapezoid,
    base_from_tcp_at: impl Fn(f64) -> Pose,
    carton_in_tcp: &Vector,
    hold: &Hold,
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
        fraction = fraction.min(hold.share(&acceleration, settings).sqrt());
    }
    (fraction * 100.0).clamp(SLOWEST_PERCENT, 100.0)
}

/// The same for a straight vertical move, whose acceleration is given.
pub(crate) fn vertical_percent(hold: &Hold, settings: &PlannerSettings) -> f64 {
    let up = Vector::new(0.0, 0.0, settings.linear_acceleration);
    let fraction = hold.share(&up, settings).sqrt();
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
