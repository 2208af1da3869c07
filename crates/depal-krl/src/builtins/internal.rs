//! What the lowering needs beside the operations of the machine.

use depal_vm::system::System;
use depal_vm::{CallContext, MachineFault, Outcome, RaisedError, Reference, Value};

use super::table::{Operator, Ran};

pub(super) const OPERATORS: [Operator; 4] = [
    ("assign text", assign_text),
    ("assign partly", assign_partly),
    ("reshape", reshape),
    ("copy", copy),
];

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

/// The variable that argument `index` refers to.
fn target(context: &CallContext<'_>, index: usize) -> Result<Reference, RaisedError> {
    match context.arguments.get(index) {
        Some(Value::Reference(reference)) => Ok(reference.clone()),
        _ => Err(context.raise(&MachineFault::NotPresent)),
    }
}

/// A string variable takes characters; the rest of it has no value then.
fn assign_text(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let target = target(context, 0)?;
    let Value::Array(mut characters) = context.required(1)?.clone() else {
        return Err(context.argument_error("a string is needed"));
    };
    while characters.last().is_some_and(Value::is_unset) {
        characters.pop();
    }
    let size = match context.memory.read(&target) {
        Ok(Value::Array(items)) => items.len(),
        _ => 0,
    };
    if characters.len() > size {
        return Err(context.raise(&MachineFault::StringTooLong {
            length: characters.len(),
            limit: size,
        }));
    }
    characters.resize(size, Value::Unset);
    let written = context.memory.write(&target, Value::Array(characters));
    written.map_err(|fault| context.raise(&fault))?;
    done()
}

/// Components without a value in the new record stay as they are in the variable.
fn merge(old: &mut Value, new: Value) {
    match (old, new) {
        (_, Value::Unset) => {}
        (Value::Record(old), Value::Record(new)) if old.len() == new.len() => {
            for (old, new) in old.iter_mut().zip(new) {
                merge(old, new);
            }
        }
        (old, new) => {
            if !(matches!(new, Value::Array(_)) && new.is_unset()) {
                *old = new;
            }
        }
    }
}

fn assign_partly(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let target = target(context, 0)?;
    let new = context.required(1)?.clone();
    match context.memory.read_mut(&target) {
        Ok(old) => {
            merge(old, new);
            done()
        }
        Err(fault) => Err(context.raise(&fault)),
    }
}

/// The components of one structure in the places of another; -1 has no value.
fn reshape(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (Value::Record(parts), Value::Array(sources)) =
        (context.required(0)?, context.required(1)?)
    else {
        return Err(context.argument_error("a structure is needed"));
    };
    let made = sources.iter().map(|source| match source {
        Value::Int(index) if *index >= 0 => {
            parts.get(*index as usize).cloned().unwrap_or(Value::Unset)
        }
        _ => Value::Unset,
    });
    Ok(Outcome::Done(Value::Record(made.collect())))
}

/// The value of a variable, or that it has none.
fn copy(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(context.required(0)?.clone()))
}
