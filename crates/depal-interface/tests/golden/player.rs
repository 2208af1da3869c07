//! A server that plays a transcript, and what the transcript says about its jobs.

use std::collections::VecDeque;

use depal_frames::{EulerConvention, JointPositions};
use depal_interface::*;
use depal_time::{SimDuration, SimTime};

use crate::notation::*;

const PORT: PortId = PortId(0);
const CLIENT: ConnectionId = ConnectionId(1);

pub struct Player {
    server: Server,
    encoding: Encoding,
    now: SimTime,
    pub replies: VecDeque<Vec<u8>>,
    jobs: Vec<Job>,
    waypoints: Vec<PathPoint>,
    custom_ports: Vec<CustomPort>,
    sections: usize,
    pub setup: String,
}

impl Player {
    pub fn new(setup: &str, property_config: &str, encoding: Encoding) -> Self {
        let items = |key: &str| -> Vec<Vec<&str>> {
            let head = format!("{key}=");
            let value = setup
                .split_whitespace()
                .find_map(|word| word.strip_prefix(&head))
                .unwrap_or_default();
            let list = value.split(',').filter(|item| !item.is_empty());
            list.map(|item| item.split(':').collect()).collect()
        };
        let whole = |text: &str| text.parse::<i32>().expect("a whole number");
        let inputs = items("inputs");
        let projects = items("projects").into_iter().map(|fields| {
            let project = project(&fields.join(":"));
            let steps = inputs.iter().filter(|input| whole(input[0]) == project.id);
            VisionProject {
                input_steps: steps.map(|input| input[1].to_owned()).collect(),
                ..project
            }
        });
        let viz = VizProject {
            branches: items("branches")
                .iter()
                .map(|branch| BranchStep {
                    step: whole(branch[0]),
                    exits: whole(branch[1]),
                })
                .collect(),
            index_steps: items("index")
                .iter()
                .map(|index| IndexStep {
                    step: whole(index[0]),
                    places: whole(index[1]),
                })
                .collect(),
            parameters: items("parameters")
                .iter()
                .map(|parameter| StepParameter {
                    step: whole(parameter[0]),
                    key: parameter[1].to_owned(),
                    value: parameter[2].parse().expect("a value"),
                    writable: Some(ParameterRange::ANY),
                })
                .collect(),
        };
        let variables = items("variables").into_iter().map(|variable| Variable {
            name: variable[0].to_owned(),
            kind: match variable[1] {
                "number" => VariableKind::Number,
                "numbers" => VariableKind::Numbers,
                "text" => VariableKind::Text,
                "texts" => VariableKind::Texts,
                other => panic!("kind {other}"),
            },
        });
        let poses = items("calibration").first().map_or(0, |n| whole(n[0]));
        let settings = ServerSettings {
            ports: vec![PortSettings {
                encoding,
                ..PortSettings::default()
            }],
            projects: projects.collect(),
            viz: Some(viz),
            solutions: items("solutions").iter().map(|n| whole(n[0])).collect(),
            variables: variables.collect(),
            property_config: property_config.to_owned(),
            calibration: (0..poses).map(|n| calibration_pose(f64::from(n))).collect(),
            ..ServerSettings::default()
        };
        let mut player = Self {
            server: Server::new(settings).expect("good settings"),
            encoding,
            now: SimTime::ZERO,
            replies: VecDeque::new(),
            jobs: Vec::new(),
            waypoints: Vec::new(),
            custom_ports: Vec::new(),
            sections: 0,
            setup: setup.to_owned(),
        };
        player.server.handle_connect(player.now, PORT, CLIENT);
        player
    }

    pub fn send(&mut self, bytes: &[u8]) {
        self.server.handle_input(self.now, PORT, CLIENT, bytes);
        self.collect();
        if self.encoding.is_hex() {
            // The first frame of a connection ends with silence.
            self.wait(20);
        }
    }

    fn wait(&mut self, millis: u64) {
        self.now += SimDuration::from_millis(millis);
        self.server.handle_timeout(self.now);
        self.collect();
    }

    fn collect(&mut self) {
        self.replies
            .extend(std::iter::from_fn(|| self.server.poll_reply()).map(|r| r.bytes));
        self.jobs
            .extend(std::iter::from_fn(|| self.server.poll_job()));
    }

    /// No reply may be left over.
    #[track_caller]
    pub fn settle(&self, place: &str) {
        let left: Vec<_> = self.replies.iter().cloned().map(readable).collect();
        assert!(
            left.is_empty(),
            "before {place}: not in the transcript: {left:?}"
        );
    }

