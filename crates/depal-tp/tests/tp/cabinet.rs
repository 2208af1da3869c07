//! Programs in the real cabinet, without an arm and with that of the scene.

use std::sync::Arc;

use depal_arm::Arm;
use depal_controller::{
    Controller, ControllerSpec, ControllerState, NoNetwork, SignalKind, SignalSpec,
};
use depal_frames::JointPositions;
use depal_syntax::SourceFile;
use depal_time::{SimDuration, SimTime, TICK};
use depal_tp::{Options, Tasks, decimal, load};

use crate::fake_system::{listing, taught};

/// Runs `MAIN`; at 1 s DI[1] comes. The registers, how it ended, and when.
fn run(mut controller: Controller, text: &str) -> (String, ControllerState, SimTime, Controller) {
    let loaded = load(
        &[SourceFile::new("MAIN.LS", text)],
        &Options::default(),
        "MAIN",
    );
    let program = loaded
        .program
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let mut tasks = Tasks::new(program, "MAIN");
    let view = tasks.view();
    controller.set_task(Box::new(tasks));
    let mut now = SimTime::ZERO;
    while *controller.state() == ControllerState::Running || !controller.is_standing() {
        controller.tick(now, &mut NoNetwork);
        while controller.poll_event().is_some() {}
        now += TICK;
        if now == SimTime::ZERO + SimDuration::from_millis(1000) {
            controller.set_input("DI[1]", 1.0).expect("an input");
        }
        assert!(
            now.as_secs_f64() < 120.0,
            "hangs at {:?}",
            controller.location()
        );
    }
    let registers: Vec<_> = view
        .written_registers()
        .iter()
        .map(|(n, v)| format!("R[{n}]={}", decimal(*v)))
        .collect();
    (
        registers.join(" "),
        controller.state().clone(),
        now,
        controller,
    )
}

fn signals() -> Vec<SignalSpec> {
    vec![
        SignalSpec::new("DI[1]", SignalKind::DigitalInput),
        SignalSpec::new("DO[1]", SignalKind::DigitalOutput),
    ]
}

fn free() -> Controller {
    let mut spec = ControllerSpec::without_arm("rob1");
    spec.signals = signals();
    Controller::without_arm(spec).expect("a good cabinet")
}

fn with_arm() -> Controller {
    let text = include_str!("../../../../urdf/fanuc_r2000ic_165f.urdf");
    let arm = Arm::from_urdf_uniform(text, "tool0", 4.0).expect("a good description");
    let home = JointPositions::from_degrees(&[90.0, -20.0, -20.0, 0.0, -90.0, 0.0]);
    let mut spec = ControllerSpec::new("rob1", Arc::new(arm), home);
    spec.signals = signals();
    Controller::new(spec).expect("a good cabinet")
}

const JOINTS: &str = "P[3]{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1= 10.000 deg,\tJ2= 20.000 deg,\tJ3= -30.000 deg,\n\tJ4= 1.500 deg,\tJ5= -60.000 deg,\tJ6= 5.000 deg\n};\n";

#[test]
fn without_an_arm_the_last_target_is_read_back_in_its_own_kind() {
    let lines = [
        "L P[1] 500mm/sec FINE",
        "PR[1]=LPOS",
        "R[1]=PR[1,1]",
        "R[2]=PR[1,3]",
        "R[3]=PR[1,4]",
        "R[4]=PR[1,6]",
        "J P[3] 100% FINE",
        "PR[2]=JPOS",
        "R[11]=PR[2,2]",
        "R[12]=PR[2,3]",
        "R[13]=PR[2,4]",
    ];
    let text = listing(
        &lines,
        &(taught(1, [1000.25, 0.0, 500.0, 180.0, 0.0, 30.0]) + JOINTS),
    );
    let (registers, state, ..) = run(free(), &text);
    assert_eq!(state, ControllerState::Finished);
    assert_eq!(
        registers,
        "R[1]=1000.25 R[2]=500 R[3]=180 R[4]=30 R[11]=20 R[12]=-30 R[13]=1.5"
    );
}

#[test]
fn a_skip_stops_the_arm_on_its_way() {
    let lines = [
        "SKIP CONDITION DI[1]=ON",
        "PR[1]=LPOS",
        "PR[2]=PR[1]",
        "PR[2,3]=PR[1,3]+400",
        "L PR[2] 100mm/sec FINE Skip,LBL[1]",
        "PR[3]=LPOS",
        "R[1]=PR[3,3]-PR[1,3]",
        "L PR[1] 500mm/sec FINE",
        "R[2]=1",
        "END",
        "LBL[1]",
        "R[9]=1",
    ];
    let (registers, state, _, _) = run(with_arm(), &listing(&lines, ""));
    assert_eq!(state, ControllerState::Finished);
    // A second at 100 mm/s, less the start, and the way of the stop.
    let travelled = registers
        .split(' ')
        .next()
        .and_then(|r| r[5..].parse::<f64>().ok());
    assert!(
        travelled.is_some_and(|way| (80.0..110.0).contains(&way)),
        "{registers}"
    );
    assert!(registers.ends_with("R[2]=1"), "{registers}");
}

#[test]
fn a_corner_before_an_input_is_reached() {
    let lines = [
        "PR[1]=LPOS",
        "PR[1,3]=PR[1,3]-100",
        "L PR[1] 200mm/sec CNT100",
        "R[1]=DI[1]",
        "PR[2]=LPOS",
        "R[2]=(ABS[PR[2,3]-PR[1,3]]<.01)",
    ];
    let (registers, state, ..) = run(with_arm(), &listing(&lines, ""));
    assert_eq!(
        (registers.as_str(), state),
        ("R[1]=0 R[2]=1", ControllerState::Finished)
    );
}

#[test]
fn the_arm_of_the_scene_moves_and_tells_where_it_is() {
    let lines = [
        "PR[1]=JPOS",
        "R[1]=PR[1,3]",
        "PR[2]=LPOS",
        "PR[2,3]=PR[2,3]-100",
        "PR[3]=PR[2]",
        "PR[3,1]=PR[3,1]+200",
        "L PR[2] 500mm/sec CNT50",
        "L PR[3] 500mm/sec CNT50 DB 20.0mm,DO[1]=ON",
        "J PR[1] 50% FINE",
        "PR[4]=JPOS",
        "R[2]=(ABS[PR[4,3]-PR[1,3]]<.001)",
        "L PR[3] 800mm/sec FINE",
        "PR[5]=LPOS",
        "R[3]=(ABS[PR[5,1]-PR[3,1]]<.01 AND ABS[PR[5,3]-PR[3,3]]<.01)",
        "L PR[1] 800mm/sec FINE",
        "R[4]=DO[1]",
        "PR[3,1]=9000",
        "L PR[3] 800mm/sec FINE",
    ];
    let (registers, state, _, controller) = run(with_arm(), &listing(&lines, ""));
    assert_eq!(registers, "R[1]=0 R[2]=1 R[3]=1 R[4]=1");
    let ControllerState::Failed(error) = state else {
        panic!("{state:?}");
    };
    assert_eq!(
        (error.name.as_str(), error.call_stack[0].line),
        ("MOTN", 18)
    );
    assert!(
        error.message.starts_with("Position not reachable"),
        "{}",
        error.message
    );
    assert!(controller.is_standing());
}
