//! Replays the transcripts in `tests/golden/wire` byte by byte, in virtual time and without sockets.
//!
//! Each transcript is played three times: as text, packed little-endian as written, and big-endian with
//! the bytes of every cell reversed. Lines:
//!
//! - `# ...` a comment; `-> KIND ...` what the robot sends; `<- KIND ...` the next reply, KIND `ascii` or `hex-le`
//!   (`\r` escaped; bytes in hexadecimal, `|` between cells, `+N` for N zeros);
//! - `! setup projects=ID:poses|path|custom[:RECIPE+RECIPE],... branches=STEP:EXITS,... [index=STEP:PLACES,...]
//!   [parameters=STEP:KEY:VALUE,...] [solutions=N,...] [variables=NAME:KIND,...] [inputs=PROJECT:STEP,...]
//!   [calibration=POSES]`; `! property LINE ; LINE ...` right after it;
//! - `! wait MS`; `! vision X,Y,Z,TURN,LABEL ...` (top faces, mm and degrees); `! vision error CODE`;
//! - `! waypoint joint|linear pose P6 joints J6 tool T velocity V label L [plan 21 values]`, then
//!   `! viz [outputs N ... | N ...]` (rounds) or `! viz error CODE`, or the same with `! vision path`;
//! - `! custom PORT=V,V|V,V ...` and `! sections N` for the next result; `! vision custom X,Y,Z,TURN,LABEL ...`;
//! - `! notify MESSAGE`; `! at branch STEP`; `! expect branch STEP exit EXIT`; `! expect index STEP at INDEX`;
//!   `! expect capture NUMBER`.
//!
//! Replies must come exactly where they stand: after every other line nothing may be left over.

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::path::Path;

use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_interface::*;
use depal_time::{SimDuration, SimTime};

const PORT: PortId = PortId(0);
const CLIENT: ConnectionId = ConnectionId(1);

struct Player {
    server: Server,
    encoding: Encoding,
    now: SimTime,
    replies: VecDeque<Vec<u8>>,
    jobs: Vec<Job>,
    waypoints: Vec<PathPoint>,
    custom_ports: Vec<CustomPort>,
    sections: usize,
    setup: String,
}

