//! What went over the sockets of a program, written down and played again.

use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;
use std::task::Poll;

use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, Received, SocketId};

use crate::Network;

/// One thing that happened on a connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Exchange {
    /// Connected to an address as the program spells it.
    Connected(String, u16),
    /// Nobody was there.
    Refused(String, u16),
    /// The program sent bytes.
    Sent(Vec<u8>),
    /// The program was given bytes.
    Received(Vec<u8>),
    /// The other side closed.
    PeerClosed,
    /// The program closed.
    Closed,
}

/// A line of a transcript.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TranscriptLine {
    /// Simulated time.
    pub at: SimTime,
    /// Which connection, from 1 in the order in which they were asked for.
    pub connection: u32,
    /// What happened.
    pub exchange: Exchange,
}

/// A line of a transcript that cannot be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct TranscriptError {
    /// From 1.
    pub line: usize,
    /// What was expected and found.
    pub message: String,
}

/// What went over the client sockets of a program, in order.
///
/// As text, one line each: simulated seconds, connection, word, then an address or bytes in hexadecimal.
/// `#` begins a comment.
///
/// ```text
/// 0.120000000 1 connected 192.168.1.5:50000
/// 0.124000000 1 sent 0a0b
/// 0.180000000 1 received 66
/// 0.200000000 1 closed
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Transcript {
    /// In the order of time.
    pub lines: Vec<TranscriptLine>,
}

impl Transcript {
    /// As text.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for line in &self.lines {
            let seconds = line.at.as_nanos() / 1_000_000_000;
            let nanos = line.at.as_nanos() % 1_000_000_000;
            let _ = write!(text, "{seconds}.{nanos:09} {} ", line.connection);
            let hex = |bytes: &[u8]| {
                bytes.iter().fold(String::new(), |mut hex, byte| {
                    let _ = write!(hex, "{byte:02x}");
                    hex
                })
            };
            let _ = match &line.exchange {
                Exchange::Connected(host, port) => writeln!(text, "connected {host}:{port}"),
                Exchange::Refused(host, port) => writeln!(text, "refused {host}:{port}"),
                Exchange::Sent(bytes) => writeln!(text, "sent {}", hex(bytes)),
                Exchange::Received(bytes) => writeln!(text, "received {}", hex(bytes)),
                Exchange::PeerClosed => writeln!(text, "peer-closed"),
                Exchange::Closed => writeln!(text, "closed"),
            };
        }
        text
    }

    /// From text.
    ///
    /// # Errors
    /// The first line that cannot be understood.
    pub fn parse(text: &str) -> Result<Self, TranscriptError> {
        let mut lines = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let parsed = parse_line(line).map_err(|message| TranscriptError {
                line: index + 1,
                message,
            })?;
            lines.push(parsed);
        }
        Ok(Self { lines })
    }
}

fn parse_line(line: &str) -> Result<TranscriptLine, String> {
    let mut words = line.split_whitespace();
    let mut next = |what: &str| words.next().ok_or_else(|| format!("the {what} is missing"));
    let time = next("time")?;
    let seconds: f64 = time
        .parse()
        .map_err(|_| format!("{time:?} is no time in seconds"))?;
    if !(0.0..=1e9).contains(&seconds) {
        return Err(format!("{time} s is no simulated time"));
    }
    let connection = next("connection")?;
    let connection = connection
        .parse()
        .map_err(|_| format!("{connection:?} is no number of a connection"))?;
    let word = next("word")?;
    let exchange = match word {
        "connected" | "refused" => {
            let address = next("address")?;
            let wrong = || format!("{address:?} is no HOST:PORT");
            let (host, port) = address.rsplit_once(':').ok_or_else(wrong)?;
            let port = port.parse().map_err(|_| wrong())?;
            if word == "connected" {
                Exchange::Connected(host.to_owned(), port)
            } else {
                Exchange::Refused(host.to_owned(), port)
            }
        }
        "sent" => Exchange::Sent(bytes(next("bytes")?)?),
        "received" => Exchange::Received(bytes(next("bytes")?)?),
        "peer-closed" => Exchange::PeerClosed,
        "closed" => Exchange::Closed,
        other => {
            return Err(format!(
                "{other:?}: expected connected, refused, sent, received, peer-closed or closed"
            ));
        }
    };
    Ok(TranscriptLine {
        at: SimTime::ZERO + SimDuration::from_secs_f64(seconds),
        connection,
        exchange,
    })
}

fn bytes(hex: &str) -> Result<Vec<u8>, String> {
    let digits = hex.as_bytes();
    if !digits.len().is_multiple_of(2) || !hex.is_ascii() {
        return Err(format!("{hex:?} are no bytes in hexadecimal"));
    }
    digits
        .chunks(2)
        .map(|pair| {
            let pair = std::str::from_utf8(pair).unwrap_or_default();
            u8::from_str_radix(pair, 16).map_err(|_| format!("{pair:?} is no byte in hexadecimal"))
        })
        .collect()
}

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

