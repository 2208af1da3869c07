use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_time::{SimDuration, SimTime};

use crate::*;

mod connections;
mod coverage;
mod faults;
mod order_model;
mod property_config;
mod random;
mod robot_pose;
mod vision;
mod viz;

const PORT: PortId = PortId(0);
const CLIENT: ConnectionId = ConnectionId(1);

/// One ASCII port with projects 1 (poses, recipes 1 and 2), 2 (path), 3 (no recipes) and a branch step 7.
struct Bench {
    server: Server,
    now: SimTime,
}

impl Bench {
    fn new() -> Self {
        Self::with_port(PortSettings::default())
    }

    fn with_port(port: PortSettings) -> Self {
        let project = |id, recipes: &[i32], output| VisionProject {
            id,
            recipes: recipes.to_vec(),
            output,
            ..VisionProject::default()
        };
        let settings = ServerSettings {
            ports: vec![port],
            projects: vec![
                project(1, &[1, 2], OutputPort::Poses),
                project(2, &[], OutputPort::Path),
                project(3, &[], OutputPort::Poses),
            ],
            viz: Some(VizProject {
                branches: vec![BranchStep { step: 7, exits: 2 }],
                ..VizProject::default()
            }),
            ..ServerSettings::default()
        };
        let mut bench = Self {
            server: Server::new(settings).unwrap(),
            now: SimTime::ZERO,
        };
        bench.server.handle_connect(bench.now, PORT, CLIENT);
        bench
    }

    fn send(&mut self, client: ConnectionId, text: &str) {
        let line = format!("{text}\r");
        self.server
            .handle_input(self.now, PORT, client, line.as_bytes());
    }

    fn replies(&mut self) -> Vec<String> {
        std::iter::from_fn(|| self.server.poll_reply())
            .map(|reply| {
                String::from_utf8(reply.bytes)
                    .unwrap()
                    .trim_end()
                    .to_owned()
            })
            .collect()
    }

    fn wait(&mut self, millis: u64) {
        self.now += SimDuration::from_millis(millis);
        self.server.handle_timeout(self.now);
    }

    /// The only line that touches the API: one request, all replies joined.
    #[track_caller]
    fn check(&mut self, request: &str, expected: &str) {
        self.send(CLIENT, request);
        assert_eq!(self.replies().join("|"), expected, "{request}");
    }

    fn job(&mut self) -> Job {
        self.server.poll_job().expect("a job")
    }

    fn job_id(&mut self) -> JobId {
        match self.job() {
            Job::RunVision { job_id, .. }
            | Job::StartViz { job_id, .. }
            | Job::StopViz { job_id }
            | Job::SetIndex { job_id, .. }
            | Job::SetBranch { job_id, .. } => job_id,
            other => panic!("{other:?} belongs to no run"),
        }
    }

    fn start_viz(&mut self) -> JobId {
        self.check("201,2,0,-20,10,0,60,0", "201,2103");
        self.job_id()
    }

    fn finish_viz(&mut self, job_id: JobId, path: VizOutcome) {
        self.server.finish_viz(self.now, job_id, path);
    }
}

fn object(x: f64) -> VisionPoint {
    VisionPoint {
        base_from_object: Pose::new(Vector::new(x, 0.1, 0.45), Vector::z() * 30f64.to_radians()),
        label: 3,
    }
}

fn waypoint(place: usize, is_vision_move: bool) -> PathPoint {
    PathPoint {
        joints: JointPositions::from_degrees(&[place as f64 + 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        base_from_tcp: Pose::translation(0.6, 0.1, 0.45),
        motion: Motion::Joint,
        tool: 1,
        velocity_percent: 80.4,
        label: 0,
        vision_move: is_vision_move.then(|| VisionMoveData {
            labels: [0; 10],
            picked_total: 1,
            picked_now: 1,
            edge_or_corner: 0,
            group_from_tcp_offset: Vector::zeros(),
            is_group_square: false,
            is_box_square: false,
            group_size: BoxSize::from_mm([400.0, 300.0, 250.0]),
        }),
    }
}

fn path(length: usize, vision_move: Option<usize>) -> VizPath {
    VizPath {
        points: (0..length)
            .map(|place| waypoint(place, Some(place) == vision_move))
            .collect(),
        digital_outputs: vec![1, 3],
    }
}
