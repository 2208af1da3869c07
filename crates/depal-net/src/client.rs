//! One client: its socket on one side, the brain on the other.

use std::io::ErrorKind;
use std::time::Duration;

use depal_interface::Encoding;
use socket2::SockRef;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::{mpsc::UnboundedReceiver, watch};
use tokio::time::{Instant, sleep_until, timeout};

use crate::Limits;
use crate::brain::{BrainLink, Client, ToBrain, Turn};

/// Most commands handed over at a time: a client that floods gets its share, not more.
const SHARE_COMMANDS: usize = 16;
/// Most bytes handed over at a time: one long line or record, several short ones.
const SHARE_BYTES: usize = 2048;
/// Bytes read ahead; while they wait, the client's own sending blocks.
const READ_AHEAD: usize = 16 * 1024;
/// After a client has closed its sending side, silence may still complete its last HEX command.
const LAST_WORD: Duration = Duration::from_millis(150);
/// A client that is closed may still be sending; so long we read on, for it to see our last reply.
const FAREWELL: Duration = Duration::from_millis(200);
/// And so many bytes.
const FAREWELL_BYTES: usize = 256 * 1024;

pub(crate) struct Task {
    pub(crate) stream: TcpStream,
    pub(crate) client: Client,
    pub(crate) encoding: Encoding,
    pub(crate) limits: Limits,
    pub(crate) to_brain: BrainLink,
    pub(crate) from_brain: UnboundedReceiver<Turn>,
    pub(crate) stop: watch::Receiver<bool>,
    /// A reply could not be written in time.
    pub(crate) is_deaf: bool,
}

/// Between two calls of the loop.
#[derive(Default)]
struct Progress {
    /// Read, and not yet handed over.
    ahead: Vec<u8>,
    /// Bytes are with the brain, not yet acknowledged.
    is_in_flight: bool,
    /// A command waits for a run to end.
    is_waiting: bool,
    /// When the client closed its sending side.
    ended: Option<Instant>,
    last_byte: Option<u8>,
    has_read: bool,
}

impl Task {
    /// Serves the client to its end, and tells the brain.
    pub(crate) async fn run(mut self) {
        let reason = self.serve().await;
        // The brain is gone only while the process ends.
        self.to_brain
            .send(ToBrain::Disconnected(self.client, reason));
        self.farewell().await;
    }

    /// Why it ended.
    async fn serve(&mut self) -> String {
        let mut at = Progress::default();
        let mut chunk = vec![0; 4096];
        let mut idle_from = Instant::now();
        loop {
            if *self.stop.borrow() && !at.is_in_flight {
                return "the server stops".to_owned();
            }
            self.hand_over(&mut at);
            if let Some(ended) = at.ended
                && at.ahead.is_empty()
                && !at.is_in_flight
                && !at.is_waiting
                && (self.is_complete(&at) || ended.elapsed() >= LAST_WORD)
            {
                return "closed by the client".to_owned();
            }
            let wake = at
                .ended
                .map_or(idle_from + self.limits.idle, |ended| ended + LAST_WORD);
            let may_sleep = !at.is_in_flight && !at.is_waiting;
            tokio::select! {
                biased;
                turn = self.from_brain.recv() => {
                    let Some(turn) = turn else {
                        return "the server stops".to_owned();
                    };
                    for reply in &turn.replies {
                        if let Err(reason) = self.write(reply).await {
                            return reason;
                        }
                    }
                    if turn.closes {
                        return "closed by the server".to_owned();
                    }
                    at.is_in_flight &= !turn.acknowledges;
                    at.is_waiting = turn.is_waiting;
                    idle_from = Instant::now();
                    if at.ended.is_some() {
                        at.ended = Some(Instant::now());
                    }
                }
                read = self.stream.read(&mut chunk),
                    if at.ended.is_none() && at.ahead.len() < READ_AHEAD =>
                {
                    match read {
                        Ok(0) => self.end(&mut at),
                        Ok(count) => {
                            let bytes = &chunk[..count];
                            if !at.has_read && let Some(other) = other_protocol(bytes) {
                                return format!("not our protocol: this looks like {other}");
                            }
                            at.has_read = true;
                            at.last_byte = bytes.last().copied();
                            at.ahead.extend_from_slice(bytes);
                            idle_from = Instant::now();
                        }
                        Err(error) if error.kind() == ErrorKind::Interrupted => {}
                        Err(error) => return format!("connection lost: {error}"),
                    }
                }
                _ = self.stop.changed() => {}
                () = sleep_until(wake), if may_sleep => {
                    if at.ended.is_none() {
                        let seconds = self.limits.idle.as_secs_f64();
                        return format!("silent for {seconds} s");
                    }
                }
            }
        }
    }

