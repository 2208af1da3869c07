use std::collections::BTreeMap;
use std::task::Poll;

use depal_frames::{JointPositions, Point, Pose};
use depal_time::{SimDuration, SimTime};

use super::Timed;
use crate::system::{
    Fault, LogKind, MoveId, MoveRequest, MoveTarget, MoveZone, PathAction, PathEvent,
    ProgramLocation, Received, SocketId, SocketState, System,
};

/// Most moves in the queue.
const QUEUE: usize = 3;

/// What is on the other side of a cabinet's signals and sockets.
pub trait Peer: Default {
    /// All signals, and the greatest value that each takes.
    const SIGNALS: &'static [(&'static str, f64)];

    /// Takes what the program sent, and says what of it goes into the trace.
    fn take(&mut self, now: SimTime, bytes: &[u8]) -> Option<String>;

    /// At most so many bytes of what has arrived at the program by now.
    fn give(&mut self, now: SimTime, limit: usize) -> Vec<u8>;
}

/// A cabinet that writes down what is asked of it. A move takes 100 ms.
///
/// Its joints always show 10, 20 .. 60 degrees, and of any joints the flange stands at a tenth of the first three
/// degrees in metres, unless [`arm`](Self::arm) says otherwise; positions of more than 10 m are out of reach.
#[derive(Debug, Clone)]
pub struct RecordingCabinet<P> {
    /// The time.
    pub now: SimTime,
    /// What was asked, with the time in seconds, and all messages.
    pub trace: Vec<String>,
    /// Values of all signals.
    pub signals: BTreeMap<String, f64>,
    /// Signal changes to come.
    pub changes: Vec<(SimTime, String, f64)>,
    /// When each move ends.
    pub moves: Vec<SimTime>,
    /// The move that is out of reach, counted from 0.
    pub refuse_move: Option<usize>,
    /// The other side.
    pub peer: P,
    /// The state of each socket.
    pub sockets: Vec<SocketState>,
    /// When the other end of all sockets closes.
    pub peer_closes_at: Option<SimTime>,
    /// How long connecting takes; `None` is refused.
    pub connect_after: Option<SimDuration>,
    /// When the program first asked to be connected.
    pub connecting_since: Option<SimTime>,
    /// How many statements began.
    pub statements: usize,
    /// Where the arm is instead of the usual place.
    pub arm: Option<(JointPositions, Pose)>,
    /// Loads that the program told with its moves: of the tool (kg, m in the flange frame), or what was carried.
    pub loads: Vec<String>,
}

