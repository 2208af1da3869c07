//! KUKA KRL: lexer, parser, checks, lowering and built-ins.
//!
//! [`load`] turns the files of one task into a [`Program`](depal_vm::Program) for the
//! [`Machine`](depal_vm::Machine); [`check`] does the same without knowing the signals of a cabinet.
//! The `.src` and the `.dat` of one name are one module. All errors of all files come at once, as
//! [`Diagnostic`](depal_syntax::Diagnostic)s with their places.
//!
//! It must never know: the arm, the world, the vision server, files, sockets of the operating system.
//! Programs reach the cabinet through [`System`](depal_vm::system::System) only.
//!
//! ```
//! use depal_syntax::SourceFile;
//!
//! let source = SourceFile::new("demo.src", "
//! DEF demo( )
//!   DECL INT i
//!   FOR i = 1 TO 3
//!     MsgNotify(\"again\")
//!   ENDFOR
//! END
//! ");
//! let loaded = depal_krl::load(&[source], &[], "demo");
//! assert!(loaded.diagnostics.is_empty());
//! assert!(loaded.program.is_some());
//! ```
//!
//! Units: KRL data hold millimetres, degrees and seconds; the built-ins convert to metres, radians and
//! simulated time where they call the cabinet. A, B, C turn about Z, Y', X''. An axis angle is the joint angle
//! of the arm's URDF in degrees. REAL is a 32-bit float, INT a 32-bit integer.
//!
//! Signals of the cabinet are named as programs write them: `$IN[5]`, `$OUT[5]`, `$ANIN[1]`, `$ANOUT[1]`.
//!
//! Ethernet KRL: [`with_channels`] gives a program its channels. What arrives is taken in whenever a flag is
//! read or a channel is called, so that waits and interrupts on `$FLAG` see it; an output of `Set_Out` follows then.
//! The flag of `Set_Flag` rises for each record: one that came while the flag was on, and is still unread 12 ms after
//! the program has reset the flag, raises it again.
//! A channel lasts as long as its task, whatever ENVIRONMENT says. A call that fails tells it in `MSG_NO` and in the
//! event log, and the program goes on; `EKI_CHECK(ret, #QUIT)` stops it.
//!
//! The program runs up to `$ADVANCE` moves ahead of the arm. Inputs and outputs, waits, HALT, the actual position
//! and messages wait for the arm first, unless CONTINUE stands before the statement. Timers and flags do not wait:
//! write WAIT SEC 0 before them. Errors stop the program.
//!
//! A `.sub` file is loaded like the others; its first routine is an entry of its own, which never waits for the
//! arm. A program made from the same files has the same slots for global data; the first [`OWN_GLOBALS`] of them
//! belong to each task alone, all others (data lists, system variables, `$FLAG`, `$TIMER`) are
//! [`shared`](depal_vm::Program::shared) as soon as there is a `.sub` file.
//!
//! Limitations: AND and OR compute both sides; C_PTP takes its share of half the way as a distance; of status and
//! turn only the sign of A5 and the turns of A4 to A6 choose a solution; external axes, spline blocks, cyclic
//! flags and analogue loops are refused or told as warnings; `$APO` begins with values of our own.
//!
//! Not affiliated with any vendor; KRL is a language of KUKA.

mod builtins;
mod channels;
mod compile;
mod errors;
mod loading;
mod syntax;

pub use builtins::{OWN_GLOBALS, built_in_names};
pub use channels::with_channels;
pub use depal_syntax::decode;
pub use depal_vm::Loaded;
pub use loading::{
    check, check_syntax, check_with_signals, load, load_with_any_signals, normal_form,
};
