//! The cabinet's side: sockets, and one scan after another.

use std::task::Poll;

use depal_vm::execution::{RobotTask, Step};
use depal_vm::system::{LogKind, ProgramLocation, Received, SocketId, System};
use depal_wire::s7::{BlockServer, DataBlock};

use crate::PlcSettings;
use crate::sequence::{Sequence, words};

/// Bytes taken from a socket at a time.
const CHUNK: usize = 1024;

/// A controller's program with its data block, as a task of a cabinet.
#[derive(Debug, Clone)]
pub struct PlcTask {
    port: u16,
    block: DataBlock,
    sequence: Sequence,
    listener: Option<SocketId>,
    client: Option<Client>,
}

/// Vision's connection.
#[derive(Debug, Clone)]
struct Client {
    socket: SocketId,
    server: BlockServer,
}

impl PlcTask {
    /// With an empty block, before its first scan.
    pub fn new(settings: PlcSettings) -> Self {
        Self {
            port: settings.port,
            block: DataBlock::new(),
            sequence: Sequence::new(settings),
            listener: None,
            client: None,
        }
    }

    /// The block as it stands.
    pub fn block(&self) -> &DataBlock {
        &self.block
    }

    /// Takes connections and answers telegrams; whether there was anything to do.
    fn communicate(&mut self, system: &mut dyn System) -> Result<bool, String> {
        let Some(listener) = self.listener else {
            let listener = system.socket_create();
            system
                .socket_bind(listener, "0.0.0.0", self.port)
                .and_then(|()| system.socket_listen(listener))
                .map_err(|fault| format!("port {}: {}", self.port, words(&fault)))?;
            self.listener = Some(listener);
            return Ok(true);
        };
        if let Poll::Ready(accepted) = system.socket_accept(listener) {
            let (socket, _) = accepted.map_err(|fault| words(&fault))?;
            // Vision has one connection: a new one means that the old one is dead.
            self.hang_up(system);
            self.client = Some(Client {
                socket,
                server: BlockServer::new(),
            });
            return Ok(true);
        }
        let Some(client) = &mut self.client else {
            return Ok(false);
        };
        match system.socket_receive(client.socket, CHUNK) {
            Poll::Pending => return Ok(false),
            Poll::Ready(Ok(Received::Data(bytes))) => client.server.push(&bytes),
            Poll::Ready(Ok(Received::Closed) | Err(_)) => {
                self.hang_up(system);
                return Ok(true);
            }
        }
        loop {
            match client.server.poll(&mut self.block) {
                Ok(None) => return Ok(true),
                Ok(Some(served)) => {
                    if system.socket_send(client.socket, &served.frame).is_err() {
                        break;
                    }
                }
                Err(error) => {
                    let text = format!("vision's connection is closed: {error}");
                    system.log(LogKind::EventLog, &self.sequence.location(), &text);
                    break;
                }
            }
        }
        self.hang_up(system);
        Ok(true)
    }

    fn hang_up(&mut self, system: &mut dyn System) {
        if let Some(client) = self.client.take() {
            system.socket_close(client.socket);
        }
    }
}

impl RobotTask for PlcTask {
    fn step(&mut self, system: &mut dyn System) -> Step {
        let has_communicated = match self.communicate(system) {
            Ok(has_communicated) => has_communicated,
            Err(reason) => return Step::Stopped(reason),
        };
        match self.sequence.step(&mut self.block, system) {
            Step::Blocked if has_communicated => Step::Ran,
            step => step,
        }
    }

    fn location(&self) -> ProgramLocation {
        self.sequence.location()
    }
}
