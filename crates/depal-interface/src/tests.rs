use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_time::{SimDuration, SimTime};
use proptest::prelude::*;

use crate::*;

mod coverage;
mod faults;
mod order_model;
mod property_config;
mod robot_pose;

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

#[test]
fn points_are_turned_down_and_come_once() {
    let mut bench = Bench::new();
    bench.check("101,1,0,0,0,0,0,0,0,0", "101,1102");
    let job = bench.job_id();
    bench
        .server
        .finish_vision(bench.now, job, Ok(vec![object(0.6)]));
    bench.check(
        "102,1",
        "102,1100,1,1,0,600.0,100.0,450.0,30.0,0.0,180.0,3,0",
    );
    bench.check("102,1", "102,1002");
}

#[test]
fn angles_follow_the_brand() {
    let mut bench = Bench::with_port(PortSettings {
        euler: EulerConvention::FanucWpr,
        ..PortSettings::default()
    });
    bench.check("101,1,0,0", "101,1102");
    let job = bench.job_id();
    bench
        .server
        .finish_vision(bench.now, job, Ok(vec![object(0.6)]));
    bench.check(
        "102,1",
        "102,1100,1,1,0,600.0,100.0,450.0,180.0,0.0,30.0,3,0",
    );
}

#[test]
fn order_rules_of_vision() {
    let mut bench = Bench::new();
    bench.check("102,1", "102,1020");
    bench.check("102,9", "102,1011");
    bench.check("102,2", "102,1016");
    bench.check("101,9,0,0,0,0,0,0,0,0", "101,1011");
    bench.check("101,1,0,9,0,0,0,0,0,0", "101,1005");
    bench.check("101,1,-1,0,0,0,0,0,0,0", "101,1018");
    bench.check("101,1,0,2,10001,0,0,0,0,0", "101,1006");
    bench.check("101,1,0,2,0,0,0,361,0,0", "101,1006");
    bench.check("103,1,3", "103,1012");
    bench.check("103,3,1", "103,1013");
    bench.check("103,1,2", "103,1107");
    bench.check("501,1,400,0,250", "501,1022");
    bench.check("501,1,400,300,nan", "501,1022");
    bench.check("501,1,300,400,250", "501,1108");
    bench.check("101,1,2,0,0,0,0,0,0,0", "101,1102");
    for refused in ["101,1,0,0", "103,1,1", "501,1,1,1,1"] {
        bench.check(refused, &format!("{},1007", &refused[..3]));
    }
    let Job::RunVision {
        job_id,
        recipe,
        box_size,
        pose,
        ..
    } = bench.job()
    else {
        panic!("not a vision job");
    };
    assert_eq!((recipe, pose), (Some(2), RobotPose::NotSent));
    assert_eq!(box_size, Some(BoxSize::from_mm([400.0, 300.0, 250.0])));
    bench.check("101,3,0,0", "101,1102");
    let found = vec![object(0.6), object(0.7), object(0.8)];
    bench.server.finish_vision(bench.now, job_id, Ok(found));
    bench.send(CLIENT, "102,1");
    assert!(
        bench.replies()[0].starts_with("102,1100,1,2,0,"),
        "count limits the points"
    );
    bench.check("101,1,0,0", "101,1102");
    assert!(matches!(bench.job(), Job::RunVision { project: 3, .. }));
    let job = bench.job_id();
    bench
        .server
        .finish_vision(bench.now, job, Err(Status::NoPointsInRegion));
    bench.check("102,1", "102,1003");
    bench.check("101,1,0,0", "101,1102");
    let job = bench.job_id();
    bench.server.finish_vision(bench.now, job, Ok(Vec::new()));
    bench.check("102,1", "102,1002");
}

