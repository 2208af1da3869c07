use depal_vm::{Memory, Value};

use crate::state;

/// The numeric registers that the program wrote, with their values at the end, ascending.
pub fn written_registers(memory: &Memory) -> Vec<(u32, f64)> {
    let values = state::items(memory, state::R);
    let written = state::items(memory, state::R_WRITTEN);
    let both = values.iter().zip(written).zip(1..);
    both.filter(|((_, written), _)| **written == Value::Bool(true))
        .map(|((value, _), number)| (number, value.as_number().unwrap_or(0.0)))
        .collect()
}

/// A register's value as a plain decimal number: `5`, `2.5`, `-0.1`.
pub fn decimal(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX) {
        format!("{value}")
    } else {
        // The shortest decimal number that is this 32-bit float.
        format!("{}", value as f32)
    }
}
