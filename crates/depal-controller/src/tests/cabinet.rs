use super::*;
use crate::{ControllerError, ControllerState, TaskRole};

#[test]
fn statement_costs_time_and_a_cycle_ends() {
    let mut times = Vec::new();
    let (sender, receiver) = std::sync::mpsc::channel();
    let mut script = Script::new();
    for _ in 0..450 {
        let sender = sender.clone();
        script = script.then(move |system| {
            sender.send(system.now()).expect("the test listens");
            Poll::Ready(Ok(()))
        });
    }
    let mut controller = controller(script);
    for cycle in 0..3u32 {
        let now = SimTime::ZERO + SimDuration::from_millis(4 * u64::from(cycle));
        controller.tick(now, &mut NoNetwork);
        times.push(receiver.try_iter().collect::<Vec<_>>());
    }
    assert_eq!(
        times.iter().map(Vec::len).collect::<Vec<_>>(),
        [200, 200, 50]
    );
    assert_eq!(times[1][1].as_nanos(), 4_020_000);
    let statements = std::iter::from_fn(|| controller.poll_event())
        .filter(|e| matches!(e, ControllerEvent::Statement { .. }))
        .count();
    assert_eq!(statements, 3, "the last place of each cycle");
    assert_eq!(*controller.state(), ControllerState::Finished);
}

#[test]
fn numbered_signals_need_no_definition() {
    let mut spec = spec();
    spec.families = vec![
        SignalFamily {
            name: "$OUT".to_owned(),
            kind: SignalKind::DigitalOutput,
            highest: 8,
        },
        SignalFamily {
            name: "$IN".to_owned(),
            kind: SignalKind::DigitalInput,
            highest: 8,
        },
    ];
    let script = Script::new().then(|system| {
        assert_eq!(system.signal("$OUT[8]"), Ok(0.0));
        assert_eq!(system.set_signal("$out[8]", 1.0), Ok(()));
        assert_eq!(system.signal("$OUT[8]"), Ok(1.0));
        assert!(matches!(
            system.set_signal("$IN[1]", 1.0),
            Err(Fault::SignalValue { .. })
        ));
        for name in [
            "$OUT[9]", "$OUT[0]", "$OUT[+1]", "$OUT[01]", "$OUT", "$OUT[]",
        ] {
            assert!(
                matches!(system.signal(name), Err(Fault::UnknownSignal(_))),
                "{name}"
            );
        }
        Poll::Ready(Ok(()))
    });
    let mut controller = Controller::new(spec).expect("a good specification");
    controller.set_task(Box::new(script));
    assert_eq!(controller.set_input("$IN[3]", 1.0), Ok(()));
    controller.tick(SimTime::ZERO, &mut NoNetwork);
    assert_eq!(*controller.state(), ControllerState::Finished);
    // Only those that somebody set are listed.
    let listed: Vec<_> = controller
        .signals()
        .map(|signal| signal.spec.name.as_str())
        .filter(|name| name.starts_with('$'))
        .collect();
    assert_eq!(listed, ["$IN[3]", "$OUT[8]"]);
}

#[test]
fn signals_know_their_side_and_their_range() {
    let script = Script::new()
        .then(|system| {
            assert!(matches!(system.signal("nope"), Err(Fault::UnknownSignal(n)) if n == "nope"));
            for (name, value) in [
                ("diReady", 1.0),
                ("doVacuum", 2.0),
                ("doVacuum", 0.5),
                ("goSections", 16.0),
                ("goSections", -1.0),
            ] {
                assert!(
                    matches!(
                        system.set_signal(name, value),
                        Err(Fault::SignalValue { .. })
                    ),
                    "{name} {value}"
                );
            }
            Poll::Ready(system.set_signal("GOSECTIONS", 15.0))
        })
        .then(|system| {
            if system.signal("DIREADY") == Ok(1.0) {
                Poll::Ready(system.set_signal("doVacuum", 1.0))
            } else {
                Poll::Pending
            }
        });
    let mut controller = controller(script);
    let (events, _) = run(&mut controller, &mut NoNetwork, 10);
    assert!(edge(&events, "goSections") < SimTime::ZERO + TICK);
    assert_eq!(controller.output("doVacuum"), Ok(0.0));
    assert!(controller.output("diReady").is_err());
    assert!(controller.set_input("doVacuum", 1.0).is_err());
    controller.set_input("diReady", 1.0).unwrap();
    let start = SimTime::ZERO + SimDuration::from_millis(40);
    let (events, _) = run_from(&mut controller, &mut NoNetwork, start, 1);
    assert_eq!(edge(&events, "diReady"), start);
    assert_eq!(edge(&events, "doVacuum"), start);
    // Setting what is set already is no edge.
    controller.set_input("diReady", 1.0).unwrap();
    assert!(controller.poll_event().is_none());
}

