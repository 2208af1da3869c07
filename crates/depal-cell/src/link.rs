//! The in-process link between robot and vision server: the very bytes that TCP would carry, with a
//! latency in simulated time instead of a network.

use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_controller::Network;
use depal_interface::ConnectionId;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, Received, SocketId};

use crate::plc_link::{PLC, PlcLink};

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
    /// Present if the robot task is a controller: then vision calls, and polls its data block.
    plc: Option<PlcLink>,
    /// Where the task takes connections.
    listening: Option<(SocketId, u16)>,
    /// Vision's call that is not taken yet: from when on it rings, and what was sent already.
    call: Option<(SimTime, VecDeque<(SimTime, Vec<u8>)>)>,
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
            plc: None,
            listening: None,
            call: None,
        }
    }

    /// The same for a robot task that is a controller with a data block.
    pub(crate) fn with_plc(mut self, plc: PlcLink) -> Self {
        self.plc = Some(plc);
        self
    }

    /// What went wrong with the controller's data block, for the log.
    pub(crate) fn poll_notice(&mut self) -> Option<String> {
        self.plc.as_mut()?.notices.pop()
    }

    /// Takes the next message that has reached the server by `now`.
    pub(crate) fn next_for_server(&mut self, now: SimTime) -> Option<(ConnectionId, ToServer)> {
        if let Some(mut plc) = self.plc.take() {
            self.tend(now, &mut plc);
            let message = plc.poll_message();
            self.plc = Some(plc);
            return message.map(|message| (PLC, message));
        }
        self.next_message(now)
    }

    fn next_message(&mut self, now: SimTime) -> Option<(ConnectionId, ToServer)> {
        let (due, ..) = self.to_server.front()?;
        if *due > now {
            return None;
        }
        let (_, connection, message) = self.to_server.pop_front()?;
        Some((connection, message))
    }

    /// Sends a reply to the robot; it can be read one latency later. A reply to a closed socket is lost.
    pub(crate) fn send_to_robot(&mut self, now: SimTime, connection: ConnectionId, bytes: Vec<u8>) {
        if let Some(plc) = &mut self.plc {
            plc.handle_reply(now, &bytes);
            return;
        }
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

    /// Vision's dealings with the controller: its answers, a call, what is due, and what is to be sent.
    fn tend(&mut self, now: SimTime, plc: &mut PlcLink) {
        while let Some((connection, message)) = self.next_message(now) {
            let is_good = match message {
                ToServer::Bytes(bytes) if connection == PLC => plc.handle_input(now, &bytes),
                ToServer::Disconnect if connection == PLC => {
                    plc.handle_disconnect(now);
                    true
                }
                // The task calls vision as a robot would: nobody is there for it.
                _ => true,
            };
            if !is_good {
                self.ends.retain(|_, end| end.connection != PLC);
            }
        }
        let is_there = self.listening.is_some_and(|(_, port)| port == plc.port);
        if is_there && plc.wants_to_call(now) {
            self.ends.retain(|_, end| end.connection != PLC);
            self.call = Some((now + self.latency, VecDeque::new()));
            plc.handle_connect();
        }
        plc.handle_timeout(now);
        while let Some(bytes) = plc.poll_output() {
            let due = now + self.latency;
            if let Some((_, early)) = &mut self.call {
                early.push_back((due, bytes));
            } else if let Some(end) = self.end_of(PLC) {
                end.incoming.push_back((due, bytes));
            }
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

    fn listen(
        &mut self,
        _now: SimTime,
        _controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Result<(), Fault> {
        if self.listening.is_some() {
            let address = format!("{address}:{port}");
            return Err(Fault::AddressInUse { address });
        }
        self.listening = Some((socket, port));
        Ok(())
    }

    fn accept(
        &mut self,
        now: SimTime,
        _controller: &str,
        socket: SocketId,
        accepted: SocketId,
    ) -> Poll<Result<String, Fault>> {
        let is_listening = self
            .listening
            .is_some_and(|(listener, _)| listener == socket);
        match self.call.take() {
            Some((due, incoming)) if is_listening && due <= now => {
                let end = RobotEnd {
                    connection: PLC,
                    open_from: now,
                    incoming,
                    closed_from: None,
                };
                self.ends.insert(accepted, end);
                Poll::Ready(Ok("vision".to_owned()))
            }
            other => {
                self.call = other;
                Poll::Pending
            }
        }
    }

    fn close(&mut self, now: SimTime, _controller: &str, socket: SocketId) {
        if self
            .listening
            .is_some_and(|(listener, _)| listener == socket)
        {
            self.listening = None;
        }
        if let Some(end) = self.ends.remove(&socket) {
            self.to_server
                .push_back((now + self.latency, end.connection, ToServer::Disconnect));
        }
    }
}
