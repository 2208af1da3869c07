//! Simulated time in integer nanoseconds, the tick, and named seeded random streams.
//!
//! Time never comes from a wall clock: the cell owns it and advances it by [`TICK`].
//! Randomness never comes from the system: a stream is asked for by name, so that adding a
//! consumer does not change the numbers that another one gets.
//!
//! ```
//! use depal_time::{RandomStreams, SimDuration, SimTime, TICK};
//! let now = SimTime::ZERO + TICK + SimDuration::from_millis(250);
//! assert_eq!(now.to_string(), "0.254 s");
//! let streams = RandomStreams::new(7);
//! assert_eq!(streams.stream("cartons").uniform(0.0, 1.0), streams.stream("cartons").uniform(0.0, 1.0));
//! ```

mod random;
mod sim_time;

pub use random::{RandomStream, RandomStreams};
pub use sim_time::{SimDuration, SimTime, TICK};