impl<P: Peer> Default for RecordingCabinet<P> {
    fn default() -> Self {
        let signals = P::SIGNALS.iter();
        Self {
            now: SimTime::ZERO,
            trace: Vec::new(),
            signals: signals.map(|(name, _)| ((*name).to_owned(), 0.0)).collect(),
            changes: Vec::new(),
            moves: Vec::new(),
            refuse_move: None,
            peer: P::default(),
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

impl<P> RecordingCabinet<P> {
    fn note(&mut self, text: &str) {
        let at = self.now.as_secs_f64();
        self.trace.push(format!("{at:.3} {text}"));
    }

    fn is_closed_by_peer(&self) -> bool {
        self.peer_closes_at.is_some_and(|at| at <= self.now)
    }
}

impl<P: Peer> Timed for RecordingCabinet<P> {
    fn set_time(&mut self, now: SimTime) {
        self.now = now;
        let changes = std::mem::take(&mut self.changes);
        let (due, later): (Vec<_>, Vec<_>) = changes.into_iter().partition(|(at, ..)| *at <= now);
        self.changes = later;
        for (_, name, value) in due {
            self.signals.insert(name, value);
        }
    }
}

impl<P: Peer> System for RecordingCabinet<P> {
    fn now(&self) -> SimTime {
        self.now
    }

    fn signal(&self, name: &str) -> Result<f64, Fault> {
        let found = self.signals.get(name).copied();
        found.ok_or_else(|| Fault::UnknownSignal(name.into()))
    }

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        self.signal(name)?;
        let known = P::SIGNALS.iter().find(|(known, _)| *known == name);
        if let Some((_, most)) = known.filter(|(_, most)| value > *most) {
            return Err(Fault::SignalValue {
                signal: name.into(),
                message: format!("{value} is above {most}"),
            });
        }
        self.signals.insert(name.into(), value);
        self.note(&format!("{name} = {value}"));
        Ok(())
    }

    fn set_signal_later(
        &mut self,
        name: &str,
        value: f64,
        delay: SimDuration,
    ) -> Result<(), Fault> {
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
        let open = self.moves.iter().filter(|end| **end > self.now).count();
        if open >= QUEUE {
            return Poll::Pending;
        }
        if self.refuse_move == Some(self.moves.len()) {
            self.refuse_move = None;
            return Poll::Ready(Err(Fault::OutOfReach {
                message: "the wrist would be 4.2 m away, at most 3.2 m".into(),
            }));
        }
        self.note(&in_words(request));
        let begin = self.moves.last().copied().unwrap_or_default().max(self.now);
        self.moves.push(begin + SimDuration::from_millis(100));
        Poll::Ready(Ok(MoveId(self.moves.len() as u64 - 1)))
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
            self.note(&format!(
                "{signal} = {value} {:?} lead {:.3} delay {:.3}",
                event.place,
                event.lead.as_secs_f64(),
                event.delay.as_secs_f64()
            ));
        }
        self.start_move(request)
    }

    fn is_move_done(&self, id: MoveId) -> Result<bool, Fault> {
        Ok(self.moves[id.0 as usize] <= self.now)
    }

    fn is_standing(&self) -> bool {
        self.moves.iter().all(|end| *end <= self.now)
    }

    fn stop_motion(&mut self) {
        self.note("stop");
        let now = self.now;
        self.moves.iter_mut().for_each(|end| *end = (*end).min(now));
    }

    fn joints(&self) -> JointPositions {
        match self.arm {
            Some((joints, _)) => joints,
            None => JointPositions::from_degrees(&[10.0, 20.0, 30.0, 40.0, 50.0, 60.0]),
        }
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
        self.note(&format!("connect {address}:{port}"));
        self.sockets[socket.0 as usize] = SocketState::Connected;
        Poll::Ready(Ok(()))
    }

    fn socket_send(&mut self, _: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        if self.is_closed_by_peer() {
            return Err(Fault::SocketClosed);
        }
        if let Some(text) = self.peer.take(self.now, bytes) {
            self.note(&text);
        }
        Ok(())
    }

    fn socket_receive(&mut self, socket: SocketId, limit: usize) -> Poll<Result<Received, Fault>> {
        if self.sockets[socket.0 as usize] != SocketState::Connected {
            return Poll::Ready(Err(Fault::SocketState {
                message: "not connected".into(),
            }));
        }
        let bytes = self.peer.give(self.now, limit);
        if !bytes.is_empty() {
            Poll::Ready(Ok(Received::Data(bytes)))
        } else if self.is_closed_by_peer() {
            Poll::Ready(Ok(Received::Closed))
        } else {
            Poll::Pending
        }
    }

    fn socket_close(&mut self, socket: SocketId) {
        self.note("close");
        self.sockets[socket.0 as usize] = SocketState::Closed;
    }

    fn socket_state(&self, socket: SocketId) -> SocketState {
        self.sockets[socket.0 as usize]
    }

    fn log(&mut self, kind: LogKind, _: &ProgramLocation, text: &str) {
        self.trace.push(match kind {
            LogKind::Operator => text.into(),
            LogKind::EventLog => format!("log: {text}"),
        });
    }

    fn statement(&mut self, _: &ProgramLocation) {
        self.statements += 1;
    }
}

fn in_words(request: &MoveRequest) -> String {
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
    };
    format!(
        "line {} {:?} {target} at {:.3} m/s {zone} tool z {:.3}",
        request.location.line,
        request.kind,
        request.speed.tcp,
        request.flange_from_tcp.translation.z
    )
}
