//! Whole-cell tests live in `main.rs`, the one test binary.
