//! One deterministic step loop that owns the clock, the events, the score and the truth.

pub mod event;
pub mod observer;
pub mod score;
pub mod truth;
