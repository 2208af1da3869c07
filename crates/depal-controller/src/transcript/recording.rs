use std::collections::BTreeMap;
use std::task::Poll;

use depal_time::SimTime;
use depal_vm::system::{Fault, Received, SocketId};

use super::{Exchange, Transcript, TranscriptLine};
use crate::Network;

/// A network that writes down what goes over another one. Connections that the cabinet takes as a server are passed
/// on without being written down.
#[derive(Debug)]
pub struct RecordingNetwork<N> {
    inner: N,
    transcript: Transcript,
    connections: BTreeMap<SocketId, u32>,
    count: u32,
}

impl<N: Network> RecordingNetwork<N> {
    /// Around a network.
    pub fn new(inner: N) -> Self {
        Self {
            inner,
            transcript: Transcript::default(),
            connections: BTreeMap::new(),
            count: 0,
        }
    }

    /// What went over so far.
    pub fn transcript(&self) -> &Transcript {
        &self.transcript
    }

    /// The network inside.
    pub fn inner_mut(&mut self) -> &mut N {
        &mut self.inner
    }

    fn note(&mut self, at: SimTime, socket: SocketId, exchange: Exchange) {
        if let Some(connection) = self.connections.get(&socket) {
            self.transcript.lines.push(TranscriptLine {
                at,
                connection: *connection,
                exchange,
            });
        }
    }
}

impl<N: Network> Network for RecordingNetwork<N> {
    fn connect(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        let answer = self.inner.connect(now, controller, socket, address, port);
        let exchange = match &answer {
            Poll::Pending => return answer,
            Poll::Ready(Ok(())) => Exchange::Connected(address.to_owned(), port),
            Poll::Ready(Err(_)) => Exchange::Refused(address.to_owned(), port),
        };
        self.count += 1;
        self.connections.insert(socket, self.count);
        self.note(now, socket, exchange);
        answer
    }

    fn send(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        bytes: &[u8],
    ) -> Result<(), Fault> {
        let answer = self.inner.send(now, controller, socket, bytes);
        let exchange = match &answer {
            Ok(()) => Exchange::Sent(bytes.to_vec()),
            Err(_) => Exchange::PeerClosed,
        };
        self.note(now, socket, exchange);
        answer
    }

    fn receive(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        limit: usize,
    ) -> Poll<Received> {
        let answer = self.inner.receive(now, controller, socket, limit);
        match &answer {
            Poll::Pending => {}
            Poll::Ready(Received::Data(bytes)) => {
                self.note(now, socket, Exchange::Received(bytes.clone()));
            }
            Poll::Ready(Received::Closed) => self.note(now, socket, Exchange::PeerClosed),
        }
        answer
    }

    fn close(&mut self, now: SimTime, controller: &str, socket: SocketId) {
        self.note(now, socket, Exchange::Closed);
        self.connections.remove(&socket);
        self.inner.close(now, controller, socket);
    }

    fn listen(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Result<(), Fault> {
        self.inner.listen(now, controller, socket, address, port)
    }

    fn accept(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        accepted: SocketId,
    ) -> Poll<Result<String, Fault>> {
        self.inner.accept(now, controller, socket, accepted)
    }
}
