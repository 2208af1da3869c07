//! A cabinet without an arm: moves take their time, the vacuum follows the outputs; and vision beside it.

use std::collections::VecDeque;
use std::task::Poll;

use depal_frames::{BoxSize, JointPositions, Pose, Vector};
use depal_interface::{
    BranchStep, ConnectionId, HandshakeSettings, Job, Motion, OutputPort, PathPoint, PlannedPath,
    PlcClient, PortId, PortSettings, Server, ServerSettings, Status, VisionMoveData, VisionProject,
    VizProject, plc_port,
};
use depal_time::{SimDuration, SimTime, TICK};
use depal_vm::execution::{RobotTask, Step};
use depal_vm::system::{
    Fault, LogKind, MoveId, MoveRequest, MoveTarget, ProgramLocation, Received, SocketId,
    SocketState, System,
};

use crate::{PlcSettings, PlcTask};

const PORT: PortId = PortId(0);
const VISION: ConnectionId = ConnectionId(1);
const LISTENER: SocketId = SocketId(1);

/// A move takes this long.
const MOVE: SimDuration = SimDuration::from_millis(400);

pub struct Cabinet {
    pub now: SimTime,
    /// Moves in order, with the time at which each is over.
    pub moves: Vec<(MoveRequest, SimTime)>,
    /// Every value that the group output took.
    pub outputs: Vec<u32>,
    pub log: Vec<String>,
    /// The vacuum switch works for this many picks; then it stays at 0.
    pub good_picks: usize,
    picks: usize,
    output_since: SimTime,
    is_listening: bool,
    calls: usize,
    /// Towards the program.
    incoming: VecDeque<u8>,
    /// Towards vision.
    outgoing: Vec<u8>,
    is_open: bool,
}

impl System for Cabinet {
    fn now(&self) -> SimTime {
        self.now
    }

    fn signal(&self, name: &str) -> Result<f64, Fault> {
        match name {
            "diVacuumOk" => {
                let is_on = self.outputs.last().is_some_and(|bits| *bits != 0);
                let settled = self.output_since + SimDuration::from_millis(200) <= self.now;
                let works = self.picks <= self.good_picks;
                Ok(f64::from(u8::from(works && is_on == settled)))
            }
            other => Err(Fault::UnknownSignal(other.to_owned())),
        }
    }

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        if name != "goVacuum" {
            return Err(Fault::UnknownSignal(name.to_owned()));
        }
        self.outputs.push(value as u32);
        self.output_since = self.now;
        self.picks += usize::from(value != 0.0);
        Ok(())
    }

    fn start_move(&mut self, request: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        let free = self.moves.last().map_or(self.now, |(_, over)| *over);
        if free > self.now + MOVE {
            return Poll::Pending;
        }
        self.moves
            .push((request.clone(), free.max(self.now) + MOVE));
        Poll::Ready(Ok(MoveId(self.moves.len() as u64 - 1)))
    }

    fn is_move_done(&self, id: MoveId) -> Result<bool, Fault> {
        Ok(self.moves[id.0 as usize].1 <= self.now)
    }

    fn is_standing(&self) -> bool {
        self.moves.last().is_none_or(|(_, over)| *over <= self.now)
    }

    fn stop_motion(&mut self) {
        self.log.push("motion stopped".to_owned());
    }

    fn joints(&self) -> JointPositions {
        self.planned_joints()
    }

    fn planned_joints(&self) -> JointPositions {
        JointPositions::from_degrees(&[0.0; 6])
    }

    /// The first three joints are metres.
    fn forward(&self, joints: &JointPositions) -> Pose {
        let values: Vec<f64> = joints.iter().map(|joint| joint.to_degrees()).collect();
        Pose::translation(values[0], values[1], values[2])
    }

    fn inverse(&self, _: &Pose, near: &JointPositions) -> Result<JointPositions, Fault> {
        Ok(*near)
    }

    fn socket_create(&mut self) -> SocketId {
        LISTENER
    }

    fn socket_bind(&mut self, _: SocketId, _: &str, port: u16) -> Result<(), Fault> {
        assert_eq!(port, 102);
        Ok(())
    }

    fn socket_listen(&mut self, _: SocketId) -> Result<(), Fault> {
        self.is_listening = true;
        Ok(())
    }

    fn socket_accept(&mut self, _: SocketId) -> Poll<Result<(SocketId, String), Fault>> {
        if self.calls == 0 {
            return Poll::Pending;
        }
        self.calls -= 1;
        self.is_open = true;
        Poll::Ready(Ok((SocketId(2), "vision".to_owned())))
    }

    fn socket_connect(&mut self, _: SocketId, _: &str, _: u16) -> Poll<Result<(), Fault>> {
        Poll::Ready(Err(Fault::SocketClosed))
    }

    fn socket_send(&mut self, _: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        self.outgoing.extend(bytes);
        Ok(())
    }

    fn socket_receive(&mut self, _: SocketId, limit: usize) -> Poll<Result<Received, Fault>> {
        if !self.is_open {
            return Poll::Ready(Ok(Received::Closed));
        }
        if self.incoming.is_empty() {
            return Poll::Pending;
        }
        let count = limit.min(self.incoming.len());
        Poll::Ready(Ok(Received::Data(self.incoming.drain(..count).collect())))
    }

    fn socket_close(&mut self, _: SocketId) {
        self.is_open = false;
    }

    fn socket_state(&self, _: SocketId) -> SocketState {
        SocketState::Connected
    }

    fn log(&mut self, _: LogKind, _: &ProgramLocation, text: &str) {
        self.log.push(text.to_owned());
    }

    fn statement(&mut self, _: &ProgramLocation) {}
}

