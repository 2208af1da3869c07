//! The server as clients meet it: real sockets on the loopback interface, a real cell behind them.
//! Each test has ports of its own; a port is a session, so that tests do not touch one another.
#![allow(missing_docs, clippy::disallowed_methods)]

mod faults_ascii;
mod faults_hex;
mod faults_transport;
mod inject;
mod served;
mod settled;
