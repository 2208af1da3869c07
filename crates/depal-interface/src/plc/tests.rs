//! A block in memory, a session, and time that passes in steps of a millisecond.

mod bench;
mod functions;
mod handshake;
mod reconnect;
