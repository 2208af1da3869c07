//! The servers that are measured, each a process of its own.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Error, Write};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use depal_cell::event::Event;
use depal_cell::station::{Station, StationReply};
use depal_frames::{Pose, Vector};
use depal_interface::{
    ConnectionId, Encoding, Job, LogEntry, PortId, PortSettings, Server, ServerSettings,
    VisionPoint,
};
use depal_net::{Limits, SessionHost, Stop, bind, compute_on_thread, serve};
use depal_scene::Scene;
use depal_time::{SimTime, TICK};

/// Ports of the stand-in: a result belongs to a port, so each client has its own.
const SESSIONS: usize = 65;

/// What a process serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Every line is answered with what its command is answered with by the others, without looking further.
    Echo,
    /// The demo's cell.
    Cell,
    /// Sessions whose vision finds 20 points at once.
    Points,
}

impl Role {
    const ALL: [(Self, &'static str); 3] = [
        (Self::Echo, "serve-echo"),
        (Self::Cell, "serve-cell"),
        (Self::Points, "serve-points"),
    ];

    pub fn from_name(name: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(_, known)| *known == name);
        found.map(|(role, _)| *role)
    }
}

/// A server process; it ends with this value.
pub struct Running {
    child: Child,
    pub addresses: Vec<SocketAddr>,
}

impl Running {
    pub fn start(role: Role) -> Result<Self, Box<dyn std::error::Error>> {
        let name = Role::ALL.iter().find(|(known, _)| *known == role);
        let mut child = Command::new(std::env::current_exe()?)
            .args(name.map(|(_, name)| name))
            .stdout(Stdio::piped())
            .spawn()?;
        let out = child.stdout.take().ok_or("no stdout")?;
        let mut line = String::new();
        BufReader::new(out).read_line(&mut line)?;
        let addresses = line
            .split_whitespace()
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        Ok(Self { child, addresses })
    }

