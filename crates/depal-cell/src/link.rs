//! The in-process link between robot and vision server: the very bytes that TCP would carry, with a
//! latency in simulated time instead of a network.

use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_controller::Network;
use depal_interface::ConnectionId;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, Received, SocketId};

/// What travels from the robot to the server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ToServer {
    /// A connection was opened.
    Connect,
    /// Bytes arrived.
    Bytes(Vec<u8>),
    /// The robot closed.
    Disconnect,
}

/// One end of a connection, at the robot.
#[derive(Debug, Clone)]
struct RobotEnd {
    connection: ConnectionId,
    open_from: SimTime,
    incoming: VecDeque<(SimTime, Vec<u8>)>,
    /// When the robot learns that the server has closed.
    closed_from: Option<SimTime>,
}

impl RobotEnd {
    fn is_closed(&self, now: SimTime) -> bool {
        self.closed_from.is_some_and(|from| from <= now)
    }
}

/// The link. In process there are no addresses: the port alone decides who answers.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    port: u16,
    latency: SimDuration,
    ends: BTreeMap<SocketId, RobotEnd>,
    to_server: VecDeque<(SimTime, ConnectionId, ToServer)>,
    next_connection: u64,
    /// Connection attempts to ports where nobody listens, for the log.
    pub(crate) refused: Vec<(String, u16)>,
}

impl Link {
    /// A link to a server that listens on `port`; each way takes `latency`.
    pub(crate) fn new(port: u16, latency: SimDuration) -> Self {
        Self {
            port,
            latency,
            ends: BTreeMap::new(),
            to_server: VecDeque::new(),
            next_connection: 1,
            refused: Vec::new(),
        }
    }

    /// Takes the next message that has reached the server by `now`.
    pub(crate) fn next_for_server(&mut self, now: SimTime) -> Option<(ConnectionId, ToServer)> {
        let (due, ..) = self.to_server.front()?;
        if *due > now {
            return None;
        }
        let (_, connection, message) = self.to_server.pop_front()?;
        Some((connection, message))
    }

    /// Sends a reply to the robot; it can be read one latency later. A reply to a closed socket is lost.
    pub(crate) fn send_to_robot(&mut self, now: SimTime, connection: ConnectionId, bytes: Vec<u8>) {
        let due = now + self.latency;
        if let Some(end) = self.end_of(connection) {
            end.incoming.push_back((due, bytes));
        }
    }

    /// The server closes; the robot learns it one latency later, after all that was sent before.
    pub(crate) fn close_from_server(&mut self, now: SimTime, connection: ConnectionId) {
        let due = now + self.latency;
        if let Some(end) = self.end_of(connection) {
            end.closed_from.get_or_insert(due);
        }
    }

    fn end_of(&mut self, connection: ConnectionId) -> Option<&mut RobotEnd> {
        self.ends
            .values_mut()
            .find(|end| end.connection == connection)
    }
}

impl Network for Link {
    fn connect(
        &mut self,
        now: SimTime,
        _controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        if let Some(end) = self.ends.get(&socket) {
            return if now >= end.open_from {
                Poll::Ready(Ok(()))
            } else {
                Poll::Pending
            };
        }
        if port != self.port {
            self.refused.push((address.to_owned(), port));
            return Poll::Ready(Err(Fault::SocketClosed));
        }
        let connection = ConnectionId(self.next_connection);
        self.next_connection += 1;
        self.to_server
            .push_back((now + self.latency, connection, ToServer::Connect));
        self.ends.insert(
            socket,
            RobotEnd {
                connection,
                open_from: now + self.latency + self.latency,
                incoming: VecDeque::new(),
                closed_from: None,
            },
        );
        Poll::Pending
    }

    fn send(
        &mut self,
        now: SimTime,
        _controller: &str,
        socket: SocketId,
        bytes: &[u8],
    ) -> Result<(), Fault> {
        let Some(end) = self.ends.get(&socket).filter(|end| !end.is_closed(now)) else {
            return Err(Fault::SocketClosed);
        };
        let message = ToServer::Bytes(bytes.to_vec());
        self.to_server
            .push_back((now + self.latency, end.connection, message));
        Ok(())
    }

    fn receive(
        &mut self,
        now: SimTime,
        _controller: &str,
        socket: SocketId,
        limit: usize,
    ) -> Poll<Received> {
        let Some(end) = self.ends.get_mut(&socket) else {
            return Poll::Ready(Received::Closed);
        };
        let mut bytes = Vec::new();
        while let Some((due, chunk)) = end.incoming.front_mut() {
            if *due > now || bytes.len() == limit {
                break;
            }
            let count = chunk.len().min(limit - bytes.len());
            bytes.extend(chunk.drain(..count));
            if chunk.is_empty() {
                end.incoming.pop_front();
            }
        }
        if bytes.is_empty() && end.is_closed(now) {
            Poll::Ready(Received::Closed)
        } else if bytes.is_empty() {
            Poll::Pending
        } else {
            Poll::Ready(Received::Data(bytes))
        }
    }

    fn close(&mut self, now: SimTime, _controller: &str, socket: SocketId) {
        if let Some(end) = self.ends.remove(&socket) {
            self.to_server
                .push_back((now + self.latency, end.connection, ToServer::Disconnect));
        }
    }
}
