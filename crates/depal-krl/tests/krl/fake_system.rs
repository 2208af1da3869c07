//! A cabinet that writes down what is asked of it. Moves take 100 ms each; a statement 20 us; a tick 4 ms.
//! Its arm is a drawer: A1, A2, A3 in degrees are the flange's x, y, z in decimetres.

use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_frames::{EulerConvention, JointPositions, Point, Pose};
use depal_krl::load;
use depal_syntax::SourceFile;
use depal_time::{SimDuration, SimTime};
use depal_vm::execution::Step;
use depal_vm::system::*;
pub use depal_vm::testing::run;
use depal_vm::testing::{Timed, program};
use depal_vm::{Machine, Value};

/// Where the times of moves lie that are put aside.
const AWAY: SimTime = SimTime::from_nanos(1_000_000_000_000_000);

pub struct Motion {
    pub begin: SimTime,
    pub end: SimTime,
    pub to: JointPositions,
    pub events: Vec<PathEvent>,
}

pub struct FakeSystem {
    pub now: SimTime,
    pub trace: Vec<String>,
    pub signals: BTreeMap<String, f64>,
    /// Signal changes to come.
    pub changes: Vec<(SimTime, String, f64)>,
    pub moves: Vec<Motion>,
    pub held: Option<SimTime>,
    /// When the path that is put aside was held.
    pub aside: Option<SimTime>,
    pub refuse_move: Option<usize>,
    pub answers: VecDeque<String>,
    pub joint_count: usize,
    pub last: Option<MoveRequest>,
    /// Loads that the program told with its moves: of the tool (kg, m in the flange frame), or what was carried.
    pub loads: Vec<String>,
}

impl Default for FakeSystem {
    fn default() -> Self {
        let numbers = 1..=16;
        let names = numbers.flat_map(|n| [format!("$IN[{n}]"), format!("$OUT[{n}]")]);
        let analogue = ["$ANIN[1]", "$ANOUT[1]"].map(str::to_owned);
        Self {
            now: SimTime::ZERO,
            trace: Vec::new(),
            signals: names.chain(analogue).map(|n| (n, 0.0)).collect(),
            changes: Vec::new(),
            moves: Vec::new(),
            held: None,
            aside: None,
            refuse_move: None,
            answers: VecDeque::new(),
            joint_count: 6,
            last: None,
            loads: Vec::new(),
        }
    }
}

pub fn signals() -> Vec<String> {
    FakeSystem::default().signals.into_keys().collect()
}

pub fn sources(files: &[(&str, &str)]) -> Vec<SourceFile> {
    let files = files.iter();
    files
        .map(|(name, text)| SourceFile::new(*name, *text))
        .collect()
}

pub fn machine(files: &[(&str, &str)]) -> Machine {
    let sources = sources(files);
    let loaded = load(&sources, &signals(), "main");
    Machine::new(program(loaded, &sources), "T_ROB1")
}

/// The trace of a program, with how it ended unless that is its end.
pub fn run_files(files: &[(&str, &str)]) -> Vec<String> {
    let mut system = FakeSystem::default();
    let mut machine = machine(files);
    let end = run(&mut machine, &mut system);
    match end {
        Step::Finished => {}
        Step::Failed(error) => {
            let report = error.report(system.now);
            system
                .trace
                .push(report.lines().next().unwrap_or_default().into());
        }
        end => system.trace.push(format!("{end:?}")),
    }
    system.trace
}

/// `main` with these declarations and statements.
pub fn main_of(declarations: &str, statements: &str) -> String {
    format!("DEF main( )\n{declarations}\n{statements}\nEND\n")
}

/// The messages of statements in `main`.
pub fn output(declarations: &str, statements: &str) -> Vec<String> {
    run_files(&[("main.src", &main_of(declarations, statements))])
}

/// The value of an INT expression.
pub fn shown(declarations: &str, statements: &str, expression: &str) -> String {
    let statements = format!("{statements}\nMsgNotify(\"%1\", {expression})");
    output(declarations, &statements).join("|")
}

pub fn global(machine: &Machine, name: &str) -> Value {
    machine.global(name).expect("declared").clone()
}

impl FakeSystem {
    fn note(&mut self, text: String) {
        let at = self.now.as_secs_f64();
        self.trace.push(format!("{at:.3} {text}"));
    }

