use depal_frames::JointPositions;

use crate::*;

fn recognise(id: i32) -> Step {
    Step::new(id, StepKind::VisualRecognition { project: 1 })
}

fn pick(id: i32) -> Step {
    Step::new(
        id,
        StepKind::VisionMove {
            uses_sections: true,
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
        StepKind::FixedPointMove(FixedPoint {
            joints: JointPositions::from_degrees(&[f64::from(id); 6]),
            motion: MoveMotion::Joint,
            velocity_percent: 60.0,
        }),
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
            Piece::Fixed { step, .. } => (step, None),
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
        go(5),
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
                project: 1
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
        assert_eq!(pick.via.len(), 1);
        assert_eq!(pick.via[0].velocity_percent, 30.0);
        assert_eq!(
            pieces(engine.planned(Ok(round))),
            [(2, None), (3, Some(round)), (7, None)]
        );
    }
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
        let Ask::PlanPick { pick, place } = ask else {
            panic!("{ask:?}");
        };
        assert_eq!((place, pick.via.len()), (expected, exit));
        assert_eq!(pieces(engine.planned(Ok(9))), [(2, Some(9))]);
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

/// Two steps a round, so that ten thousand steps are used up.
const MOST_ROUNDS: usize = 5_000;

#[track_caller]
fn check(steps: Vec<Step>, expected: &[&str]) {
    let found: Vec<String> = Project::new(steps)
        .check(&[1])
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(found, expected);
}

#[test]
fn faulty_projects_are_refused_with_all_reasons() {
    check(vec![], &["the Viz project has no steps"]);
    check(
        vec![go(0), go(1), go(1), branch(4, &[]), branch(5, &[9])],
        &[
            "step id 0: expected a number from 1",
            "step id 1 is there twice",
            "step 4 is a branch without exits",
            "step 5 goes on at step 9, which does not exist; steps are [0, 1, 1, 4, 5]",
        ],
    );
    check(
        vec![Step::new(1, StepKind::VisualRecognition { project: 8 })],
        &["step 1 runs vision project 8, which does not exist; projects are [1]"],
    );
    check(
        vec![go(1).then(Next::Step(3)), go(2), go(3).then(Next::Step(1))],
        &[
            "step 1 is a dead end: no way leads from it to the end of the run",
            "step 2 is never reached",
            "step 3 is a dead end: no way leads from it to the end of the run",
        ],
    );
    check(
        vec![branch(1, &[2, 3]), recognise(2), pick(3), place(4)],
        &["step 3 picks, but a run can come to it without a visual recognition before"],
    );
    check(
        vec![
            place(1),
            recognise(2),
            pick(3),
            place(4),
            Step::new(5, StepKind::SetDo),
        ],
        &[
            "step 1 needs a Vision Move, but a run can come to it without one before",
            "step 5 needs a Vision Move, but a run can come to it without one before",
        ],
    );
    let mut fast = go(1);
    if let StepKind::FixedPointMove(point) = &mut fast.kind {
        point.velocity_percent = 120.0;
    }
    check(
        vec![fast],
        &["step 1: velocity 120 %, expected more than 0 and at most 100"],
    );
}

#[test]
fn a_project_reads_as_text() {
    let project = Project::new(vec![
        recognise(1),
        branch(2, &[3, 5]),
        pick(3),
        place(4).then(Next::End),
        go(5),
    ]);
    assert_eq!(
        project.to_string(),
        "   1  visual_recognition project 1\n   2  branch_by_msg -> 3 5\n   \
         3  vision_move by sections\n   4  pallet_pattern conveyor -> end\n   \
         5  fixed_point_move joint at 60 %\n"
    );
}
