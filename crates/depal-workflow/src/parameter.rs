//! Parameters of steps that the robot may read and change (commands 207 and 208).

use thiserror::Error;

use crate::project::{Project, StepKind};

/// Largest count of a grid in one direction.
const MOST_PLACES: f64 = 1000.0;
/// Farthest offset, mm.
const FARTHEST_MM: f64 = 100_000.0;

/// Why a parameter was not read or changed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ParameterError {
    /// No such step.
    #[error("step {step} does not exist")]
    UnknownStep {
        /// The step.
        step: i32,
    },
    /// The step has no such parameter.
    #[error("step {step} has no parameter {key:?}")]
    UnknownKey {
        /// The step.
        step: i32,
        /// The key.
        key: String,
    },
    /// The value makes no sense for the parameter.
    #[error("step {step}, {key}: expected {expected}, found {found}")]
    Value {
        /// The step.
        step: i32,
        /// The key.
        key: String,
        /// What it takes.
        expected: &'static str,
        /// What came.
        found: f64,
    },
}

impl ParameterError {
    /// The interface's status code for reading (207).
    pub fn read_status_code(&self) -> i32 {
        2041
    }

    /// The interface's status code for writing (208).
    pub fn write_status_code(&self) -> i32 {
        2016
    }
}

/// A parameter that a robot may read, with the values that it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The step.
    pub step: i32,
    /// Its key.
    pub key: &'static str,
    /// Its value now, in the units of the wire.
    pub value: f64,
    /// What may be written; absent: it can only be read.
    pub writable: Option<Writable>,
}

/// The values that a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Writable {
    /// Whole numbers of 1 to 1000.
    Count,
    /// Millimetres, at most 100 m either way.
    Offset,
    /// More than 0 and at most 100 percent.
    Velocity,
}

impl Writable {
    /// Smallest and largest value; the smallest velocity is above its own.
    pub fn bounds(self) -> (f64, f64) {
        match self {
            Self::Count => (1.0, MOST_PLACES),
            Self::Offset => (-FARTHEST_MM, FARTHEST_MM),
            Self::Velocity => (0.0, 100.0),
        }
    }
}

/// Every key that a step may have.
const KEYS: [&str; 9] = [
    "velocity", "xCount", "yCount", "zCount", "xOffset", "yOffset", "zOffset", "message", "project",
];

/// Every parameter of every step.
pub(crate) fn parameters(project: &Project) -> Vec<Parameter> {
    let mut found = Vec::new();
    for step in &project.steps {
        for key in KEYS {
            if let Ok(value) = read_parameter(project, step.id, key) {
                let writable = match key {
                    "velocity" => Some(Writable::Velocity),
                    "message" | "project" => None,
                    _ if key.ends_with("Count") => Some(Writable::Count),
                    _ => Some(Writable::Offset),
                };
                found.push(Parameter {
                    step: step.id,
                    key,
                    value,
                    writable,
                });
            }
        }
    }
    found
}

/// Where a key of a grid lies: which list and which axis.
fn grid_key(key: &str) -> Option<(bool, usize)> {
    match key {
        "xCount" => Some((true, 0)),
        "yCount" => Some((true, 1)),
        "zCount" => Some((true, 2)),
        "xOffset" => Some((false, 0)),
        "yOffset" => Some((false, 1)),
        "zOffset" => Some((false, 2)),
        _ => None,
    }
}

/// The axis of an offset's key.
fn offset_axis(key: &str) -> Option<usize> {
    ["xOffset", "yOffset", "zOffset"]
        .iter()
        .position(|name| *name == key)
}

/// Counts plain, lengths in mm, velocities in percent.
pub(crate) fn read_parameter(
    project: &Project,
    step: i32,
    key: &str,
) -> Result<f64, ParameterError> {
    let kind = &project
        .step(step)
        .ok_or(ParameterError::UnknownStep { step })?
        .kind;
    let found = match (kind, key) {
        (_, "velocity") => kind.velocity_percent(),
        (StepKind::MoveByGrid { grid, .. }, _) => grid_key(key).map(|(is_count, axis)| {
            if is_count {
                f64::from(grid.counts[axis])
            } else {
                grid.offsets[axis] * 1e3
            }
        }),
        (StepKind::RelativeMove { offset, .. }, _) => {
            offset_axis(key).map(|axis| offset.translation.vector[axis] * 1e3)
        }
        (StepKind::Notify { message }, "message") => Some(f64::from(*message)),
        (StepKind::VisualRecognition { project, .. }, "project") => Some(f64::from(*project)),
        _ => None,
    };
    found
        .map(|value| (value * 1e6).round() / 1e6)
        .ok_or_else(|| ParameterError::UnknownKey {
            step,
            key: key.to_owned(),
        })
}

pub(crate) fn write_parameter(
    project: &mut Project,
    step: i32,
    key: &str,
    value: f64,
) -> Result<(), ParameterError> {
    let refuse = |expected| ParameterError::Value {
        step,
        key: key.to_owned(),
        expected,
        found: value,
    };
    let unknown = || ParameterError::UnknownKey {
        step,
        key: key.to_owned(),
    };
    let place = project
        .place_of(step)
        .ok_or(ParameterError::UnknownStep { step })?;
    let kind = &mut project.steps[place].kind;
    if key == "velocity" {
        let velocity = kind.velocity_percent_mut().ok_or_else(unknown)?;
        if !(value > 0.0 && value <= 100.0) {
            return Err(refuse("more than 0 and at most 100 percent"));
        }
        *velocity = value;
        return Ok(());
    }
    // No range contains NaN.
    let offsets = -FARTHEST_MM..=FARTHEST_MM;
    match kind {
        StepKind::MoveByGrid { grid, .. } => match grid_key(key).ok_or_else(unknown)? {
            (true, axis) => {
                if value.fract() != 0.0 || !(1.0..=MOST_PLACES).contains(&value) {
                    return Err(refuse("a whole number of 1 to 1000"));
                }
                grid.counts[axis] = value as u32;
            }
            (false, axis) => {
                if !offsets.contains(&value) {
                    return Err(refuse("at most 100 m either way"));
                }
                grid.offsets[axis] = value * 1e-3;
            }
        },
        StepKind::RelativeMove { offset, .. } => {
            let axis = offset_axis(key).ok_or_else(unknown)?;
            if !offsets.contains(&value) {
                return Err(refuse("at most 100 m either way"));
            }
            offset.translation.vector[axis] = value * 1e-3;
        }
        _ => return Err(unknown()),
    }
    Ok(())
}
