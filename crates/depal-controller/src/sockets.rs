use std::collections::BTreeMap;
use std::task::Poll;

use depal_time::SimTime;
use depal_vm::system::{Fault, Received, SocketId, SocketState};

use crate::Network;

/// The client sockets of a cabinet's programs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sockets {
    states: BTreeMap<SocketId, SocketState>,
    /// Number of the task that made each.
    owners: BTreeMap<SocketId, usize>,
    /// Where bound sockets are bound.
    bound: BTreeMap<SocketId, (String, u16)>,
    next: u32,
}

impl Sockets {
    /// A new socket of the task of this number.
    pub fn create(&mut self, owner: usize) -> SocketId {
        let id = SocketId(self.next);
        self.next += 1;
        self.owners.insert(id, owner);
        self.states.insert(id, SocketState::Created);
        id
    }

    pub fn state(&self, socket: SocketId) -> SocketState {
        self.states
            .get(&socket)
            .copied()
            .unwrap_or(SocketState::Closed)
    }

    pub fn connect(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        (address, port): (&str, u16),
    ) -> Poll<Result<(), Fault>> {
        match self.state(socket) {
            SocketState::Created => {
                let answer = network.connect(now, controller, socket, address, port);
                if answer == Poll::Ready(Ok(())) {
                    self.states.insert(socket, SocketState::Connected);
                }
                answer
            }
            SocketState::Connected | SocketState::Bound | SocketState::Listening => {
                Poll::Ready(Err(Fault::SocketState {
                    message: format!(
                        "connecting to {address}:{port}: expected a created socket, it is in use"
                    ),
                }))
            }
            SocketState::Closed => Poll::Ready(Err(Fault::SocketClosed)),
        }
    }

    /// Refuses what needs a connection; `doing` names it.
    fn expect_connected(&self, socket: SocketId, doing: &str) -> Result<(), Fault> {
        match self.state(socket) {
            SocketState::Connected => Ok(()),
            SocketState::Created => Err(Fault::SocketState {
                message: format!("{doing}: expected a connected socket, it is created only"),
            }),
            SocketState::Bound | SocketState::Listening => Err(Fault::SocketState {
                message: format!("{doing}: expected a connected socket, it is a server's"),
            }),
            SocketState::Closed => Err(Fault::SocketClosed),
        }
    }

    pub fn send(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        bytes: &[u8],
    ) -> Result<(), Fault> {
        self.expect_connected(socket, "sending")?;
        network.send(now, controller, socket, bytes)
    }

    pub fn receive(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        limit: usize,
    ) -> Poll<Result<Received, Fault>> {
        if let Err(fault) = self.expect_connected(socket, "receiving") {
            return Poll::Ready(Err(fault));
        }
        if limit == 0 {
            return Poll::Ready(Err(Fault::SocketState {
                message: "receiving: expected room for at least 1 byte, found 0".to_owned(),
            }));
        }
        network.receive(now, controller, socket, limit).map(Ok)
    }

    pub fn bind(&mut self, socket: SocketId, address: &str, port: u16) -> Result<(), Fault> {
        let state = self.state(socket);
        if state != SocketState::Created {
            return Err(Fault::SocketState {
                message: format!("binding: expected a created socket, it is {state:?}"),
            });
        }
        self.bound.insert(socket, (address.to_owned(), port));
        self.states.insert(socket, SocketState::Bound);
        Ok(())
    }

    pub fn listen(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        socket: SocketId,
    ) -> Result<(), Fault> {
        let (SocketState::Bound, Some((address, port))) =
            (self.state(socket), self.bound.get(&socket))
        else {
            return Err(Fault::SocketState {
                message: "listening: expected a bound socket; call SocketBind first".to_owned(),
            });
        };
        network.listen(now, controller, socket, address, *port)?;
        self.states.insert(socket, SocketState::Listening);
        Ok(())
    }

    pub fn accept(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        socket: SocketId,
    ) -> Poll<Result<(SocketId, String), Fault>> {
        if self.state(socket) != SocketState::Listening {
            return Poll::Ready(Err(Fault::SocketState {
                message: "accepting: expected a listening socket; call SocketListen first"
                    .to_owned(),
            }));
        }
        let accepted = SocketId(self.next);
        match network.accept(now, controller, socket, accepted) {
            Poll::Pending => Poll::Pending,
            Poll::Ready(Err(fault)) => Poll::Ready(Err(fault)),
            Poll::Ready(Ok(peer)) => {
                self.next += 1;
                self.states.insert(accepted, SocketState::Connected);
                if let Some(owner) = self.owners.get(&socket).copied() {
                    self.owners.insert(accepted, owner);
                }
                Poll::Ready(Ok((accepted, peer)))
            }
        }
    }

    pub fn close(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        socket: SocketId,
    ) {
        // Closing what is closed, or was never created, is no error.
        self.bound.remove(&socket);
        self.owners.remove(&socket);
        if self.states.remove(&socket).is_some() {
            network.close(now, controller, socket);
        }
    }

    /// Closes all of a task, as a cabinet does at its end.
    pub fn close_all(
        &mut self,
        network: &mut dyn Network,
        now: SimTime,
        controller: &str,
        owner: usize,
    ) {
        let owned = self.owners.iter().filter(|(_, of)| **of == owner);
        let sockets: Vec<_> = owned.map(|(socket, _)| *socket).collect();
        for socket in sockets {
            self.close(network, now, controller, socket);
        }
    }
}
