//! Cell events to a rerun recording and to JSON lines.
//!
//! This is the only crate that names rerun. It observes a cell ([`depal_cell::observer::Observer`]) and
//! changes nothing in it.
//! Units in the recording are metres and seconds of simulated time; the timelines are `sim_time`
//! (default), `pick` and `frame`.
//!
//! [`JsonLines`] writes every event as one line; the bytes are the same for the same scene, seed and binary.
//! [`Recording`] writes `run.rrd`; its bytes are not (rerun gives every chunk a random id), its content is.
//! Both write to a temporary name and take the final name only when the run is over, so that a file that
//! bears the name is whole.
//!
//! Limitations: the depth image is stored at half resolution and the point cloud thinned, to keep the file small.

mod blueprint;
mod error;
mod json_lines;
mod picture;
mod recording;
mod scenery;
mod shapes;

pub use error::RecordError;
pub use json_lines::JsonLines;
pub use recording::Recording;
pub use scenery::RecordingSetup;

#[cfg(test)]
mod tests;