    /// Memory in use, KiB.
    #[allow(clippy::disallowed_methods)] // The system's own figures of a process are files.
    pub fn resident_kib(&self) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
        line.split_whitespace().nth(1)?.parse().ok()
    }

    /// Open descriptors.
    #[allow(clippy::disallowed_methods)] // As above.
    pub fn descriptors(&self) -> Option<usize> {
        let list = std::fs::read_dir(format!("/proc/{}/fd", self.child.id())).ok()?;
        Some(list.count())
    }

    /// The same once no more than `wanted` are left, or after a while.
    pub fn descriptors_at_rest(&self, wanted: usize) -> usize {
        for _ in 0..100 {
            if self.descriptors().is_some_and(|count| count <= wanted) {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        self.descriptors().unwrap_or(usize::MAX)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Serves until it is killed.
pub fn be(role: Role) -> Result<(), Box<dyn std::error::Error>> {
    if role == Role::Echo {
        return Ok(echo()?);
    }
    let count = if role == Role::Points { SESSIONS } else { 1 };
    let ports = bind(&vec!["127.0.0.1:0".parse()?; count])?;
    announce(ports.addresses())?;
    let (limits, stop) = (Limits::default(), Stop::on_signals());
    if role == Role::Cell {
        let station = cell()?;
        serve(ports, station, limits, |_| {}, None, stop)?;
    } else {
        serve(ports, Points::new()?, limits, |_| {}, None, stop)?;
    }
    Ok(())
}

fn announce(addresses: &[SocketAddr]) -> std::io::Result<()> {
    let mut out = std::io::stdout();
    let addresses: Vec<String> = addresses.iter().map(SocketAddr::to_string).collect();
    writeln!(out, "{}", addresses.join(" "))?;
    out.flush()
}

fn cell() -> Result<Station, Box<dyn std::error::Error>> {
    let scene = Scene::demo(&[], None).map_err(|errors| errors.to_string())?;
    let mut spec = scene.cell_spec()?;
    for port in &mut spec.interface.ports {
        port.encoding = Encoding::Ascii;
    }
    Ok(Station::new(spec, || 0.0, compute_on_thread()?)?)
}

/// Sessions with a stand-in for vision.
struct Points {
    server: Server,
    points: Vec<VisionPoint>,
    tick: u64,
    replies: VecDeque<StationReply>,
}

impl Points {
    fn new() -> Result<Self, Box<dyn std::error::Error>> {
        let point = |n: u32| VisionPoint {
            base_from_object: Pose::new(
                Vector::new(0.5 + 0.01234567 * f64::from(n), -0.3, 0.45),
                Vector::z() * 0.1 * f64::from(n),
            ),
            label: n as i32,
        };
        Ok(Self {
            server: Server::new(ServerSettings {
                ports: vec![PortSettings::default(); SESSIONS],
                ..ServerSettings::default()
            })?,
            points: (1..=20).map(point).collect(),
            tick: 0,
            replies: VecDeque::new(),
        })
    }

    fn now(&self) -> SimTime {
        SimTime::from_nanos(self.tick * TICK.as_nanos())
    }

    fn follow_up(&mut self) {
        let now = self.now();
        while let Some(job) = self.server.poll_job() {
            if let Job::RunVision { job_id, .. } = job {
                let points = Ok(self.points.clone());
                self.server.finish_vision(now, job_id, points);
            }
        }
        while let Some(reply) = self.server.poll_reply() {
            self.replies.push_back(StationReply {
                tick: self.tick,
                port: reply.port,
                connection: reply.connection,
                bytes: reply.bytes,
                closes: reply.closes,
            });
        }
    }
}

impl SessionHost for Points {
    fn encodings(&self) -> Vec<Encoding> {
        vec![Encoding::Ascii; SESSIONS]
    }

    fn tick(&self) -> u64 {
        self.tick
    }

    fn connect(&mut self, port: PortId, connection: ConnectionId) {
        self.server.handle_connect(self.now(), port, connection);
    }

    fn receive(&mut self, port: PortId, connection: ConnectionId, bytes: &[u8]) {
        let now = self.now();
        self.server.handle_input(now, port, connection, bytes);
        self.follow_up();
    }

    fn disconnect(&mut self, port: PortId, connection: ConnectionId) {
        let now = self.now();
        self.server.handle_disconnect(now, port, connection);
    }

    fn is_waiting(&self, port: PortId, connection: ConnectionId) -> bool {
        self.server.is_waiting(port, connection)
    }

    fn awaits_run(&self, port: PortId, connection: ConnectionId) -> bool {
        self.server.awaits_run(port, connection)
    }

    fn next_due(&self) -> Option<u64> {
        let due = self.server.poll_timeout()?;
        Some(due.as_nanos().div_ceil(TICK.as_nanos()).max(self.tick + 1))
    }

    fn advance(&mut self, target: u64) -> u64 {
        self.tick = self.tick.max(target);
        let now = self.now();
        if self.server.poll_timeout().is_some_and(|due| due <= now) {
            self.server.handle_timeout(now);
            self.follow_up();
        }
        self.tick
    }

    fn poll_reply(&mut self) -> Option<StationReply> {
        self.replies.pop_front()
    }

    fn poll_log(&mut self) -> Option<LogEntry> {
        self.server.poll_log()
    }

    fn poll_event(&mut self) -> Option<(PortId, Event)> {
        None
    }
}

/// Answers every line at once, on one thread.
fn echo() -> std::io::Result<()> {
    let point = ",512.3457,-300.0,450.0,5.7296,0.0,180.0,1,0";
    let long = format!("102,1100,1,20,0{}\r", point.repeat(20));
    let answer = move |command: u8| match command {
        b'1' => long.clone().into_bytes(),
        _ => b"901,1101\r".to_vec(),
    };
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await?;
        announce(&[listener.local_addr()?])?;
        loop {
            let (mut stream, _) = listener.accept().await?;
            let answer = answer.clone();
            tokio::spawn(async move {
                stream.set_nodelay(true)?;
                let mut buffer = vec![0; 4096];
                loop {
                    let count = stream.read(&mut buffer).await?;
                    if count == 0 {
                        return Ok::<(), Error>(());
                    }
                    if buffer[..count].starts_with(b"101") {
                        stream.write_all(b"101,1102\r").await?;
                    } else {
                        stream.write_all(&answer(buffer[0])).await?;
                    }
                }
            });
        }
    })
}
