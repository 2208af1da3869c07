//! Instructions and functions of the controller, by theme. Each is a heading in RAPID and its code.

mod analog;
mod data_by_name;
mod dialogs;
mod event_log;
mod files;
mod geometry;
mod information;
mod interrupts;
mod io;
mod maths;
mod messages;
mod motion;
mod operator;
mod path;
mod positions;
mod rawbytes;
mod records;
pub(crate) mod refused;
mod search;
mod settings;
mod socket;
mod strings;
mod table;
mod tasks;
mod timing;
mod triggers;

pub(crate) use refused::refused;
pub(crate) use table::Table;
pub use table::built_in_names;

#[cfg(test)]
mod tests;
