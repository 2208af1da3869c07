//! Whole-cell tests. The one test binary is `main.rs`.
