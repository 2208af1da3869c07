//! The vision side of the tests: a session that finds three points at once, behind a client of the block.

use std::collections::BTreeMap;
use std::net::{SocketAddr, TcpListener};
use std::pin::Pin;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use depal_interface::{
    ConnectionId, HandshakeSettings, Job, PortId, PortSettings, Server, ServerSettings,
    VisionPoint, VisionResult, plc_port,
};
use depal_time::{SimDuration, SimTime};
use tokio::sync::watch;

use crate::brain::{BrainLink, Letter, ToBrain, Turn};
use crate::s7::{PlcAddress, SessionLink, Teller, poll_plc, serve_block};
use crate::{Limits, Notice};

pub struct Vision {
    /// What was told to people.
    pub told: Arc<Mutex<Vec<String>>>,
    /// Runs of the project.
    pub runs: Arc<AtomicUsize>,
    stop: watch::Sender<bool>,
}

impl Drop for Vision {
    fn drop(&mut self) {
        self.stop.send_replace(true);
    }
}

impl Vision {
    /// Works on the block of a controller until it is dropped.
    pub fn at(plc: PlcAddress) -> Self {
        Self::start(plc.poll, move |settings, session, teller, stopped| {
            Box::pin(poll_plc(plc, settings, session, teller, stopped))
        })
    }

    /// Offers the block itself, until it is dropped.
    pub fn offering() -> (Self, SocketAddr) {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        listener.set_nonblocking(true).expect("a socket");
        let address = listener.local_addr().expect("bound");
        let vision = Self::start(
            Duration::from_secs(1),
            move |settings, session, teller, stopped| {
                Box::pin(async move {
                    let listener = tokio::net::TcpListener::from_std(listener).expect("a runtime");
                    let limits = Limits::default();
                    serve_block(listener, settings, session, limits, teller, stopped).await;
                })
            },
        );
        (vision, address)
    }

    fn start(
        poll: Duration,
        task: impl FnOnce(
            HandshakeSettings,
            SessionLink,
            Teller,
            watch::Receiver<bool>,
        ) -> Pin<Box<dyn Future<Output = ()>>>
        + Send
        + 'static,
    ) -> Self {
        let (to_brain, letters) = BrainLink::new();
        let runs = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&runs);
        let own = plc_port(&PortSettings::default());
        let settings = HandshakeSettings {
            poll_period: SimDuration::from_nanos(poll.as_nanos() as u64),
            profile: own.profile.clone(),
            ..HandshakeSettings::default()
        };
        thread::spawn(move || brain(&letters, own, &counter));
        let told: Arc<Mutex<Vec<String>>> = Arc::default();
        let list = Arc::clone(&told);
        let teller = Teller {
            port: PortId(0),
            notices: Arc::new(move |notice| {
                if let Notice::Plc { text, .. } = notice {
                    list.lock().expect("alive").push(text);
                }
            }),
        };
        let session = SessionLink::new((PortId(0), ConnectionId(1)), to_brain);
        let (stop, stopped) = watch::channel(false);
        thread::spawn(move || {
            tokio::runtime::Builder::new_current_thread()
                .enable_all()
                .build()
                .expect("a runtime")
                .block_on(async { task(settings, session, teller, stopped).await });
        });
        Self { told, runs, stop }
    }

    pub fn has_told(&self, text: &str) -> bool {
        self.told
            .lock()
            .expect("alive")
            .iter()
            .any(|told| told.contains(text))
    }

    pub fn wait_told(&self, text: &str) {
        let started = Instant::now();
        while !self.has_told(text) {
            let told = self.told.lock().expect("alive").clone();
            assert!(
                started.elapsed() < Duration::from_secs(20),
                "not told: {text}; told: {told:?}"
            );
            thread::sleep(Duration::from_millis(2));
        }
    }

    pub fn run_count(&self) -> usize {
        self.runs.load(Ordering::SeqCst)
    }
}

fn brain(letters: &Receiver<Letter>, own: PortSettings, runs: &AtomicUsize) {
    let settings = ServerSettings {
        ports: vec![own],
        ..ServerSettings::default()
    };
    let mut server = Server::new(settings).expect("good settings");
    let started = Instant::now();
    let mut clients = BTreeMap::new();
    loop {
        let letter = letters.recv_timeout(Duration::from_millis(2));
        let now = SimTime::from_nanos(started.elapsed().as_nanos() as u64);
        match letter.map(|letter| letter.message) {
            Ok(ToBrain::Connected((port, id), _, sender)) => {
                server.handle_connect(now, port, id);
                clients.insert(id, sender);
            }
            Ok(ToBrain::Bytes((port, id), bytes)) => server.handle_input(now, port, id, &bytes),
            Ok(_) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        server.handle_timeout(now);
        while let Some(job) = server.poll_job() {
            if let Job::RunVision { job_id, .. } = job {
                runs.fetch_add(1, Ordering::SeqCst);
                server.finish_vision_custom(now, job_id, Ok(points()));
            }
        }
        while let Some(reply) = server.poll_reply() {
            let turn = Turn {
                replies: vec![reply.bytes],
                ..Turn::default()
            };
            if let Some(sender) = clients.get(&reply.connection) {
                let _ = sender.send(turn);
            }
        }
    }
}

fn points() -> VisionResult {
    let point = |n: i32| {
        let mut base_from_object = VisionPoint {
            base_from_object: depal_frames::Pose::identity(),
            label: n,
        };
        base_from_object.base_from_object.translation.x = 0.1 * f64::from(n);
        base_from_object
    };
    VisionResult {
        points: (1..=3).map(point).collect(),
        ..VisionResult::default()
    }
}
