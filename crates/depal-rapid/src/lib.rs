//! ABB RAPID: lexer, parser, checks, lowering and built-ins.
//!
//! [`load`] turns the modules of one task into a [`Program`](depal_vm::Program) for the
//! [`Machine`](depal_vm::Machine); [`check`] does the same without knowing the signals of a cabinet.
//! All errors of all files come at once, as [`Diagnostic`](depal_syntax::Diagnostic)s with their places.
//!
//! It must never know: the arm, the world, the vision server, files, sockets of the operating system.
//! Programs reach the cabinet through [`System`](depal_vm::system::System) only.
//!
//! ```
//! use depal_syntax::SourceFile;
//!
//! let source = SourceFile::new("demo.mod", r#"
//! MODULE demo
//!   PROC main()
//!     TPWrite "hello";
//!   ENDPROC
//! ENDMODULE
//! "#);
//! let loaded = depal_rapid::load(&[source], &[], "main");
//! assert!(loaded.diagnostics.is_empty());
//! assert!(loaded.program.is_some());
//! ```
//!
//! Units: RAPID data hold millimetres, degrees and seconds; the built-ins convert to metres, radians and
//! simulated time where they call the cabinet. Quaternions are `q1` (the scalar) to `q4`.
//! num is a 32-bit float, dnum a 64-bit float; geometry is computed in f64 and stored as num.
//!
//! Every message has a page ([`explain`], `docs/diagnostics.md`), every instruction a row in
//! `docs/instructions.md`, and what the manuals leave open is in `docs/open-rules.md`; all three are made from
//! the code.
//!
//! Several tasks are several programs; [`Program::shared`](depal_vm::Program::shared) lists the persistents that they
//! have in common: global ones, neither LOCAL nor TASK.
//!
//! Limitations: a call by name takes no optional arguments; BACKWARD is read and never run; the
//! configuration data of a target must be reached unless ConfJ and ConfL are off, as on the controller, where a line
//! cannot choose and the quarter turns of joints 1, 4 and 6 count; external axes, stationary
//! tools and coordinated work objects are refused.
//! SyncMoveOn and SyncMoveOff let tasks meet with the arm at rest; a cabinet has one arm, so in between one task moves
//! it and the moves of another are refused, \ID is read and orders nothing. IError is ordered by the messages of its
//! own task (ErrWrite, ErrLog, ErrRaise), not by those of the controller or of other tasks; an error that a handler
//! takes is no message. Event routines of RESTART are checked, and run when the cabinet is told to go on behind a Stop;
//! `depal exec` ends at a Stop and never tells it. Data found by name are module data of the own task. `built_in_names` lists what is there.
//!
//! Not affiliated with any vendor; RAPID is a language of ABB.

mod builtins;
mod catalogue;
mod compile;
mod errors;
mod loading;
mod rules;
mod syntax;

pub use builtins::built_in_names;
pub use catalogue::{Page, explain, pages};
pub use compile::types::SignalKind;
pub use depal_syntax::decode;
pub use depal_vm::Loaded;
pub use loading::{
    SignalDefinition, TaskEntry, TaskEvent, check, check_syntax, check_with_signals, load,
    load_task, load_with_auto_signals, normal_form, program_list,
};
pub use rules::{OPEN_RULES, OpenRule};
