//! Instructions and functions of the controller, by theme. Each is a heading in RAPID and its code.

mod geometry;
mod interrupts;
mod io;
mod maths;
mod messages;
mod motion;
mod operator;
mod rawbytes;
mod records;
pub(crate) mod refused;
mod socket;
mod strings;
mod table;
mod timing;

pub(crate) use refused::refused;
pub(crate) use table::Table;
pub use table::built_in_names;

#[cfg(test)]
mod tests;