// Transcripts are files on purpose: they are read by people and shared with other tests.
#[allow(clippy::disallowed_methods)]
#[test]
fn transcripts_replay_byte_by_byte() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/wire");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .expect("folder of transcripts")
        .map(|entry| entry.expect("entry").path())
        .collect();
    files.sort();
    let names: Vec<String> = files
        .iter()
        .map(|file| {
            file.file_name()
                .expect("name")
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    for command in depal_wire::Request::CODES {
        let head = format!("{command}_");
        assert!(
            names.iter().any(|name| name.starts_with(&head)),
            "no transcript of {command}"
        );
    }
    for dialogue in ["a", "b", "c", "d", "e", "f"] {
        let head = format!("dialogue_{dialogue}_");
        assert!(
            names.iter().any(|name| name.starts_with(&head)),
            "no dialogue {dialogue}"
        );
    }
    for (file, name) in files.iter().zip(&names) {
        let text = std::fs::read_to_string(file).expect("readable transcript");
        for encoding in [
            Encoding::Ascii,
            Encoding::HexLittleEndian,
            Encoding::HexBigEndian,
        ] {
            play(name, &text, encoding);
        }
    }
}

fn play(name: &str, text: &str, encoding: Encoding) {
    let mut player: Option<Player> = None;
    for (number, line) in text.lines().enumerate() {
        let place = format!("{name}:{} ({})", number + 1, encoding.name());
        let (mark, rest) = line.split_once(' ').unwrap_or((line, ""));
        match mark {
            "" | "#" => {}
            "!" if rest.starts_with("setup ") => player = Some(Player::new(rest, "", encoding)),
            "!" if rest.starts_with("property ") => {
                let setup = player.expect("setup comes first").setup;
                let lines = rest["property ".len()..].replace(';', "\n");
                player = Some(Player::new(&setup, &lines, encoding));
            }
            "!" => {
                let player = player.as_mut().expect("setup comes first");
                player.settle(&place);
                player.act(rest, &place);
            }
            "->" | "<-" => {
                let player = player.as_mut().expect("setup comes first");
                let Some(bytes) = bytes_of(rest, encoding) else {
                    continue;
                };
                if mark == "->" {
                    player.settle(&place);
                    player.send(&bytes);
                } else {
                    let reply = player.replies.pop_front();
                    assert_eq!(reply.map(readable), Some(readable(bytes)), "{place}");
                }
            }
            _ => panic!("{place}: {line}"),
        }
    }
    player.expect("a setup line").settle(name);
}

/// Bytes of a `->` or `<-` line, if it is meant for this encoding.
fn bytes_of(line: &str, encoding: Encoding) -> Option<Vec<u8>> {
    let (kind, body) = line.split_once(' ').expect("kind and bytes");
    let body = body.trim();
    if (kind == "ascii") == encoding.is_hex() {
        return None;
    }
    if kind == "ascii" {
        return Some(body.replace("\\r", "\r").into_bytes());
    }
    let mut bytes = Vec::new();
    for word in body.split_whitespace().filter(|word| *word != "|") {
        match word.strip_prefix('+') {
            Some(zeros) => bytes.resize(bytes.len() + zeros.parse::<usize>().expect("zeros"), 0),
            None => bytes.push(u8::from_str_radix(word, 16).expect("a byte")),
        }
    }
    if encoding == Encoding::HexBigEndian {
        bytes.chunks_exact_mut(4).for_each(<[u8]>::reverse);
    }
    Some(bytes)
}

/// Text as it is, cells in hexadecimal, so that a failure can be read.
fn readable(bytes: Vec<u8>) -> String {
    let is_text = bytes.iter().all(|b| matches!(b, b' '..=b'~' | b'\r'));
    if is_text && !bytes.is_empty() {
        return String::from_utf8_lossy(&bytes).into_owned();
    }
    let mut text = format!("{} bytes:", bytes.len());
    for cell in bytes.chunks(4) {
        text.push(' ');
        for byte in cell {
            write!(text, "{byte:02x}").expect("writing to a string");
        }
    }
    text
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(',')
        .map(|n| n.parse().expect("a number"))
        .collect()
}

fn six(text: &str) -> [f64; 6] {
    numbers(text).try_into().expect("six numbers")
}

fn status(text: &str) -> Status {
    Status::from_code(text.parse().expect("a code")).expect("a known code")
}

fn project(text: &str) -> VisionProject {
    let fields: Vec<&str> = text.split(':').collect();
    VisionProject {
        id: fields[0].parse().expect("project number"),
        output: match fields[1] {
            "poses" => OutputPort::Poses,
            "path" => OutputPort::Path,
            "custom" => OutputPort::Custom,
            other => panic!("output {other}"),
        },
        recipes: fields.get(2).map_or(Vec::new(), |list| {
            list.split('+')
                .map(|r| r.parse().expect("recipe"))
                .collect()
        }),
        ..VisionProject::default()
    }
}

impl Player {
    fn new(setup: &str, property_config: &str, encoding: Encoding) -> Self {
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

    fn send(&mut self, bytes: &[u8]) {
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
    fn settle(&self, place: &str) {
        let left: Vec<_> = self.replies.iter().cloned().map(readable).collect();
        assert!(
            left.is_empty(),
            "before {place}: not in the transcript: {left:?}"
        );
    }

    fn act(&mut self, line: &str, place: &str) {
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

/// The 21 numbers of the standard, in their order on the wire.
fn vision_move(values: &[f64]) -> VisionMoveData {
    let mut labels = [0; 10];
    for (label, value) in labels.iter_mut().zip(values) {
        *label = *value as i32;
    }
    VisionMoveData {
        labels,
        picked_total: values[10] as i32,
        picked_now: values[11] as i32,
        edge_or_corner: values[12] as i32,
        group_from_tcp_offset: Vector::new(values[13], values[14], values[15]) * 1e-3,
        is_group_square: values[16] != 0.0,
        is_box_square: values[17] != 0.0,
        group_size: BoxSize::from_mm([values[18], values[19], values[20]]),
    }
}

fn vision_point(text: &str) -> VisionPoint {
    let v = numbers(text);
    VisionPoint {
        base_from_object: Pose::new(
            Vector::new(v[0], v[1], v[2]) * 1e-3,
            Vector::z() * v[3].to_radians(),
        ),
        label: v[4] as i32,
    }
}

fn custom_port(text: &str) -> CustomPort {
    let (name, rows) = text.split_once('=').expect("PORT=ROWS");
    CustomPort {
        name: name.to_owned(),
        rows: rows.split('|').map(numbers).collect(),
    }
}

/// Pose n of the calibrations in the transcripts.
fn calibration_pose(n: f64) -> CalibrationPose {
    CalibrationPose {
        base_from_flange: EulerConvention::AbbZyx.pose_from_mm_deg([
            600.0 + 10.0 * n,
            0.0,
            800.0,
            0.0,
            0.0,
            180.0,
        ]),
        joints: JointPositions::from_degrees(&[10.0 * n, 0.0, 10.0, 0.0, 30.0, 0.0]),
    }
}
