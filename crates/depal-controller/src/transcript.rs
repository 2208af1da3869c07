//! What went over the sockets of a program, written down and played again.

use std::fmt::Write as _;

use depal_time::{SimDuration, SimTime};

pub use recording::RecordingNetwork;
pub use replay::ReplayNetwork;

mod recording;
mod replay;

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