/// Everything together.
pub struct Cell {
    pub cabinet: Cabinet,
    pub task: PlcTask,
    /// Commands that vision heard, in order.
    pub commands: Vec<i32>,
    /// Statuses that it answered.
    pub statuses: Vec<i32>,
    /// Cartons left to plan for.
    pub cartons: usize,
    client: PlcClient,
    server: Server,
    is_connected: bool,
    is_away: bool,
    due: Vec<(SimTime, Job)>,
}

/// The path to one carton: 2 is the pick, 4 the place; the joints tell the carton.
pub fn path(carton: usize) -> PlannedPath {
    let point = |place: usize| PathPoint {
        joints: JointPositions::from_degrees(&[
            place as f64 + 1.0,
            carton as f64,
            0.5,
            0.0,
            0.0,
            0.0,
        ]),
        base_from_tcp: Pose::identity(),
        motion: if place == 1 {
            Motion::Linear
        } else {
            Motion::Joint
        },
        tool: 1,
        velocity_percent: 80.0,
        label: 0,
        vision_move: (place == 1).then(|| VisionMoveData {
            labels: [0; 10],
            picked_total: carton as i32,
            picked_now: 1,
            edge_or_corner: 0,
            group_from_tcp_offset: Vector::zeros(),
            is_group_square: false,
            is_box_square: false,
            group_size: BoxSize::from_mm([400.0, 300.0, 250.0]),
        }),
    };
    PlannedPath {
        points: (0..4).map(point).collect(),
        rounds: vec![vec![1, 3, 6]],
        ..PlannedPath::default()
    }
}

impl Cell {
    pub fn new(settings: PlcSettings, cartons: usize) -> Self {
        let own = plc_port(&PortSettings::default());
        let handshake = HandshakeSettings {
            profile: own.profile.clone(),
            ..HandshakeSettings::default()
        };
        let mut server = Server::new(ServerSettings {
            ports: vec![own],
            projects: vec![VisionProject {
                output: OutputPort::Path,
                ..VisionProject::default()
            }],
            viz: Some(VizProject {
                branches: vec![BranchStep { step: 5, exits: 2 }],
                ..VizProject::default()
            }),
            ..ServerSettings::default()
        })
        .expect("good settings");
        server.handle_connect(SimTime::ZERO, PORT, VISION);
        Self {
            cabinet: Cabinet {
                now: SimTime::ZERO,
                moves: Vec::new(),
                outputs: Vec::new(),
                log: Vec::new(),
                good_picks: usize::MAX,
                picks: 0,
                output_since: SimTime::ZERO,
                is_listening: false,
                calls: 0,
                incoming: VecDeque::new(),
                outgoing: Vec::new(),
                is_open: false,
            },
            task: PlcTask::new(settings),
            commands: Vec::new(),
            statuses: Vec::new(),
            cartons,
            client: PlcClient::new(handshake, 1, 0, 1),
            server,
            is_connected: false,
            is_away: false,
            due: Vec::new(),
        }
    }

