use depal_arm::JointLimit;
use depal_frames::JointPositions;

/// Seconds for a straight joint move from stand to stand at full joint speed and acceleration:
/// a trapezoid (or triangle) along the line, all joints in step.
/// What a [`Trajectory`](crate::Trajectory) takes for the same move when nothing but the joints limits it.
pub fn point_to_point_time(
    limits: &[JointLimit],
    from: &JointPositions,
    to: &JointPositions,
) -> f64 {
    let mut speed = f64::INFINITY;
    let mut acceleration = f64::INFINITY;
    for (limit, (a, b)) in limits.iter().zip(from.iter().zip(to.iter())) {
        let distance = (b - a).abs();
        if distance > 0.0 {
            speed = speed.min(limit.max_speed / distance);
            acceleration = acceleration.min(limit.max_acceleration / distance);
        }
    }
    if !speed.is_finite() {
        return 0.0;
    }
    // Along the normalised line of length 1.
    if speed * speed >= acceleration {
        2.0 / acceleration.sqrt()
    } else {
        1.0 / speed + speed / acceleration
    }
}
