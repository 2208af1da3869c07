//! A running server, and clients that are as good or as bad as a test wants them.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use depal_cell::station::Station;
use depal_interface::{CalibrationPose, Encoding, FaultScript, IndexStep, PortSettings};
use depal_net::{
    Limits, NetError, Notice, Ports, Stop, Stopper, bind, compute_on_thread, serve as serve_station,
};
use depal_scene::Scene;

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/interface.toml");
pub const TRIGGER: &str = "101,1,0,0,0,0,0,0,0,0";
/// A client that waits longer has found a server that hangs.
const PATIENCE: Duration = Duration::from_secs(20);

/// What is served.
pub struct Setup<'a> {
    pub kinds: &'a [Encoding],
    pub set: &'a [(&'a str, &'a str)],
    pub inject: &'a [&'a str],
    pub limits: Limits,
}

impl Default for Setup<'_> {
    fn default() -> Self {
        Self {
            kinds: &[Encoding::Ascii],
            set: &[],
            inject: &[],
            limits: Limits::default(),
        }
    }
}

pub struct Served {
    pub ports: Vec<SocketAddr>,
    notices: Arc<Mutex<Vec<Notice>>>,
    stopper: Stopper,
    thread: Option<JoinHandle<Result<(), NetError>>>,
}

/// One ASCII port.
pub fn ascii() -> Served {
    serve(&Setup::default())
}

pub fn serve(setup: &Setup<'_>) -> Served {
    let loopback = "127.0.0.1:0".parse().expect("an address");
    let ports = bind(&vec![loopback; setup.kinds.len()]).expect("free ports");
    serve_on(ports, setup)
}

pub fn serve_on(ports: Ports, setup: &Setup<'_>) -> Served {
    let addresses = ports.addresses().to_vec();
    let station = station(setup);
    let notices = Arc::new(Mutex::new(Vec::new()));
    let stop = Stop::when_told();
    let stopper = stop.stopper();
    let (limits, kept) = (setup.limits.clone(), Arc::clone(&notices));
    let thread = std::thread::spawn(move || {
        let keep = move |notice| {
            let is_raw = matches!(notice, Notice::RawReceived { .. } | Notice::RawSent { .. });
            if !is_raw {
                kept.lock().expect("no panic").push(notice);
            }
        };
        serve_station(ports, station, limits, keep, None, stop)
    });
    Served {
        ports: addresses,
        notices,
        stopper,
        thread: Some(thread),
    }
}

/// The cell of the interface scene, with a calibration and a counting step.
pub fn station(setup: &Setup<'_>) -> Station {
    let set: Vec<(String, String)> = setup
        .set
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let scene = Scene::load_file(SCENE, &set, None).expect("a good scene");
    let mut spec = scene.cell_spec().expect("a good cell");
    let own = spec.interface.ports[0].clone();
    let port = |encoding: &Encoding| PortSettings {
        encoding: *encoding,
        ..own.clone()
    };
    spec.interface.ports = setup.kinds.iter().map(port).collect();
    let pose = CalibrationPose {
        base_from_flange: spec.base_from_camera(None),
        joints: spec.controller.start,
    };
    spec.interface.calibration = vec![pose; 3];
    if let Some(viz) = &mut spec.interface.viz
        && viz.index_steps.is_empty()
    {
        viz.index_steps = vec![IndexStep { step: 3, places: 6 }];
    }
    let faults = FaultScript::parse(setup.inject).expect("good faults");
    spec.interface.faults.extend(faults);
    let errands = compute_on_thread().expect("a thread");
    Station::new(spec, || 0.0, errands).expect("a good cell")
}

impl Served {
    pub fn client(&self) -> Client {
        self.client_of(0)
    }

    pub fn client_of(&self, port: usize) -> Client {
        Client::connect(self.ports[port])
    }

