use super::*;
use crate::ControllerState;

/// The very trap of run-ahead: an output after a fly-by move switches while the arm is still far away.
#[test]
fn output_after_a_fly_by_move_switches_before_arrival() {
    let script = || Script::new().go(move_j(60.0, 10.0, Z100));
    let rest = |s: Script| {
        s.set("doVacuum", 1.0)
            .go(move_j(60.0, 40.0, MoveZone::Fine))
    };
    let (events, _) = run(&mut controller(rest(script())), &mut NoNetwork, 600);
    assert!(edge(&events, "doVacuum") < SimTime::ZERO + TICK);
    assert!(reached(&events, 0).as_secs_f64() > 0.5);

    // The same with a stop point: the arm stands before the output switches, within a cycle of arriving.
    let fine = Script::new().go(move_j(60.0, 10.0, MoveZone::Fine));
    let (events, trace) = run(&mut controller(rest(fine)), &mut NoNetwork, 600);
    let (edge, reached) = (edge(&events, "doVacuum"), reached(&events, 0));
    assert!(edge >= reached && edge - reached <= TICK + SimDuration::from_micros(100));
    let at_edge = trace[(edge.as_nanos() / TICK.as_nanos()) as usize];
    assert!(at_edge.max_distance(&joints(60.0, 10.0)) < 1e-9);
}

#[test]
fn program_waits_when_the_queue_is_full() {
    let mut script = Script::new();
    for i in 1..=8 {
        script = script.go(move_j(10.0 * f64::from(i), 10.0, Z100));
    }
    let mut controller = controller(script.set("doVacuum", 1.0));
    let (events, _) = run(&mut controller, &mut NoNetwork, 1000);
    // 8 moves, 1 under way and 5 waiting: the eighth is taken when the second is left behind.
    let edge = edge(&events, "doVacuum");
    let (second, third) = (reached(&events, 1), reached(&events, 2));
    assert!(edge >= second && edge < third, "{second} {edge} {third}");
    assert_eq!(controller.corner_failures(), 0);
    assert_eq!(*controller.state(), ControllerState::Finished);
    assert!(controller.is_standing());
}

/// A program that computes too long between two moves loses its corner, and the log says which.
#[test]
fn late_move_makes_the_corner_a_stop() {
    let script = Script::new()
        .go(move_j(30.0, 10.0, Z100))
        .then(|system| {
            if system.now().as_secs_f64() < 5.0 {
                Poll::Pending
            } else {
                Poll::Ready(Ok(()))
            }
        })
        .go(move_j(60.0, 40.0, MoveZone::Fine));
    let (events, trace) = run(&mut controller(script), &mut NoNetwork, 2000);
    assert!(
        events
            .iter()
            .any(|e| matches!(e, ControllerEvent::CornerFailure { id, .. } if id.0 == 0))
    );
    assert!(trace[1200].max_distance(&joints(30.0, 10.0)) < 1e-9);
    assert!(trace[2000].max_distance(&joints(60.0, 40.0)) < 1e-9);
}

#[test]
fn commanded_joints_keep_the_limits_through_corners_and_a_collision() {
    let mut script = Script::new();
    for i in 0..6 {
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        script = script.go(move_j(40.0 * side, 10.0 + 30.0 * side, Z100));
    }
    let mut controller = controller(script);
    let (_, mut trace) = run(&mut controller, &mut NoNetwork, 200);
    let before = controller.commanded_joints();
    assert!(trace[199].max_distance(&before) > 1e-3, "under way");
    controller.report_collision("carton 7, 900 N");
    let start = SimTime::ZERO + SimDuration::from_millis(800);
    let (events, rest) = run_from(&mut controller, &mut NoNetwork, start, 500);
    trace.extend(&rest[1..]);
    let (speed, acceleration) = use_of_limits(&trace);
    assert!(
        speed <= 1.01 && acceleration <= 1.01,
        "{speed} {acceleration}"
    );
    assert!(speed > 0.5 && acceleration > 0.9, "it does use them");
    // From at most 100 deg/s with 180 deg/s2 it stands within 0.56 s.
    assert!(rest[150].max_distance(&rest[500]) < 1e-12);
    assert!(
        rest[1].max_distance(&rest[500]) > 1e-3,
        "it takes its way to brake"
    );
    assert!(matches!(
        &events[0],
        ControllerEvent::MotionStopped { dropped, reason, .. }
            if !dropped.is_empty() && reason.contains("900 N")
    ));
}