    /// Outputs along moves and signal changes whose time has come.
    pub fn catch_up(&mut self) {
        let now = self.now;
        let mut due = Vec::new();
        let held = self.held.is_some();
        for motion in self.moves.iter_mut().filter(|_| !held) {
            let (begin, end) = (motion.begin, motion.end);
            motion.events.retain(|event| {
                let at = match event.place {
                    PathPlace::AfterStart(_) => begin,
                    PathPlace::BeforeEnd(_) => end,
                };
                let passed = at + event.delay <= now + event.lead;
                if passed && let depal_vm::system::PathAction::Set { signal, value } = &event.action
                {
                    due.push((signal.clone(), *value));
                }
                !passed
            });
        }
        for (name, value) in due {
            self.note(format!("{name} = {value} on the way"));
            self.signals.insert(name, value);
        }
        let (due, later): (Vec<_>, Vec<_>) = std::mem::take(&mut self.changes)
            .into_iter()
            .partition(|(at, ..)| *at <= now);
        self.changes = later;
        for (_, name, value) in due {
            self.signals.insert(name, value);
        }
    }

    fn clock(&self) -> SimTime {
        self.held.unwrap_or(self.now)
    }
}

impl Timed for FakeSystem {
    fn set_time(&mut self, now: SimTime) {
        self.now = now;
        self.catch_up();
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
        self.signal(name)?;
        self.signals.insert(name.into(), value);
        self.note(format!("{name} = {value}"));
        Ok(())
    }

    fn set_signal_later(
        &mut self,
        name: &str,
        value: f64,
        delay: SimDuration,
    ) -> Result<(), Fault> {
        self.signal(name)?;
        self.changes.push((self.now + delay, name.into(), value));
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
        self.start_move_with_events(request, &[])
    }

    fn start_move_with_events(
        &mut self,
        request: &MoveRequest,
        events: &[PathEvent],
    ) -> Poll<Result<MoveId, Fault>> {
        if self.refuse_move == Some(self.moves.len()) {
            self.refuse_move = None;
            return Poll::Ready(Err(Fault::OutOfReach {
                message: "the wrist would be 4.2 m away, at most 3.2 m".into(),
            }));
        }
        let (target, to) = match &request.target {
            MoveTarget::Joints(joints) => (format!("joints {:.1?}", joints.to_degrees()), *joints),
            MoveTarget::Tcp(pose) | MoveTarget::Arc { to: pose, .. } => {
                let [x, y, z, a, b, c] = EulerConvention::KukaAbc.mm_deg_from_pose(pose);
                let round = |v: f64| (v * 10.0).round() / 10.0 + 0.0;
                let [x, y, z, a, b, c] = [x, y, z, a, b, c].map(round);
                let flange = pose * request.flange_from_tcp.inverse();
                let near = self.planned_joints();
                let joints = self.inverse(&flange, &near).unwrap_or(near);
                (format!("tcp {x} {y} {z} {a} {b} {c}"), joints)
            }
        };
        let zone = match request.zone {
            MoveZone::Fine => "fine".to_owned(),
            MoveZone::Fly { tcp, .. } => format!("fly {:.1}", tcp * 1e3),
        };
        let speed = match request.kind {
            MoveKind::Joint => format!("{:.2} of the joints", request.speed.joint_fraction),
            MoveKind::Linear => format!("{:.3} m/s", request.speed.tcp),
        };
        self.note(format!(
            "line {} {:?} {target} at {speed} {zone}",
            request.location.line, request.kind
        ));
        let here = self.moves.iter().filter(|m| m.begin < AWAY);
        let begin = here.map(|m| m.end).fold(self.now, SimTime::max);
        self.moves.push(Motion {
            begin,
            end: begin + SimDuration::from_millis(100),
            to,
            events: events.to_vec(),
        });
        self.last = Some(request.clone());
        Poll::Ready(Ok(MoveId(self.moves.len() as u64 - 1)))
    }

    fn is_move_done(&self, id: MoveId) -> Result<bool, Fault> {
        let motion = self.moves.get(id.0 as usize);
        Ok(motion.is_none_or(|m| m.end <= self.clock()))
    }

    fn is_move_begun(&self, id: MoveId) -> bool {
        let motion = self.moves.get(id.0 as usize);
        motion.is_none_or(|m| m.begin <= self.clock())
    }

