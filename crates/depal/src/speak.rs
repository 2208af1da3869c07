//! Lines for people and lines that are the result.
//!
//! Who closes the other end of a pipe (`depal run 2>&1 | head`) loses the lines, not the run's results.

/// A line on stderr, for people.
macro_rules! tell {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}

/// A line on stdout: a result.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($text)*);
    }};
}
