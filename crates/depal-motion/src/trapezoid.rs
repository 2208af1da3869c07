use depal_arm::JointLimit;
use depal_frames::JointPositions;

/// A rest-to-rest move of unit length with limits on speed and acceleration: ramp up, cruise, ramp down.
/// What a [`Trajectory`](crate::Trajectory) does along a straight joint move when only speeds and accelerations of the
/// joints limit it.
#[derive(Debug, Clone, Copy)]
pub struct Trapezoid {
    /// Seconds.
    pub duration: f64,
    /// Length of each ramp, seconds.
    pub ramp: f64,
    acceleration: f64,
}

impl Trapezoid {
    const STILL: Self = Self {
        duration: 0.0,
        ramp: 0.0,
        acceleration: 0.0,
    };

    /// `speed` and `acceleration` in units of the whole way, 1/s and 1/s2.
    pub fn new(speed: f64, acceleration: f64) -> Self {
        if speed * speed >= acceleration {
            // Never reaches full speed.
            let ramp = (1.0 / acceleration).sqrt();
            return Self {
                duration: 2.0 * ramp,
                ramp,
                acceleration,
            };
        }
        let ramp = speed / acceleration;
        Self {
            duration: 1.0 / speed + ramp,
            ramp,
            acceleration,
        }
    }

    /// All joints (radians) start and stop together; the slowest one sets the pace.
    pub fn joints(from: &JointPositions, to: &JointPositions, limits: &[JointLimit]) -> Self {
        let (mut speed, mut acceleration) = (f64::INFINITY, f64::INFINITY);
        for ((a, b), limit) in from.iter().zip(to.iter()).zip(limits) {
            let way = (b - a).abs();
            speed = speed.min(limit.max_speed / way);
            acceleration = acceleration.min(limit.max_acceleration / way);
        }
        if speed > 1e9 {
            return Self::STILL;
        }
        Self::new(speed, acceleration)
    }

    /// One way of `length`, m or rad, at a speed and an acceleration per second in the same unit.
    fn line(length: f64, speed: f64, acceleration: f64) -> Self {
        if length < 1e-9 {
            return Self::STILL;
        }
        Self::new(speed / length, acceleration / length)
    }

    /// Fraction of the way after `time` seconds.
    pub fn at(&self, time: f64) -> f64 {
        let half = |t: f64| {
            if t < self.ramp {
                0.5 * self.acceleration * t * t
            } else {
                self.acceleration * self.ramp * (t - 0.5 * self.ramp)
            }
        };
        if time <= self.duration * 0.5 {
            half(time.max(0.0))
        } else {
            1.0 - half((self.duration - time).max(0.0))
        }
    }
}

/// Seconds for a straight joint move from stand to stand at full joint speed and acceleration, all joints in step.
pub fn point_to_point_time(
    limits: &[JointLimit],
    from: &JointPositions,
    to: &JointPositions,
) -> f64 {
    Trapezoid::joints(from, to, limits).duration
}

/// Seconds that the slowest joint alone needs from stand to stand: no way between the two postures takes less.
pub fn slowest_joint_time(
    limits: &[JointLimit],
    from: &JointPositions,
    to: &JointPositions,
) -> f64 {
    from.iter()
        .zip(to.iter())
        .zip(limits)
        .map(|((a, b), limit)| {
            Trapezoid::line((b - a).abs(), limit.max_speed, limit.max_acceleration).duration
        })
        .fold(0.0, f64::max)
}
