//! A cabinet of its own for tests: an arm that is at once where it is sent, and sockets whose other end is the vision
//! server's brain, or a script.

use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_interface::*;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{
    Fault, LogKind, MoveId, MoveRequest, MoveTarget, ProgramLocation, Received, SocketId,
    SocketState, System,
};

const PORT: PortId = PortId(0);

#[derive(Debug)]
pub(super) struct Cabinet {
    pub(super) now: SimTime,
    pub(super) server: Option<Server>,
    /// Status codes that the server answered, in order; 0 where a reply has none.
    pub(super) answered: Vec<i32>,
    /// Bytes that wait, by socket.
    pub(super) inbox: BTreeMap<SocketId, VecDeque<u8>>,
    /// What the program has sent.
    pub(super) sent: Vec<u8>,
    /// The peer has closed.
    pub(super) is_closed: bool,
    /// Nobody answers calls.
    pub(super) is_deaf: bool,
    /// Calls are refused.
    pub(super) refuses: bool,
    /// After so many replies the peer closes instead of answering.
    pub(super) closes_after: Option<usize>,
    /// Someone who will call the listening robot.
    pub(super) caller: bool,
    pub(super) listens: Option<u16>,
    pub(super) signals: BTreeMap<String, f64>,
    pub(super) moves: Vec<MoveRequest>,
    pub(super) log: Vec<String>,
    pub(super) jobs: Vec<Job>,
    /// Poses have no axes.
    pub(super) is_out_of_reach: bool,
    joints: JointPositions,
    sockets: u32,
    open: Vec<SocketId>,
}

impl Cabinet {
    /// Nobody at the other end.
    pub(super) fn new() -> Self {
        let outputs = (1..=64).map(|n| (format!("$OUT[{n}]"), 0.0));
        Self {
            now: SimTime::ZERO,
            server: None,
            answered: Vec::new(),
            inbox: BTreeMap::new(),
            sent: Vec::new(),
            is_closed: false,
            is_deaf: false,
            refuses: false,
            closes_after: None,
            caller: false,
            listens: None,
            signals: outputs.collect(),
            moves: Vec::new(),
            log: Vec::new(),
            jobs: Vec::new(),
            is_out_of_reach: false,
            joints: JointPositions::from_degrees(&[10.0, -90.0, 90.0, 0.0, 45.0, 0.0]),
            sockets: 0,
            open: Vec::new(),
        }
    }

    /// The vision server at the other end: project 1 gives poses, 2 a path, 3 custom data.
    pub(super) fn with_vision(encoding: Encoding, profile: Profile) -> Self {
        let project = |id, output| VisionProject {
            id,
            recipes: vec![1, 2],
            output,
            ..VisionProject::default()
        };
        let pose = |degrees: f64| CalibrationPose {
            base_from_flange: Pose::translation(1.0, 0.2, 1.5),
            joints: JointPositions::from_degrees(&[degrees, -90.0, 90.0, 0.0, 45.0, 0.0]),
        };
        let settings = ServerSettings {
            ports: vec![PortSettings {
                encoding,
                euler: EulerConvention::KukaAbc,
                ..PortSettings::of_profile(profile)
            }],
            projects: vec![
                project(1, OutputPort::Poses),
                project(2, OutputPort::Path),
                project(3, OutputPort::Custom),
            ],
            viz: Some(VizProject {
                branches: vec![BranchStep { step: 7, exits: 2 }],
                index_steps: vec![IndexStep {
                    step: 5,
                    places: 10,
                }],
                parameters: vec![StepParameter {
                    step: 4,
                    key: "xOffset".into(),
                    value: 12.5,
                    writable: Some(ParameterRange::ANY),
                }],
            }),
            property_config: "read,1,4,xOffset\nwrite,2,4,xOffset,3\n".into(),
            calibration: vec![pose(1.0), pose(2.0), pose(3.0)],
            ..ServerSettings::default()
        };
        Self {
            server: Some(Server::new(settings).expect("good settings")),
            ..Self::new()
        }
    }

    pub(super) fn advance(&mut self, time: SimDuration) {
        self.now += time;
        let Some(mut server) = self.server.take() else {
            return;
        };
        server.handle_timeout(self.now);
        self.serve(&mut server);
        self.server = Some(server);
    }

    fn serve(&mut self, server: &mut Server) {
        while let Some(job) = server.poll_job() {
            self.jobs.push(job.clone());
            match job {
                Job::RunVision {
                    job_id, project, ..
                } => match project {
                    2 => server.finish_vision_path(self.now, job_id, Ok(path())),
                    3 => server.finish_vision_custom(self.now, job_id, Ok(custom())),
                    _ => {
                        server.notify(self.now, job_id, 77);
                        let points = (1..=22).map(|n| point(f64::from(n) * 0.1)).collect();
                        server.finish_vision(self.now, job_id, Ok(points));
                    }
                },
                Job::StartViz { job_id, .. } => server.viz_waiting_at_branch(self.now, job_id, 7),
                Job::SetBranch { job_id, .. } => {
                    server.finish_viz_path(self.now, job_id, Ok(path()));
                }
                _ => {}
            }
        }
        while let Some(reply) = server.poll_reply() {
            if self.closes_after == Some(self.answered.len()) {
                self.is_closed = true;
                return;
            }
            self.answered.push(reply.status.map_or(0, Status::code));
            let socket = SocketId(reply.connection.0 as u32);
            self.inbox.entry(socket).or_default().extend(reply.bytes);
        }
    }
}

fn point(x: f64) -> VisionPoint {
    VisionPoint {
        base_from_object: Pose::new(Vector::new(x, 0.1, 0.45), Vector::z() * 30f64.to_radians()),
        label: 3,
    }
}

