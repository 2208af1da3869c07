//! A cabinet that writes down what is asked of it. Moves take 100 ms each; a statement 20 us; a tick 4 ms.

use crate::vision::Vision;
use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_frames::{JointPositions, Point, Pose};
use depal_time::{SimDuration, SimTime, TICK};
use depal_tp::{Options, Tasks, decimal, load, written_registers};
use depal_vm::SourceFile;
use depal_vm::execution::{RobotTask, Step};
use depal_vm::system::*;

pub struct FakeSystem {
    pub now: SimTime,
    pub trace: Vec<String>,
    pub signals: BTreeMap<String, f64>,
    /// Signal changes to come.
    pub changes: Vec<(SimTime, String, f64)>,
    pub moves: Vec<SimTime>,
    pub refuse_move: Option<usize>,
    /// Replies to requests of 64 bytes: pieces, each so long after the request.
    pub replies: VecDeque<Vec<(SimDuration, Vec<u8>)>>,
    /// A vision system in this process instead of a script.
    pub vision: Option<Box<Vision>>,
    pub outgoing: Vec<u8>,
    pub writes: usize,
    pub inbox: Vec<(SimTime, u8)>,
    pub sent: Vec<Vec<u8>>,
    pub sockets: Vec<SocketState>,
    pub peer_closes_at: Option<SimTime>,
    pub connect_after: Option<SimDuration>,
    pub connecting_since: Option<SimTime>,
    pub statements: usize,
    /// Where the arm is instead of the usual place.
    pub arm: Option<(JointPositions, Pose)>,
    /// Loads that the program told with its moves: of the tool (kg, m in the flange frame), or what was carried.
    pub loads: Vec<String>,
}

impl Default for FakeSystem {
    fn default() -> Self {
        let names = [
            "DI[1]", "DI[2]", "DO[1]", "DO[2]", "RI[1]", "RO[1]", "GI[1]", "GO[1]", "AI[1]",
            "AO[1]",
        ];
        Self {
            now: SimTime::ZERO,
            trace: Vec::new(),
            signals: names.iter().map(|n| ((*n).to_owned(), 0.0)).collect(),
            changes: Vec::new(),
            moves: Vec::new(),
            refuse_move: None,
            replies: VecDeque::new(),
            vision: None,
            outgoing: Vec::new(),
            writes: 0,
            inbox: Vec::new(),
            sent: Vec::new(),
            sockets: Vec::new(),
            peer_closes_at: None,
            connect_after: Some(SimDuration::ZERO),
            connecting_since: None,
            statements: 0,
            arm: None,
            loads: Vec::new(),
        }
    }
}

/// A listing of one program, `MAIN`, with numbered lines.
pub fn listing(lines: &[&str], positions: &str) -> String {
    program("MAIN", lines, positions)
}

pub fn program(name: &str, lines: &[&str], positions: &str) -> String {
    use std::fmt::Write;
    let mut text = format!("/PROG  {name}\n/ATTR\n/MN\n");
    for (index, line) in lines.iter().enumerate() {
        writeln!(text, "{:4}:  {line} ;", index + 1).expect("writing to a string works");
    }
    text + "/POS\n" + positions + "/END\n"
}

/// A taught position in user frame 0 with tool 1.
pub fn taught(number: u32, values: [f64; 6]) -> String {
    let [x, y, z, w, p, r] = values;
    format!(
        "P[{number}]{{\n   GP1:\n\tUF : 0, UT : 1,\tCONFIG : 'N U T, 0, 0, 0',\n\tX = {x} mm,\tY = {y} mm,\tZ = {z} mm,\n\tW = {w} deg,\tP = {p} deg,\tR = {r} deg\n}};\n"
    )
}

pub fn machine_with(texts: &[String], options: &Options) -> Tasks {
    let sources: Vec<_> = texts
        .iter()
        .map(|t| SourceFile::new("TEST.LS", t.clone()))
        .collect();
    let loaded = load(&sources, options, "MAIN");
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(&sources))
        .collect();
    let program = loaded
        .program
        .unwrap_or_else(|| panic!("{}", shown.join("\n")));
    Tasks::new(program, "TP")
}

/// What a run left behind.
pub struct Left {
    pub trace: Vec<String>,
    pub registers: Vec<String>,
    /// Empty if the program came to its end.
    pub end: String,
    pub system: FakeSystem,
}

/// How a program ended, in a line.
pub fn ended(end: &Step) -> String {
    match end {
        Step::Finished => String::new(),
        Step::Stopped(reason) => format!("stopped: {reason}"),
        Step::Failed(error) => {
            let report = error.report(SimTime::ZERO);
            report.lines().next().unwrap_or_default().to_owned()
        }
        other => format!("{other:?}"),
    }
}

pub fn run_all(texts: &[String], options: &Options, mut system: FakeSystem) -> Left {
    let mut machine = machine_with(texts, options);
    let end = run(&mut machine, &mut system);
    let registers = written_registers(machine.memory());
    Left {
        trace: system.trace.clone(),
        registers: registers
            .iter()
            .map(|(n, v)| format!("R[{n}]={}", decimal(*v)))
            .collect(),
        end: ended(&end),
        system,
    }
}