#[test]
fn a_waiting_get_is_answered_by_the_run_or_the_timeout() {
    let mut bench = Bench::new();
    bench.check("101,1,0,0", "101,1102");
    let job = bench.job_id();
    bench.check("102,1", "");
    assert_eq!(
        bench.server.poll_timeout(),
        Some(SimTime::from_nanos(10_000_000_000))
    );
    bench.wait(9_999);
    assert_eq!(bench.replies(), Vec::<String>::new());
    bench.wait(1);
    assert_eq!(bench.replies(), ["102,1019"]);
    assert_eq!(bench.server.poll_timeout(), None);
    // The run lives on; two commands in the pipe are answered in order.
    bench.send(CLIENT, "102,1\r901");
    assert_eq!(bench.replies(), Vec::<String>::new());
    bench
        .server
        .finish_vision(bench.now, job, Ok(vec![object(0.6)]));
    let replies = bench.replies();
    assert!(
        replies[0].starts_with("102,1100,1,1,0,600.0"),
        "{replies:?}"
    );
    assert_eq!(replies[1..], ["901,1101"]);
}

#[test]
fn more_than_the_cap_comes_in_parts() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.finish_viz(job, Ok(path(45, Some(22))));
    let mut heads = Vec::new();
    for _ in 0..4 {
        bench.send(CLIENT, "205,1");
        let reply = bench.replies().remove(0);
        heads.push(reply.split(',').take(6).collect::<Vec<_>>().join(","));
    }
    assert_eq!(
        heads,
        [
            "205,2100,0,20,23,1.0",
            "205,2100,0,20,3,21.0",
            "205,2100,1,5,0,41.0",
            "205,2022"
        ]
    );
}

#[test]
fn order_rules_of_viz() {
    let mut bench = Bench::new();
    bench.check("202", "202,2104");
    bench.check("205,1", "205,2022");
    bench.check("210,1", "210,2022");
    bench.check("206", "206,2011");
    bench.check("203,7,1", "203,2022");
    bench.check("203,7,0", "203,2018");
    bench.check("203,7,3", "203,2018");
    bench.check("203,99,1", "203,2024");
    bench.check("201,9,0,0,0,0,0,0", "201,2006");
    bench.check("201,2,0,0,0,0,0,nan", "201,2013");
    let job = bench.start_viz();
    bench.check("201,0", "201,2002");
    bench.check("205,3", "205,2012");
    bench.check("210,5", "210,2012");
    bench.check("206", "206,2011");
    bench.finish_viz(job, Ok(path(3, Some(1))));
    let list = format!("206,2102,1,3{}", ",-1".repeat(62));
    bench.check("206", &list);
    bench.check("210,1", "210,2100,0,0,1.0,0.0,0.0,0.0,0.0,0.0,1,1,80");
    bench.check("205,1", "205,2042");
    bench.check("210,1", "210,2100,0,1,2.0,0.0,0.0,0.0,0.0,0.0,1,1,80,0");
    bench.check("210,1", "210,2100,1,0,3.0,0.0,0.0,0.0,0.0,0.0,1,1,80");
    bench.check("210,1", "210,2022");
    bench.check("206,4", &list);
    bench.check("203,7,1", "203,2022");
    let job = bench.start_viz();
    bench.finish_viz(job, Err(Status::VizNoPointsInRegion));
    bench.check("203,7,1", "203,2105");
    bench.check("205,1", "205,2038");
    bench.check("206", "206,2011");
}

#[test]
fn stop_gives_the_run_up() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.check("205,1", "");
    let other = ConnectionId(2);
    bench.server.handle_connect(bench.now, PORT, other);
    bench.send(other, "202");
    assert_eq!(bench.replies(), ["202,2104", "205,2022"]);
    assert_eq!(bench.job(), Job::StopViz { job_id: job });
    // Too late: the run is no longer wanted.
    bench.finish_viz(job, Ok(path(2, Some(0))));
    bench.check("205,1", "205,2022");
}

#[test]
fn a_branch_exit_is_latched_until_its_step_is_reached() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.check("203,7,2", "203,2105");
    assert_eq!(bench.server.poll_job(), None);
    bench.server.viz_waiting_at_branch(bench.now, job, 7);
    let go_on = Job::SetBranch {
        job_id: job,
        step: 7,
        exit: 1,
    };
    assert_eq!(bench.job(), go_on);
    // The other way round, and with a timeout in between.
    bench.check("202", "202,2104");
    bench.job();
    let job = bench.start_viz();
    bench.server.viz_waiting_at_branch(bench.now, job, 7);
    assert_eq!(bench.server.poll_job(), None, "every run needs its own 203");
    bench.check("205,2", "");
    bench.wait(10_000);
    assert_eq!(bench.replies(), ["205,2025"]);
    bench.check("203,7,1", "203,2105");
    assert_eq!(
        bench.job(),
        Job::SetBranch {
            job_id: job,
            step: 7,
            exit: 0
        }
    );
    bench.finish_viz(job, Ok(path(1, None)));
    bench.check("205,2", "205,2100,1,1,0,600.0,100.0,450.0,0.0,0.0,0.0,0,80");
}

