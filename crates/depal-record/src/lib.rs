//! Cell events to a rerun recording and to JSON lines.
