//! Replays the transcripts in `tests/golden/wire` byte by byte, in virtual time and without sockets.
//!
//! Each transcript is played three times: as text, packed little-endian as written, and big-endian with
//! the bytes of every cell reversed. Lines:
//!
//! - `# ...` a comment; `-> KIND ...` what the robot sends; `<- KIND ...` the next reply, KIND `ascii` or `hex-le`
//!   (`\r` escaped; bytes in hexadecimal, `|` between cells, `+N` for N zeros);
//! - `! setup projects=ID:poses|path[:RECIPE+RECIPE],... branches=STEP:EXITS,...`;
//! - `! wait MS`; `! vision X,Y,Z,TURN,LABEL ...` (top faces, mm and degrees); `! vision error CODE`;
//! - `! waypoint joint|linear pose P6 joints J6 tool T velocity V label L [plan 21 values]`, then
//!   `! viz [outputs N ...]` or `! viz error CODE`; `! at branch STEP`; `! expect branch STEP exit EXIT`.
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
    for command in [101, 102, 103, 201, 202, 203, 205, 206, 210, 501, 901] {
        let head = format!("{command}_");
        assert!(
            names.iter().any(|name| name.starts_with(&head)),
            "no transcript of {command}"
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
            "!" if rest.starts_with("setup ") => player = Some(Player::new(rest, encoding)),
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
    fn new(setup: &str, encoding: Encoding) -> Self {
        let value = |key: &str| {
            let head = format!("{key}=");
            setup
                .split_whitespace()
                .find_map(|word| word.strip_prefix(&head))
                .unwrap_or_default()
        };
        let branches = value("branches").split(',').map(|branch| {
            let (step, exits) = branch.split_once(':').expect("STEP:EXITS");
            BranchStep {
                step: step.parse().expect("step"),
                exits: exits.parse().expect("exits"),
            }
        });
        let settings = ServerSettings {
            ports: vec![PortSettings {
                encoding,
                ..PortSettings::default()
            }],
            projects: value("projects").split(',').map(project).collect(),
            viz: Some(VizProject {
                branches: branches.collect(),
                ..VizProject::default()
            }),
            ..ServerSettings::default()
        };
        let mut player = Self {
            server: Server::new(settings).expect("good settings"),
            encoding,
            now: SimTime::ZERO,
            replies: VecDeque::new(),
            jobs: Vec::new(),
            waypoints: Vec::new(),
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
            ["vision", points @ ..] => {
                let points = points.iter().map(|point| {
                    let v = numbers(point);
                    VisionPoint {
                        base_from_object: Pose::new(
                            Vector::new(v[0], v[1], v[2]) * 1e-3,
                            Vector::z() * v[3].to_radians(),
                        ),
                        label: v[4] as i32,
                    }
                });
                self.finish_vision(Ok(points.collect()));
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
            ["viz"] | ["viz", "outputs", ..] => {
                let path = VizPath {
                    points: std::mem::take(&mut self.waypoints),
                    digital_outputs: words
                        .iter()
                        .skip(2)
                        .map(|n| n.parse().expect("output"))
                        .collect(),
                };
                self.finish_viz(Ok(path));
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
                self.collect();
                let place_of_job = self.jobs.iter().position(|job| *job == expected);
                let found =
                    place_of_job.unwrap_or_else(|| panic!("{place}: jobs are {:?}", self.jobs));
                self.jobs.remove(found);
            }
            _ => panic!("{place}: unknown action {line}"),
        }
        self.collect();
    }

    fn finish_vision(&mut self, outcome: VisionOutcome) {
        let job_id = self.jobs.iter().rev().find_map(|job| match job {
            Job::RunVision { job_id, .. } => Some(*job_id),
            _ => None,
        });
        self.server
            .finish_vision(self.now, job_id.expect("a vision run"), outcome);
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
