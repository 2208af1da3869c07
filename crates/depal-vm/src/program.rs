use crate::operators::{BinaryOp, UnaryOp};
use crate::{Builtin, MachineFault, RaisedError, SharedDatum, Value};

/// One operation of the machine. Operands are taken from and put on the operand stack of the frame.
/// Jump targets are indexes into the code of the routine.
#[derive(Debug, Clone, PartialEq)]
pub enum Op {
    /// A statement begins. The operand stack is empty here.
    Statement {
        /// Source line, from 1.
        line: u32,
        /// Where the statement after this one begins (where an error handler goes on with "next").
        next: u32,
    },
    /// Puts a constant.
    Push(Value),
    /// Drops the top.
    Pop,
    /// Puts a copy of a local, through a reference if it holds one. An absent one is an error.
    LoadLocal(u32),
    /// Puts a copy of a global.
    LoadGlobal(u32),
    /// Takes a value into a local, through a reference if it holds one.
    StoreLocal(u32),
    /// Takes a value into a global.
    StoreGlobal(u32),
    /// Sets a local slot itself (initial values at the start of a scope).
    SetLocal(u32),
    /// Puts a reference to a local, or the reference that it holds.
    PlaceLocal(u32),
    /// Puts a reference to a global.
    PlaceGlobal(u32),
    /// Extends the reference on top by a field.
    PlaceField(u32),
    /// Takes this many indexes (from 1) and extends the reference below them.
    PlaceIndex(u32),
    /// Replaces the reference on top by a copy of what it refers to.
    LoadPlace,
    /// Takes a value, then a reference, and assigns.
    StorePlace,
    /// Replaces the record on top by one of its fields.
    Field(u32),
    /// Takes this many indexes and replaces the array below them by an element.
    Index(u32),
    /// Makes a record of this many values.
    MakeRecord(u32),
    /// Makes an array of this many values.
    MakeArray(u32),
    /// Looks at the top: a value that is [unset](Value::is_unset) is a fault that names this variable.
    CheckSet(Box<str>),
    /// Leaves all routines above the one that declared the interrupt being served, and goes on there with the
    /// statement after the one under way. Without an interrupt it is a fault.
    Resume,
    /// Takes one, puts one.
    Unary(UnaryOp),
    /// Takes two, puts one.
    Binary(BinaryOp),
    /// Replaces a signal by its value now, as a 32-bit number.
    ReadSignal,
    /// Goes on elsewhere.
    Jump(u32),
    /// Takes a truth value and goes elsewhere if it is false.
    JumpIfFalse(u32),
    /// Leaves the truth value and goes elsewhere if it is false (short cut of AND).
    JumpIfFalseKeep(u32),
    /// Leaves the truth value and goes elsewhere if it is true (short cut of OR).
    JumpIfTrueKeep(u32),
    /// Puts a local slot as it is: absent, a value, or the reference it holds.
    PassLocal(u32),
    /// Puts whether an optional parameter was given.
    IsPresent(u32),
    /// Begins a counting loop: takes the step (if `stepped`), the end and the start.
    /// Without a step it is +1, or -1 if the start is above the end and the language's rules say so.
    ForBegin {
        /// Slot of the loop variable; the next two slots hold end and step.
        slot: u32,
        /// Whether a step is on the stack.
        stepped: bool,
    },
    /// Leaves the loop if the variable has passed the end.
    ForTest {
        /// As in `ForBegin`.
        slot: u32,
        /// Behind the loop.
        exit: u32,
    },
    /// Adds the step.
    ForStep {
        /// As in `ForBegin`.
        slot: u32,
    },
    /// Calls a routine with the top `arguments` values as its first locals.
    Call {
        /// Index of the routine.
        routine: u32,
        /// Number of parameters.
        arguments: u32,
    },
    /// Takes this many arguments (references or values), then a string, and calls the procedure of that name.
    CallByName {
        /// Number of arguments.
        arguments: u32,
    },
    /// Takes a reference and connects a new interrupt, whose number it assigns, with a routine.
    Connect(u32),
    /// Puts the number of the interrupt being served (0 if none is).
    LoadInterruptNumber,
    /// The end of an UNDO clause.
    EndUndo,
    /// Calls a built-in with the top `arguments` values. It may block; it is asked again with the same arguments.
    CallBuiltin {
        /// Index in the program's table.
        builtin: u32,
        /// Number of parameters.
        arguments: u32,
        /// Whether its result is wanted.
        result: bool,
    },
    /// Returns to the caller, with the top value if `value`.
    Return {
        /// A function's result is on the stack.
        value: bool,
    },
    /// A function ran into its end.
    MissingReturn,
    /// Puts the number of the error being handled (0 if none ever was).
    LoadErrorNumber,
    /// Takes a number and raises it in this routine, or to the caller when inside a handler.
    Raise,
    /// Hands the error being handled to the caller; also the end of a handler.
    Reraise,
    /// Runs the failed statement again.
    Retry,
    /// Goes on behind the failed statement.
    TryNext,
    /// Forgets how often statements were retried.
    ResetRetries,
    /// Notes the time at which a wait begins.
    WaitBegin,
    /// Puts the seconds since `WaitBegin` as a 64-bit number.
    WaitElapsed,
    /// Ends this step as blocked; goes on there in the next.
    Block(u32),
    /// Raises a fault.
    Fault(Box<MachineFault>),
    /// Raises an error of the language.
    RaiseError(Box<RaisedError>),
    /// Stops the program, with the reason.
    Stop(String),
}

