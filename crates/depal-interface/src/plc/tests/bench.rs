use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_time::{SimDuration, SimTime};
use depal_wire::Status;
use depal_wire::s7::{COMMAND_BYTES, DataBlock, Field};

use crate::plc::{Handshake, HandshakeSettings, Transfer, plc_port};
use crate::*;

pub fn ms(millis: u64) -> SimDuration {
    SimDuration::from_millis(millis)
}
const CLIENT: ConnectionId = ConnectionId(1);
const PORT: PortId = PortId(0);

/// What the bench answers to the jobs of the session.
pub struct Results {
    pub points: Result<VisionResult, Status>,
    pub path: Result<PlannedPath, Status>,
    /// From a job to its result.
    pub latency: SimDuration,
}

/// One side's write to the block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Seen {
    pub at: SimTime,
    pub field: Field,
    pub first: usize,
    pub bytes: Vec<u8>,
}

pub struct Bench {
    pub now: SimTime,
    pub block: DataBlock,
    pub handshake: Handshake,
    pub server: Server,
    pub results: Results,
    /// Everything that vision wrote.
    pub seen: Vec<Seen>,
    /// Jobs as the session gave them.
    pub jobs: Vec<Job>,
    pub notices: Vec<String>,
    /// Transfers that still succeed; then the connection is lost, with the last write arrived or not.
    pub cut_after: Option<(usize, bool)>,
    pending: Vec<(SimTime, Job)>,
}

pub fn settings() -> ServerSettings {
    ServerSettings {
        ports: vec![plc_port(&PortSettings {
            timeout: SimDuration::from_millis(2_000),
            ..PortSettings::default()
        })],
        projects: vec![
            VisionProject {
                recipes: vec![1, 2],
                ..VisionProject::default()
            },
            VisionProject {
                id: 2,
                output: OutputPort::Path,
                ..VisionProject::default()
            },
            VisionProject {
                id: 3,
                output: OutputPort::Custom,
                ..VisionProject::default()
            },
        ],
        viz: Some(VizProject {
            branches: vec![BranchStep { step: 2, exits: 3 }],
            index_steps: vec![IndexStep { step: 4, places: 9 }],
            parameters: Vec::new(),
        }),
        ..ServerSettings::default()
    }
}

pub fn point(x: f64, label: i32) -> VisionPoint {
    VisionPoint {
        base_from_object: Pose::translation(x, 0.25, 0.5),
        label,
    }
}

pub fn points(count: usize) -> VisionResult {
    VisionResult {
        points: (0..count)
            .map(|place| point(0.1 * (place + 1) as f64, place as i32 + 1))
            .collect(),
        custom_ports: vec![
            CustomPort {
                name: "b".to_owned(),
                rows: (0..count).map(|place| vec![0.5, place as f64]).collect(),
            },
            CustomPort {
                name: "a".to_owned(),
                rows: (0..count).map(|place| vec![-1.0 - place as f64]).collect(),
            },
        ],
    }
}