    /// Gives the brain its next share, if it has dealt with the last one.
    fn hand_over(&self, at: &mut Progress) {
        if at.is_in_flight || at.is_waiting || at.ahead.is_empty() || *self.stop.borrow() {
            return;
        }
        let share = share(self.encoding, &at.ahead);
        let bytes: Vec<u8> = at.ahead.drain(..share).collect();
        at.is_in_flight = self.to_brain.send(ToBrain::Bytes(self.client, bytes));
    }

    /// The client sends nothing more. The end of its stream ends its last line, too.
    fn end(&self, at: &mut Progress) {
        if !self.encoding.is_hex() && at.last_byte.is_some() && !self.is_complete(at) {
            at.ahead.push(b'\r');
            at.last_byte = Some(b'\r');
        }
        at.ended = Some(Instant::now());
        self.to_brain.send(ToBrain::HalfClosed(self.client));
    }

    /// Whether nothing half said remains.
    fn is_complete(&self, at: &Progress) -> bool {
        match at.last_byte {
            None => true,
            Some(last) => !self.encoding.is_hex() && matches!(last, b'\r' | b'\n'),
        }
    }

    async fn write(&mut self, reply: &[u8]) -> Result<(), String> {
        match timeout(self.limits.write, self.stream.write_all(reply)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(error)) => Err(format!("connection lost: {error}")),
            Err(_) => {
                self.is_deaf = true;
                let seconds = self.limits.write.as_secs_f64();
                Err(format!("does not read: a reply waited for {seconds} s"))
            }
        }
    }

    /// Closes so that the last reply arrives even if the client is still sending.
    async fn farewell(mut self) {
        if self.is_deaf {
            // An orderly end would wait behind the replies that nobody reads, and the system keep them:
            // without lingering, the connection is reset.
            let _ = SockRef::from(&self.stream).set_linger(Some(Duration::ZERO));
            return;
        }
        if self.stream.shutdown().await.is_err() {
            return;
        }
        let _ = timeout(FAREWELL, async {
            let mut rest = vec![0; 4096];
            let mut left = FAREWELL_BYTES;
            while left > 0 {
                match self.stream.read(&mut rest).await {
                    Ok(count) if count > 0 => left = left.saturating_sub(count),
                    _ => break,
                }
            }
        })
        .await;
    }
}

/// How much of what was read is handed over at once.
fn share(encoding: Encoding, ahead: &[u8]) -> usize {
    let most = ahead.len().min(SHARE_BYTES);
    if encoding.is_hex() {
        return most;
    }
    ahead[..most]
        .iter()
        .enumerate()
        .filter(|(_, byte)| matches!(byte, b'\r' | b'\n'))
        .nth(SHARE_COMMANDS - 1)
        .map_or(most, |(place, _)| place + 1)
}

/// The name of another protocol that begins so. None of these is the beginning of a command.
fn other_protocol(opening: &[u8]) -> Option<&'static str> {
    const OPENINGS: [(&[u8], &str); 6] = [
        (&[0x16, 0x03], "TLS"),
        (b"GET ", "HTTP"),
        (b"POST ", "HTTP"),
        (b"HEAD ", "HTTP"),
        (b"PRI * HTTP", "HTTP"),
        (b"SSH-", "SSH"),
    ];
    OPENINGS
        .iter()
        .find(|(bytes, _)| opening.starts_with(bytes))
        .map(|(_, name)| *name)
}
