//! What a controller keeps: registers, frames, settings. Each is a global of the program.

use depal_vm::{Memory, RaisedError, Value};
use depal_wire::Encoding;

use crate::errors::{interpreter, uninitialized};
use crate::position::Position;
use crate::{ByteOrder, Options};

pub(crate) const R: u32 = 0;
pub(crate) const R_WRITTEN: u32 = 1;
pub(crate) const PR: u32 = 2;
pub(crate) const SR: u32 = 3;
pub(crate) const FLAG: u32 = 4;
pub(crate) const MARKER: u32 = 5;
pub(crate) const TIMER: u32 = 6;
pub(crate) const FRAMES: u32 = 7;
pub(crate) const TOOLS: u32 = 8;
/// Numbers in use: see [`UFRAME_NUM`] and the following.
pub(crate) const NUMBERS: u32 = 9;
/// Pairs of name and value.
pub(crate) const SYSTEM: u32 = 10;
pub(crate) const CONDITIONS: u32 = 11;
pub(crate) const LINK: u32 = 12;
pub(crate) const LIST: u32 = 13;
pub(crate) const DO_LIST: u32 = 14;
pub(crate) const SETTINGS: u32 = 15;
/// Programs that RUN has asked for: index of the routine, then its arguments.
pub(crate) const STARTS: u32 = 16;
/// Positions of the programs come from here on.
pub(crate) const COUNT: u32 = 17;

const NAMES: [&str; COUNT as usize] = [
    "R",
    "R written",
    "PR",
    "SR",
    "F",
    "M",
    "TIMER",
    "UFRAME",
    "UTOOL",
    "numbers",
    "system variables",
    "conditions",
    "vision link",
    "vision points",
    "vision outputs",
    "settings",
    "starts",
];

/// In [`NUMBERS`].
pub(crate) const UFRAME_NUM: usize = 0;
pub(crate) const UTOOL_NUM: usize = 1;
pub(crate) const OVERRIDE: usize = 2;
pub(crate) const PAYLOAD: usize = 3;

/// In [`CONDITIONS`].
pub(crate) const OFFSET: usize = 0;
pub(crate) const OFFSET_FRAME: usize = 1;
pub(crate) const TOOL_OFFSET: usize = 2;
pub(crate) const SKIP: usize = 3;

pub(crate) const REGISTERS: u32 = 999;
pub(crate) const POSITION_REGISTERS: usize = 300;
const STRING_REGISTERS: usize = 100;
const FLAGS: usize = 4096;
const TIMERS: usize = 50;
pub(crate) const FRAME_COUNT: u32 = 9;
pub(crate) const TOOL_COUNT: u32 = 29;

/// The state before the first line, and its names.
pub(crate) fn initial(options: &Options) -> (Vec<Value>, Vec<String>) {
    let zero = || Position::cartesian([0.0; 6]).to_value();
    let mut registers = vec![Value::Absent; REGISTERS as usize];
    for (number, value) in &options.registers {
        if let Some(slot) = (*number as usize)
            .checked_sub(1)
            .and_then(|i| registers.get_mut(i))
        {
            *slot = Value::Dnum(stored(*value));
        }
    }
    let mut frames = vec![zero(); FRAME_COUNT as usize];
    let mut tools = vec![zero(); TOOL_COUNT as usize];
    for (to, from) in [(&mut frames, &options.frames), (&mut tools, &options.tools)] {
        for (number, values) in from {
            if let Some(slot) = (*number as usize)
                .checked_sub(1)
                .and_then(|i| to.get_mut(i))
            {
                *slot = Position::cartesian(*values).to_value();
            }
        }
    }
    let groups = options.groups.iter().map(|group| {
        Value::Record(vec![
            Value::Str(group.signal.clone()),
            Value::Int(i64::from(group.first)),
            Value::Int(i64::from(group.bits)),
        ])
    });
    let stopped = Value::Record(vec![Value::Bool(false), Value::Dnum(0.0), Value::Int(0)]);
    let system = Value::Array(vec![Value::Str("$WAITTMOUT".into()), Value::Dnum(3000.0)]);
    let values = vec![
        Value::Array(registers),
        Value::Array(vec![Value::Bool(false); REGISTERS as usize]),
        Value::Array(vec![Value::Absent; POSITION_REGISTERS]),
        Value::Array(vec![Value::Str(String::new()); STRING_REGISTERS]),
        Value::Array(vec![Value::Bool(false); FLAGS]),
        Value::Array(vec![Value::Bool(false); FLAGS]),
        Value::Array(vec![stopped; TIMERS]),
        Value::Array(frames),
        Value::Array(tools),
        Value::Array([0.0, 1.0, 100.0, 1.0].map(Value::Dnum).to_vec()),
        Value::Array(vec![system]),
        Value::Array(vec![Value::Absent; 4]),
        Value::Absent,
        Value::Array(Vec::new()),
        Value::Array(Vec::new()),
        Value::Array(vec![
            Value::Bool(options.is_axis_3_coupled),
            Value::Bool(options.byte_order == ByteOrder::BigEndian),
            Value::Array(groups.collect()),
        ]),
        Value::Array(Vec::new()),
    ];
    (values, NAMES.map(str::to_owned).to_vec())
}

