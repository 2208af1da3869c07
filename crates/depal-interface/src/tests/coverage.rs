//! The last column of the status table is true: exactly the codes that have a situation can be heard.

use std::collections::BTreeSet;

use super::*;

/// All statuses heard, from one server after the other.
#[derive(Default)]
struct Ear {
    heard: BTreeSet<Status>,
}

struct Talk<'a> {
    ear: &'a mut Ear,
    server: Server,
    now: SimTime,
}

impl Ear {
    fn talk(&mut self, settings: ServerSettings) -> Talk<'_> {
        let mut server = Server::new(settings).unwrap();
        server.handle_connect(SimTime::ZERO, PORT, CLIENT);
        Talk {
            ear: self,
            server,
            now: SimTime::ZERO,
        }
    }
}

impl Talk<'_> {
    /// Sends the lines and waits until all are answered; returns the jobs.
    fn say(&mut self, lines: &[&str]) -> Vec<Job> {
        for line in lines {
            let bytes = format!("{line}\r");
            self.server
                .handle_input(self.now, PORT, CLIENT, bytes.as_bytes());
        }
        self.listen();
        std::iter::from_fn(|| self.server.poll_job()).collect()
    }

    fn wait(&mut self) {
        self.now += SimDuration::from_millis(10_000);
        self.server.handle_timeout(self.now);
        self.listen();
    }

    fn listen(&mut self) {
        while let Some(reply) = self.server.poll_reply() {
            self.ear.heard.extend(reply.status);
        }
    }

    fn vision(&mut self, start: &str, outcome: Result<VisionResult, Status>) {
        let job_id = job_of(&self.say(&[start]));
        self.server.finish_vision_custom(self.now, job_id, outcome);
    }

    fn vision_path(&mut self, outcome: Result<PlannedPath, Status>) {
        let job_id = job_of(&self.say(&["101,2,0,0"]));
        self.server.finish_vision_path(self.now, job_id, outcome);
    }

    fn viz(&mut self, outcome: Result<PlannedPath, Status>) {
        let job_id = job_of(&self.say(&["201,0"]));
        self.server.finish_viz_path(self.now, job_id, outcome);
    }
}

fn job_of(jobs: &[Job]) -> JobId {
    jobs.iter()
        .find_map(|job| match job {
            Job::RunVision { job_id, .. } | Job::StartViz { job_id, .. } => Some(*job_id),
            _ => None,
        })
        .expect("a run")
}

