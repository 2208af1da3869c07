use depal_frames::{JointPositions, Pose};

use crate::*;

mod check;
mod indexed;

/// Two steps a round, so that ten thousand steps are used up.
const MOST_ROUNDS: usize = 5_000;

fn recognise(id: i32) -> Step {
    Step::new(
        id,
        StepKind::VisualRecognition {
            project: 1,
            reuses_result: false,
        },
    )
}

fn pick(id: i32) -> Step {
    Step::new(
        id,
        StepKind::VisionMove {
            uses_sections: true,
            plans_all: false,
            max_group: 1,
            velocity_percent: 80.0,
        },
    )
}

fn place(id: i32) -> Step {
    Step::new(
        id,
        StepKind::PalletPattern {
            place: Place::Conveyor,
        },
    )
}

fn branch(id: i32, exits: &[i32]) -> Step {
    Step::new(
        id,
        StepKind::BranchByMsg {
            exits: exits.to_vec(),
        },
    )
}

fn go(id: i32) -> Step {
    Step::new(
        id,
        StepKind::FixedPointMove {
            joints: JointPositions::from_degrees(&[f64::from(id); 6]),
            travel: Travel::joint(60.0),
        },
    )
}

fn beside(id: i32, reference: Reference) -> Step {
    Step::new(
        id,
        StepKind::RelativeMove {
            offset: Pose::translation(0.0, 0.0, -0.2),
            frame: OffsetFrame::Tool,
            reference,
            travel: Travel::linear(100.0),
        },
    )
}

fn grid() -> Grid {
    Grid {
        base_from_first: Pose::translation(1.0, -1.0, 0.5),
        counts: [3, 2, 1],
        offsets: [0.4, 0.3, 0.0],
    }
}

fn by_grid(id: i32) -> Step {
    Step::new(
        id,
        StepKind::MoveByGrid {
            grid: grid(),
            travel: Travel::joint(100.0),
        },
    )
}

fn engine(steps: Vec<Step>) -> Engine<u32> {
    Engine::new(Project::new(steps), &[1]).unwrap()
}

fn pieces(ask: Ask<u32>) -> Vec<(i32, Option<u32>)> {
    let Ask::Done(pieces) = ask else {
        panic!("{ask:?}");
    };
    pieces
        .into_iter()
        .map(|piece| match piece {
            Piece::Move(next) => (next.step, None),
            Piece::Planned { step, plan } => (step, Some(plan)),
        })
        .collect()
}

#[test]
fn a_whole_round() {
    let mut project = Project::new(vec![
        recognise(1),
        go(2),
        pick(3),
        Step::new(4, StepKind::SetDo),
        place(6),
        go(7),
    ]);
    project.global_velocity_percent = 50.0;
    let mut engine = Engine::new(project, &[1]).unwrap();
    for round in 0..2 {
        assert_eq!(
            engine.start(),
            Ask::Recognise {
                step: 1,
                project: 1,
                may_reuse: false
            }
        );
        let Ask::PlanPick { pick, place } = engine.recognised(Ok(())) else {
            panic!("expected a plan");
        };
        assert_eq!(
            (pick.step, pick.project, place),
            (3, 1, Some(Place::Conveyor))
        );
        assert!(pick.wants_outputs && pick.uses_sections);
        assert_eq!(pick.velocity_percent, 40.0);
        let [Piece::Move(before)] = engine.pieces() else {
            panic!("{:?}", engine.pieces());
        };
        assert_eq!((before.step, before.velocity_percent), (2, 30.0));
        assert_eq!(
            pieces(engine.planned(Ok(round))),
            [(2, None), (3, Some(round)), (7, None)]
        );
    }
}

#[test]
fn moves_behind_a_pick_follow_its_plan() {
    let mut engine = engine(vec![
        Step::new(9, StepKind::Notify { message: 1000 }),
        recognise(1),
        beside(4, Reference::Next),
        pick(2),
        Step::new(5, StepKind::SetDo),
        beside(6, Reference::Previous),
        by_grid(3),
    ]);
    assert_eq!(
        engine.start(),
        Ask::Notify {
            step: 9,
            message: 1000
        }
    );
    assert!(matches!(engine.notified(), Ask::Recognise { step: 1, .. }));
    let ask = engine.recognised(Ok(()));
    let Ask::PlanPick { pick, place: None } = ask else {
        panic!("{ask:?}");
    };
    assert!(pick.wants_outputs && !pick.plans_all);
    assert_eq!(
        pieces(engine.planned(Ok(7))),
        [(4, None), (2, Some(7)), (6, None), (3, None)]
    );
}

/// Tool positions of the grid moves of a finished run.
fn tools(ask: Ask<u32>) -> Vec<[f64; 3]> {
    let Ask::Done(pieces) = ask else {
        panic!("{ask:?}");
    };
    let target = |piece| match piece {
        Piece::Move(Move {
            target: Target::Tool(pose),
            ..
        }) => Some(pose.translation.vector.into()),
        _ => None,
    };
    pieces.into_iter().filter_map(target).collect()
}

