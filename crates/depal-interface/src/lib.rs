//! The vision server's brain: sessions, jobs, order rules and status codes.