    /// Vision goes, with its connection, or comes back.
    pub fn set_away(&mut self, is_away: bool) {
        self.is_away = is_away;
        if is_away {
            self.client.handle_disconnect();
            self.cabinet.is_open = false;
            self.cabinet.incoming.clear();
            self.cabinet.outgoing.clear();
            self.is_connected = false;
        }
    }

    /// Runs until the program ends, at most 100 s.
    pub fn run(&mut self) -> Step {
        for _ in 0..25_000 {
            if let Some(end) = self.tick() {
                return end;
            }
        }
        panic!("the program stands at {:?}", self.task.location());
    }

    /// One cycle; how the program ended, if it did.
    pub fn tick(&mut self) -> Option<Step> {
        if !self.is_away {
            self.vision();
        }
        self.cabinet.now += TICK;
        for _ in 0..100 {
            match self.task.step(&mut self.cabinet) {
                Step::Ran => {}
                Step::Blocked => break,
                end => return Some(end),
            }
        }
        None
    }

    fn vision(&mut self) {
        let now = self.cabinet.now;
        if self.cabinet.is_listening && !self.is_connected {
            self.is_connected = true;
            self.cabinet.calls += 1;
            self.client.handle_connect();
        }
        let bytes = std::mem::take(&mut self.cabinet.outgoing);
        self.client
            .handle_input(now, &bytes)
            .expect("good telegrams");
        while let Some(request) = self.client.poll_request() {
            self.server.handle_input(now, PORT, VISION, &request);
        }
        self.server.handle_timeout(now);
        while let Some(job) = self.server.poll_job() {
            self.due.push((now + SimDuration::from_millis(300), job));
        }
        let (due, later): (Vec<_>, Vec<_>) = self.due.drain(..).partition(|(due, _)| *due <= now);
        self.due = later;
        for (_, job) in due {
            match job {
                Job::StartViz { job_id, .. } => {
                    let path = self.next_path(Status::VizNoVisionResult);
                    self.server.finish_viz_path(now, job_id, path);
                }
                Job::RunVision { job_id, .. } => {
                    let path = self.next_path(Status::NoVisionResult);
                    self.server.finish_vision_path(now, job_id, path);
                }
                _ => {}
            }
        }
        while let Some(reply) = self.server.poll_reply() {
            self.commands.push(reply.command);
            self.statuses.extend(reply.status.map(Status::code));
            self.client.handle_reply(now, &reply.bytes);
        }
        self.client.handle_timeout(now);
        while let Some(request) = self.client.poll_request() {
            self.server.handle_input(now, PORT, VISION, &request);
        }
        while let Some(bytes) = self.client.poll_output() {
            self.cabinet.incoming.extend(bytes);
        }
    }

    fn next_path(&mut self, none: Status) -> Result<PlannedPath, Status> {
        if self.cartons == 0 {
            return Err(none);
        }
        let path = path(self.cartons);
        self.cartons -= 1;
        Ok(path)
    }
}

/// First two joints of a target, or place of a straight move.
pub fn target(request: &MoveRequest) -> [f64; 2] {
    match &request.target {
        MoveTarget::Joints(joints) => {
            let values: Vec<f64> = joints.iter().map(|joint| joint.to_degrees()).collect();
            [
                (values[0] * 1e3).round() / 1e3,
                (values[1] * 1e3).round() / 1e3,
            ]
        }
        MoveTarget::Tcp(pose) | MoveTarget::Arc { to: pose, .. } => [
            (pose.translation.x * 1e3).round() / 1e3,
            (pose.translation.y * 1e3).round() / 1e3,
        ],
    }
}
