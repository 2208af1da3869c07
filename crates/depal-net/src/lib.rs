//! Real sockets: a vision server that robots reach over TCP, paced against the wall clock.
//!
//! [`bind`] opens ports, [`serve`] answers on them until it is told to stop, [`replay`] answers a
//! recorded [`journal`] again without sockets and finds the first difference.
//!
//! One thread owns the [`depal_cell::station::Station`] and its clock; pictures and plans are computed on
//! another; each client has a task of its own on a third. They talk through channels. A client hands over
//! a few commands at a time and reads on when they are answered, so that no client delays another and
//! memory does not grow with what a client sends.
//!
//! This crate must never know what a command means, nor touch files: the journal goes to a writer.
//!
//! ```no_run
//! # fn example(station: depal_cell::station::Station) -> Result<(), depal_net::NetError> {
//! use depal_net::{Limits, Stop, bind, serve};
//! let ports = bind(&["127.0.0.1:0".parse().unwrap()])?;
//! println!("listening on {}", ports.addresses()[0]);
//! serve(ports, station, Limits::default(), |notice| println!("{notice:?}"), None, Stop::on_signals())?;
//! # Ok(())
//! # }
//! ```
//!
//! Anything else that is a [`SessionHost`] can stand in for the station; `examples/load.rs` measures the
//! server so, beside a trivial one.
//!
//! Simulated time runs at the speed of the wall clock, in ticks of 4 ms, and waits where computing takes
//! longer than its latency; it never runs faster to catch up.
//!
//! Ports may also be data blocks of Siemens controllers, see [`s7`].
//!
//! Limitations: TCP only. A client that has closed its sending side and one that is
//! gone look alike: its waiting command gives way to the next client's, and what is answered before that
//! client asks is lost with it.

mod brain;
mod client;
mod clock;
mod compute;
mod error;
pub mod journal;
mod limits;
mod notice;
mod ports;
mod replay;
pub mod robot_sockets;
pub mod s7;
mod server;
mod session_host;

pub use compute::{compute_at_once, compute_on_thread};
pub use error::NetError;
pub use limits::Limits;
pub use notice::Notice;
pub use ports::{Listen, Ports, bind, open};
pub use replay::{Difference, Replayed, replay};
pub use server::{Stop, Stopper, serve};
pub use session_host::SessionHost;
