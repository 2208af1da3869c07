//! Steps that count: grids and patterns.

use super::*;

#[test]
fn an_index_begins_below_its_number_and_rises_when_carried_out() {
    let mut engine = engine(vec![branch(1, &[3]), by_grid(3)]);
    engine.start();
    assert_eq!(tools(engine.branch(0)), [[1.0, -1.0, 0.5]]);
    assert_eq!(engine.index(3), 1);
    engine.start();
    engine.set_index(3, 5).unwrap();
    assert_eq!(engine.index(3), 4);
    // Index 4 of 3 x 2: second column, second row.
    assert_eq!(tools(engine.branch(0)), [[1.4, -0.7, 0.5]]);
    assert_eq!(engine.index(3), 5);
    for (step, number, code) in [(3, 0, 2027), (3, 7, 2027), (1, 1, 2026), (77, 1, 2026)] {
        let error = engine.set_index(step, number).unwrap_err();
        assert_eq!(error.status_code(), code, "{error}");
    }
    assert_eq!(engine.project().index_steps(), [(3, 6)]);
}

#[test]
fn a_full_grid_or_pattern_ends_a_loop_with_its_status() {
    let stack = Step::new(
        2,
        StepKind::CartonPattern {
            pattern: CartonPattern::Custom(vec![Pose::identity(); 2]),
            travel: Travel::joint(100.0),
        },
    );
    for (last, code) in [(stack, 2032), (by_grid(2), 2027)] {
        let mut engine = engine(vec![
            recognise(5),
            pick(4),
            last.then(Next::Step(3)),
            branch(3, &[5, 6]),
            go(6),
        ]);
        let mut ask = engine.start();
        let failure = loop {
            ask = match ask {
                Ask::Recognise { .. } => engine.recognised(Ok(())),
                Ask::WaitBranch { .. } => engine.branch(0),
                Ask::PlanPick { .. } => engine.planned(Ok(0)),
                Ask::Failed(failure) => break failure,
                other => panic!("{other:?}"),
            };
        };
        assert_eq!(failure.status_code(), code);
    }
}

#[test]
fn layers_count_columns_first_and_alternate() {
    let pattern = CartonPattern::Predefined(Layers {
        base_from_first: Pose::translation(1.0, 0.0, 0.1),
        rows: 2,
        columns: 3,
        layers: 2,
        pitch: [0.4, 0.3, 0.25],
        is_alternating: true,
    });
    let at = |index| {
        let pose = pattern.base_from_carton(index)?;
        let xyz: [f64; 3] = pose.translation.vector.into();
        let turn = pose.rotation.euler_angles().2.to_degrees().round();
        Some((xyz.map(|v| (v * 1e6).round() / 1e6), turn))
    };
    assert_eq!(at(0), Some(([1.0, 0.0, 0.1], 0.0)));
    assert_eq!(at(4), Some(([1.4, 0.3, 0.1], 0.0)));
    // Second layer: the first carton (-0.4, -0.15 from the middle 1.4, 0.15) turned by 90 degrees.
    assert_eq!(at(6), Some(([1.55, -0.25, 0.35], 90.0)));
    assert_eq!(at(12), None);
    assert_eq!(pattern.len(), 12);
}
