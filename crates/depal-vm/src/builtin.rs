use depal_time::{SimDuration, SimTime};

use crate::memory::Memory;
use crate::system::{Fault, ProgramLocation, System};
use crate::{LanguageRules, MachineFault, Program, RaisedError, Value};

/// What a built-in answered.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Over, with its result ([`Value::Absent`] for a procedure).
    Done(Value),
    /// Not yet: it is asked again in the next tick, with the same arguments, start time and notes.
    Blocked,
    /// The program itself raises an error: inside an error clause it goes to the caller.
    Raise(RaisedError),
    /// The program stops here, with the reason in words.
    Stop(String),
    /// The program begins anew at its entry; module data keep their values.
    Restart,
}

/// The code of a built-in.
pub type BuiltinFn = fn(&mut CallContext<'_>, &mut dyn System) -> Result<Outcome, RaisedError>;

/// An instruction or function that the language crate supplies.
#[derive(Clone, Copy)]
pub struct Builtin {
    /// Its name as the manual spells it.
    pub name: &'static str,
    /// Runs it, or asks it again.
    pub run: BuiltinFn,
}

impl std::fmt::Debug for Builtin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Builtin").field(&self.name).finish()
    }
}

/// What a built-in may see and change.
#[derive(Debug)]
pub struct CallContext<'a> {
    /// One value for each parameter of its signature, [`Value::Absent`] where none was given.
    pub arguments: &'a mut Vec<Value>,
    /// When it was called.
    pub started: SimTime,
    /// What it wrote down for the next time it is asked; empty at first.
    pub notes: &'a mut Vec<Value>,
    /// The program's data, for arguments given by reference.
    pub memory: &'a mut Memory,
    /// The statement it stands in.
    pub location: &'a ProgramLocation,
    /// Rules of the language.
    pub rules: &'a LanguageRules,
    /// The program, to find data by their names.
    pub program: &'a Program,
}

impl CallContext<'_> {
    /// Argument `index`, through a reference if it is one; `None` if it was not given.
    pub fn value(&self, index: usize) -> Result<Option<&Value>, RaisedError> {
        match self.arguments.get(index) {
            None | Some(Value::Absent) => Ok(None),
            Some(Value::Reference(reference)) => self
                .memory
                .read(reference)
                .map(Some)
                .map_err(|fault| self.raise(&fault)),
            Some(value) => Ok(Some(value)),
        }
    }

    /// Argument `index`, which must be there.
    pub fn required(&self, index: usize) -> Result<&Value, RaisedError> {
        self.value(index)?
            .ok_or_else(|| self.raise(&MachineFault::NotPresent))
    }

    /// Whether argument `index` was given.
    pub fn is_given(&self, index: usize) -> bool {
        self.arguments.get(index).is_some_and(Value::is_present)
    }

    /// A number, 0 if it was not given.
    pub fn number(&self, index: usize) -> Result<f64, RaisedError> {
        Ok(self.optional_number(index)?.unwrap_or(0.0))
    }

    /// A number, if it was given.
    pub fn optional_number(&self, index: usize) -> Result<Option<f64>, RaisedError> {
        match self.value(index)? {
            None => Ok(None),
            Some(value) => match value.as_number() {
                Some(number) => Ok(Some(number)),
                None => Err(self.mismatch("a number", value)),
            },
        }
    }

    /// A string.
    pub fn string(&self, index: usize) -> Result<String, RaisedError> {
        match self.required(index)? {
            Value::Str(text) => Ok(text.clone()),
            other => Err(self.mismatch("a string", other)),
        }
    }

    /// The name of a signal.
    pub fn signal(&self, index: usize) -> Result<String, RaisedError> {
        match self.required(index)? {
            Value::Signal(name) => Ok(name.to_string()),
            other => Err(self.mismatch("a signal", other)),
        }
    }

    /// Assigns to argument `index`, which was given by reference.
    pub fn assign(&mut self, index: usize, value: Value) -> Result<(), RaisedError> {
        match self.arguments.get(index) {
            Some(Value::Reference(reference)) => self
                .memory
                .write(reference, value)
                .map_err(|fault| (self.rules.raise)(&fault)),
            _ => Err(self.raise(&MachineFault::NotPresent)),
        }
    }

    /// Assigns a number of the kind that the variable has.
    pub fn assign_number(&mut self, index: usize, number: f64) -> Result<(), RaisedError> {
        let value = match self.required(index)? {
            Value::Dnum(_) => Value::Dnum(number),
            Value::Int(_) => Value::Int(number as i64),
            _ => Value::Num(number as f32),
        };
        self.assign(index, value)
    }

    /// Time since the call.
    pub fn elapsed(&self, now: SimTime) -> SimDuration {
        now.saturating_since(self.started)
    }

    /// The language's error for a fault of the cabinet.
    pub fn system_fault(&self, fault: Fault) -> RaisedError {
        self.raise(&MachineFault::System(fault))
    }

    /// The language's error for a wrong argument.
    pub fn argument_error(&self, message: impl Into<String>) -> RaisedError {
        self.raise(&MachineFault::Argument {
            message: message.into(),
        })
    }

    /// The language's error for a fault.
    pub fn raise(&self, fault: &MachineFault) -> RaisedError {
        (self.rules.raise)(fault)
    }

    fn mismatch(&self, expected: &str, found: &Value) -> RaisedError {
        self.argument_error(format!("expected {expected}, found {}", found.kind_name()))
    }
}
