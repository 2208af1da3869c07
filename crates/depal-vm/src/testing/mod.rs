//! Cabinets for the tests and benches of languages; not in a product. Behind the feature `testing`.
//!
//! [`RecordingCabinet`] writes down what a program asks of it; what is on the other side of its signals and sockets
//! is each language's own [`Peer`]. [`EmptyCabinet`] has nothing and counts statements.
//! [`run`] gives a task its time, [`program`] is what loading gave, or its messages.

mod empty_cabinet;
mod recording_cabinet;
mod runs;

pub use empty_cabinet::EmptyCabinet;
pub use recording_cabinet::{Peer, RecordingCabinet};
pub use runs::{Timed, program, run};