fn full_settings() -> ServerSettings {
    let project = |id, recipes: &[i32], output| VisionProject {
        id,
        recipes: recipes.to_vec(),
        output,
        input_steps: vec!["pick".to_owned()],
    };
    let pose = CalibrationPose {
        base_from_flange: Pose::translation(0.6, 0.0, 0.8),
        joints: JointPositions::from_degrees(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
    };
    ServerSettings {
        projects: vec![
            project(1, &[1], OutputPort::Poses),
            project(2, &[], OutputPort::Path),
            project(3, &[], OutputPort::Custom),
        ],
        viz: Some(VizProject {
            branches: vec![BranchStep { step: 7, exits: 2 }],
            index_steps: vec![IndexStep { step: 8, places: 6 }],
            parameters: vec![StepParameter {
                step: 8,
                key: "xCount".to_owned(),
                value: 3.0,
                writable: Some(ParameterRange::ANY),
            }],
        }),
        solutions: vec![1],
        variables: vec![Variable {
            name: "speed".to_owned(),
            kind: VariableKind::Number,
        }],
        property_config: "read,1,8,xCount\nread,2,9,xCount\nwrite,1,8,xCount,4\nwrite,2,9,xCount,4"
            .to_owned(),
        calibration: vec![pose; 3],
        ..ServerSettings::default()
    }
}

fn planned(length: usize) -> PlannedPath {
    PlannedPath::from(path(length, Some(0)))
}

#[test]
fn the_table_of_situations_is_true() {
    let mut ear = Ear::default();

    let mut talk = ear.talk(full_settings());
    talk.say(&[
        "901",
        "999",
        "103,1",
        "101,1,0,9",
        "101,1,0,2,10001,0,0,0,0,0",
        "101,9,0,0",
        "101,1,-1,0",
        "102,1",
        "105,1,1",
        "105,2,3",
        "106,2",
        "103,1,1",
        "103,1,2",
        "103,2,1",
        "501,1,400,300,250",
        "501,1,0,1,1",
        "503,1,pick,1,2,3,4,5,6",
        "503,1,place,1,2,3,4,5,6",
        "504,speed,1",
        "504,nobody,1",
        "104,1",
        "104,2",
        "502,1,2,3,4,5,6",
        "207,1",
        "207,2",
        "207,3",
        "208,1",
        "208,2",
        "202",
        "203,7,1",
        "203,7,3",
        "203,9,1",
        "204,9,1",
        "204,8,9",
        "205,3",
        "206",
        "201,9,0,0,0,0,0,0",
        "201,2,nan,0,0,0,0,0",
        "701,9,1,2,3,4,5,6,1,2,3,4,5,6",
        "701,0,0,0,0,0,0,0,1,2,3,4,5,6",
        "701,0,1,2,3,4,5,6",
        "701,0,1,2,3,4,5,6,1,2,3,4,5,6",
        "701,2,1,2,3,4,5,6,1,2,3,4,5,6",
    ]);
    talk.say(&["101,1,0,0", "101,1,0,0", "106,1", "102,1"]);
    talk.wait();
    talk.vision_path(Ok(planned(2)));
    talk.say(&["106,2", "105,2,1", "105,2,1"]);
    let row = |rows: usize| CustomPort {
        name: "a".to_owned(),
        rows: vec![vec![1.0]; rows],
    };
    let result = |rows: usize| VisionResult {
        points: vec![object(0.6); 2],
        custom_ports: vec![row(rows)],
    };
    talk.vision("101,3,0,0", Ok(result(2)));
    talk.say(&["110,3"]);
    talk.vision("101,3,0,0", Ok(result(1)));
    talk.say(&["110,3"]);
    talk.say(&["201,0", "201,0", "204,8,1", "203,7,1", "204,8,1", "205,1"]);
    talk.wait();
    talk.say(&["202"]);
    talk.viz(Ok(planned(3)));
    talk.say(&["205,1", "206"]);
    talk.viz(Ok(planned(3)));
    talk.say(&["210,1", "205,1"]);

    let mut talk = ear.talk(ServerSettings {
        projects: Vec::new(),
        viz: None,
        ..ServerSettings::default()
    });
    talk.say(&["901", "201,0"]);
    let mut settings = full_settings();
    settings.ports = vec![PortSettings::of_profile(Profile::v2_2())];
    ear.talk(settings).say(&["901"]);

    // Verdicts of the cell ("the run found ...", "the run reports it") are passed on as they are.
    let passed_on = Status::ALL
        .iter()
        .filter(|status| status.situation().starts_with("the run "));
    for status in passed_on {
        let mut talk = ear.talk(full_settings());
        if status.code() < 2000 {
            talk.vision("101,1,0,0", Err(*status));
            talk.say(&["102,1"]);
        } else {
            talk.viz(Err(*status));
            talk.say(&["205,1"]);
        }
    }
    let mut talk = ear.talk(full_settings());
    talk.vision("101,1,0,0", Err(Status::NoPointsInRegion));
    talk.say(&["102,1"]);

    let told: BTreeSet<Status> = Status::ALL
        .iter()
        .copied()
        .filter(|status| !status.situation().is_empty())
        .collect();
    let unheard: Vec<_> = told.difference(&ear.heard).collect();
    let untold: Vec<_> = ear.heard.difference(&told).collect();
    assert_eq!(
        unheard,
        Vec::<&Status>::new(),
        "have a situation but were not heard"
    );
    assert_eq!(
        untold,
        Vec::<&Status>::new(),
        "were heard but have no situation"
    );
}

#[test]
fn profiles_shape_the_output() {
    let reply = |profile: Profile, lines: &[&str]| -> Vec<String> {
        let mut settings = full_settings();
        settings.ports = vec![PortSettings::of_profile(profile)];
        let mut ear = Ear::default();
        let mut talk = ear.talk(settings);
        let job_id = job_of(&talk.say(&["201,0"]));
        talk.server
            .finish_viz_path(talk.now, job_id, Ok(planned(1)));
        for line in lines {
            let bytes = format!("{line}\r");
            talk.server
                .handle_input(talk.now, PORT, CLIENT, bytes.as_bytes());
        }
        std::iter::from_fn(|| talk.server.poll_reply())
            .map(|reply| String::from_utf8(reply.bytes).unwrap())
            .collect()
    };
    let ask = ["901", "205,1"];
    let rest = "205,2100,1,1,1,1.0,0.0,0.0,0.0,0.0,0.0,0";
    assert_eq!(
        reply(Profile::v1_5(), &ask),
        ["901,1101,", &format!("{rest},80,")]
    );
    for profile in [Profile::v1_7(), Profile::v1_8()] {
        assert_eq!(
            reply(profile, &ask),
            ["901,1101\r", &format!("{rest},80\r")]
        );
    }
    assert_eq!(
        reply(Profile::v2_1(), &ask),
        ["901,1101\r", &format!("{rest},1\r")]
    );
    assert_eq!(
        reply(Profile::v2_2(), &ask),
        ["901,9100,1,1,1\r", &format!("{rest},1\r")]
    );
}

#[test]
fn the_encoding_of_a_connection_is_found_out() {
    let settings = ServerSettings {
        ports: vec![PortSettings {
            detects_encoding: true,
            ..PortSettings::default()
        }],
        ..ServerSettings::default()
    };
    let mut server = Server::new(settings).unwrap();
    for (number, encoding) in [
        Encoding::Ascii,
        Encoding::HexLittleEndian,
        Encoding::HexBigEndian,
    ]
    .into_iter()
    .enumerate()
    {
        let client = ConnectionId(number as u64);
        server.handle_connect(SimTime::ZERO, PORT, client);
        let frame =
            depal_wire::Request::GetState(depal_wire::GetState).encode(encoding, &Profile::v1_8());
        for byte in &frame {
            server.handle_input(SimTime::ZERO, PORT, client, &[*byte]);
        }
        server.handle_timeout(SimTime::from_nanos(20_000_000));
        let expected = depal_wire::Reply::status(901, Status::VisionReady);
        assert_eq!(
            server.poll_reply().unwrap().bytes,
            expected.encode(encoding, &Profile::v1_8())
        );
    }
}