/// A program that waits for a fine point hears of the collision there; unhandled, it fails.
#[test]
fn collision_fails_the_program_that_waits_for_its_move() {
    let mut controller = controller(Script::new().go(move_j(90.0, 10.0, MoveZone::Fine)));
    run(&mut controller, &mut NoNetwork, 100);
    controller.report_collision("carton 7, 900 N");
    let start = SimTime::ZERO + SimDuration::from_millis(400);
    run_from(&mut controller, &mut NoNetwork, start, 200);
    let ControllerState::Failed(error) = controller.state() else {
        panic!("{:?}", controller.state());
    };
    assert!(error.name.contains("MotionSupervision") && error.message.contains("900 N"));
    assert!(controller.is_standing());
    assert!(controller.commanded_joints()[0] < 60f64.to_radians());
}

/// A handled collision: the same move again goes on from where the arm stands, and the alarm is told only once.
#[test]
fn collision_can_be_handled() {
    let script = Script::new()
        .go(move_j(90.0, 10.0, Z100))
        .go(move_j(90.0, 40.0, MoveZone::Fine))
        .set("goSections", 15.0)
        .handler_here()
        .set("doVacuum", 1.0)
        .go(move_j(0.0, 10.0, MoveZone::Fine));
    let mut controller = controller(script);
    run(&mut controller, &mut NoNetwork, 100);
    controller.report_collision("carton 7, 900 N");
    let start = SimTime::ZERO + SimDuration::from_millis(400);
    let (events, trace) = run_from(&mut controller, &mut NoNetwork, start, 800);
    assert_eq!(controller.output("doVacuum"), Ok(1.0));
    assert_eq!(
        controller.output("goSections"),
        Ok(0.0),
        "skipped by the fault"
    );
    assert_eq!(*controller.state(), ControllerState::Finished, "{events:?}");
    assert!(trace[800].max_distance(&joints(0.0, 10.0)) < 1e-9);
    let (speed, acceleration) = use_of_limits(&trace);
    assert!(
        speed <= 1.01 && acceleration <= 1.01,
        "{speed} {acceleration}"
    );
}

/// The program runs ahead, so an impossible target is found at its own instruction while the arm is on its way there.
#[test]
fn impossible_move_fails_at_its_own_instruction_and_the_arm_brakes() {
    let script = Script::new()
        .go(move_j(90.0, 10.0, Z100))
        .go(move_j(90.0, 200.0, MoveZone::Fine));
    let mut controller = controller(script);
    let (events, _) = run(&mut controller, &mut NoNetwork, 300);
    let ControllerState::Failed(error) = controller.state() else {
        panic!("{:?}", controller.state());
    };
    assert_eq!(error.call_stack[0].line, 2);
    assert!(
        error.message.contains("joint 2 would be at 200.00 deg"),
        "{}",
        error.message
    );
    assert!(
        time_of(&events, |e| matches!(e, ControllerEvent::TaskEnded { .. })) < SimTime::ZERO + TICK
    );
    assert!(controller.is_standing());
    assert!(controller.commanded_joints()[0] < 1f64.to_radians());
}

#[test]
fn stop_of_the_program_brakes_the_arm() {
    struct StopAfter(SimTime, Script);
    impl RobotTask for StopAfter {
        fn step(&mut self, system: &mut dyn System) -> Step {
            if system.now() >= self.0 {
                return Step::Stopped("Stop instruction".into());
            }
            self.1.step(system)
        }
        fn location(&self) -> ProgramLocation {
            RobotTask::location(&self.1)
        }
    }
    let script = Script::new().go(move_j(90.0, 10.0, MoveZone::Fine));
    let mut controller = Controller::new(spec()).unwrap();
    let stop_at = SimTime::ZERO + SimDuration::from_millis(500);
    controller.set_task(Box::new(StopAfter(stop_at, script)));
    let (_, trace) = run(&mut controller, &mut NoNetwork, 500);
    assert_eq!(
        *controller.state(),
        ControllerState::Stopped("Stop instruction".into())
    );
    let stand = controller.commanded_joints();
    assert!(stand[0] < 60f64.to_radians() && stand[0] > trace[125][0]);
    let (_, acceleration) = use_of_limits(&trace);
    assert!(acceleration <= 1.01);
}
