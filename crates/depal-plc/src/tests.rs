//! The program against a real vision session, through real telegrams, in simulated time.

mod cell;
mod runs;
