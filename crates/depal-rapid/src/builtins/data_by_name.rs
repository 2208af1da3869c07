//! Module data that a program finds by their names while it runs.
//!
//! Data of routines are not found. Whether a value fits is told by its shape (numbers of the same width, components in
//! the same order); two record types of one shape are not told apart.

use depal_vm::system::System;
use depal_vm::{CallContext, NamedDatum, Outcome, RaisedError, Reference, Root, Value};

use super::records::{num, number};
use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 5] = [
    (
        "PROC GetDataVal(string Object \\VAR datapos Block | string TaskName, INOUT anytype Value)",
        get_data_val,
    ),
    (
        "PROC SetDataVal(string Object \\VAR datapos Block | string TaskName, anytype Value)",
        set_data_val,
    ),
    (
        "PROC SetAllDataVal(string Type \\string TypeMod \\string Object \\switch Hidden, anytype Value)",
        set_all_data_val,
    ),
    (
        "PROC SetDataSearch(string Type \\string TypeMod \\string Object \\switch PersSym \\switch VarSym \\switch ConstSym \\string InTask | string InMod \\string InRout \\switch GlobalSym | switch LocalSym)",
        set_data_search,
    ),
    (
        "FUNC bool GetNextSym(INOUT string Object, VAR datapos Block \\switch Recursive)",
        get_next_sym,
    ),
];

fn no_access(message: impl Into<String>) -> RaisedError {
    error("ERR_SYM_ACCESS", message)
}

fn own_task(context: &CallContext<'_>, index: usize) -> Result<(), RaisedError> {
    if !context.is_given(index) {
        return Ok(());
    }
    let task = context.string(index)?;
    if task.is_empty() || task.eq_ignore_ascii_case(&context.location.task) {
        return Ok(());
    }
    Err(no_access(format!(
        "data of the task {task} are not reached from {}; share a PERS of the same name",
        context.location.task
    )))
}

/// The global that arguments 0 (its name), 1 (where a search found it) and 2 (the task) mean.
fn slot(context: &CallContext<'_>) -> Result<usize, RaisedError> {
    own_task(context, 2)?;
    let name = context.string(0)?;
    if let Some(block) = context.value(1)? {
        let place = number(block, 0) as usize;
        let found = place.checked_sub(1).filter(|slot| {
            let datum = context.program.data.get(*slot);
            datum.is_some_and(|datum| datum.name.eq_ignore_ascii_case(&name))
        });
        return found.ok_or_else(|| {
            no_access(format!(
                "the datapos is not that of {name}; take both from the same GetNextSym"
            ))
        });
    }
    context
        .program
        .visible_datum(&name, &context.location.module)
        .ok_or_else(|| {
            no_access(format!(
                "module {} sees no module data named {name}",
                context.location.module
            ))
        })
}