    pub fn act(&mut self, line: &str, place: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["wait", millis] => self.wait(millis.parse().expect("milliseconds")),
            ["vision", "error", code] => self.finish_vision(Err(status(code))),
            ["vision", "path", ..] => {
                let (job_id, path) = (self.vision_job(), self.path(&words[2..]));
                self.server.finish_vision_path(self.now, job_id, Ok(path));
            }
            ["vision", "custom", points @ ..] => {
                let result = VisionResult {
                    points: points.iter().map(|point| vision_point(point)).collect(),
                    custom_ports: std::mem::take(&mut self.custom_ports),
                };
                let job_id = self.vision_job();
                self.server
                    .finish_vision_custom(self.now, job_id, Ok(result));
            }
            ["vision", points @ ..] => {
                self.finish_vision(Ok(points.iter().map(|point| vision_point(point)).collect()));
            }
            ["custom", ports @ ..] => {
                self.custom_ports = ports.iter().map(|port| custom_port(port)).collect();
            }
            ["sections", sections] => self.sections = sections.parse().expect("sections"),
            ["notify", message] => {
                let job_id = self.viz_job();
                let message = message.parse().expect("message");
                self.server.notify(self.now, job_id, message);
            }
            [
                "waypoint",
                motion,
                "pose",
                pose,
                "joints",
                joints,
                "tool",
                tool,
                "velocity",
                velocity,
                "label",
                label,
                plan @ ..,
            ] => {
                self.waypoints.push(PathPoint {
                    joints: JointPositions::from_degrees(&six(joints)),
                    base_from_tcp: EulerConvention::AbbZyx.pose_from_mm_deg(six(pose)),
                    motion: if *motion == "linear" {
                        Motion::Linear
                    } else {
                        Motion::Joint
                    },
                    tool: tool.parse().expect("tool"),
                    velocity_percent: velocity.parse().expect("velocity"),
                    label: label.parse().expect("label"),
                    vision_move: plan.get(1).map(|plan| vision_move(&numbers(plan))),
                });
            }
            ["viz", "error", code] => self.finish_viz(Err(status(code))),
            ["viz", rest @ ..] => {
                let (job_id, path) = (self.viz_job(), self.path(rest));
                self.server.finish_viz_path(self.now, job_id, Ok(path));
            }
            ["at", "branch", step] => {
                let job_id = self.viz_job();
                self.server
                    .viz_waiting_at_branch(self.now, job_id, step.parse().expect("step"));
            }
            ["expect", "branch", step, "exit", exit] => {
                let expected = Job::SetBranch {
                    job_id: self.viz_job(),
                    step: step.parse().expect("step"),
                    exit: exit.parse().expect("exit"),
                };
                self.expect_job(place, |job| *job == expected);
            }
            ["expect", "index", step, "at", index] => {
                let expected = Job::SetIndex {
                    job_id: self.viz_job(),
                    step: step.parse().expect("step"),
                    index: index.parse().expect("index"),
                };
                self.expect_job(place, |job| *job == expected);
            }
            ["expect", "capture", wanted] => {
                let wanted: usize = wanted.parse().expect("number");
                self.expect_job(
                    place,
                    |job| matches!(job, Job::CaptureCalibration { number, .. } if *number == wanted),
                );
            }
            _ => panic!("{place}: unknown action {line}"),
        }
        self.collect();
    }

    fn expect_job(&mut self, place: &str, is_wanted: impl Fn(&Job) -> bool) {
        self.collect();
        let found = self.jobs.iter().position(is_wanted);
        let found = found.unwrap_or_else(|| panic!("{place}: jobs are {:?}", self.jobs));
        self.jobs.remove(found);
    }

    /// The waypoints and custom values told so far, with `outputs N ... | N ...`.
    fn path(&mut self, words: &[&str]) -> PlannedPath {
        let outputs = words.split_first().map_or(&[] as &[_], |(_, rest)| rest);
        PlannedPath {
            points: std::mem::take(&mut self.waypoints),
            rounds: outputs
                .split(|word| *word == "|")
                .map(|round| round.iter().map(|n| n.parse().expect("output")).collect())
                .collect(),
            sections: self.sections,
            custom_ports: std::mem::take(&mut self.custom_ports),
        }
    }

    fn vision_job(&self) -> JobId {
        let job_id = self.jobs.iter().rev().find_map(|job| match job {
            Job::RunVision { job_id, .. } => Some(*job_id),
            _ => None,
        });
        job_id.expect("a vision run")
    }

    fn finish_vision(&mut self, outcome: VisionOutcome) {
        let job_id = self.vision_job();
        self.server.finish_vision(self.now, job_id, outcome);
    }

    fn viz_job(&self) -> JobId {
        let job_id = self.jobs.iter().rev().find_map(|job| match job {
            Job::StartViz { job_id, .. } => Some(*job_id),
            _ => None,
        });
        job_id.expect("a Viz run")
    }

    fn finish_viz(&mut self, outcome: VizOutcome) {
        let job_id = self.viz_job();
        self.server.finish_viz(self.now, job_id, outcome);
    }
}
