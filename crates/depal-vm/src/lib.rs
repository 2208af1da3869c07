//! Values and one stackless virtual machine for robot languages, and what a program may ask of its cabinet.
//!
//! A language crate turns text into a [`Program`]: routines of flat [`Op`]s, initial values, a table of
//! [`Builtin`]s and [`LanguageRules`]. A [`Machine`] runs it one statement at a time against a
//! [`System`](system::System). Everything the machine knows is plain data in [`Memory`] and can be cloned
//! in the middle of any statement: there are no native stacks, futures or pointers in it.
//!
//! It must never know: a particular language, the arm, the world, sockets of the operating system, files,
//! the wall clock.
//!
//! ```
//! use std::sync::Arc;
//! use depal_vm::{BinaryOp, LanguageRules, Op, Program, Routine, Value};
//!
//! let main = Routine {
//!     name: "main".into(),
//!     module: "demo".into(),
//!     code: vec![
//!         Op::Push(Value::Num(1.0)),
//!         Op::Push(Value::Num(2.0)),
//!         Op::Binary(BinaryOp::Add),
//!         Op::StoreGlobal(0),
//!         Op::Return { value: false },
//!     ],
//!     ..Routine::default()
//! };
//! let program = Program { routines: vec![main], globals: vec![Value::Num(0.0)], ..Program::default() };
//! let machine = depal_vm::Machine::new(Arc::new(program), "T_ROB1");
//! assert_eq!(machine.memory().globals[0], Value::Num(0.0));
//! # let _ = LanguageRules::default();
//! ```
//!
//! Units: times are simulated times; numbers wear the units of their language (millimetres and degrees in
//! most), the built-ins of the language crate convert to SI at the [`System`](system::System) border.
//!
//! Statements of 32-bit numbers, truth values, jumps and counting loops have a second, faster form that the
//! machine makes for itself; a cabinet that grants [spare statements](system::System::spare_statements) gets them
//! in batches. What they do, and when, is the same.
//!
//! Several tasks are several machines. Data that they share by name are listed in [`Program::shared`]; the cabinet
//! carries changes from one to the other with [`RobotTask`](execution::RobotTask).
//!
//! [`Loaded`] is what a language makes of its texts: a program, and messages in the words of `depal-syntax`, which
//! have their names here as well for those who only load. Cabinets for tests are behind the feature `testing`.
//!
//! Limitations: a statement is the smallest step.

mod builtin;
mod error;
pub mod execution;
mod host_state;
mod loaded;
mod machine;
mod memory;
mod operators;
mod path_length;
mod plain;
mod program;
mod report;
mod shared;
mod signal_check;
pub mod system;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
mod value;

pub use builtin::{Builtin, BuiltinFn, CallContext, Outcome};
pub use depal_syntax::{Diagnostic, Severity, SourceFile, Span};
pub use error::{MachineFault, RaisedError};
pub use host_state::HostState;
pub use loaded::Loaded;
pub use machine::Machine;
pub use memory::{Frame, Interrupt, Interrupts, Level, Memory, Trigger};
pub use operators::{BinaryOp, UnaryOp};
pub use program::{
    CallParameter, ErrorHandler, ErrorNumber, EventRoutines, LanguageRules, NamedDatum, Op,
    Program, Routine,
};
pub use report::{Report, ReportFilter};
pub use shared::{SharedDatum, SharingConflict, sharing_conflicts};
pub use value::{ClockState, RAW_BYTES_LIMIT, RawBytes, Reference, Root, Value};

#[cfg(test)]
mod tests;