/// A network that plays the other side of a transcript. Connections are taken in their order; what the program
/// receives comes as long after its own last act (connecting or sending) as it did then.
///
/// A program that sends something else than it did then finds the connection closed, and
/// [`difference`](Self::difference) tells what.
#[derive(Debug, Clone)]
pub struct ReplayNetwork {
    script: BTreeMap<u32, VecDeque<(SimTime, Exchange)>>,
    sockets: BTreeMap<SocketId, Replayed>,
    count: u32,
    difference: Option<String>,
}

/// A connection being replayed.
#[derive(Debug, Clone)]
struct Replayed {
    rest: VecDeque<(SimTime, Exchange)>,
    connection: u32,
    /// Sent by the program and not yet found in the transcript, or the other way about.
    ahead: VecDeque<u8>,
    /// When the program last acted: then, and now.
    acted: (SimTime, SimTime),
}

impl ReplayNetwork {
    /// The other side of a transcript.
    pub fn new(transcript: &Transcript) -> Self {
        let mut script: BTreeMap<u32, VecDeque<(SimTime, Exchange)>> = BTreeMap::new();
        for line in &transcript.lines {
            let lines = script.entry(line.connection).or_default();
            lines.push_back((line.at, line.exchange.clone()));
        }
        Self {
            script,
            sockets: BTreeMap::new(),
            count: 0,
            difference: None,
        }
    }

    /// What the program did otherwise than then, if anything: the first difference.
    pub fn difference(&self) -> Option<&str> {
        self.difference.as_deref()
    }

    fn differ(&mut self, now: SimTime, connection: u32, what: &str) {
        self.difference.get_or_insert_with(|| {
            format!(
                "{:.3} s, connection {connection}: {what}",
                now.as_secs_f64()
            )
        });
    }
}

impl Network for ReplayNetwork {
    fn connect(
        &mut self,
        now: SimTime,
        _: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        self.count += 1;
        let connection = self.count;
        let refused = Poll::Ready(Err(Fault::SocketClosed));
        let Some(mut rest) = self.script.remove(&connection) else {
            self.differ(now, connection, "the transcript has no such connection");
            return refused;
        };
        let (at, known) = match rest.pop_front() {
            Some((at, Exchange::Connected(host, known))) => (at, (host, known)),
            Some((_, Exchange::Refused(..))) => return refused,
            _ => {
                self.differ(
                    now,
                    connection,
                    "the transcript does not begin with a connection",
                );
                return refused;
            }
        };
        if known != (address.to_owned(), port) {
            let (host, known) = known;
            self.differ(
                now,
                connection,
                &format!("connects to {address}:{port}, then to {host}:{known}"),
            );
        }
        let replayed = Replayed {
            rest,
            connection,
            ahead: VecDeque::new(),
            acted: (at, now),
        };
        self.sockets.insert(socket, replayed);
        Poll::Ready(Ok(()))
    }

    fn send(&mut self, now: SimTime, _: &str, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        let Some(replayed) = self.sockets.get_mut(&socket) else {
            return Err(Fault::SocketClosed);
        };
        // A message may be sent in other pieces than then.
        for byte in bytes {
            if replayed.ahead.is_empty()
                && let Some((at, Exchange::Sent(expected))) = replayed.rest.front()
            {
                replayed.acted = (*at, now);
                replayed.ahead.extend(expected);
                replayed.rest.pop_front();
            }
            let expected = replayed.ahead.pop_front();
            if expected != Some(*byte) {
                let connection = replayed.connection;
                let then = expected.map_or("nothing".to_owned(), |b| format!("{b:02x}"));
                self.sockets.remove(&socket);
                self.differ(now, connection, &format!("sends {byte:02x}, then {then}"));
                return Err(Fault::SocketClosed);
            }
        }
        Ok(())
    }

    fn receive(&mut self, now: SimTime, _: &str, socket: SocketId, limit: usize) -> Poll<Received> {
        let Some(replayed) = self.sockets.get_mut(&socket) else {
            return Poll::Ready(Received::Closed);
        };
        let (then, since) = replayed.acted;
        let due = |at: SimTime| now.saturating_since(since) >= at.saturating_since(then);
        match replayed.rest.front_mut() {
            Some((at, Exchange::Received(bytes))) if due(*at) => {
                let count = limit.min(bytes.len());
                let given = bytes.drain(..count).collect();
                if bytes.is_empty() {
                    replayed.rest.pop_front();
                }
                Poll::Ready(Received::Data(given))
            }
            Some((at, Exchange::PeerClosed)) if due(*at) => Poll::Ready(Received::Closed),
            // Nothing came any more: then the program waited, too.
            _ => Poll::Pending,
        }
    }

    fn close(&mut self, _: SimTime, _: &str, socket: SocketId) {
        self.sockets.remove(&socket);
    }
}