#[test]
fn bad_descriptions_are_refused() {
    let with = |change: &dyn Fn(&mut ControllerSpec)| {
        let mut spec = spec();
        change(&mut spec);
        Controller::new(spec).map(|_| ()).unwrap_err()
    };
    let twice = SignalSpec::new("DOVACUUM", SignalKind::DigitalOutput);
    assert!(matches!(
        with(&|s| s.signals.push(twice.clone())),
        ControllerError::DuplicateSignal { .. }
    ));
    let wide = SignalSpec::new("go", SignalKind::GroupOutput { bits: 0 });
    assert!(matches!(
        with(&|s| s.signals.push(wide.clone())),
        ControllerError::GroupWidth { bits: 0, .. }
    ));
    assert!(matches!(
        with(&|s| s.start = joints(500.0, 0.0)),
        ControllerError::StartJoints { .. }
    ));
    assert_eq!(
        with(&|s| s.statement_cost = SimDuration::ZERO),
        ControllerError::StatementCost
    );
}

fn tour() -> Script {
    Script::new()
        .go(move_j(30.0, 10.0, Z100))
        .go(move_j(30.0, 40.0, Z100))
        .set("doVacuum", 1.0)
        .go(move_j(-30.0, 10.0, MoveZone::Fine))
}

#[test]
fn two_runs_are_equal_to_the_bit() {
    let runs = || run(&mut controller(tour()), &mut NoNetwork, 700);
    let (a, b) = (runs(), runs());
    assert_eq!(a.0, b.0);
    assert_eq!(a.1, b.1);
}

/// A saved cabinet runs on as the original does. The arm is under way and the program has ended its part.
#[test]
fn saved_state_runs_on_alike() {
    let script = Script::new()
        .go(move_j(30.0, 10.0, Z100))
        .go(move_j(30.0, 40.0, Z100));
    let mut original = controller(script);
    run(&mut original, &mut NoNetwork, 60);
    let mut copy = Controller::resume(original.cabinet().clone(), None);
    let start = SimTime::ZERO + SimDuration::from_millis(240);
    let a = run_from(&mut original, &mut NoNetwork, start, 300);
    let b = run_from(&mut copy, &mut NoNetwork, start, 300);
    assert_eq!(a, b);
    assert!(a.1[0].max_distance(&a.1[300]) > 0.1, "it was under way");
}

/// A saved cabinet with its tasks runs on as the original does, whatever they share and wait for.
#[test]
fn several_tasks_are_saved_with_their_cabinet() {
    let role = |name: &str, moves_arm| TaskRole {
        moves_arm,
        ..TaskRole::motion(name)
    };
    let machine = |shared: bool| {
        use depal_vm::{BinaryOp, Machine, Op, Program, Routine, SharedDatum, Value};
        // Counts one datum up for ever, by 1 or by 3.
        let step = if shared { 3.0 } else { 1.0 };
        let code = vec![
            Op::Statement { line: 1, next: 5 },
            Op::LoadGlobal(0),
            Op::Push(Value::Num(step)),
            Op::Binary(BinaryOp::Add),
            Op::StoreGlobal(0),
            Op::Jump(0),
        ];
        let program = Program {
            routines: vec![Routine {
                code,
                ..Routine::default()
            }],
            globals: vec![Value::Num(0.0)],
            global_names: vec!["count".into()],
            shared: vec![SharedDatum {
                name: "count".into(),
                kind: "num".into(),
                global: 0,
                has_value: true,
            }],
            ..Program::default()
        };
        Machine::new(Arc::new(program), if shared { "B" } else { "A" })
    };
    let value = |controller: &Controller| format!("{:?}", controller.cabinet());
    let tick = |controller: &mut Controller, cycle: u32| {
        let at = SimTime::ZERO + SimDuration::from_millis(4 * u64::from(cycle));
        controller.tick(at, &mut NoNetwork);
    };
    let mut original = Controller::new(spec()).unwrap();
    original.add_task(role("A", true), Box::new(machine(false)));
    original.add_task(role("B", false), Box::new(machine(true)));
    for cycle in 0..3 {
        tick(&mut original, cycle);
    }
    // 200 statements of each task a cycle; a cycle adds 200 and 600.
    let counted = value(&original);
    assert!(counted.contains("Num(2400.0)"), "{counted}");
    let mut again = Controller::new(spec()).unwrap();
    again.add_task(role("A", true), Box::new(machine(false)));
    again.add_task(role("B", false), Box::new(machine(true)));
    for cycle in 0..3 {
        tick(&mut again, cycle);
    }
    assert_eq!(counted, value(&again), "two runs are equal");
    // The machines are plain data: the copies stand where the originals do.
    let copies = [machine(false), machine(true)].map(|mut copy| {
        let total = depal_vm::Value::Num(2400.0);
        depal_vm::execution::RobotTask::set_shared(&mut copy, 0, total);
        Box::new(copy) as Box<dyn RobotTask>
    });
    let mut copy = Controller::resume(original.cabinet().clone(), copies);
    for cycle in 3..5 {
        tick(&mut original, cycle);
        tick(&mut copy, cycle);
    }
    assert_eq!(value(&original), value(&copy));
}
