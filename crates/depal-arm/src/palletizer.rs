use std::f64::consts::PI;

use depal_frames::{JointPositions, Pose, Vector};

use crate::chain::Chain;

/// Axes may be this far from where a palletizer has them, metres or (for directions) unitless.
const TOLERANCE: f64 = 1e-6;

/// Closed form for a four-axis palletizer whose parallelogram is written as a chain of six turning links.
/// Either 1, 2, minus 2, 3, minus 3, 4: joint angles 2 and 3 are those of the motors, against the vertical and the
/// horizontal. Or 1, 2, 3, minus 3, minus 2, 4: joint angle 3 is counted from the upper arm.
/// The two counter-turns (mimics) keep the flange level.
///
/// In the plane of the arm the flange is at `fixed + turn(2) * upper + turn(3) * fore`: a triangle,
/// where `turn(3)` is that of the forearm against the base.
#[derive(Debug, Clone)]
pub(crate) struct Palletizer {
    /// Of joints 1, 2, 3, 4: +1 about Z, Y, Y and Z.
    signs: [f64; 4],
    /// Joint 3 is counted from the upper arm.
    from_upper_arm: bool,
    /// In the plane (x outwards, z up), m.
    fixed: (f64, f64),
    upper: (f64, f64),
    fore: (f64, f64),
    /// Turn of the flange at zero joints.
    base_from_flange: Pose,
}

impl Palletizer {
    pub fn recognise(chain: &Chain, names: &[String]) -> Option<Self> {
        const ABSOLUTE: [(usize, f64); 6] =
            [(0, 1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0), (3, 1.0)];
        const FROM_UPPER_ARM: [(usize, f64); 6] =
            [(0, 1.0), (1, 1.0), (2, 1.0), (2, -1.0), (1, -1.0), (3, 1.0)];
        let axes = chain.axes_at_zero(names.len());
        if axes.len() != 6 || names.len() != 4 {
            return None;
        }
        let along = [
            Vector::z(),
            Vector::y(),
            Vector::y(),
            Vector::y(),
            Vector::y(),
            Vector::z(),
        ];
        let follows = |pattern: &[(usize, f64); 6]| {
            axes.iter()
                .zip(pattern)
                .zip(&along)
                .all(|((axis, &(index, factor)), along)| {
                    let turned = axis.direction.dot(along) * axis.multiplier;
                    axes.iter()
                        .find(|a| a.index == index)
                        .is_some_and(|driver| {
                            let forward = driver.direction.dot(along) * driver.multiplier;
                            axis.index == index
                                && axis.offset == 0.0
                                && (turned.abs() - 1.0).abs() <= TOLERANCE
                                && (turned - factor * forward).abs() <= TOLERANCE
                        })
                })
        };
        let from_upper_arm = follows(&FROM_UPPER_ARM);
        if !from_upper_arm && !follows(&ABSOLUTE) {
            return None;
        }
        let flange = chain.base_from_tip(&JointPositions::zeros(4));
        let tip = flange.translation.vector;
        let off_axis = |p: Vector| p.xy().norm() > TOLERANCE;
        if off_axis(axes[0].point)
            || tip.y.abs() > TOLERANCE
            || off_axis(axes[5].point - tip)
            || axes[1..5].iter().any(|a| !a.point.y.is_finite())
        {
            return None;
        }
        let plane = |v: Vector| (v.x, v.z);
        let p: Vec<Vector> = axes.iter().map(|a| a.point).collect();
        let sign = |i: usize| axes[i].direction.dot(&along[i]).signum();
        // Which links are turned by the upper arm's angle, by the forearm's, and by neither.
        let (third, fixed, upper, fore) = if from_upper_arm {
            (
                2,
                p[1] + (tip - p[4]),
                (p[2] - p[1]) + (p[4] - p[3]),
                p[3] - p[2],
            )
        } else {
            (
                3,
                p[1] + (p[3] - p[2]) + (tip - p[4]),
                p[2] - p[1],
                p[4] - p[3],
            )
        };
        Some(Self {
            signs: [sign(0), sign(1), sign(third), sign(5)],
            from_upper_arm,
            fixed: plane(fixed),
            upper: plane(upper),
            fore: plane(fore),
            base_from_flange: flange,
        })
    }

    /// Up to four postures, each angle somewhere in one turn. Empty for a flange that is not level.
    pub fn branches(
        &self,
        base_from_flange: &Pose,
        near: Option<&JointPositions>,
    ) -> Vec<Vec<f64>> {
        let turn = base_from_flange.rotation * self.base_from_flange.rotation.inverse();
        let tilt = turn * Vector::z() - Vector::z();
        if tilt.norm() > 1e-6 {
            return Vec::new();
        }
        let ahead = turn * Vector::x();
        let yaw = ahead.y.atan2(ahead.x);
        let at = base_from_flange.translation.vector;
        let radius = at.xy().norm();
        // Above its own foot the arm may look anywhere.
        let bearing = match near {
            Some(near) if radius < 1e-9 => self.signs[0] * near[0],
            _ => at.y.atan2(at.x),
        };
        let mut found = Vec::new();
        for (first, reach) in [(bearing, radius), (bearing + PI, -radius)] {
            let target = (reach - self.fixed.0, at.z - self.fixed.1);
            for (second, third) in triangle(self.upper, self.fore, target) {
                let third = if self.from_upper_arm {
                    third - second
                } else {
                    third
                };
                found.push(vec![
                    self.signs[0] * first,
                    self.signs[1] * second,
                    self.signs[2] * third,
                    self.signs[3] * (yaw - first),
                ]);
            }
        }
        found
    }
}

/// Turns about Y (x towards -z) of two arms in the plane (x, z) that add up to `target`.
fn triangle(upper: (f64, f64), fore: (f64, f64), target: (f64, f64)) -> Vec<(f64, f64)> {
    let length = |v: (f64, f64)| v.0.hypot(v.1);
    let angle = |v: (f64, f64)| (-v.1).atan2(v.0);
    let (a, b, c) = (length(upper), length(fore), length(target));
    if c < 1e-12 {
        return Vec::new();
    }
    let cosine = (a * a + c * c - b * b) / (2.0 * a * c);
    // Stretched out the cosine is 1 but for rounding.
    if cosine.is_nan() || cosine.abs() > 1.0 + 1e-12 {
        return Vec::new();
    }
    let opening = cosine.clamp(-1.0, 1.0).acos();
    [opening, -opening]
        .map(|open| {
            let along = angle(target) + open;
            let rest = (target.0 - a * along.cos(), target.1 + a * along.sin());
            (along - angle(upper), angle(rest) - angle(fore))
        })
        .to_vec()
}
