//! Positions as registers and taught points hold them.

use depal_frames::{EulerConvention, JointPositions, Pose};
use depal_vm::Value;

/// A position: millimetres and degrees, or degrees of the axes as the controller shows them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Position {
    pub is_joint: bool,
    /// Number of the user frame it was taught in; `None` for a register, which takes the frame in use.
    pub frame: Option<u32>,
    pub tool: Option<u32>,
    /// As in `N U T, 0, 0, 0`. Kept and given back; of several joint solutions the nearest is taken.
    pub config: String,
    /// x, y, z, W, P, R or J1 to J6. NaN was never taught.
    pub values: [f64; 6],
}

impl Position {
    pub(crate) fn cartesian(values: [f64; 6]) -> Self {
        Self {
            is_joint: false,
            frame: None,
            tool: None,
            config: "N U T, 0, 0, 0".into(),
            values,
        }
    }

    pub(crate) fn joint(values: [f64; 6]) -> Self {
        Self {
            is_joint: true,
            config: String::new(),
            ..Self::cartesian(values)
        }
    }

    pub(crate) fn from_pose(pose: &Pose) -> Self {
        Self::cartesian(shown_pose(pose))
    }

    pub(crate) fn pose(&self) -> Pose {
        EulerConvention::FanucWpr.pose_from_mm_deg(self.values)
    }

    /// Whether every value is there.
    pub(crate) fn is_complete(&self) -> bool {
        self.values.iter().all(|v| v.is_finite())
    }

    pub(crate) fn to_value(&self) -> Value {
        let number = |n: Option<u32>| Value::Int(n.map_or(-1, i64::from));
        Value::Record(vec![
            Value::Bool(self.is_joint),
            number(self.frame),
            number(self.tool),
            Value::Str(self.config.clone()),
            Value::Array(self.values.iter().map(|v| Value::Dnum(*v)).collect()),
        ])
    }

    pub(crate) fn from_value(value: &Value) -> Option<Self> {
        let Value::Record(fields) = value else {
            return None;
        };
        let [
            Value::Bool(is_joint),
            Value::Int(frame),
            Value::Int(tool),
            Value::Str(config),
            Value::Array(items),
        ] = fields.as_slice()
        else {
            return None;
        };
        let mut values = [f64::NAN; 6];
        for (value, item) in values.iter_mut().zip(items) {
            *value = item.as_number().unwrap_or(f64::NAN);
        }
        Some(Self {
            is_joint: *is_joint,
            frame: u32::try_from(*frame).ok(),
            tool: u32::try_from(*tool).ok(),
            config: config.clone(),
            values,
        })
    }
}

/// Whole numbers without the noise of the last digits, and no zero with a sign.
fn without_noise(value: f64) -> f64 {
    let whole = value.round();
    if (value - whole).abs() < 1e-9 {
        whole + 0.0
    } else {
        value
    }
}

/// x, y, z in mm and W, P, R in degrees; half a turn is 180, not -180.
pub(crate) fn shown_pose(pose: &Pose) -> [f64; 6] {
    let mut values = EulerConvention::FanucWpr
        .mm_deg_from_pose(pose)
        .map(without_noise);
    for angle in &mut values[3..] {
        if *angle == -180.0 {
            *angle = 180.0;
        }
    }
    values
}

/// Axes of the arm (radians, each against the link before) from those the controller shows (degrees).
///
/// The controller shows axis 3 against the horizontal: with J2 alone moving, the forearm keeps its direction.
/// Axis 2 leans forward for positive angles, axis 3 of the arm's description lifts the forearm for positive ones,
/// so the forearm's direction is `q3 - q2`, and `q3 = J3 + J2`.
pub(crate) fn arm_from_shown(shown: &[f64], count: usize, is_coupled: bool) -> JointPositions {
    let mut degrees = [0.0; 6];
    for (to, from) in degrees.iter_mut().zip(shown) {
        *to = *from;
    }
    if is_coupled && count >= 6 {
        degrees[2] += degrees[1];
    }
    JointPositions::from_degrees(&degrees[..count.min(6)])
}

/// The reverse of [`arm_from_shown`].
pub(crate) fn shown_from_arm(joints: &JointPositions, is_coupled: bool) -> [f64; 6] {
    let mut shown = [0.0; 6];
    for (to, from) in shown.iter_mut().zip(joints.to_degrees()) {
        *to = from;
    }
    if is_coupled && joints.len() >= 6 {
        shown[2] -= shown[1];
    }
    shown.map(without_noise)
}
