//! A vision server behind the sockets, in simulated time: the interface's own brain, and a cell that answers every
//! job with the same cartons and the same path after a while.

use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_controller::Network;
use depal_frames::{BoxSize, JointPositions, Pose, Vector};
use depal_interface::*;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, Received, SocketId};

use crate::harness::arm;

const PORT: PortId = PortId(0);
/// From a job to its result.
const WORK: SimDuration = SimDuration::from_millis(400);

pub struct VisionPeer {
    server: Server,
    clients: BTreeMap<SocketId, ConnectionId>,
    inbox: BTreeMap<ConnectionId, VecDeque<u8>>,
    connections: u64,
    due: Vec<(SimTime, Job)>,
    /// Cartons that are left, one is taken off with every vision run and Viz run.
    pub cartons: usize,
    /// Requests as they came.
    pub requests: Vec<i32>,
    /// Bytes of a reply that are given at a time.
    pub piece: usize,
    /// The connection breaks when this many requests have come.
    pub breaks_after: Option<usize>,
    /// Vision runs do not end for so many captures.
    pub silent: usize,
    exits: Vec<usize>,
    indexes: Vec<usize>,
}

impl VisionPeer {
    pub fn new(cartons: usize) -> Self {
        let settings = ServerSettings {
            ports: vec![PortSettings {
                encoding: Encoding::HexLittleEndian,
                ..PortSettings::default()
            }],
            projects: vec![VisionProject {
                id: 1,
                recipes: vec![1, 2],
                output: OutputPort::Poses,
                ..VisionProject::default()
            }],
            viz: Some(VizProject {
                branches: vec![BranchStep { step: 1, exits: 2 }],
                index_steps: vec![IndexStep { step: 3, places: 9 }],
                ..VizProject::default()
            }),
            ..ServerSettings::default()
        };
        Self {
            server: Server::new(settings).expect("good settings"),
            clients: BTreeMap::new(),
            inbox: BTreeMap::new(),
            connections: 0,
            due: Vec::new(),
            cartons,
            requests: Vec::new(),
            piece: usize::MAX,
            breaks_after: None,
            silent: 0,
            exits: Vec::new(),
            indexes: Vec::new(),
        }
    }

    /// Exits and indexes that the program chose.
    pub fn chosen(&self) -> (&[usize], &[usize]) {
        (&self.exits, &self.indexes)
    }

    fn work(&mut self, now: SimTime) {
        self.server.handle_timeout(now);
        let (due, later) = self.due.drain(..).partition(|(at, _)| *at <= now);
        self.due = later;
        let due: Vec<(SimTime, Job)> = due;
        for (_, job) in due {
            match job {
                Job::RunVision { job_id, .. } => {
                    let outcome = self.points();
                    self.server.finish_vision(now, job_id, outcome);
                }
                Job::StartViz { job_id, .. } => {
                    let outcome = self.path();
                    self.server.finish_viz(now, job_id, outcome);
                }
                _ => {}
            }
        }
        while let Some(job) = self.server.poll_job() {
            match &job {
                Job::RunVision { .. } if self.silent > 0 => self.silent -= 1,
                Job::SetBranch { exit, .. } => self.exits.push(*exit),
                Job::SetIndex { index, .. } => self.indexes.push(*index),
                _ => self.due.push((now + WORK, job)),
            }
        }
        while let Some(reply) = self.server.poll_reply() {
            let inbox = self.inbox.entry(reply.connection).or_default();
            inbox.extend(reply.bytes);
        }
        while self.server.poll_log().is_some() {}
    }

    fn points(&mut self) -> VisionOutcome {
        let points = (0..self.cartons.min(3)).map(|n| VisionPoint {
            base_from_object: Pose::translation(1.6, 0.3 * n as f64 - 0.3, 0.8),
            label: n as i32 + 1,
        });
        let points: Vec<_> = points.collect();
        self.cartons = self.cartons.saturating_sub(1);
        if points.is_empty() {
            return Err(Status::from_code(1002).expect("a code"));
        }
        Ok(points)
    }

    fn path(&mut self) -> VizOutcome {
        if self.cartons == 0 {
            return Err(Status::from_code(2038).expect("a code"));
        }
        self.cartons -= 1;
        let arm = arm();
        let way = [
            [0.0, 0.0, 10.0, 0.0, 80.0, 0.0],
            [0.0, 20.0, 15.0, 0.0, 55.0, 0.0],
            [0.0, 0.0, 10.0, 0.0, 80.0, 0.0],
            [70.0, 10.0, 15.0, 0.0, 65.0, 0.0],
        ];
        let points = way.iter().enumerate().map(|(index, degrees)| {
            let joints = JointPositions::from_degrees(degrees);
            PathPoint {
                joints,
                base_from_tcp: arm.base_from_flange(&joints) * Pose::translation(0.0, 0.0, 0.3),
                motion: Motion::Joint,
                tool: 1,
                velocity_percent: 80.0,
                label: i32::from(index == 1),
                vision_move: (index == 1).then(|| VisionMoveData {
                    labels: [0; 10],
                    picked_total: 2,
                    picked_now: 2,
                    edge_or_corner: 1,
                    group_from_tcp_offset: Vector::zeros(),
                    is_group_square: false,
                    is_box_square: false,
                    group_size: BoxSize::from_mm([600.0, 400.0, 200.0]),
                }),
            }
        });
        Ok(VizPath {
            points: points.collect(),
            digital_outputs: vec![1, 3],
        })
    }
}

impl Network for VisionPeer {
    fn connect(
        &mut self,
        now: SimTime,
        _: &str,
        socket: SocketId,
        _: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        if port != 50000 {
            return Poll::Ready(Err(Fault::SocketClosed));
        }
        self.connections += 1;
        let client = ConnectionId(self.connections);
        self.server.handle_connect(now, PORT, client);
        self.clients.insert(socket, client);
        Poll::Ready(Ok(()))
    }

    fn send(&mut self, now: SimTime, _: &str, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        let Some(client) = self.clients.get(&socket).copied() else {
            return Err(Fault::SocketClosed);
        };
        let head = bytes[..4].try_into().expect("a head");
        self.requests.push(i32::from_le_bytes(head));
        if self
            .breaks_after
            .is_some_and(|count| self.requests.len() > count)
        {
            self.breaks_after = None;
            self.clients.remove(&socket);
            self.server.handle_disconnect(now, PORT, client);
            return Err(Fault::SocketClosed);
        }
        self.server.handle_input(now, PORT, client, bytes);
        self.work(now);
        Ok(())
    }

    fn receive(&mut self, now: SimTime, _: &str, socket: SocketId, limit: usize) -> Poll<Received> {
        self.work(now);
        let Some(client) = self.clients.get(&socket) else {
            return Poll::Ready(Received::Closed);
        };
        let inbox = self.inbox.entry(*client).or_default();
        if inbox.is_empty() {
            return Poll::Pending;
        }
        let count = limit.min(self.piece).min(inbox.len());
        Poll::Ready(Received::Data(inbox.drain(..count).collect()))
    }

    fn close(&mut self, now: SimTime, _: &str, socket: SocketId) {
        if let Some(client) = self.clients.remove(&socket) {
            self.server.handle_disconnect(now, PORT, client);
        }
    }
}