#[test]
fn results_outlive_the_connection_and_come_once() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.check("205,1", "");
    bench.server.handle_disconnect(bench.now, PORT, CLIENT);
    bench.finish_viz(job, Ok(path(1, None)));
    assert_eq!(bench.replies(), Vec::<String>::new());
    let next = ConnectionId(2);
    bench.server.handle_connect(bench.now, PORT, next);
    bench.send(next, "205,1\r205,1");
    let replies = bench.replies();
    assert!(replies[0].starts_with("205,2100,1,1,0,1.0"), "{replies:?}");
    assert_eq!(replies[1], "205,2022");
}

#[test]
fn all_zero_joints_are_never_sent() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    let mut zero = path(1, None);
    zero.points[0].joints = JointPositions::zeros(6);
    bench.finish_viz(job, Ok(zero));
    bench.check(
        "205,1",
        &format!("205,2100,1,1,0{},0,80", ",0.0001".repeat(6)),
    );
}

#[test]
fn swapped_bytes_are_named_in_the_log() {
    let mut bench = Bench::with_port(PortSettings {
        encoding: Encoding::HexLittleEndian,
        ..PortSettings::default()
    });
    let mut frame = [0u8; 64];
    frame[..4].copy_from_slice(&901i32.to_be_bytes());
    bench.server.handle_input(bench.now, PORT, CLIENT, &frame);
    bench.wait(20);
    let reply = bench.server.poll_reply().unwrap();
    assert_eq!(reply.status, Some(Status::InvalidCommand));
    assert_eq!(reply.bytes[..4], frame[..4]);
    let entry = bench.server.poll_log().unwrap();
    assert!(
        entry.text.contains("byte order? Swapped it is 901"),
        "{}",
        entry.text
    );
}

#[test]
fn the_log_names_what_was_said() {
    let mut bench = Bench::new();
    bench.check("901", "901,1101");
    bench.check("103,1", "103,3002");
    let log: Vec<_> = std::iter::from_fn(|| bench.server.poll_log())
        .map(|e| (e.direction, e.command, e.status, e.text))
        .collect();
    let expected = [
        (Direction::Received, 901, None, "901 (get state)"),
        (Direction::Sent, 901, Some(1101), "901,1101 (vision ready)"),
        (
            Direction::Received,
            103,
            None,
            "refused: field 3 is missing",
        ),
        (
            Direction::Sent,
            103,
            Some(3002),
            "103,3002 (wrong number or form of parameters)",
        ),
    ];
    assert_eq!(log, expected.map(|(d, c, s, t)| (d, c, s, t.to_owned())));
}

#[test]
fn an_endless_line_is_cut() {
    let mut bench = Bench::new();
    bench
        .server
        .handle_input(bench.now, PORT, CLIENT, &[b'7'; 5000]);
    let reply = bench.server.poll_reply().unwrap();
    assert!(reply.closes);
    bench.check("901", "");
}

#[test]
fn a_flood_behind_a_waiting_request_is_cut() {
    let mut bench = Bench::new();
    bench.start_viz();
    bench.check("205,1", "");
    for _ in 0..20 {
        let flood = "901\r".repeat(1_000);
        bench
            .server
            .handle_input(bench.now, PORT, CLIENT, flood.as_bytes());
    }
    assert!(bench.server.poll_reply().unwrap().closes);
    assert_eq!(bench.server.poll_reply(), None);
    assert_eq!(bench.server.poll_timeout(), None);
}

