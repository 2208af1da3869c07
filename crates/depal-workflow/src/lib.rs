//! The planning project: steps and branches as a small engine.