#[test]
fn one_picture_is_used_up_in_a_loop() {
    let reuse = Step::new(
        1,
        StepKind::VisualRecognition {
            project: 1,
            reuses_result: true,
        },
    );
    let steps = vec![reuse, pick(2), by_grid(3).then(Next::Step(1)), go(4)];
    let mut project = Project::new(steps);
    // The loop has no other way out than an empty picture.
    assert!(
        project
            .check(&[1])
            .contains(&WorkflowError::Unreachable { step: 4 })
    );
    project.steps.pop();
    let mut engine: Engine<u32> = Engine::new(project, &[1]).unwrap();
    let mut ask = engine.start();
    for carton in 0..3 {
        assert!(
            matches!(
                ask,
                Ask::Recognise {
                    may_reuse: true,
                    ..
                }
            ),
            "{ask:?}"
        );
        let plan = engine.recognised(Ok(()));
        // The pick is planned when the next picture is wanted.
        assert!(
            matches!(plan, Ask::PlanPick { place: None, .. }),
            "{plan:?}"
        );
        ask = engine.planned(Ok(carton));
    }
    let done = pieces(engine.recognised(Err(2037)));
    let picks: Vec<u32> = done.iter().filter_map(|(_, plan)| *plan).collect();
    assert_eq!((picks, done.len()), (vec![0, 1, 2], 6));
    // With nothing planned, an empty picture is a failure.
    engine.start();
    assert_eq!(
        engine.recognised(Err(2037)),
        Ask::Failed(Failure::Status(2037))
    );
}

#[test]
fn an_external_move_needs_its_pose() {
    let external = StepKind::ExternalMove {
        travel: Travel::joint(100.0),
    };
    let mut engine = engine(vec![Step::new(1, external)]);
    assert_eq!(engine.start(), Ask::Failed(Failure::NoExternalPose));
    engine.set_external_pose(Pose::translation(1.0, 2.0, 3.0));
    assert_eq!(tools(engine.start()), [[1.0, 2.0, 3.0]]);
}

#[test]
fn parameters_are_read_and_changed_by_key() {
    let mut engine = engine(vec![by_grid(3), beside(4, Reference::Previous)]);
    assert_eq!(engine.parameter(3, "xCount"), Ok(3.0));
    assert_eq!(engine.parameter(3, "xOffset"), Ok(400.0));
    assert_eq!(engine.parameter(4, "zOffset"), Ok(-200.0));
    engine.set_parameter(3, "xOffset", 10.0).unwrap();
    engine.set_parameter(3, "xCount", 1.0).unwrap();
    engine.set_parameter(3, "velocity", 25.0).unwrap();
    engine.start();
    engine.set_index(3, 2).unwrap();
    assert_eq!(engine.parameter(3, "xOffset"), Ok(10.0));
    assert_eq!(engine.project().index_steps(), [(3, 2)]);
    for (step, key, value) in [
        (77, "xCount", 1.0),
        (3, "xcount", 1.0),
        (3, "xCount", 0.0),
        (3, "xCount", 1.5),
        (3, "yOffset", f64::NAN),
        (3, "velocity", 0.0),
        (4, "xCount", 2.0),
    ] {
        let error = engine.set_parameter(step, key, value).unwrap_err();
        assert_eq!(error.write_status_code(), 2016, "{error}");
    }
    assert_eq!(
        engine.parameter(3, "xCount"),
        Ok(1.0),
        "a refusal changes nothing"
    );
    assert_eq!(
        engine
            .parameter(77, "xCount")
            .unwrap_err()
            .read_status_code(),
        2041
    );
}

#[test]
fn a_branch_decides_where_a_pick_goes() {
    let steps = vec![
        recognise(1),
        pick(2),
        branch(3, &[4, 5]),
        place(4).then(Next::End),
        go(5),
    ];
    for (exit, expected) in [(0, Some(Place::Conveyor)), (1, None)] {
        let mut engine = engine(steps.clone());
        engine.start();
        assert_eq!(
            engine.recognised(Ok(())),
            Ask::WaitBranch { step: 3, exits: 2 }
        );
        let ask = engine.branch(exit);
        let Ask::PlanPick { place, .. } = ask else {
            panic!("{ask:?}");
        };
        assert_eq!(place, expected);
        let path = pieces(engine.planned(Ok(9)));
        assert_eq!(path, [(2, Some(9)), (5, None)][..=exit]);
    }
    assert_eq!(engine(steps.clone()).project().branches(), [(3, 2)]);
}

#[test]
fn failures_end_the_run() {
    let steps = vec![recognise(1), pick(2), place(3)];
    let mut run = engine(steps.clone());
    run.start();
    assert_eq!(
        run.recognised(Err(2038)),
        Ask::Failed(Failure::Status(2038))
    );
    assert_eq!(
        run.recognised(Ok(())),
        Ask::Failed(Failure::UnexpectedAnswer)
    );
    run.start();
    run.recognised(Ok(()));
    let Ask::Failed(failure) = run.planned(Err(2004)) else {
        panic!("expected a failure");
    };
    assert_eq!(failure.status_code(), 2004);
    let mut run = engine(vec![branch(1, &[2]), go(2)]);
    run.start();
    assert_eq!(run.branch(1), Ask::Failed(Failure::UnexpectedAnswer));
}

#[test]
fn two_picks_without_places_are_planned_in_order() {
    let mut run = engine(vec![recognise(1), pick(2), pick(3)]);
    run.start();
    let steps_of = |ask: &Ask<u32>| match ask {
        Ask::PlanPick { pick, place: None } => pick.step,
        other => panic!("{other:?}"),
    };
    assert_eq!(steps_of(&run.recognised(Ok(()))), 2);
    assert_eq!(steps_of(&run.planned(Ok(7))), 3);
    assert_eq!(pieces(run.planned(Ok(8))), [(2, Some(7)), (3, Some(8))]);
}

#[test]
fn a_loop_behind_a_branch_does_not_hang() {
    // Exit 0 comes back to the branch for ever, exit 1 ends: the robot decides how often.
    let mut run = engine(vec![branch(1, &[2, 3]), go(2).then(Next::Step(1)), go(3)]);
    let mut ask = run.start();
    for _ in 0..MOST_ROUNDS {
        assert!(matches!(ask, Ask::WaitBranch { .. }), "{ask:?}");
        ask = run.branch(0);
    }
    assert_eq!(ask, Ask::Failed(Failure::EndlessLoop));
}
