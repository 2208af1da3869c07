//! Works on the data block of a controller that comes and goes.

use std::time::Duration;

use depal_interface::{Handshake, HandshakeSettings, Transfer};
use tokio::sync::watch;
use tokio::time::{sleep, sleep_until};

use super::{PlcAddress, S7Client, S7LinkError, SessionLink, Teller, WallClock};

/// First pause after a lost connection, doubled after each attempt in vain.
const FIRST_PAUSE: Duration = Duration::from_millis(200);
/// Longest pause; with its spread and one attempt in vain it stays well below 7 s.
const LONGEST_PAUSE: Duration = Duration::from_millis(3_500);

/// Serves the controller until told to stop.
pub(crate) async fn poll_plc(
    plc: PlcAddress,
    settings: HandshakeSettings,
    session: SessionLink,
    teller: Teller,
    mut stop: watch::Receiver<bool>,
) {
    let mut poller = Poller {
        plc,
        handshake: Handshake::new(settings),
        session,
        teller,
        clock: WallClock::start(),
        pauses: Pauses::new(u64::from(plc.address.port())),
        told: String::new(),
    };
    tokio::select! {
        () = poller.run() => {}
        _ = stop.wait_for(|stop| *stop) => {}
    }
}

struct Poller {
    plc: PlcAddress,
    handshake: Handshake,
    session: SessionLink,
    teller: Teller,
    clock: WallClock,
    pauses: Pauses,
    /// The last trouble: the same one is told once.
    told: String,
}

impl Poller {
    async fn run(&mut self) {
        loop {
            if let Err(error) = self.connection().await {
                self.handshake.handle_disconnect();
                let text = format!("PLC {}: {error}", self.plc.address);
                if text != self.told {
                    self.teller.tell(format!("{text}; trying again"));
                    self.told = text;
                }
            }
            sleep(self.pauses.next()).await;
        }
    }

    /// One connection, to its end; it never ends without an error.
    async fn connection(&mut self) -> Result<(), S7LinkError> {
        let mut client = S7Client::connect(self.plc).await?;
        self.handshake.handle_connect();
        let mut is_announced = false;
        loop {
            while let Some(replies) = self.session.try_recv() {
                self.take(&replies);
            }
            while let Some(request) = self.handshake.poll_request() {
                self.session.send(request);
            }
            while let Some(text) = self.handshake.poll_notice() {
                self.teller
                    .tell(format!("PLC {}: {text}", self.plc.address));
            }
            match self.handshake.poll_transfer(self.clock.now()) {
                Some(Transfer::Read { first, len }) => {
                    let bytes = client.read(first, len).await?;
                    self.handshake.handle_read(self.clock.now(), &bytes);
                }
                Some(Transfer::Write { first, bytes }) => {
                    client.write(first, bytes).await?;
                    self.handshake.handle_written(self.clock.now());
                    // The controller reads and writes: whatever was wrong is over.
                    if !is_announced {
                        is_announced = true;
                        self.told.clear();
                        self.pauses.reset();
                        self.announce(client.pdu());
                    }
                }
                None => self.wait().await,
            }
        }
    }

    fn announce(&mut self, pdu: u16) {
        self.session.open(self.plc.address);
        let PlcAddress {
            address,
            db,
            rack,
            slot,
            ..
        } = self.plc;
        self.teller.tell(format!(
            "PLC {address}: connected to DB {db}, rack {rack}, slot {slot}, telegrams of {pdu} bytes"
        ));
    }

    /// Until something is due or the session answers.
    async fn wait(&mut self) {
        let Some(due) = self.handshake.poll_timeout() else {
            return;
        };
        tokio::select! {
            () = sleep_until(self.clock.instant(due)) => {}
            replies = self.session.recv() => self.take(&replies),
        }
    }

    fn take(&mut self, replies: &[Vec<u8>]) {
        for reply in replies {
            self.handshake.handle_reply(reply);
        }
    }
}

/// Pauses between attempts: doubled each time, spread so that several clients do not come in step.
#[derive(Debug)]
struct Pauses {
    next: Duration,
    spread: u64,
}

impl Pauses {
    /// The spread follows from `seed` alone.
    fn new(seed: u64) -> Self {
        Self {
            next: FIRST_PAUSE,
            spread: seed,
        }
    }

    fn reset(&mut self) {
        self.next = FIRST_PAUSE;
    }

    /// Between 0.9 and 1.1 times the pause that is due.
    fn next(&mut self) -> Duration {
        let pause = self.next;
        self.next = (pause * 2).min(LONGEST_PAUSE);
        // A linear congruential generator with the constants of MMIX.
        self.spread = self
            .spread
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let share = (self.spread >> 40) as f64 / (1_u64 << 24) as f64;
        pause.mul_f64(0.9 + 0.2 * share)
    }
}
