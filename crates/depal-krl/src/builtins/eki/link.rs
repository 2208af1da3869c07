//! One channel and its sockets.

use std::task::Poll;

use depal_eki::{Channel, EkiError};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, Received, SocketId, System};

/// Most bytes that are taken from a socket at once.
const PIECE: usize = 4096;
/// Most pieces that are taken from one socket before others have their turn.
const PIECES: usize = 64;

/// An initialised channel.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub(super) channel: Channel,
    pub(super) socket: Option<SocketId>,
    pub(super) listener: Option<SocketId>,
}

impl Link {
    pub(super) fn connect(
        &mut self,
        started: SimTime,
        system: &mut dyn System,
    ) -> Poll<Result<(), EkiError>> {
        let config = self.channel.config();
        let (address, port) = (config.external_ip.clone(), config.external_port);
        let limit_ms = config.connect_timeout_ms;
        let socket = *self.socket.get_or_insert_with(|| system.socket_create());
        let reason = match system.socket_connect(socket, &address, port) {
            Poll::Ready(Ok(())) => {
                self.channel.connect(system.now());
                return Poll::Ready(Ok(()));
            }
            Poll::Ready(Err(fault)) => words(&fault),
            Poll::Pending => {
                let limit = SimDuration::from_millis(u64::from(limit_ms));
                if limit_ms == 0 || system.now().saturating_since(started) < limit {
                    return Poll::Pending;
                }
                "nobody answers".to_owned()
            }
        };
        self.hang_up(system);
        Poll::Ready(Err(EkiError::NoContact {
            address,
            port,
            limit_ms,
            reason,
        }))
    }

    pub(super) fn listen(&mut self, system: &mut dyn System) -> Result<(), EkiError> {
        let config = self.channel.config();
        let (address, port) = (config.internal_ip.clone(), config.internal_port);
        let listener = system.socket_create();
        let bound = system
            .socket_bind(listener, &address, port)
            .and_then(|()| system.socket_listen(listener));
        if let Err(fault) = bound {
            system.socket_close(listener);
            return Err(EkiError::NoContact {
                address,
                port,
                limit_ms: config.connect_timeout_ms,
                reason: words(&fault),
            });
        }
        self.listener = Some(listener);
        Ok(())
    }

    pub(super) fn hang_up(&mut self, system: &mut dyn System) {
        let sockets = [self.socket.take(), self.listener.take()];
        for socket in sockets.into_iter().flatten() {
            system.socket_close(socket);
        }
    }

    pub(super) fn pump(&mut self, system: &mut dyn System) -> Result<(), EkiError> {
        if let (Some(listener), None) = (self.listener, self.socket) {
            match system.socket_accept(listener) {
                Poll::Ready(Ok((socket, _))) => {
                    self.socket = Some(socket);
                    self.channel.connect(system.now());
                }
                Poll::Ready(Err(_)) | Poll::Pending => {}
            }
        }
        if !self.channel.is_connected() {
            return Ok(());
        }
        let Some(socket) = self.socket else {
            return Ok(());
        };
        let mut end = Ok(());
        for _ in 0..PIECES {
            match system.socket_receive(socket, PIECE) {
                Poll::Pending => break,
                Poll::Ready(Ok(Received::Data(bytes))) => {
                    end = self.channel.receive(&bytes, system.now());
                }
                Poll::Ready(Ok(Received::Closed) | Err(_)) => self.channel.lose_connection(),
            }
            if !self.channel.is_connected() {
                break;
            }
        }
        if end.is_ok() {
            end = self.channel.poll(system.now());
        }
        if !self.channel.is_connected() {
            self.hang_up(system);
        }
        end
    }

    pub(super) fn flush(&mut self, system: &mut dyn System) -> Result<(), EkiError> {
        let bytes = self.channel.take_outgoing();
        if bytes.is_empty() {
            return Ok(());
        }
        let sent = match self.socket {
            Some(socket) => system.socket_send(socket, &bytes).is_ok(),
            None => false,
        };
        if sent {
            return Ok(());
        }
        self.channel.close();
        self.hang_up(system);
        Err(EkiError::ConnectionLost)
    }
}

/// What a fault of the cabinet means to who wants a connection.
fn words(fault: &Fault) -> String {
    match fault {
        Fault::SocketClosed => "refused".to_owned(),
        Fault::AddressInUse { address } => format!("{address} is in use"),
        Fault::SocketState { message }
        | Fault::NotThere { message }
        | Fault::File { message }
        | Fault::OutOfReach { message }
        | Fault::MotionSupervision { message } => message.clone(),
        Fault::UnknownSignal(name) => name.clone(),
        _ => "refused by the cabinet".to_owned(),
    }
}