fn custom() -> VisionResult {
    VisionResult {
        points: vec![point(0.6), point(0.7)],
        custom_ports: vec![CustomPort {
            name: "weight".into(),
            rows: vec![vec![1.5, 2.5], vec![3.5, 4.5]],
        }],
    }
}

fn path() -> PlannedPath {
    let waypoint = |number: u32| PathPoint {
        joints: JointPositions::from_degrees(&[f64::from(number), -90.0, 90.0, 0.0, 45.0, -5.0]),
        base_from_tcp: Pose::translation(0.6, 0.1, 0.45),
        motion: if number == 2 {
            Motion::Linear
        } else {
            Motion::Joint
        },
        tool: 1,
        velocity_percent: 80.0,
        label: 4,
        vision_move: (number == 2).then(|| VisionMoveData {
            labels: [9, 0, 0, 0, 0, 0, 0, 0, 0, 0],
            picked_total: 5,
            picked_now: 1,
            edge_or_corner: 2,
            group_from_tcp_offset: Vector::new(0.01, 0.0, 0.0),
            is_group_square: false,
            is_box_square: true,
            group_size: BoxSize::from_mm([400.0, 300.0, 250.0]),
        }),
    };
    PlannedPath {
        points: (1..=3).map(waypoint).collect(),
        rounds: vec![vec![1, 3], vec![6]],
        sections: 4,
        custom_ports: Vec::new(),
    }
}

impl System for Cabinet {
    fn now(&self) -> SimTime {
        self.now
    }

    fn signal(&self, name: &str) -> Result<f64, Fault> {
        let value = self.signals.get(name).copied();
        value.ok_or_else(|| Fault::UnknownSignal(name.to_owned()))
    }

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        self.signal(name)?;
        self.signals.insert(name.to_owned(), value);
        Ok(())
    }

    fn start_move(&mut self, request: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        if let MoveTarget::Joints(joints) = &request.target {
            self.joints = *joints;
        }
        self.moves.push(request.clone());
        Poll::Ready(Ok(MoveId(self.moves.len() as u64)))
    }

    fn is_move_done(&self, _: MoveId) -> Result<bool, Fault> {
        Ok(true)
    }

    fn is_standing(&self) -> bool {
        true
    }

    fn stop_motion(&mut self) {}

    fn joints(&self) -> JointPositions {
        self.joints
    }

    fn planned_joints(&self) -> JointPositions {
        self.joints
    }

    fn forward(&self, _: &JointPositions) -> Pose {
        Pose::translation(1.0, 0.2, 1.5)
    }

    fn inverse(&self, _: &Pose, near: &JointPositions) -> Result<JointPositions, Fault> {
        if self.is_out_of_reach {
            return Err(Fault::OutOfReach {
                message: "too far".into(),
            });
        }
        Ok(*near)
    }

    fn socket_create(&mut self) -> SocketId {
        self.sockets += 1;
        SocketId(self.sockets)
    }

    fn socket_connect(&mut self, socket: SocketId, _: &str, _: u16) -> Poll<Result<(), Fault>> {
        if self.refuses {
            return Poll::Ready(Err(Fault::SocketClosed));
        }
        if self.is_deaf {
            return Poll::Pending;
        }
        self.is_closed = false;
        self.open.push(socket);
        if let Some(server) = &mut self.server {
            server.handle_connect(self.now, PORT, ConnectionId(socket.0.into()));
        }
        Poll::Ready(Ok(()))
    }

    fn socket_send(&mut self, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        if self.is_closed || !self.open.contains(&socket) {
            return Err(Fault::SocketClosed);
        }
        self.sent.extend_from_slice(bytes);
        if let Some(server) = &mut self.server {
            server.handle_input(self.now, PORT, ConnectionId(socket.0.into()), bytes);
        }
        Ok(())
    }

    fn socket_receive(&mut self, socket: SocketId, limit: usize) -> Poll<Result<Received, Fault>> {
        if !self.open.contains(&socket) {
            return Poll::Ready(Err(Fault::SocketClosed));
        }
        let inbox = self.inbox.entry(socket).or_default();
        if inbox.is_empty() {
            return if self.is_closed {
                Poll::Ready(Ok(Received::Closed))
            } else {
                Poll::Pending
            };
        }
        // In odd pieces, as a network may.
        let count = inbox.len().min(limit).min(97);
        Poll::Ready(Ok(Received::Data(inbox.drain(..count).collect())))
    }

    fn socket_close(&mut self, socket: SocketId) {
        if self.open.contains(&socket)
            && let Some(server) = &mut self.server
        {
            server.handle_disconnect(self.now, PORT, ConnectionId(socket.0.into()));
        }
        self.open.retain(|open| *open != socket);
    }

    fn socket_state(&self, socket: SocketId) -> SocketState {
        if self.open.contains(&socket) {
            SocketState::Connected
        } else {
            SocketState::Closed
        }
    }

    fn socket_bind(&mut self, _: SocketId, _: &str, port: u16) -> Result<(), Fault> {
        self.listens = Some(port);
        Ok(())
    }

    fn socket_listen(&mut self, _: SocketId) -> Result<(), Fault> {
        Ok(())
    }

    fn socket_accept(&mut self, _: SocketId) -> Poll<Result<(SocketId, String), Fault>> {
        if !std::mem::take(&mut self.caller) {
            return Poll::Pending;
        }
        let socket = self.socket_create();
        self.open.push(socket);
        self.is_closed = false;
        Poll::Ready(Ok((socket, "10.0.0.9".into())))
    }

    fn log(&mut self, _: LogKind, _: &ProgramLocation, text: &str) {
        self.log.push(text.to_owned());
    }

    fn statement(&mut self, _: &ProgramLocation) {}
}
