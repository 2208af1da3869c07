//! A vision system in this process: the real server, with jobs done by a script.

use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_interface::{
    BranchStep, CalibrationPose, ConnectionId, CustomPort, Encoding, IndexStep, Job, Motion,
    OutputPort, ParameterRange, PathPoint, PlannedPath, PortId, PortSettings, Server,
    ServerSettings, StepParameter, VisionMoveData, VisionPoint, VisionProject, VisionResult,
    VizProject,
};
use depal_time::{SimDuration, SimTime};

const PORT: PortId = PortId(0);
const CLIENT: ConnectionId = ConnectionId(1);

pub struct Vision {
    server: Server,
    due: Vec<(SimTime, Job)>,
}

/// Joints of waypoint `k`, degrees, in the order of the arm's description.
pub const WAYPOINT: [f64; 6] = [10.0, 20.0, 35.0, 0.0, 60.0, -5.0];

fn path() -> PlannedPath {
    let point = |vision_move: Option<VisionMoveData>| PathPoint {
        joints: JointPositions::from_degrees(&WAYPOINT),
        base_from_tcp: Pose::translation(1.5, 0.25, 0.75),
        motion: Motion::Linear,
        tool: 1,
        velocity_percent: 40.0,
        label: 3,
        vision_move,
    };
    let data = VisionMoveData {
        labels: [3, 3, 0, 0, 0, 0, 0, 0, 0, 0],
        picked_total: 4,
        picked_now: 2,
        edge_or_corner: 1,
        group_from_tcp_offset: Vector::new(0.01, 0.0, 0.0),
        is_group_square: false,
        is_box_square: true,
        group_size: BoxSize::from_mm([400.0, 600.0, 250.0]),
    };
    PlannedPath {
        points: vec![point(None), point(Some(data)), point(None)],
        rounds: vec![vec![1, 2]],
        ..PlannedPath::default()
    }
}

impl Vision {
    pub fn new(encoding: Encoding) -> Self {
        let project = |id: i32, output| VisionProject {
            id,
            recipes: vec![1, 2],
            output,
            ..VisionProject::default()
        };
        let calibration = |x: f64| CalibrationPose {
            base_from_flange: Pose::translation(x, 0.5, 0.5),
            joints: JointPositions::from_degrees(&WAYPOINT),
        };
        let mut server = Server::new(ServerSettings {
            ports: vec![PortSettings {
                encoding,
                euler: EulerConvention::FanucWpr,
                ..PortSettings::default()
            }],
            projects: vec![
                project(1, OutputPort::Poses),
                project(2, OutputPort::Path),
                project(3, OutputPort::Custom),
            ],
            viz: Some(VizProject {
                branches: vec![BranchStep { step: 1, exits: 3 }],
                index_steps: vec![IndexStep {
                    step: 2,
                    places: 20,
                }],
                parameters: vec![StepParameter {
                    step: 3,
                    key: "xCount".into(),
                    value: 6.5,
                    writable: Some(ParameterRange {
                        low: 0.0,
                        excludes_low: false,
                        high: 100.0,
                        is_whole: false,
                    }),
                }],
            }),
            property_config: "read,5,3,xCount\nwrite,1,3,xCount,7\n".into(),
            calibration: [1.0, 1.1, 1.2, 1.3, 1.4].map(calibration).to_vec(),
            ..ServerSettings::default()
        })
        .expect("good settings");
        server.handle_connect(SimTime::ZERO, PORT, CLIENT);
        Self {
            server,
            due: Vec::new(),
        }
    }

    /// Bytes from the robot, as small as it writes them.
    pub fn take(&mut self, now: SimTime, bytes: &[u8]) {
        self.server.handle_input(now, PORT, CLIENT, bytes);
        self.jobs(now);
    }

    fn jobs(&mut self, now: SimTime) {
        while let Some(job) = self.server.poll_job() {
            if let Job::StartViz { job_id, .. } = &job {
                self.server.notify(now, *job_id, 77);
            }
            self.due.push((now + SimDuration::from_millis(300), job));
        }
    }

    /// Bytes for the robot.
    pub fn pump(&mut self, now: SimTime) -> Vec<u8> {
        if self.server.poll_timeout().is_some_and(|at| at <= now) {
            self.server.handle_timeout(now);
        }
        let (ready, later) = std::mem::take(&mut self.due)
            .into_iter()
            .partition(|(at, _)| *at <= now);
        self.due = later;
        let ready: Vec<(SimTime, Job)> = ready;
        for (_, job) in ready {
            self.finish(now, &job);
        }
        self.jobs(now);
        let mut bytes = Vec::new();
        while let Some(reply) = self.server.poll_reply() {
            bytes.extend(reply.bytes);
        }
        bytes
    }

    fn finish(&mut self, now: SimTime, job: &Job) {
        let point = |x: f64, label: i32| VisionPoint {
            base_from_object: Pose::translation(x, 0.2, 0.4),
            label,
        };
        match job {
            Job::RunVision {
                job_id, project: 1, ..
            } => {
                // More points than a part holds.
                let points = (0..23)
                    .map(|k| point(1.0 + 0.01 * f64::from(k), k))
                    .collect();
                self.server.finish_vision(now, *job_id, Ok(points));
            }
            Job::RunVision {
                job_id, project: 2, ..
            } => {
                self.server.finish_vision_path(now, *job_id, Ok(path()));
            }
            Job::RunVision { job_id, .. } => {
                let result = VisionResult {
                    points: vec![point(1.0, 4), point(2.0, 5)],
                    custom_ports: vec![CustomPort {
                        name: "customData1".into(),
                        rows: vec![vec![0.5, 1.5], vec![2.5, 3.5]],
                    }],
                };
                self.server.finish_vision_custom(now, *job_id, Ok(result));
            }
            Job::StartViz { job_id, .. } => self.server.finish_viz_path(now, *job_id, Ok(path())),
            _ => {}
        }
    }
}
