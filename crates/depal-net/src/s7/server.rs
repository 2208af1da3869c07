//! Offers the data block itself: one block and one session, any number of clients.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use depal_interface::{Handshake, HandshakeSettings, Transfer};
use depal_time::SimTime;
use depal_wire::s7::{BlockServer, DataBlock, S7Error};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Notify, watch};
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep, sleep_until, timeout, timeout_at};

use super::{SessionLink, Teller, WallClock};
use crate::Limits;

/// A telegram that has begun has to end within this.
const WHOLE_TELEGRAM: Duration = Duration::from_secs(8);
/// After a failed accept.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// The block and who watches it.
struct Shared {
    state: Mutex<State>,
    /// The handshake has something to say or to ask.
    changed: Notify,
    clock: WallClock,
}

struct State {
    block: DataBlock,
    handshake: Handshake,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state
            .lock()
            .expect("nothing panics while it holds this")
    }

    /// The next whole telegram of a client; what follows from it happens before anybody else sees the block.
    fn answer(&self, server: &mut BlockServer) -> Result<Option<Vec<u8>>, S7Error> {
        let mut state = self.state();
        let Some(served) = server.poll(&mut state.block)? else {
            return Ok(None);
        };
        if served.is_written {
            let now = self.clock.now();
            state.handshake.handle_change(now);
            state.transfer(now);
            self.changed.notify_one();
        }
        Ok(Some(served.frame))
    }
}

impl State {
    /// Carries out what the handshake wants from the block.
    fn transfer(&mut self, now: SimTime) {
        while let Some(transfer) = self.handshake.poll_transfer(now) {
            match transfer {
                Transfer::Read { first, len } => {
                    let bytes = self.block.bytes(first, len).unwrap_or_default();
                    self.handshake.handle_read(now, bytes);
                }
                Transfer::Write { first, bytes } => {
                    self.block.write(first, &bytes);
                    self.handshake.handle_written(now);
                }
            }
        }
    }
}

/// Serves the block until told to stop.
pub(crate) async fn serve_block(
    listener: TcpListener,
    settings: HandshakeSettings,
    mut session: SessionLink,
    limits: Limits,
    teller: Teller,
    mut stop: watch::Receiver<bool>,
) {
    let mut handshake = Handshake::new(settings);
    handshake.handle_connect();
    let shared = Arc::new(Shared {
        state: Mutex::new(State {
            block: DataBlock::new(),
            handshake,
        }),
        changed: Notify::new(),
        clock: WallClock::start(),
    });
    let count = Arc::new(AtomicUsize::new(0));
    let mut clients = JoinSet::new();
    loop {
        let due = tend(&shared, &session, &teller);
        tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, peer)) => {
                    if count.load(Ordering::Relaxed) >= limits.clients_per_port {
                        teller.tell(format!(
                            "{peer} refused: {} clients are connected already",
                            limits.clients_per_port
                        ));
                        continue;
                    }
                    session.open(peer);
                    count.fetch_add(1, Ordering::Relaxed);
                    let client = BlockClient::new(stream, Arc::clone(&shared), &limits);
                    let (teller, count) = (teller.clone(), Arc::clone(&count));
                    clients.spawn(async move {
                        teller.tell(format!("{peer} connected"));
                        let reason = client.run().await;
                        teller.tell(format!("{peer} gone: {reason}"));
                        count.fetch_sub(1, Ordering::Relaxed);
                    });
                }
                Err(_) => sleep(ACCEPT_PAUSE).await,
            },
            () = shared.changed.notified() => {}
            replies = session.recv() => {
                let mut state = shared.state();
                for reply in replies {
                    state.handshake.handle_reply(&reply);
                }
            }
            () = sleep_until(shared.clock.instant(due)) => {}
            Some(_) = clients.join_next(), if !clients.is_empty() => {}
            _ = stop.changed() => return,
        }
    }
}

/// Does what is due now; when the next thing is.
fn tend(shared: &Shared, session: &SessionLink, teller: &Teller) -> SimTime {
    let now = shared.clock.now();
    let mut state = shared.state();
    state.transfer(now);
    while let Some(request) = state.handshake.poll_request() {
        session.send(request);
    }
    while let Some(text) = state.handshake.poll_notice() {
        teller.tell(text);
    }
    let far = now + depal_time::SimDuration::from_millis(1_000);
    state.handshake.poll_timeout().unwrap_or(far).min(far)
}

/// One client of the block.
struct BlockClient {
    stream: TcpStream,
    shared: Arc<Shared>,
    idle: Duration,
    write: Duration,
    server: BlockServer,
}

impl BlockClient {
    fn new(stream: TcpStream, shared: Arc<Shared>, limits: &Limits) -> Self {
        // Without it answers are only slower.
        let _ = stream.set_nodelay(true);
        Self {
            stream,
            shared,
            idle: limits.idle,
            write: limits.write,
            server: BlockServer::new(),
        }
    }

    /// To its end; why it ended.
    async fn run(mut self) -> String {
        let mut chunk = [0; 1024];
        let mut deadline = Instant::now() + self.idle;
        loop {
            let was_inside = self.server.is_inside();
            let count = match timeout_at(deadline, self.stream.read(&mut chunk)).await {
                Err(_) if was_inside => return "its telegram did not end".to_owned(),
                Err(_) => return "silent for too long".to_owned(),
                Ok(Err(error)) => return format!("connection lost: {error}"),
                Ok(Ok(0)) => return "closed by the client".to_owned(),
                Ok(Ok(count)) => count,
            };
            self.server.push(&chunk[..count]);
            let has_answered = match self.answer_all().await {
                Ok(has_answered) => has_answered,
                Err(reason) => return reason,
            };
            // The deadline of a telegram is counted from its first bytes.
            if has_answered || !was_inside {
                let is_inside = self.server.is_inside();
                deadline = Instant::now() + if is_inside { WHOLE_TELEGRAM } else { self.idle };
            }
        }
    }

    /// Answers every packet that is complete; whether there was one.
    async fn answer_all(&mut self) -> Result<bool, String> {
        let mut has_answered = false;
        loop {
            let frame = match self.shared.answer(&mut self.server) {
                Ok(None) => return Ok(has_answered),
                Ok(Some(frame)) => frame,
                Err(error) => return Err(error.to_string()),
            };
            has_answered = true;
            match timeout(self.write, self.stream.write_all(&frame)).await {
                Err(_) => return Err("does not read our answers".to_owned()),
                Ok(Err(error)) => return Err(format!("connection lost: {error}")),
                Ok(Ok(())) => {}
            }
        }
    }
}
