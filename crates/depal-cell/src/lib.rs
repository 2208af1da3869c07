//! One deterministic step loop that owns the clock, the events, the score and the truth.
