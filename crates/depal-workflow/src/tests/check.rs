//! What a project may not say, and how it reads as text.

use super::*;

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
        vec![Step::new(
            1,
            StepKind::VisualRecognition {
                project: 8,
                reuses_result: true,
            },
        )],
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
    if let StepKind::FixedPointMove { travel, .. } = &mut fast.kind {
        travel.velocity_percent = 120.0;
    }
    check(
        vec![fast, Step::new(2, StepKind::Notify { message: 0 })],
        &[
            "step 1: velocity 120 %, expected more than 0 and at most 100",
            "step 2 sends the message 0, expected a number from 1",
        ],
    );
    check(
        vec![recognise(1), pick(2), go(3), place(4)],
        &[
            "step 3 moves between a Vision Move and its pallet_pattern, whose way the planner finds by itself",
        ],
    );
    let mut all = pick(2);
    if let StepKind::VisionMove { plans_all, .. } = &mut all.kind {
        *plans_all = true;
    }
    check(
        vec![recognise(1), all.clone(), go(3)],
        &["step 2 plans all results, but a run can leave it without a pallet_pattern behind"],
    );
    check(vec![recognise(1), all, place(3)], &[]);
    check(
        vec![
            beside(1, Reference::Next),
            branch(2, &[3, 4]),
            go(3),
            beside(4, Reference::Previous),
        ],
        &["step 1 is relative to the next waypoint, but a run can go on without one"],
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
         3  vision_move by sections at 80 %\n   4  pallet_pattern conveyor -> end\n   \
         5  fixed_point_move joint at 60 %\n"
    );
}
