//! What a program may call, and what the lowering calls for it.

mod bas;
mod bytes;
mod eki;
mod frames;
mod geometry;
mod inline;
mod internal;
mod interrupts;
mod io;
mod maths;
mod messages;
mod motion;
mod move_form;
mod path;
mod state;
mod strings;
mod swrite;
mod table;
mod timing;

pub(crate) use eki::{Links, channels};
pub(crate) use move_form::{MoveForm, PathShape};
pub(crate) use state::{CHANNELS, hidden_globals, make_submit};
pub(crate) use table::{Table, predefined_data};

pub use state::OWN_GLOBALS;
pub use table::built_in_names;
