//! FANUC TP listings (`.ls`): lexer, parser, checks, lowering, instructions and the vision calls.
//!
//! [`load`] turns the listings of a task into a [`Program`](depal_vm::Program) for the
//! [`Machine`](depal_vm::Machine), or for [`Tasks`], which run what RUN starts as well; [`check`] does the same without an entry.
//! All errors of all files come at once, as [`Diagnostic`](depal_syntax::Diagnostic)s with their places.
//! Every program of a listing is a routine of the same name; a line in a message is the number in the listing.
//! After a run, [`written_registers`] tells the numeric registers that the program wrote.
//!
//! It must never know: the arm, the world, the vision server, files, sockets of the operating system.
//! Programs reach the cabinet through [`System`](depal_vm::system::System) only.
//!
//! ```
//! use depal_syntax::SourceFile;
//!
//! let source = SourceFile::new("MAIN.LS", "/PROG  MAIN\n/MN\n   1:  R[1]=1+2 ;\n/POS\n/END\n");
//! let loaded = depal_tp::load(&[source], &depal_tp::Options::default(), "MAIN");
//! assert!(loaded.diagnostics.is_empty());
//! assert!(loaded.program.is_some());
//! ```
//!
//! Units: listings hold millimetres, degrees and seconds; they become metres, radians and simulated time where the
//! cabinet is called. W, P, R turn about the fixed axes X, Y, Z. Axis 3 is shown against the horizontal.
//! The world frame is the foot of the arm and the flange frame is `tool0` of its description: the frames of the
//! scene, not those of a particular arm's manual.
//!
//! Signals go by their names in the listing: `DO[1]`, `GI[2]`. Flags and markers are the program's own memory.
//! The vision calls `MM_...` are there unless a listing of the same name is loaded.
//!
//! Limitations: one motion group, no external axes; of several joint
//! solutions the nearest is taken whatever CONFIG says; CNT is a corner whose size grows with the speed;
//! behind a CNT move registers are worked out ahead of the arm, constant outputs are switched in the corner, and
//! everything else that touches the world (other outputs, inputs, waits, timers, vision calls) first lets the arm come
//! to the target; MONITOR, edges (ON+), circle arcs,
//! remote TCP and software options such as tracking are refused.
//!
//! Not affiliated with any vendor; TP is a language of FANUC.

mod builtins;
mod compile;
mod errors;
mod loading;
mod mm;
mod options;
mod position;
mod registers;
mod state;
mod syntax;
mod tasks;

pub use builtins::built_in_names;
pub use depal_syntax::decode;
pub use depal_vm::Loaded;
pub use loading::{check, check_syntax, load, normal_form};
pub use options::{ByteOrder, GroupOutput, Options, PresetError, parse_preset};
pub use registers::{decimal, written_registers};
pub use tasks::{RegisterView, Tasks};
