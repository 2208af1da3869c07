//! What `depal serve` shows on stderr: who connects, what is said and what is answered.

use std::io::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use depal_cell::event::EventKind;
use depal_interface::{Direction, PortId};
use depal_net::Notice;

use crate::failure::Failure;

/// Lines that may wait for a slow terminal. Further ones are counted instead of shown, so that nobody who
/// does not read can hold the server up.
const WAITING_LINES: usize = 20_000;

/// Prints notices on a thread of its own.
pub struct ServeLog {
    sender: SyncSender<Notice>,
    left_out: Arc<AtomicU64>,
    is_ending: Arc<AtomicBool>,
    is_verbose: bool,
    thread: JoinHandle<()>,
}

impl ServeLog {
    /// `names` says what each port is called.
    pub fn start(names: Vec<String>, is_verbose: bool) -> Result<Self, Failure> {
        let (sender, receiver) = sync_channel(WAITING_LINES);
        let left_out = Arc::new(AtomicU64::new(0));
        let is_ending = Arc::new(AtomicBool::new(false));
        let (count, ending) = (Arc::clone(&left_out), Arc::clone(&is_ending));
        let thread = std::thread::Builder::new()
            .name("log".to_owned())
            .spawn(move || print(&receiver, &names, &count, &ending))
            .map_err(|error| Failure::Environment(format!("cannot start a thread: {error}")))?;
        Ok(Self {
            sender,
            left_out,
            is_ending,
            is_verbose,
            thread,
        })
    }

    /// What takes notices; it never blocks.
    pub fn notices(&self) -> impl Fn(Notice) + Send + Sync + 'static {
        let (sender, left_out) = (self.sender.clone(), Arc::clone(&self.left_out));
        let is_verbose = self.is_verbose;
        move |notice| {
            let is_raw = matches!(notice, Notice::RawReceived { .. } | Notice::RawSent { .. });
            if (is_verbose || !is_raw) && sender.try_send(notice).is_err() {
                left_out.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    /// Prints what is left, unless nobody reads it.
    pub fn finish(self) {
        self.is_ending.store(true, Ordering::Relaxed);
        for _ in 0..50 {
            if self.thread.is_finished() {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

fn print(receiver: &Receiver<Notice>, names: &[String], left_out: &AtomicU64, ending: &AtomicBool) {
    let mut stderr = std::io::stderr();
    loop {
        let notice = receiver.recv_timeout(Duration::from_millis(100));
        let missing = left_out.swap(0, Ordering::Relaxed);
        if missing > 0 {
            let _ = writeln!(stderr, "... {missing} lines left out: too many to show");
        }
        match notice {
            Ok(notice) => {
                if let Some(line) = line(&notice, names) {
                    // Without a stderr there is nobody to tell.
                    let _ = writeln!(stderr, "{line}");
                }
            }
            Err(_) if ending.load(Ordering::Relaxed) => return,
            Err(_) => {}
        }
    }
}

fn line(notice: &Notice, names: &[String]) -> Option<String> {
    let name = |port: &PortId| names.get(usize::from(port.0)).map_or("?", String::as_str);
    Some(match notice {
        Notice::Connected { port, client, peer } => {
            format!("{} #{} connected from {peer}", name(port), client.0)
        }
        Notice::Refused { port, peer, reason } => {
            format!("{} {peer} refused: {reason}", name(port))
        }
        Notice::Disconnected {
            port,
            client,
            reason,
        } => format!("{} #{} gone: {reason}", name(port), client.0),
        Notice::Plc { port, text } => format!("{} {text}", name(port)),
        Notice::RawReceived {
            at,
            port,
            client,
            bytes,
        } => format!(
            "{:>10.3} {} #{} -> [{}] {}",
            at.as_secs_f64(),
            name(port),
            client.0,
            bytes.len(),
            raw(bytes)
        ),
        Notice::RawSent {
            at,
            port,
            client,
            bytes,
        } => format!(
            "{:>10.3} {} #{} <- [{}] {}",
            at.as_secs_f64(),
            name(port),
            client.0,
            bytes.len(),
            raw(bytes)
        ),
        Notice::Message(entry) => {
            let arrow = match entry.direction {
                Direction::Received => "->",
                Direction::Sent => "<-",
            };
            format!(
                "{:>10.3} {} #{} {arrow} {}",
                entry.at.as_secs_f64(),
                name(&entry.port),
                entry.connection.0,
                entry.text
            )
        }
        Notice::Happened(port, event) => {
            let text = match &event.kind {
                EventKind::Vision { detections, .. } => {
                    format!("vision found {} carton(s)", detections.len())
                }
                EventKind::Plan { waypoints, .. } => {
                    format!("a path of {} waypoints is planned", waypoints.len())
                }
                EventKind::PlanRefused { reasons } => format!("no path: {}", reasons.join("; ")),
                EventKind::Message { text } => text.clone(),
                _ => return None,
            };
            format!("{:>10.3} {} {text}", event.time.as_secs_f64(), name(port))
        }
        _ => return None,
    })
}

/// Text as text, anything else in hexadecimal; trailing zeros of a record are counted only.
fn raw(bytes: &[u8]) -> String {
    let is_text = |b: &u8| b.is_ascii_graphic() || matches!(b, b' ' | b'\r' | b'\n');
    if bytes.iter().all(is_text) {
        return bytes.escape_ascii().to_string();
    }
    let used = bytes
        .iter()
        .rposition(|b| *b != 0)
        .map_or(0, |last| last + 1);
    let digits: Vec<String> = bytes[..used].iter().map(|b| format!("{b:02x}")).collect();
    match bytes.len() - used {
        0 => digits.join(" "),
        zeros => format!("{} + {zeros} x 00", digits.join(" ")),
    }
}