impl Op {
    /// Gives a jump, a test of a loop or a statement its target.
    ///
    /// # Panics
    /// If the operation has none: a mistake of the lowering.
    pub fn set_target(&mut self, to: u32) {
        match self {
            Self::Jump(target)
            | Self::JumpIfFalse(target)
            | Self::JumpIfFalseKeep(target)
            | Self::JumpIfTrueKeep(target)
            | Self::Statement { next: target, .. }
            | Self::ForTest { exit: target, .. } => *target = to,
            other => unreachable!("{other:?} has no target"),
        }
    }
}

/// An error that an error clause takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorNumber {
    /// This one.
    Number(i64),
    /// The one whose number this global holds when the error comes.
    Global(u32),
    /// The one whose number this local of the routine holds when the error comes.
    Local(u32),
}

/// The error clause of a routine.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorHandler {
    /// Where its code begins.
    pub entry: u32,
    /// The errors it takes; `None` takes all.
    pub numbers: Option<Vec<ErrorNumber>>,
}

/// What a call by name must know of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CallParameter {
    /// Takes a variable.
    pub by_reference: bool,
    /// May be left out.
    pub optional: bool,
}

/// A routine, ready to run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Routine {
    /// As spelled in the source.
    pub name: String,
    /// Module name as spelled in the source.
    pub module: String,
    /// Line where it begins, from 1.
    pub line: u32,
    /// Initial values of the locals; the parameters come first.
    pub locals: Vec<Value>,
    /// The operations.
    pub code: Vec<Op>,
    /// The error clause.
    pub handler: Option<ErrorHandler>,
    /// Where the clause begins that runs when an error leaves the routine.
    pub undo: Option<u32>,
    /// Parameters, if it can be called by name.
    pub callable: Option<Vec<CallParameter>>,
}

/// What differs between languages.
#[derive(Debug, Clone)]
pub struct LanguageRules {
    /// Name and number of a fault.
    pub raise: fn(&MachineFault) -> RaisedError,
    /// Name of an error number of the language; `None` for the user's own.
    pub error_name: fn(i64) -> Option<&'static str>,
    /// Most characters in a string.
    pub string_limit: usize,
    /// How often one statement may be retried in a row.
    pub retry_limit: u32,
    /// Most routine calls inside each other.
    pub recursion_limit: usize,
    /// Whether a counting loop without a step counts down when its start is above its end.
    pub for_counts_down: bool,
    /// Least and greatest integer.
    pub integers: (i64, i64),
}

impl Default for LanguageRules {
    fn default() -> Self {
        Self {
            raise: |fault| RaisedError {
                number: 0,
                name: "ERROR".into(),
                message: fault.to_string(),
            },
            error_name: |_| None,
            string_limit: usize::MAX,
            retry_limit: 4,
            recursion_limit: 200,
            for_counts_down: true,
            integers: (i64::MIN, i64::MAX),
        }
    }
}

/// Routines that run when something happens to the program, each list in its order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EventRoutines {
    /// Before the entry, when the program starts from its beginning.
    pub before_start: Vec<u32>,
    /// When the program has stopped itself and could be restarted.
    pub on_stop: Vec<u32>,
    /// When it goes on after that.
    pub on_restart: Vec<u32>,
}

/// What a program that looks for a global by its name is told.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct NamedDatum {
    /// As spelled in the source.
    pub name: String,
    /// The module that declares it; empty for the language's own.
    pub module: String,
    /// Its type; that of its elements if it is an array.
    pub kind: String,
    /// Whether other modules do not see it.
    pub is_local: bool,
    /// Whether it keeps its value from run to run.
    pub is_persistent: bool,
    /// Whether it cannot be changed.
    pub is_constant: bool,
}

/// A whole program, checked and lowered. Shared by all machines that run it.
#[derive(Debug, Clone, Default)]
pub struct Program {
    /// All routines.
    pub routines: Vec<Routine>,
    /// The one that runs.
    pub entry: u32,
    /// Computes initial values of globals, before the entry.
    pub initializer: Option<u32>,
    /// Initial values of the globals.
    pub globals: Vec<Value>,
    /// Name of each global, for the debugger and tests.
    pub global_names: Vec<String>,
    /// What is known of each global, in languages that find data by their names; else empty.
    pub data: Vec<NamedDatum>,
    /// The built-ins that `CallBuiltin` means.
    pub builtins: Vec<Builtin>,
    /// Data that tasks of one cabinet share by name.
    pub shared: Vec<SharedDatum>,
    /// What runs when it starts, stops and goes on.
    pub events: EventRoutines,
    /// Rules of the language.
    pub rules: LanguageRules,
}

impl Program {
    /// Slot of the global that a module sees under a name, without regard to case: its own comes first.
    pub fn visible_datum(&self, name: &str, module: &str) -> Option<usize> {
        let named = |datum: &NamedDatum| datum.name.eq_ignore_ascii_case(name);
        let own = |d: &NamedDatum| named(d) && d.module.eq_ignore_ascii_case(module);
        let position = |wanted: &dyn Fn(&NamedDatum) -> bool| self.data.iter().position(wanted);
        position(&own)
            .or_else(|| position(&|d| named(d) && !d.is_local && !d.module.is_empty()))
            .or_else(|| position(&|d| named(d) && d.module.is_empty()))
    }

    /// Slot of a global by its name, without regard to case; the first of that name.
    pub fn global(&self, name: &str) -> Option<usize> {
        self.global_names
            .iter()
            .position(|n| n.eq_ignore_ascii_case(name))
    }
}
