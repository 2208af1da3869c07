use depal_arm::JointLimit;
use depal_frames::JointPositions;

/// A rest-to-rest move of unit length with limits on speed and acceleration: ramp up, cruise, ramp down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trapezoid {
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

    /// `speed` and `acceleration` in units of the whole way.
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

    /// All joints start and stop together; the slowest one sets the pace.
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

    /// A straight line of `length` metres.
    pub fn line(length: f64, speed: f64, acceleration: f64) -> Self {
        if length < 1e-9 {
            return Self::STILL;
        }
        Self::new(speed / length, acceleration / length)
    }

    /// The same way at a share of the velocity, slowed in time as a whole.
    pub fn slowed(&self, percent: f64) -> Self {
        let stretch = 100.0 / percent;
        Self {
            duration: self.duration * stretch,
            ramp: self.ramp * stretch,
            acceleration: self.acceleration / (stretch * stretch),
        }
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

/// Time of a chain of moves, seconds. Where the controller flies past the point between two moves,
/// the ramp down and the next ramp up run at the same time.
pub(crate) fn chain_time(moves: &[(Trapezoid, bool)]) -> f64 {
    let mut time = 0.0;
    for (i, (profile, stops)) in moves.iter().enumerate() {
        time += profile.duration;
        if let Some((next, _)) = moves.get(i + 1)
            && !stops
        {
            time -= profile.ramp.min(next.ramp);
        }
    }
    time
}