    fn is_standing(&self) -> bool {
        self.moves.iter().all(|m| m.end <= self.clock())
    }

    fn hold_motion(&mut self) -> Poll<Result<(), Fault>> {
        if self.held.is_none() {
            self.note("hold".into());
            self.held = Some(self.now);
        }
        Poll::Ready(Ok(()))
    }

    fn resume_motion(&mut self) -> Result<(), Fault> {
        if let Some(held) = self.held.take() {
            let later = self.now.saturating_since(held);
            for motion in self.moves.iter_mut().filter(|m| m.end > held) {
                motion.begin += later;
                motion.end += later;
            }
            self.note("go on".into());
        }
        Ok(())
    }

    fn clear_path(&mut self) -> Result<(), Fault> {
        let clock = self.clock();
        self.note("clear".into());
        for motion in self.moves.iter_mut().filter(|m| m.end > clock) {
            motion.end = clock;
            motion.events.clear();
        }
        Ok(())
    }

    fn store_path(&mut self) -> Poll<Result<(), Fault>> {
        self.note("store".into());
        let held = self.held.take().unwrap_or(self.now);
        for motion in self.moves.iter_mut().filter(|m| m.end > held) {
            motion.begin += AWAY.saturating_since(SimTime::ZERO);
            motion.end += AWAY.saturating_since(SimTime::ZERO);
        }
        self.aside = Some(held);
        Poll::Ready(Ok(()))
    }

    fn restore_path(&mut self) -> Result<(), Fault> {
        self.note("restore".into());
        for motion in self.moves.iter_mut().filter(|m| m.begin >= AWAY) {
            motion.begin = SimTime::ZERO + motion.begin.saturating_since(AWAY);
            motion.end = SimTime::ZERO + motion.end.saturating_since(AWAY);
        }
        self.held = self.aside.take();
        Ok(())
    }

    fn stop_motion(&mut self) {
        self.moves.clear();
    }

    fn joints(&self) -> JointPositions {
        let mut over = self.moves.iter().filter(|m| m.end <= self.clock());
        over.next_back()
            .map_or(JointPositions::zeros(self.joint_count), |m| m.to)
    }

    fn planned_joints(&self) -> JointPositions {
        let last = self.moves.last();
        last.map_or(JointPositions::zeros(self.joint_count), |m| m.to)
    }

    fn forward(&self, joints: &JointPositions) -> Pose {
        let angles = joints.to_degrees();
        Pose::translation(angles[0] / 10.0, angles[1] / 10.0, angles[2] / 10.0)
    }

    fn inverse(&self, pose: &Pose, near: &JointPositions) -> Result<JointPositions, Fault> {
        let p = pose.translation.vector;
        if p.norm() > 10.0 {
            return Err(Fault::OutOfReach {
                message: format!("{:.1} m away, at most 10 m", p.norm()),
            });
        }
        let mut degrees = near.to_degrees();
        degrees[..3].copy_from_slice(&[p.x * 10.0, p.y * 10.0, p.z * 10.0]);
        Ok(JointPositions::from_degrees(&degrees))
    }

    fn socket_create(&mut self) -> SocketId {
        SocketId(0)
    }

    fn socket_connect(&mut self, _: SocketId, _: &str, _: u16) -> Poll<Result<(), Fault>> {
        Poll::Ready(Err(Fault::SocketClosed))
    }

    fn socket_send(&mut self, _: SocketId, _: &[u8]) -> Result<(), Fault> {
        Err(Fault::SocketClosed)
    }

    fn socket_receive(&mut self, _: SocketId, _: usize) -> Poll<Result<Received, Fault>> {
        Poll::Ready(Err(Fault::SocketClosed))
    }

    fn socket_close(&mut self, _: SocketId) {}

    fn socket_state(&self, _: SocketId) -> SocketState {
        SocketState::Closed
    }

    fn answer(&mut self, _: &Question) -> Poll<String> {
        self.answers.pop_front().map_or(Poll::Pending, Poll::Ready)
    }

    fn log(&mut self, _: LogKind, _: &ProgramLocation, text: &str) {
        self.trace.push(text.into());
    }

    fn statement(&mut self, _: &ProgramLocation) {}
}
