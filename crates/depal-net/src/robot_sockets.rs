//! Sockets of robot programs as real TCP sockets of this computer.

use std::collections::{BTreeMap, VecDeque};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::task::Poll;
use std::time::{Duration, Instant};

use depal_controller::Network;
use depal_time::SimTime;
use depal_vm::system::{Fault, Received, SocketId};

/// Longest wall-clock time that one attempt to connect may take.
const CONNECT_LIMIT: Duration = Duration::from_mins(1);
/// How often sockets are looked at while waiting.
const LOOK_EVERY: Duration = Duration::from_micros(100);

/// Host and port as a program spells them.
pub type HostPort = (String, u16);

/// A [`Network`] over the operating system's TCP. Nothing blocks but [`wait`](Self::wait).
///
/// The caller steps simulated time; after each step it asks [`is_waiting`](Self::is_waiting) and, if so, lets the wall
/// clock catch up with `wait`. Time-outs stay the program's own, in simulated time.
#[derive(Default)]
pub struct RobotSockets {
    routes: Vec<(HostPort, HostPort)>,
    sockets: BTreeMap<SocketId, State>,
    waiting: bool,
}

enum State {
    Connecting(Receiver<std::io::Result<TcpStream>>),
    Connected(Connection),
    Listening {
        listener: TcpListener,
        arrived: VecDeque<(TcpStream, String)>,
    },
}

struct Connection {
    stream: TcpStream,
    /// Taken from the program, not yet by the operating system.
    outgoing: Vec<u8>,
    broken: bool,
}

impl Connection {
    fn new(stream: TcpStream) -> std::io::Result<Self> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        Ok(Self {
            stream,
            outgoing: Vec::new(),
            broken: false,
        })
    }

    fn flush(&mut self) {
        while !self.outgoing.is_empty() && !self.broken {
            match self.stream.write(&self.outgoing) {
                Ok(0) => self.broken = true,
                Ok(count) => {
                    self.outgoing.drain(..count);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => self.broken = true,
            }
        }
    }

    /// Whether a read would give bytes or the end.
    fn is_ready(&self) -> bool {
        let peeked = self.stream.peek(&mut [0]);
        !matches!(peeked, Err(error) if error.kind() == ErrorKind::WouldBlock)
    }
}

impl RobotSockets {
    /// Connections to the first address of a route go to the second.
    pub fn new(routes: Vec<(HostPort, HostPort)>) -> Self {
        Self {
            routes,
            ..Self::default()
        }
    }

    /// Whether the program asked a socket that had nothing to give, since the last call.
    pub fn is_waiting(&mut self) -> bool {
        std::mem::take(&mut self.waiting)
    }

    /// Blocks until a socket has something, at most `limit` of wall-clock time.
    #[allow(clippy::disallowed_methods)] // The edge: real sockets live in wall-clock time.
    pub fn wait(&mut self, limit: Duration) {
        let begin = Instant::now();
        loop {
            if self.sockets.values_mut().any(State::is_ready) {
                return;
            }
            let left = limit.saturating_sub(begin.elapsed());
            if left.is_zero() {
                return;
            }
            std::thread::sleep(left.min(LOOK_EVERY));
        }
    }

    fn route(&self, address: &str, port: u16) -> HostPort {
        self.routes
            .iter()
            .find(|((host, from), _)| *from == port && host.eq_ignore_ascii_case(address))
            .map_or_else(|| (address.to_owned(), port), |(_, to)| to.clone())
    }
}

impl State {
    fn is_ready(&mut self) -> bool {
        match self {
            Self::Connecting(answer) => match answer.try_recv() {
                Err(TryRecvError::Empty) => false,
                Err(TryRecvError::Disconnected) => true,
                Ok(Ok(stream)) => {
                    if let Ok(connection) = Connection::new(stream) {
                        *self = Self::Connected(connection);
                    }
                    true
                }
                Ok(Err(_)) => true,
            },
            Self::Connected(connection) => {
                connection.flush();
                connection.is_ready()
            }
            Self::Listening { listener, arrived } => {
                if let Ok((stream, peer)) = listener.accept() {
                    arrived.push_back((stream, peer.ip().to_string()));
                }
                !arrived.is_empty()
            }
        }
    }
}

