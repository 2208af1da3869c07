//! The client against controllers that misbehave, over loopback sockets.

mod fake_plc;
mod faults;
mod interop;
mod recovery;
mod vision;