pub fn run_text(text: &str) -> Left {
    run_all(
        &[text.to_owned()],
        &Options::default(),
        FakeSystem::default(),
    )
}

/// Runs lines of `MAIN` with two taught positions.
pub fn lines(lines: &[&str]) -> Left {
    let positions = taught(1, [1000.0, 0.0, 500.0, 180.0, 0.0, 0.0])
        + &taught(2, [1000.0, 500.0, 500.0, 180.0, 0.0, 90.0]);
    run_text(&listing(lines, &positions))
}

/// The registers that lines of `MAIN` wrote; they must come to their end.
pub fn registers(text: &[&str]) -> String {
    let left = lines(text);
    assert_eq!(left.end, "", "{text:?}");
    left.registers.join(" ")
}

/// Runs to the end, at most 1000 simulated seconds.
pub fn run(machine: &mut Tasks, system: &mut FakeSystem) -> Step {
    loop {
        match machine.step(system) {
            Step::Ran => system.now += SimDuration::from_micros(20),
            Step::Blocked => {
                let ticks = system.now.as_nanos() / TICK.as_nanos() + 1;
                system.now = SimTime::from_nanos(ticks * TICK.as_nanos());
            }
            end => return end,
        }
        let now = system.now;
        let (due, later) = std::mem::take(&mut system.changes)
            .into_iter()
            .partition(|(at, ..)| *at <= now);
        system.changes = later;
        let due: Vec<(SimTime, String, f64)> = due;
        for (_, name, value) in due {
            system.signals.insert(name, value);
        }
        assert!(
            now < SimTime::from_nanos(1_000_000_000_000),
            "hangs at {:?}",
            machine.location()
        );
    }
}

impl FakeSystem {
    fn note(&mut self, text: String) {
        let at = self.now.as_secs_f64();
        self.trace.push(format!("{at:.3} {text}"));
    }
}

impl System for FakeSystem {
    fn now(&self) -> SimTime {
        self.now
    }

    fn signal(&self, name: &str) -> Result<f64, Fault> {
        let found = self.signals.get(name).copied();
        found.ok_or_else(|| Fault::UnknownSignal(name.into()))
    }

    fn set_signal_later(
        &mut self,
        name: &str,
        value: f64,
        delay: SimDuration,
    ) -> Result<(), Fault> {
        self.changes
            .push((self.now + delay, name.to_owned(), value));
        Ok(())
    }

