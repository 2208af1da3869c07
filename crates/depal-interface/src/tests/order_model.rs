//! A model of the order rules, written apart from the server: it foretells the status of every command
//! of random sequences. Runs end when the sequence says so; a command that would wait is followed by that end.

use proptest::prelude::*;

use super::*;

/// What the model remembers. Points and waypoints are counted only.
#[derive(Default)]
struct Model {
    poses: Run,
    path: Run,
    custom: Run,
    viz: Run,
    /// An exit was chosen since the last 201.
    branched: bool,
}

#[derive(Default, Clone, Copy, PartialEq)]
enum Run {
    #[default]
    Never,
    Runs,
    Has {
        left: usize,
        by: i32,
        begun: bool,
    },
    Failed {
        code: i32,
        told: bool,
    },
}

const POINTS: usize = 3;

impl Model {
    /// The status of a command; 0 if it has to wait.
    fn foretell(&mut self, command: &str) -> i32 {
        let fields: Vec<i32> = command.split(',').map(|f| f.parse().unwrap()).collect();
        let code = fields[0];
        let job = fields.get(1).copied().unwrap_or(0);
        match code {
            101 => match self.run(job) {
                None => 1011,
                Some(Run::Runs) => 1007,
                Some(run) => {
                    *run = Run::Runs;
                    1102
                }
            },
            103 | 501 => {
                let done = if code == 103 { 1107 } else { 1108 };
                match (job, self.run(job)) {
                    (_, None) => 1011,
                    (_, Some(Run::Runs)) => 1007,
                    (1, _) | (_, Some(_)) if code == 501 || job == 1 => done,
                    _ => 1013,
                }
            }
            102 | 105 | 110 | 111 => {
                let fits = match code {
                    102 => job != 2,
                    110 => job == 3,
                    _ => job == 2,
                };
                let done = if matches!(code, 102 | 110) {
                    1100
                } else {
                    1103
                };
                let one = matches!(code, 110 | 111);
                match self.run(job) {
                    None => 1011,
                    Some(_) if !fits => 1016,
                    Some(run) => fetch(run, code, one, done, [1020, 1002, 1016]),
                }
            }
            106 => match (job, self.run(job)) {
                (_, None) => 1011,
                (_, Some(Run::Never)) => 1020,
                (2, Some(Run::Has { .. })) => 1106,
                _ => 1008,
            },
            201 if self.viz == Run::Runs => 2002,
            201 => {
                self.viz = Run::Runs;
                self.branched = false;
                2103
            }
            202 => {
                self.viz = Run::Never;
                2104
            }
            203 => match self.viz {
                Run::Runs => {
                    self.branched = true;
                    2105
                }
                Run::Has { begun: false, .. } | Run::Failed { told: false, .. } => 2105,
                _ => 2022,
            },
            204 => match self.viz {
                Run::Never => 2022,
                Run::Runs if !self.branched => 2106,
                _ => 2028,
            },
            205 => fetch(&mut self.viz, 205, false, 2100, [2022, 2022, 2042]),
            210 => fetch(&mut self.viz, 210, true, 2100, [2022, 2022, 2042]),
            206 if matches!(self.viz, Run::Has { .. }) => 2102,
            206 => 2011,
            901 => 1101,
            other => panic!("no rule for {other}"),
        }
    }

    fn run(&mut self, job: i32) -> Option<&mut Run> {
        match job {
            1 => Some(&mut self.poses),
            2 => Some(&mut self.path),
            3 => Some(&mut self.custom),
            _ => None,
        }
    }
}

/// Fetching one item or all; `codes`: before a run, after everything, mixed.
fn fetch(run: &mut Run, by: i32, one: bool, done: i32, codes: [i32; 3]) -> i32 {
    match run {
        Run::Never => codes[0],
        Run::Runs => 0,
        Run::Failed { code, told } => {
            *told = true;
            *code
        }
        Run::Has { left: 0, .. } => codes[1],
        Run::Has { by: other, .. } if *other != 0 && *other != by => codes[2],
        Run::Has {
            left,
            by: other,
            begun,
        } => {
            *other = by;
            *begun = true;
            *left = if one { *left - 1 } else { 0 };
            done
        }
    }
}

const COMMANDS: [&str; 26] = [
    "101,1,0,0",
    "101,2,0,0",
    "101,3,0,0",
    "101,9,0,0",
    "102,1",
    "102,2",
    "102,3",
    "103,1,1",
    "103,3,1",
    "105,2,1",
    "105,1,1",
    "106,2",
    "106,1",
    "110,3",
    "110,1",
    "111,2,2",
    "201,0",
    "202",
    "203,7,1",
    "204,8,1",
    "205,1",
    "206",
    "210,4",
    "501,1,400,300,250",
    "501,9,1,1,1",
    "901",
];

/// The brain with the jobs that nobody has finished yet.
struct Brain {
    bench: Bench,
    jobs: Vec<Job>,
}