    /// Another client of the same port is answered within 50 ms: the best of some tries, for computers that are
    /// busy with other things. A server that hangs, or that is slow each time, fails.
    pub fn check_alive(&self, port: usize, kind: Encoding) {
        let mut times = Vec::new();
        for _ in 0..20 {
            let started = Instant::now();
            let mut client = self.client_of(port);
            if kind.is_hex() {
                let reply = client.ask_cells(kind, &[901]);
                assert_eq!(cells(kind, &reply, 2), [901, 1101]);
            } else {
                assert_eq!(client.ask("901"), "901,1101");
            }
            times.push(started.elapsed());
            if times[times.len() - 1] < Duration::from_millis(50) {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("a second client was answered after {times:?}");
    }

    /// Whether this was said so far; waits a little for it.
    pub fn has_told(&self, words: &str) -> bool {
        let started = Instant::now();
        loop {
            let notices = self.notices.lock().expect("no panic");
            if notices.iter().any(|n| format!("{n:?}").contains(words)) {
                return true;
            }
            drop(notices);
            if started.elapsed() > Duration::from_secs(5) {
                return false;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Ends it; how long that took.
    pub fn stop(mut self) -> Duration {
        let started = Instant::now();
        self.stopper.stop();
        let thread = self.thread.take().expect("it runs");
        thread.join().expect("no panic").expect("a clean end");
        started.elapsed()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stopper.stop();
        if let Some(thread) = self.thread.take() {
            let result = thread.join().expect("no panic");
            if !std::thread::panicking() {
                result.expect("a clean end");
            }
        }
    }
}

/// A robot's socket.
pub struct Client(pub TcpStream);

impl Client {
    pub fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).expect("it listens");
        stream.set_nodelay(true).expect("a socket");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
        Self(stream)
    }

    pub fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).expect("sent");
    }

    /// One reply without its CR.
    pub fn reply(&mut self) -> String {
        let mut text = Vec::new();
        let mut byte = [0];
        loop {
            self.0.read_exact(&mut byte).expect("a reply");
            if byte[0] == b'\r' {
                return String::from_utf8(text).expect("text");
            }
            text.push(byte[0]);
        }
    }

    pub fn ask(&mut self, command: &str) -> String {
        self.send(format!("{command}\r").as_bytes());
        self.reply()
    }

    #[track_caller]
    pub fn check(&mut self, command: &str, expected: &str) {
        assert_eq!(self.ask(command), expected, "{command:.60}");
    }

    /// One HEX reply of 660 bytes.
    pub fn frame(&mut self) -> Vec<u8> {
        let mut frame = vec![0; 660];
        self.0.read_exact(&mut frame).expect("660 bytes");
        frame
    }

    pub fn ask_cells(&mut self, kind: Encoding, values: &[i32]) -> Vec<u8> {
        self.send(&record(kind, values, 64));
        self.frame()
    }

    /// Whether the server closes, by FIN or by RST; what it says before is read.
    pub fn is_closed(&mut self) -> bool {
        let mut rest = Vec::new();
        match self.0.read_to_end(&mut rest) {
            Ok(_) => true,
            Err(error) => error.kind() == ErrorKind::ConnectionReset,
        }
    }

    /// Nothing comes for so long.
    pub fn is_quiet(&mut self, time: Duration) -> bool {
        self.0.set_read_timeout(Some(time)).expect("a socket");
        let read = self.0.read(&mut [0]);
        self.0.set_read_timeout(Some(PATIENCE)).expect("a socket");
        matches!(read, Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut))
    }
}

/// A HEX request of `length` bytes.
pub fn record(kind: Encoding, values: &[i32], length: usize) -> Vec<u8> {
    let cell = |value: &i32| match kind {
        Encoding::HexBigEndian => value.to_be_bytes(),
        _ => value.to_le_bytes(),
    };
    let mut bytes: Vec<u8> = values.iter().flat_map(cell).collect();
    bytes.resize(length, 0);
    bytes
}

/// The first cells of a HEX reply, as whole numbers.
pub fn cells(kind: Encoding, reply: &[u8], count: usize) -> Vec<i32> {
    let cell = |bytes: &[u8]| {
        let bytes = bytes.try_into().expect("four bytes");
        match kind {
            Encoding::HexBigEndian => i32::from_be_bytes(bytes),
            _ => i32::from_le_bytes(bytes),
        }
    };
    reply.chunks_exact(4).take(count).map(cell).collect()
}