/// Whether a value may take the place of another: the same kind in every part.
fn same_shape(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Record(a), Value::Record(b)) | (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_shape(a, b))
        }
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// The error of a value that cannot take the place of another.
fn check_shape(name: &str, kind: &str, datum: &Value, other: &Value) -> Result<(), RaisedError> {
    if same_shape(datum, other) {
        return Ok(());
    }
    if let (Value::Array(_), _) | (_, Value::Array(_)) = (datum, other) {
        return Err(error(
            "ERR_INVDIM",
            format!("{name} has other dimensions than the value"),
        ));
    }
    Err(error(
        "ERR_SYMBOL_TYPE",
        format!("{name} is of type {kind}, the value is not"),
    ))
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn get_data_val(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slot = slot(context)?;
    let NamedDatum { name, kind, .. } = &context.program.data[slot];
    let value = context.memory.globals[slot].clone();
    check_shape(name, kind, &value, context.required(3)?)?;
    context.assign(3, value)?;
    done()
}

/// Assigns to a global, unless it is a constant or of another kind.
fn write(context: &mut CallContext<'_>, slot: usize, value: Value) -> Result<(), RaisedError> {
    let datum = &context.program.data[slot];
    let NamedDatum { name, kind, .. } = datum;
    if datum.is_constant || datum.module.is_empty() {
        return Err(no_access(format!("{name} is a constant")));
    }
    check_shape(name, kind, &context.memory.globals[slot], &value)?;
    let reference = Reference {
        root: Root::Global(slot as u32),
        path: Vec::new(),
    };
    let written = context.memory.write(&reference, value);
    written.map_err(|fault| context.raise(&fault))
}

fn set_data_val(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slot = slot(context)?;
    // A number without a point is a num; a dnum takes it, too.
    let value = match (&context.memory.globals[slot], context.required(3)?) {
        (Value::Dnum(_), Value::Num(value)) => Value::Dnum(f64::from(*value)),
        (_, value) => value.clone(),
    };
    write(context, slot, value)?;
    done()
}

/// Slots of the module data of a type whose names fit a pattern.
fn matching(
    context: &CallContext<'_>,
    kind: usize,
    pattern: usize,
    fits: &dyn Fn(&NamedDatum) -> bool,
) -> Result<Vec<usize>, RaisedError> {
    let kind = context.string(kind)?;
    let pattern = if context.is_given(pattern) {
        Some(context.string(pattern)?.to_lowercase())
    } else {
        None
    };
    let data = context.program.data.iter().enumerate();
    let found = data.filter(|(_, datum)| {
        !datum.module.is_empty()
            && datum.kind.eq_ignore_ascii_case(&kind)
            && fits(datum)
            && pattern
                .as_ref()
                .is_none_or(|pattern| matches(pattern, &datum.name.to_lowercase()))
    });
    Ok(found.map(|(slot, _)| slot).collect())
}

fn set_all_data_val(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slots = matching(context, 0, 2, &|datum| !datum.is_constant)?;
    let value = context.required(4)?.clone();
    for slot in slots {
        // Arrays of the type are passed over.
        if same_shape(&context.memory.globals[slot], &value) {
            write(context, slot, value.clone())?;
        }
    }
    done()
}

/// Sets what [`get_next_sym`] finds, in the order of the modules and their data.
fn set_data_search(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    own_task(context, 6)?;
    if context.is_given(8) {
        return Err(
            context.argument_error("SetDataSearch \\InRout: data of routines are not found")
        );
    }
    let (persistent, variable, constant) = (
        context.is_given(3),
        context.is_given(4),
        context.is_given(5),
    );
    let any = !(persistent || variable || constant);
    let module = if context.is_given(7) {
        Some(context.string(7)?)
    } else {
        None
    };
    let (global, local) = (context.is_given(9), context.is_given(10));
    let found = matching(context, 0, 2, &|datum| {
        let class = if datum.is_persistent {
            persistent
        } else if datum.is_constant {
            constant
        } else {
            variable
        };
        let home = module.as_ref();
        (any || class)
            && home.is_none_or(|home| home.eq_ignore_ascii_case(&datum.module))
            && !(global && datum.is_local)
            && (!local || datum.is_local)
    })?;
    context.memory.found = found.into_iter().map(|slot| slot as u32).collect();
    done()
}

fn get_next_sym(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let Some(slot) = context.memory.found.pop_front() else {
        return Ok(Outcome::Done(Value::Bool(false)));
    };
    let name = context.program.data[slot as usize].name.clone();
    context.assign(0, Value::Str(name))?;
    context.assign(1, Value::Record(vec![num(f64::from(slot) + 1.0)]))?;
    Ok(Outcome::Done(Value::Bool(true)))
}

/// Whether a pattern describes a whole name: `.` is any character, `[a-z]` one of a set (`[^..]` none of it), `*` and
/// `+` repeat what stands before, `?` makes it optional; `^` and `$` at the ends change nothing.
fn matches(pattern: &str, name: &str) -> bool {
    let pattern = pattern.strip_prefix('^').unwrap_or(pattern);
    let pattern = pattern.strip_suffix('$').unwrap_or(pattern);
    let pattern: Vec<char> = pattern.chars().collect();
    let name: Vec<char> = name.chars().collect();
    rest_matches(&pattern, &name)
}

/// Characters of the first item of a pattern.
fn item_length(pattern: &[char]) -> usize {
    match pattern.first() {
        Some('[') => {
            let end = pattern.iter().skip(2).position(|c| *c == ']');
            end.map_or(1, |end| end + 3)
        }
        Some('\\') if pattern.len() > 1 => 2,
        _ => 1,
    }
}

fn item_takes(item: &[char], c: char) -> bool {
    match item {
        ['.'] => true,
        ['\\', escaped] => *escaped == c,
        ['[', '^', set @ .., ']'] => !set_has(set, c),
        ['[', set @ .., ']'] => set_has(set, c),
        [literal] => *literal == c,
        _ => false,
    }
}

fn set_has(set: &[char], c: char) -> bool {
    match set {
        [low, '-', high, rest @ ..] => (*low..=*high).contains(&c) || set_has(rest, c),
        [one, rest @ ..] => *one == c || set_has(rest, c),
        [] => false,
    }
}

fn rest_matches(pattern: &[char], name: &[char]) -> bool {
    if pattern.is_empty() {
        return name.is_empty();
    }
    let (item, rest) = pattern.split_at(item_length(pattern));
    let (least, most, rest) = match rest.first() {
        Some('*') => (0, name.len(), &rest[1..]),
        Some('+') => (1, name.len(), &rest[1..]),
        Some('?') => (0, 1, &rest[1..]),
        _ => (1, 1, rest),
    };
    let fitting = name.iter().take_while(|c| item_takes(item, **c)).count();
    (least..=fitting.min(most)).any(|count| rest_matches(rest, &name[count..]))
}
