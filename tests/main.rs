//! One test binary: what only the whole house can show.

mod tidy;
