use std::task::Poll;

use depal_time::SimTime;
use depal_vm::system::{Fault, Received, SocketId};

/// What lies behind the sockets of the programs: other parts of the simulated cell, or real connections.
/// A socket is named by the controller and the id that the controller gave it.
///
/// Nothing blocks: `Pending` means "ask again in the next cycle". Time-outs are the program's own.
pub trait Network {
    /// Connects to an address as the program spells it. Asked again until ready.
    /// Nobody there, or a refusal: [`Fault::SocketClosed`].
    fn connect(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>>;

    /// Sends all bytes. The peer is gone: [`Fault::SocketClosed`].
    fn send(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        bytes: &[u8],
    ) -> Result<(), Fault>;

    /// Takes what has arrived by `now`, at most `limit` bytes (more than zero).
    fn receive(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        limit: usize,
    ) -> Poll<Received>;

    /// The program closes, connected or still connecting.
    fn close(&mut self, now: SimTime, controller: &str, socket: SocketId);

    /// The program takes connections at a port of its cabinet. A taken port: [`Fault::AddressInUse`].
    fn listen(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Result<(), Fault> {
        let _ = (now, controller, socket, address, port);
        Err(Fault::NotThere {
            message: "a network that takes connections".to_owned(),
        })
    }

    /// The next connection to a listening socket becomes the socket `accepted`; the peer's address.
    fn accept(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        accepted: SocketId,
    ) -> Poll<Result<String, Fault>> {
        let _ = (now, controller, socket, accepted);
        Poll::Pending
    }
}

/// A cabinet without a cable: every connection is refused.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoNetwork;

impl Network for NoNetwork {
    fn connect(
        &mut self,
        _: SimTime,
        _: &str,
        _: SocketId,
        _: &str,
        _: u16,
    ) -> Poll<Result<(), Fault>> {
        Poll::Ready(Err(Fault::SocketClosed))
    }

    fn send(&mut self, _: SimTime, _: &str, _: SocketId, _: &[u8]) -> Result<(), Fault> {
        Err(Fault::SocketClosed)
    }

    fn receive(&mut self, _: SimTime, _: &str, _: SocketId, _: usize) -> Poll<Received> {
        Poll::Ready(Received::Closed)
    }

    fn close(&mut self, _: SimTime, _: &str, _: SocketId) {}
}