#[test]
fn sessions_do_not_touch_one_another() {
    let settings = ServerSettings {
        ports: vec![PortSettings::default(), PortSettings::default()],
        ..ServerSettings::default()
    };
    let mut server = Server::new(settings).unwrap();
    for port in [PortId(0), PortId(1)] {
        server.handle_connect(SimTime::ZERO, port, CLIENT);
        server.handle_input(SimTime::ZERO, port, CLIENT, b"201,0\r");
        assert_eq!(server.poll_reply().unwrap().bytes, b"201,2103\r");
    }
    let jobs: Vec<_> = std::iter::from_fn(|| server.poll_job()).collect();
    assert!(matches!(
        jobs[1],
        Job::StartViz {
            job_id: JobId {
                port: PortId(1),
                number: 1
            },
            ..
        }
    ));
}

#[test]
fn settings_are_checked() {
    let mut settings = ServerSettings::default();
    settings.ports[0].profile.pose_cap = 31;
    let refused = Server::new(settings).unwrap_err();
    assert_eq!(refused, InterfaceError::PoseCap { port: 0, found: 31 });
    let mut settings = ServerSettings::default();
    settings.projects.push(settings.projects[0].clone());
    assert_eq!(
        settings.check(),
        Err(InterfaceError::DuplicateProject { id: 1 })
    );
}

/// What a client or the cell may do in the random walk below.
fn action() -> impl Strategy<Value = (u8, String)> {
    let requests = prop::sample::select(vec![
        "101,1,0,0",
        "101,3,1,0",
        "102,1",
        "102,3",
        "103,1,1",
        "201,0",
        "202",
        "203,7,1",
        "205,1",
        "210,3",
        "206",
        "501,1,4,3,2",
        "901",
        "999",
        "x",
        "103,1",
    ]);
    (0u8..9, requests.prop_map(str::to_owned))
}

proptest! {
    /// Every request gets exactly one reply to its own command, in order, whatever the order of commands
    /// and the fate of the runs; the last ones after the timeout.
    #[test]
    fn every_request_is_answered_once(actions in prop::collection::vec(action(), 1..60)) {
        let mut bench = Bench::new();
        let mut jobs: Vec<Job> = Vec::new();
        let (mut asked, mut answered) = (Vec::new(), Vec::new());
        for (kind, request) in actions {
            match (kind, jobs.pop()) {
                (0, _) => bench.wait(3_000),
                (1, Some(Job::RunVision { job_id, .. })) => {
                    bench.server.finish_vision(bench.now, job_id, Ok(vec![object(0.5); 25]));
                }
                (1, Some(Job::StartViz { job_id, .. })) => bench.finish_viz(job_id, Ok(path(22, Some(3)))),
                (2, Some(Job::StartViz { job_id, .. })) => {
                    bench.finish_viz(job_id, Err(Status::VizUnreachable));
                }
                (_, job) => {
                    jobs.extend(job);
                    let command = request.split(',').next().unwrap_or_default();
                    asked.push(if command == "x" { "0".to_owned() } else { command.to_owned() });
                    bench.send(CLIENT, &request);
                }
            }
            jobs.extend(std::iter::from_fn(|| bench.server.poll_job()));
            answered.extend(bench.replies());
        }
        // Each one still in the pipe may wait for the whole timeout.
        for _ in 0..asked.len() {
            bench.wait(10_000);
            answered.extend(bench.replies());
        }
        let heads: Vec<_> = answered.iter().map(|r| r.split(',').next().unwrap().to_owned()).collect();
        prop_assert_eq!(heads, asked);
    }

    #[test]
    fn any_bytes_leave_the_server_alive(
        pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 0..10),
    ) {
        for encoding in [Encoding::Ascii, Encoding::HexLittleEndian, Encoding::HexBigEndian] {
            let mut bench = Bench::with_port(PortSettings { encoding, ..PortSettings::default() });
            for piece in &pieces {
                bench.server.handle_input(bench.now, PORT, CLIENT, piece);
                bench.wait(5);
            }
            bench.wait(60);
            while bench.server.poll_reply().is_some() {}
            let probe = ConnectionId(2);
            bench.server.handle_connect(bench.now, PORT, probe);
            let frame = depal_wire::Request::GetState(depal_wire::GetState)
                .encode(encoding, &Profile::v1_8());
            bench.server.handle_input(bench.now, PORT, probe, &frame);
            bench.wait(20);
            let reply = bench.server.poll_reply().unwrap();
            prop_assert_eq!(reply.status, Some(Status::VisionReady));
        }
    }
}
