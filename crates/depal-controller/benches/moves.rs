//! How much faster than the robot a program of 1,500 moves runs, without physics. Run it with `cargo bench`.

// A bench reads the wall clock and prints: that is what it is for.
#![allow(clippy::disallowed_methods, clippy::print_stdout)]

use std::sync::Arc;
use std::time::Instant;

use depal_arm::Arm;
use depal_controller::{Controller, ControllerSpec, ControllerState, NoNetwork};
use depal_frames::JointPositions;
use depal_time::{SimTime, TICK};
use depal_vm::{Machine, Program, SourceFile};

const URDF: &str = include_str!("../../../urdf/abb_irb6700_150_320.urdf");
const PROGRAM: &str = "
MODULE m
  VAR robtarget p;
  PROC main()
    MoveAbsJ [[0,0,0,0,80,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v1000, fine, tool0;
    p := CRobT(\\Tool:=tool0);
    FOR i FROM 1 TO 375 DO
      MoveL Offs(p,0,200,0), v500, z20, tool0;
      MoveL Offs(p,0,200,200), v500, z20, tool0;
      MoveJ Offs(p,0,-200,200), v500, z20, tool0;
      MoveL p, v500, fine, tool0;
    ENDFOR
  ENDPROC
ENDMODULE
";
/// The promise.
const WANTED: f64 = 500.0;

fn run(name: &str, mut controller: Controller, program: &Arc<Program>) {
    controller.set_task(Box::new(Machine::new(Arc::clone(program), "T_ROB1")));
    let begun = Instant::now();
    let mut now = SimTime::ZERO;
    let mut events = 0_u64;
    while *controller.state() == ControllerState::Running || !controller.is_standing() {
        controller.tick(now, &mut NoNetwork);
        now += TICK;
        while controller.poll_event().is_some() {
            events += 1;
        }
    }
    assert_eq!(*controller.state(), ControllerState::Finished);
    let wall = begun.elapsed().as_secs_f64();
    let factor = now.as_secs_f64() / wall;
    let verdict = if factor >= WANTED { "kept" } else { "MISSED" };
    println!(
        "{name}: 1500 moves, {:.0} s of the robot in {wall:.3} s: {factor:.0} x real time (wanted {WANTED}: {verdict}), {events} events",
        now.as_secs_f64()
    );
}

fn main() {
    let source = SourceFile::new("m.mod", PROGRAM);
    let loaded = depal_rapid::load(&[source], &[], "main");
    let program = loaded.program.expect("the program is good");
    let free = ControllerSpec::without_arm("rob1");
    run(
        "every target reachable",
        Controller::without_arm(free).expect("a cabinet"),
        &program,
    );
    let arm = Arm::from_urdf(URDF, "abb_irb6700_150_320.urdf", &[10.0; 6]).expect("an arm");
    let spec = ControllerSpec::new("rob1", Arc::new(arm), JointPositions::zeros(6));
    run(
        "with an arm",
        Controller::new(spec).expect("a cabinet"),
        &program,
    );
}