impl Brain {
    fn new() -> Self {
        let project = |id, recipes: &[i32], output| VisionProject {
            id,
            recipes: recipes.to_vec(),
            output,
            ..VisionProject::default()
        };
        let settings = ServerSettings {
            projects: vec![
                project(1, &[1], OutputPort::Poses),
                project(2, &[], OutputPort::Path),
                project(3, &[], OutputPort::Custom),
            ],
            viz: Some(VizProject {
                branches: vec![BranchStep { step: 7, exits: 2 }],
                index_steps: vec![IndexStep { step: 8, places: 6 }],
                ..VizProject::default()
            }),
            ..ServerSettings::default()
        };
        let mut bench = Bench {
            server: Server::new(settings).unwrap(),
            now: SimTime::ZERO,
        };
        bench.server.handle_connect(bench.now, PORT, CLIENT);
        Self {
            bench,
            jobs: Vec::new(),
        }
    }

    /// Ends all runs, in the brain and in the model.
    fn finish_all(&mut self, model: &mut Model, fails: bool) {
        let (now, server) = (self.bench.now, &mut self.bench.server);
        for job in std::mem::take(&mut self.jobs) {
            match job {
                Job::RunVision {
                    job_id, project: 2, ..
                } => {
                    let path = PlannedPath::from(path(POINTS, Some(1)));
                    let outcome = if fails {
                        Err(Status::VisionCollision)
                    } else {
                        Ok(path)
                    };
                    server.finish_vision_path(now, job_id, outcome);
                }
                Job::RunVision { job_id, .. } => {
                    let result = VisionResult {
                        points: vec![object(0.6); POINTS],
                        custom_ports: vec![CustomPort {
                            name: "a".to_owned(),
                            rows: vec![vec![1.0]; POINTS],
                        }],
                    };
                    let outcome = if fails {
                        Err(Status::VisionCollision)
                    } else {
                        Ok(result)
                    };
                    server.finish_vision_custom(now, job_id, outcome);
                }
                Job::StartViz { job_id, .. } => {
                    let outcome = if fails {
                        Err(Status::VizCollision)
                    } else {
                        Ok(path(POINTS, Some(1)))
                    };
                    server.finish_viz(now, job_id, outcome);
                }
                _ => {}
            }
        }
        for (run, code) in [
            (&mut model.poses, 1036),
            (&mut model.path, 1036),
            (&mut model.custom, 1036),
            (&mut model.viz, 2031),
        ] {
            if *run == Run::Runs {
                *run = if fails {
                    Run::Failed { code, told: false }
                } else {
                    Run::Has {
                        left: POINTS,
                        by: 0,
                        begun: false,
                    }
                };
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn the_brain_agrees_with_the_model(
        steps in prop::collection::vec((0usize..COMMANDS.len() + 4, any::<bool>()), 1..24),
    ) {
        let mut model = Model::default();
        let mut brain = Brain::new();
        for (choice, fails) in steps {
            let Some(command) = COMMANDS.get(choice) else {
                brain.finish_all(&mut model, fails);
                continue;
            };
            brain.bench.send(CLIENT, command);
            brain.jobs.extend(std::iter::from_fn(|| brain.bench.server.poll_job()));
            let mut expected = model.foretell(command);
            if expected == 0 {
                prop_assert_eq!(brain.bench.replies(), Vec::<String>::new(), "{} waits", command);
                brain.finish_all(&mut model, fails);
                expected = model.foretell(command);
            }
            let replies = brain.bench.replies();
            prop_assert_eq!(replies.len(), 1, "{}", command);
            let status: i32 = replies[0].split(',').nth(1).unwrap().parse().unwrap();
            prop_assert_eq!(status, expected, "{}", command);
        }
    }
}

proptest! {
    /// However a stream is cut, the replies are the same.
    #[test]
    fn any_split_gives_the_same_replies(
        choices in prop::collection::vec(0usize..COMMANDS.len(), 1..12),
        cuts in prop::collection::vec(1usize..40, 0..30),
    ) {
        let lines: Vec<_> = choices.iter().map(|choice| format!("{}\r", COMMANDS[*choice])).collect();
        let stream = lines.concat().into_bytes();
        let replies_of = |pieces: &[&[u8]]| {
            let mut bench = Brain::new().bench;
            for piece in pieces {
                bench.server.handle_input(bench.now, PORT, CLIENT, piece);
            }
            let mut replies = bench.replies();
            for _ in &choices {
                bench.wait(10_000);
                replies.extend(bench.replies());
            }
            replies
        };
        let mut rest = &stream[..];
        let mut pieces = Vec::new();
        for cut in &cuts {
            let (piece, after) = rest.split_at((*cut).min(rest.len()));
            pieces.push(piece);
            rest = after;
        }
        pieces.push(rest);
        let whole = replies_of(&[&stream[..]]);
        prop_assert_eq!(whole.len(), choices.len());
        prop_assert_eq!(replies_of(&pieces), whole);
    }
}