/// A number as a register keeps it: whole numbers of 32 bits exactly, others as a 32-bit float.
pub(crate) fn stored(value: f64) -> f64 {
    if value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX) {
        value
    } else {
        f64::from(value as f32)
    }
}

/// The elements of one of the arrays.
pub(crate) fn items(memory: &Memory, slot: u32) -> &[Value] {
    match memory.globals.get(slot as usize) {
        Some(Value::Array(items)) => items,
        _ => &[],
    }
}

pub(crate) fn items_mut(memory: &mut Memory, slot: u32) -> Option<&mut Vec<Value>> {
    match memory.globals.get_mut(slot as usize) {
        Some(Value::Array(items)) => Some(items),
        _ => None,
    }
}

/// Place in an array of something numbered from 1.
pub(crate) fn place(
    memory: &Memory,
    slot: u32,
    name: &str,
    index: f64,
) -> Result<usize, RaisedError> {
    let count = items(memory, slot).len();
    if index.fract() == 0.0 && index >= 1.0 && index <= count as f64 {
        Ok(index as usize - 1)
    } else {
        Err(interpreter(format!(
            "Invalid index: there is no {name}[{index}]; {name}[1] to {name}[{count}] are there"
        )))
    }
}

/// A numeric register; one that nobody wrote is 0.
pub(crate) fn register(memory: &Memory, index: f64) -> Result<f64, RaisedError> {
    let place = place(memory, R, "R", index)?;
    Ok(items(memory, R)[place].as_number().unwrap_or(0.0))
}

pub(crate) fn set_register(memory: &mut Memory, index: f64, value: f64) -> Result<(), RaisedError> {
    let place = place(memory, R, "R", index)?;
    if let Some(items) = items_mut(memory, R) {
        items[place] = Value::Dnum(stored(value));
    }
    if let Some(items) = items_mut(memory, R_WRITTEN) {
        items[place] = Value::Bool(true);
    }
    Ok(())
}

/// A position register, if it has a value.
pub(crate) fn raw_position(memory: &Memory, index: f64) -> Result<Option<Position>, RaisedError> {
    let place = place(memory, PR, "PR", index)?;
    Ok(Position::from_value(&items(memory, PR)[place]))
}

/// A position register whose values are all there.
pub(crate) fn position(memory: &Memory, index: f64) -> Result<Position, RaisedError> {
    match raw_position(memory, index)? {
        Some(position) if position.is_complete() => Ok(position),
        _ => Err(uninitialized(&format!("PR[{index}]"))),
    }
}

pub(crate) fn set_position(
    memory: &mut Memory,
    index: f64,
    position: &Position,
) -> Result<(), RaisedError> {
    let place = place(memory, PR, "PR", index)?;
    if let Some(items) = items_mut(memory, PR) {
        items[place] = position.to_value();
    }
    Ok(())
}

/// One of the numbers in use.
pub(crate) fn number(memory: &Memory, which: usize) -> f64 {
    let found = items(memory, NUMBERS).get(which).and_then(Value::as_number);
    found.unwrap_or(0.0)
}

/// `base_from_frame` or `flange_from_tcp` of a number; 0 is the world or the flange.
pub(crate) fn frame(memory: &Memory, slot: u32, number: f64) -> depal_frames::Pose {
    let index = (number as usize).checked_sub(1);
    let value = index.and_then(|i| items(memory, slot).get(i));
    match value.and_then(Position::from_value) {
        Some(position) => position.pose(),
        None => depal_frames::Pose::identity(),
    }
}

pub(crate) fn is_coupled(memory: &Memory) -> bool {
    items(memory, SETTINGS).first() == Some(&Value::Bool(true))
}

pub(crate) fn encoding(memory: &Memory) -> Encoding {
    match items(memory, SETTINGS).get(1) {
        Some(Value::Bool(false)) => Encoding::HexLittleEndian,
        _ => Encoding::HexBigEndian,
    }
}

/// The signal and bit of a digital output that belongs to a group.
pub(crate) fn group_of(memory: &Memory, output: u32) -> Option<(String, u32)> {
    let Some(Value::Array(groups)) = items(memory, SETTINGS).get(2) else {
        return None;
    };
    groups.iter().find_map(|group| match group {
        Value::Record(fields) => match fields.as_slice() {
            [Value::Str(signal), Value::Int(first), Value::Int(bits)] => {
                let bit = i64::from(output) - first;
                (0..*bits)
                    .contains(&bit)
                    .then(|| (signal.clone(), bit as u32))
            }
            _ => None,
        },
        _ => None,
    })
}
