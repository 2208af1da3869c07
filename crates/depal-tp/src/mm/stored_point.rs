//! A point of the list received last.

use depal_vm::{Memory, Value};

use crate::state;

/// What is kept of a vision point or waypoint.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct StoredPoint {
    /// Whether the values are joint angles (of the arm's description, degrees).
    pub is_joint: bool,
    pub values: [f64; 6],
    pub label: f64,
    /// Speed, percent.
    pub speed: f64,
    pub move_type: f64,
    pub tool: f64,
    /// The 21 plan values of a Vision Move, if they came.
    pub plan: Vec<f64>,
    pub custom: Vec<f64>,
}

fn array(values: &[f64]) -> Value {
    Value::Array(values.iter().map(|v| Value::Dnum(*v)).collect())
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().filter_map(Value::as_number).collect(),
        _ => Vec::new(),
    }
}

impl StoredPoint {
    fn to_value(&self) -> Value {
        Value::Record(vec![
            Value::Bool(self.is_joint),
            array(&self.values),
            array(&[self.label, self.speed, self.move_type, self.tool]),
            array(&self.plan),
            array(&self.custom),
        ])
    }

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Record(fields) = value else {
            return None;
        };
        let [is_joint, values, numbers_of, plan, custom] = fields.as_slice() else {
            return None;
        };
        let values: [f64; 6] = numbers(values).try_into().ok()?;
        let [label, speed, move_type, tool]: [f64; 4] = numbers(numbers_of).try_into().ok()?;
        Some(Self {
            is_joint: *is_joint == Value::Bool(true),
            values,
            label,
            speed,
            move_type,
            tool,
            plan: numbers(plan),
            custom: numbers(custom),
        })
    }
}

pub(super) fn clear(memory: &mut Memory) {
    if let Some(items) = state::items_mut(memory, state::LIST) {
        items.clear();
    }
}

pub(super) fn count(memory: &Memory) -> usize {
    state::items(memory, state::LIST).len()
}

pub(super) fn push(memory: &mut Memory, point: &StoredPoint) {
    if let Some(items) = state::items_mut(memory, state::LIST) {
        items.push(point.to_value());
    }
}

/// The point of an index from 1.
pub(super) fn point(memory: &Memory, serial: f64) -> Option<StoredPoint> {
    if serial.fract() != 0.0 || serial < 1.0 {
        return None;
    }
    let items = state::items(memory, state::LIST);
    items
        .get(serial as usize - 1)
        .and_then(StoredPoint::from_value)
}
