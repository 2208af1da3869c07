//! A cabinet that writes down what is asked of it. Moves take 100 ms each; a statement 20 us; a tick 4 ms.

use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_frames::{JointPositions, Point, Pose};
use depal_rapid::{SignalDefinition, SignalKind, load};
use depal_time::{SimDuration, SimTime, TICK};
use depal_vm::execution::{RobotTask, Step};
use depal_vm::system::*;
use depal_vm::{Machine, SourceFile, Value};

#[derive(Clone)]
pub struct FakeSystem {
    pub now: SimTime,
    pub trace: Vec<String>,
    pub signals: BTreeMap<String, f64>,
    /// Signal changes to come.
    pub changes: Vec<(SimTime, String, f64)>,
    pub moves: Vec<SimTime>,
    pub refuse_move: Option<usize>,
    /// Bytes that the peer sends, each so long after the one before was asked for.
    pub replies: VecDeque<(SimDuration, Vec<u8>)>,
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
        let names = ["di_part", "do_pump", "go_zone", "gi_count", "ao_flow"];
        Self {
            now: SimTime::ZERO,
            trace: Vec::new(),
            signals: names.iter().map(|n| ((*n).to_owned(), 0.0)).collect(),
            changes: Vec::new(),
            moves: Vec::new(),
            refuse_move: None,
            replies: VecDeque::new(),
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

pub fn signals() -> Vec<SignalDefinition> {
    [
        ("di_part", SignalKind::Di),
        ("do_pump", SignalKind::Do),
        ("go_zone", SignalKind::Go),
        ("gi_count", SignalKind::Gi),
        ("ao_flow", SignalKind::Ao),
    ]
    .map(|(name, kind)| SignalDefinition {
        name: name.into(),
        kind,
    })
    .to_vec()
}

pub fn machine(text: &str) -> Machine {
    let source = SourceFile::new("test.mod", text);
    let loaded = load(std::slice::from_ref(&source), &signals(), "main");
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(std::slice::from_ref(&source)))
        .collect();
    Machine::new(
        loaded
            .program
            .unwrap_or_else(|| panic!("{}", shown.join("\n"))),
        "T_ROB1",
    )
}

/// Runs to the end, at most 1000 simulated seconds.
pub fn run(machine: &mut Machine, system: &mut FakeSystem) -> Step {
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

/// Runs a body of `main` with module data and gives back what the program wrote and how it ended.
pub fn run_text(text: &str) -> Vec<String> {
    let mut system = FakeSystem::default();
    let mut machine = machine(text);
    let end = run(&mut machine, &mut system);
    if end != Step::Finished {
        system.trace.push(format!("{end:?}"));
    }
    system.trace
}

/// The operator lines of statements in `main`.
pub fn output(data: &str, statements: &str) -> Vec<String> {
    let text = format!("MODULE m\n{data}\nPROC main()\n{statements}\nENDPROC\nENDMODULE\n");
    run_text(&text)
}

pub fn global(machine: &Machine, name: &str) -> Value {
    machine.global(name).expect("declared").clone()
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

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        if name == "go_zone" && value > 15.0 {
            return Err(Fault::SignalValue {
                signal: name.into(),
                message: format!("{value} is above 15"),
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
        self.moves.clear();
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
        self.note(format!("send {bytes:?}"));
        self.sent.push(bytes.to_vec());
        if let Some((delay, reply)) = self.replies.pop_front() {
            let at = self.now + delay;
            self.inbox.extend(reply.into_iter().map(|byte| (at, byte)));
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