    fn start_move_with_events(
        &mut self,
        request: &MoveRequest,
        events: &[PathEvent],
    ) -> Poll<Result<MoveId, Fault>> {
        for event in events {
            let PathAction::Set { signal, value } = &event.action else {
                continue;
            };
            self.note(format!(
                "{signal} = {value} {:?} lead {:.3} delay {:.3}",
                event.place,
                event.lead.as_secs_f64(),
                event.delay.as_secs_f64()
            ));
        }
        self.start_move(request)
    }

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        if !self.signals.contains_key(name) {
            return Err(Fault::UnknownSignal(name.into()));
        }
        if name == "GO[1]" && value > 65535.0 {
            return Err(Fault::SignalValue {
                signal: name.into(),
                message: format!("{value} is above 65535"),
            });
        }
        self.signals.insert(name.into(), value);
        self.note(format!("{name} = {value}"));
        Ok(())
    }

    fn set_tool_load(&mut self, load: Option<(f64, Point)>) {
        let text = match load {
            Some((mass, at)) => format!("tool {mass} at {:.3} {:.3} {:.3}", at.x, at.y, at.z),
            None => "as set up".to_owned(),
        };
        if self.loads.last() != Some(&text) {
            self.loads.push(text);
        }
    }

    fn set_payload(&mut self, mass: f64, at: Point) {
        let text = format!("carried {mass} at {:.3} {:.3} {:.3}", at.x, at.y, at.z);
        self.loads.push(text);
    }

    fn start_move(&mut self, request: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        let open = self.moves.iter().filter(|end| **end > self.now).count();
        if open >= 3 {
            return Poll::Pending;
        }
        if self.refuse_move == Some(self.moves.len()) {
            self.refuse_move = None;
            return Poll::Ready(Err(Fault::OutOfReach {
                message: "the wrist would be 4.2 m away, at most 3.2 m".into(),
            }));
        }
        let target = match &request.target {
            MoveTarget::Joints(joints) => format!("joints {:.1?}", joints.to_degrees()),
            MoveTarget::Tcp(pose) | MoveTarget::Arc { to: pose, .. } => {
                let p = pose.translation.vector;
                format!("tcp {:.4} {:.4} {:.4}", p.x, p.y, p.z)
            }
        };
        let zone = match request.zone {
            MoveZone::Fine => "fine".to_owned(),
            MoveZone::Fly { tcp, .. } => format!("fly {tcp:.4}"),
            MoveZone::Blend { joints } => format!("blend {joints:.4}"),
        };
        self.note(format!(
            "line {} {:?} {target} at {:.3} m/s {zone} tool z {:.3}",
            request.location.line,
            request.kind,
            request.speed.tcp,
            request.flange_from_tcp.translation.z
        ));
        let begin = self.moves.last().copied().unwrap_or_default().max(self.now);
        self.moves.push(begin + SimDuration::from_millis(100));
        Poll::Ready(Ok(MoveId(self.moves.len() as u64 - 1)))
    }

    fn is_move_done(&self, id: MoveId) -> Result<bool, Fault> {
        Ok(self.moves[id.0 as usize] <= self.now)
    }

    fn is_standing(&self) -> bool {
        self.moves.iter().all(|end| *end <= self.now)
    }

    fn stop_motion(&mut self) {
        self.note("stop".into());
        let now = self.now;
        self.moves.iter_mut().for_each(|end| *end = (*end).min(now));
    }

    fn joints(&self) -> JointPositions {
        if let Some((joints, _)) = self.arm {
            return joints;
        }
        JointPositions::from_degrees(&[10.0, 20.0, 30.0, 40.0, 50.0, 60.0])
    }

    fn planned_joints(&self) -> JointPositions {
        self.joints()
    }

    fn forward(&self, joints: &JointPositions) -> Pose {
        if let Some((_, flange)) = self.arm {
            return flange;
        }
        let angles = joints.to_degrees();
        Pose::translation(angles[0] / 10.0, angles[1] / 10.0, angles[2] / 10.0)
    }

    fn inverse(&self, pose: &Pose, _: &JointPositions) -> Result<JointPositions, Fault> {
        let p = pose.translation.vector;
        if p.norm() > 10.0 {
            return Err(Fault::OutOfReach {
                message: format!("{:.1} m away, at most 10 m", p.norm()),
            });
        }
        let degrees = [p.x * 10.0, p.y * 10.0, p.z * 10.0, 0.0, 0.0, 0.0];
        Ok(JointPositions::from_degrees(&degrees))
    }

    fn socket_create(&mut self) -> SocketId {
        self.sockets.push(SocketState::Created);
        SocketId(self.sockets.len() as u32 - 1)
    }

    fn socket_connect(
        &mut self,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        let Some(delay) = self.connect_after else {
            return Poll::Ready(Err(Fault::SocketClosed));
        };
        let since = *self.connecting_since.get_or_insert(self.now);
        if self.now.saturating_since(since) < delay {
            return Poll::Pending;
        }
        self.note(format!("connect {address}:{port}"));
        self.sockets[socket.0 as usize] = SocketState::Connected;
        Poll::Ready(Ok(()))
    }

    fn socket_send(&mut self, _: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        if self.peer_closes_at.is_some_and(|at| at <= self.now) {
            return Err(Fault::SocketClosed);
        }
        self.writes += 1;
        self.outgoing.extend(bytes);
        if let Some(vision) = &mut self.vision {
            vision.take(self.now, bytes);
        }
        while self.outgoing.len() >= 64 {
            let frame: Vec<u8> = self.outgoing.drain(..64).collect();
            self.sent.push(frame);
            for (delay, piece) in self.replies.pop_front().unwrap_or_default() {
                let at = self.now + delay;
                self.inbox.extend(piece.into_iter().map(|byte| (at, byte)));
            }
        }
        Ok(())
    }

    fn socket_receive(&mut self, socket: SocketId, limit: usize) -> Poll<Result<Received, Fault>> {
        if self.sockets[socket.0 as usize] != SocketState::Connected {
            return Poll::Ready(Err(Fault::SocketState {
                message: "not connected".into(),
            }));
        }
        let now = self.now;
        if let Some(vision) = &mut self.vision {
            let arrived = vision.pump(now);
            self.inbox
                .extend(arrived.into_iter().map(|byte| (now, byte)));
        }
        let here = self.inbox.iter().take_while(|(at, _)| *at <= now).count();
        if here == 0 {
            if self.peer_closes_at.is_some_and(|at| at <= now) {
                return Poll::Ready(Ok(Received::Closed));
            }
            return Poll::Pending;
        }
        let taken = self.inbox.drain(..here.min(limit)).map(|(_, b)| b);
        Poll::Ready(Ok(Received::Data(taken.collect())))
    }

    fn socket_close(&mut self, socket: SocketId) {
        self.note("close".into());
        self.sockets[socket.0 as usize] = SocketState::Closed;
    }

    fn socket_state(&self, socket: SocketId) -> SocketState {
        self.sockets[socket.0 as usize]
    }

    fn log(&mut self, kind: LogKind, _: &ProgramLocation, text: &str) {
        match kind {
            LogKind::Operator => self.trace.push(text.into()),
            LogKind::EventLog => self.trace.push(format!("log: {text}")),
        }
    }

    fn statement(&mut self, _: &ProgramLocation) {
        self.statements += 1;
    }
}