/// `count` waypoints, the one at `pick` (from 0) a Vision Move.
pub fn path(count: usize, pick: usize) -> PlannedPath {
    let waypoint = |place: usize| PathPoint {
        joints: JointPositions::from_degrees(&[place as f64 + 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        base_from_tcp: EulerConvention::AbbZyx.pose_from_mm_deg([
            100.0 * (place + 1) as f64,
            0.0,
            500.0,
            30.0,
            0.0,
            180.0,
        ]),
        motion: if place == pick {
            Motion::Linear
        } else {
            Motion::Joint
        },
        tool: 1,
        velocity_percent: 80.0,
        label: if place == pick { 7 } else { 0 },
        vision_move: (place == pick).then(|| VisionMoveData {
            labels: [7, 8, 0, 0, 0, 0, 0, 0, 0, 0],
            picked_total: 4,
            picked_now: 2,
            edge_or_corner: 1,
            group_from_tcp_offset: Vector::new(0.01, 0.0, 0.0),
            is_group_square: false,
            is_box_square: true,
            group_size: BoxSize::from_mm([400.0, 300.0, 200.0]),
        }),
    };
    PlannedPath {
        points: (0..count).map(waypoint).collect(),
        rounds: vec![vec![1, 3, 4]],
        sections: 4,
        custom_ports: Vec::new(),
    }
}

impl Bench {
    /// Connected, with an empty block.
    pub fn new() -> Self {
        let mut bench = Self::disconnected();
        bench.connect();
        bench
    }

    pub fn disconnected() -> Self {
        let settings = settings();
        let handshake = Handshake::new(HandshakeSettings {
            profile: settings.ports[0].profile.clone(),
            ..HandshakeSettings::default()
        });
        let mut server = Server::new(settings).expect("good settings");
        server.handle_connect(SimTime::ZERO, PORT, CLIENT);
        Self {
            now: SimTime::ZERO,
            block: DataBlock::new(),
            handshake,
            server,
            results: Results {
                points: Ok(points(2)),
                path: Ok(path(3, 1)),
                latency: SimDuration::from_millis(100),
            },
            seen: Vec::new(),
            jobs: Vec::new(),
            notices: Vec::new(),
            cut_after: None,
            pending: Vec::new(),
        }
    }

    pub fn connect(&mut self) {
        self.handshake.handle_connect();
    }

    /// Time passes.
    pub fn run(&mut self, span: SimDuration) {
        let end = self.now + span;
        while self.now < end {
            self.step();
            self.now += ms(1);
        }
    }

    /// Runs until `done`, at most 20 s; the time it took.
    pub fn run_until(&mut self, what: &str, done: impl Fn(&Self) -> bool) -> SimDuration {
        let from = self.now;
        while !done(self) {
            assert!(
                self.now.saturating_since(from) < ms(20_000),
                "waited 20 s for: {what}"
            );
            self.step();
            self.now += ms(1);
        }
        self.now.saturating_since(from)
    }

    fn step(&mut self) {
        loop {
            self.transfers();
            let mut is_quiet = true;
            while let Some(request) = self.handshake.poll_request() {
                self.server.handle_input(self.now, PORT, CLIENT, &request);
                is_quiet = false;
            }
            if self
                .server
                .poll_timeout()
                .is_some_and(|due| due <= self.now)
            {
                self.server.handle_timeout(self.now);
            }
            while let Some(job) = self.server.poll_job() {
                self.jobs.push(job.clone());
                self.pending.push((self.now + self.results.latency, job));
            }
            let (due, later) = std::mem::take(&mut self.pending)
                .into_iter()
                .partition(|(due, _)| *due <= self.now);
            self.pending = later;
            for (_, job) in due {
                self.finish(&job);
            }
            while let Some(reply) = self.server.poll_reply() {
                self.handshake.handle_reply(&reply.bytes);
                is_quiet = false;
            }
            self.notices
                .extend(std::iter::from_fn(|| self.handshake.poll_notice()));
            if is_quiet {
                return;
            }
        }
    }

    fn transfers(&mut self) {
        while let Some(transfer) = self.handshake.poll_transfer(self.now) {
            if let Some((left, arrives)) = self.cut_after {
                if left == 0 {
                    self.cut_after = None;
                    if let (Transfer::Write { first, bytes }, true) = (&transfer, arrives) {
                        self.write(*first, bytes);
                    }
                    self.handshake.handle_disconnect();
                    return;
                }
                self.cut_after = Some((left - 1, arrives));
            }
            match transfer {
                Transfer::Read { first, len } => {
                    let bytes = self.block.bytes(first, len).expect("inside").to_vec();
                    self.handshake.handle_read(self.now, &bytes);
                }
                Transfer::Write { first, bytes } => {
                    self.write(first, &bytes);
                    self.handshake.handle_written(self.now);
                }
            }
        }
    }

    fn write(&mut self, first: usize, bytes: &[u8]) {
        assert!(first >= COMMAND_BYTES, "vision wrote byte {first}");
        assert!(self.block.write(first, bytes));
        self.seen.push(Seen {
            at: self.now,
            field: Field::at(first).expect("inside"),
            first,
            bytes: bytes.to_vec(),
        });
    }

    fn finish(&mut self, job: &Job) {
        match job {
            Job::RunVision {
                job_id, project: 2, ..
            } => {
                let path = self.results.path.clone();
                self.server.finish_vision_path(self.now, *job_id, path);
            }
            Job::RunVision { job_id, .. } => {
                let points = self.results.points.clone();
                self.server.finish_vision_custom(self.now, *job_id, points);
            }
            Job::StartViz { job_id, .. } => {
                let path = self.results.path.clone();
                self.server.finish_viz_path(self.now, *job_id, path);
            }
            _ => {}
        }
    }

    pub fn set(&mut self, field: Field, value: i16) {
        self.block.set_int(field, 0, value);
    }

    pub fn int(&self, field: Field) -> i16 {
        self.block.int(field, 0)
    }

    pub fn is_set(&self, field: Field) -> bool {
        self.block.bool(field)
    }

    pub fn trigger(&mut self, value: bool) {
        self.block.set_bool(Field::Trigger, value);
    }

    /// The four-way handshake of a well written controller; Status at its end.
    pub fn call(&mut self, command: i16) -> i16 {
        self.set(Field::Command, command);
        self.trigger(true);
        self.run_until("Acknowledge", |b| b.is_set(Field::Acknowledge));
        self.trigger(false);
        self.run_until("Acknowledge falls", |b| !b.is_set(Field::Acknowledge));
        self.run_until("Status", |b| b.int(Field::Status) != 0);
        // The flag follows Status in a transfer of its own.
        self.run(ms(1));
        self.int(Field::Status)
    }

    /// Registers that vision wrote since, without heartbeats, each run once.
    pub fn order_since(&self, from: usize) -> Vec<Field> {
        let fields = self.seen[from..].iter().map(|seen| seen.field);
        let mut order: Vec<Field> = fields.filter(|field| *field != Field::Heartbeat).collect();
        order.dedup();
        order
    }

    /// Runs of projects so far.
    pub fn run_count(&self) -> usize {
        let is_run = |job: &&Job| matches!(job, Job::RunVision { .. } | Job::StartViz { .. });
        self.jobs.iter().filter(is_run).count()
    }
}
