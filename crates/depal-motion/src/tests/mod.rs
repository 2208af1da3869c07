use std::sync::Arc;

use depal_arm::Arm;
use depal_frames::{JointPositions, Pose};

use crate::{Interpolation, MotionError, Segment, SegmentTarget, Speed, Trajectory, Zone};

mod blended;
mod circles;
mod corners;
mod hold;
mod laws;
mod marks;
mod retiming;
mod torque;

pub const TICK: f64 = 0.004;
const IRB6700: &str = include_str!("../../../../urdf/abb_irb6700_150_320.urdf");

pub fn arm() -> Arc<Arm> {
    // 180, 180, 180, 400, 400, 500 deg/s2.
    let accelerations = [180.0, 180.0, 180.0, 400.0, 400.0, 500.0].map(f64::to_radians);
    Arc::new(Arm::from_urdf(IRB6700, "abb_irb6700_150_320.urdf", &accelerations).unwrap())
}

pub fn joints(degrees: [f64; 6]) -> JointPositions {
    JointPositions::from_degrees(&degrees)
}

/// The tool points down, well inside the reach.
pub fn home() -> JointPositions {
    joints([0.0, 10.0, 10.0, 0.0, 70.0, 0.0])
}

pub fn tool() -> Pose {
    Pose::translation(0.0, 0.0, 0.25)
}

pub fn speed(tcp: f64) -> Speed {
    Speed {
        tcp,
        orientation: 8.0,
        ..Speed::UNLIMITED
    }
}

pub fn fly(tcp: f64) -> Zone {
    Zone::Fly {
        tcp,
        orientation: 1.0,
    }
}

pub fn joint_move(target: [f64; 6], zone: Zone) -> Segment {
    Segment {
        interpolation: Interpolation::Joint,
        target: SegmentTarget::Joints(joints(target)),
        flange_from_tcp: tool(),
        speed: Speed::UNLIMITED,
        zone,
        quarters: None,
    }
}

pub fn linear_move(base_from_tcp: Pose, tcp: f64, zone: Zone) -> Segment {
    Segment {
        interpolation: Interpolation::Linear,
        target: SegmentTarget::Tcp(base_from_tcp),
        flange_from_tcp: tool(),
        speed: speed(tcp),
        zone,
        quarters: None,
    }
}

/// TCP at `home`, moved in the base frame.
pub fn home_tcp(arm: &Arm, dx: f64, dy: f64, dz: f64) -> Pose {
    Pose::translation(dx, dy, dz) * arm.base_from_flange(&home()) * tool()
}

/// Largest use of the joint speed and acceleration limits over ticks, as finite differences; 1 is the limit.
pub fn use_of_limits(arm: &Arm, samples: &[JointPositions], step: f64) -> (f64, f64) {
    let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
    for w in samples.windows(3) {
        for (j, limit) in arm.limits().iter().enumerate() {
            speed = speed.max((w[2][j] - w[1][j]).abs() / step / limit.max_speed);
            let bend = (w[2][j] - 2.0 * w[1][j] + w[0][j]).abs() / (step * step);
            acceleration = acceleration.max(bend / limit.max_acceleration);
        }
    }
    (speed, acceleration)
}

/// Samples from before the start to after the end.
pub fn samples(trajectory: &Trajectory, step: f64) -> Vec<JointPositions> {
    let count = (trajectory.duration() / step) as i32 + 3;
    (-3..=count)
        .map(|i| trajectory.sample(f64::from(i) * step))
        .collect()
}

#[test]
fn errors_name_the_place_and_leave_the_path_alone() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let far = linear_move(home_tcp(&arm, 3.0, 0.0, 0.0), 1.0, Zone::Fine);
    assert!(matches!(
        t.append(0.0, &far),
        Err(MotionError::TargetOutOfReach { .. })
    ));
    let beyond = joint_move([0.0, 120.0, 0.0, 0.0, 0.0, 0.0], Zone::Fine);
    let error = t.append(0.0, &beyond).unwrap_err();
    assert!(
        matches!(error, MotionError::JointLimit { joint: 2, .. }),
        "{error}"
    );
    let slow = Segment {
        speed: speed(0.0),
        ..joint_move([0.0; 6], Zone::Fine)
    };
    assert!(matches!(
        t.append(0.0, &slow),
        Err(MotionError::Speed { .. })
    ));
    assert_eq!(t.duration(), 0.0);
    assert_eq!(t.end_joints(), home());
    t.append(
        0.0,
        &joint_move([20.0, 0.0, 0.0, 0.0, 30.0, 0.0], Zone::Fine),
    )
    .unwrap();
    assert!(t.duration() > 0.1);
}

/// From one side of the base to the other the line passes through the column: the ends are reachable, the way is not.
#[test]
fn line_through_the_column_is_refused_on_its_way() {
    let arm = arm();
    let start = joints([80.0, 10.0, 10.0, 0.0, 70.0, 0.0]);
    let from = arm.base_from_flange(&start) * tool();
    let mut to = from;
    to.translation.vector.y = -from.translation.vector.y;
    to.rotation =
        depal_frames::Rotation::from_euler_angles(0.0, 0.0, -160f64.to_radians()) * from.rotation;
    let mut t = Trajectory::new(Arc::clone(&arm), start);
    let error = t
        .append(0.0, &linear_move(to, 1.0, Zone::Fine))
        .unwrap_err();
    assert!(
        matches!(
            error,
            MotionError::LineOutOfReach { travelled_mm, length_mm, .. }
            | MotionError::LineJumps { travelled_mm, length_mm, .. }
                if travelled_mm > 0.1 * length_mm && travelled_mm < 0.9 * length_mm
        ),
        "{error}"
    );
}