fn connect((host, port): HostPort) -> std::io::Result<TcpStream> {
    let mut failure = std::io::Error::from(ErrorKind::AddrNotAvailable);
    for address in (host.as_str(), port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_LIMIT) {
            Ok(stream) => return Ok(stream),
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

impl Network for RobotSockets {
    fn connect(
        &mut self,
        _: SimTime,
        _: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        if !self.sockets.contains_key(&socket) {
            let target = self.route(address, port);
            let (sender, answer) = channel();
            // Opening a connection blocks in the standard library, so it has a thread of its own; the thread ends
            // with the attempt, and a program that has given up does not listen any more.
            std::thread::spawn(move || {
                let _ = sender.send(connect(target));
            });
            self.sockets.insert(socket, State::Connecting(answer));
        }
        match self.sockets.get_mut(&socket) {
            Some(State::Connecting(answer)) => match answer.try_recv() {
                Err(TryRecvError::Empty) => {
                    self.waiting = true;
                    Poll::Pending
                }
                Ok(Ok(stream)) => {
                    if let Ok(connection) = Connection::new(stream) {
                        self.sockets.insert(socket, State::Connected(connection));
                        Poll::Ready(Ok(()))
                    } else {
                        self.sockets.remove(&socket);
                        Poll::Ready(Err(Fault::SocketClosed))
                    }
                }
                Ok(Err(_)) | Err(TryRecvError::Disconnected) => {
                    self.sockets.remove(&socket);
                    Poll::Ready(Err(Fault::SocketClosed))
                }
            },
            // `wait` saw the connection first.
            Some(State::Connected(_)) => Poll::Ready(Ok(())),
            _ => Poll::Ready(Err(Fault::SocketClosed)),
        }
    }

    fn send(&mut self, _: SimTime, _: &str, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        let Some(State::Connected(connection)) = self.sockets.get_mut(&socket) else {
            return Err(Fault::SocketClosed);
        };
        connection.outgoing.extend_from_slice(bytes);
        connection.flush();
        if connection.broken {
            Err(Fault::SocketClosed)
        } else {
            Ok(())
        }
    }

    fn receive(&mut self, _: SimTime, _: &str, socket: SocketId, limit: usize) -> Poll<Received> {
        let Some(State::Connected(connection)) = self.sockets.get_mut(&socket) else {
            return Poll::Ready(Received::Closed);
        };
        connection.flush();
        let mut buffer = vec![0; limit];
        loop {
            return match connection.stream.read(&mut buffer) {
                Ok(0) => Poll::Ready(Received::Closed),
                Ok(count) => {
                    buffer.truncate(count);
                    Poll::Ready(Received::Data(buffer))
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    self.waiting = true;
                    Poll::Pending
                }
                Err(_) => Poll::Ready(Received::Closed),
            };
        }
    }

    fn close(&mut self, _: SimTime, _: &str, socket: SocketId) {
        if let Some(State::Connected(mut connection)) = self.sockets.remove(&socket) {
            connection.flush();
        }
    }

    fn listen(
        &mut self,
        _: SimTime,
        _: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Result<(), Fault> {
        let (host, to) = self.route(address, port);
        let taken = || Fault::AddressInUse {
            address: format!("{host}:{to}"),
        };
        let listener = TcpListener::bind((host.as_str(), to)).map_err(|_| taken())?;
        listener.set_nonblocking(true).map_err(|_| taken())?;
        let arrived = VecDeque::new();
        self.sockets
            .insert(socket, State::Listening { listener, arrived });
        Ok(())
    }

    fn accept(
        &mut self,
        _: SimTime,
        _: &str,
        socket: SocketId,
        accepted: SocketId,
    ) -> Poll<Result<String, Fault>> {
        let Some(State::Listening { listener, arrived }) = self.sockets.get_mut(&socket) else {
            return Poll::Ready(Err(Fault::SocketClosed));
        };
        if let Ok((stream, peer)) = listener.accept() {
            arrived.push_back((stream, peer.ip().to_string()));
        }
        let Some((stream, peer)) = arrived.pop_front() else {
            self.waiting = true;
            return Poll::Pending;
        };
        match Connection::new(stream) {
            Ok(connection) => {
                self.sockets.insert(accepted, State::Connected(connection));
                Poll::Ready(Ok(peer))
            }
            Err(_) => Poll::Ready(Err(Fault::SocketClosed)),
        }
    }
}
