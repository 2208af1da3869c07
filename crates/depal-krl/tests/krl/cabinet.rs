//! The same programs in the real cabinet, without an arm.

use depal_controller::{
    Controller, ControllerSpec, ControllerState, NoNetwork, SignalFamily, SignalKind,
};
use depal_krl::load_with_any_signals;
use depal_time::{SimTime, TICK};
use depal_vm::Machine;

use crate::fake_system::sources;
use crate::pick;

fn controller(files: &[(&str, &str)]) -> Controller {
    let loaded = load_with_any_signals(&sources(files), "main");
    let mut spec = ControllerSpec::without_arm("rob1");
    let families = [
        ("$IN", SignalKind::DigitalInput),
        ("$OUT", SignalKind::DigitalOutput),
    ];
    spec.families = families
        .map(|(name, kind)| SignalFamily {
            name: name.into(),
            kind,
            highest: 1024,
        })
        .into();
    let mut controller = Controller::without_arm(spec).expect("a cabinet");
    let program = loaded.program.expect("right");
    controller.set_task(Box::new(Machine::new(program, "T_ROB1")));
    controller
}

/// Runs while the task does, at most 60 s; `each` sees every tick.
fn run(controller: &mut Controller, mut each: impl FnMut(&mut Controller, f64)) -> f64 {
    let mut now = SimTime::ZERO;
    while *controller.state() == ControllerState::Running && now.as_secs_f64() < 60.0 {
        controller.tick(now, &mut NoNetwork);
        now += TICK;
        each(controller, now.as_secs_f64());
    }
    now.as_secs_f64()
}

#[test]
fn the_pick_program_ends_with_the_vacuum_switched_twice() {
    let mut cell = controller(&[("main.src", pick::SOURCE), ("main.dat", pick::DATA)]);
    let mut edges = Vec::new();
    let mut since = 0.0;
    let mut before = 0.0;
    let seconds = run(&mut cell, |cell, now| {
        let pump = cell.output("$OUT[1]").expect("there");
        if pump != before {
            edges.push(pump);
            since = now;
            before = pump;
        }
        // The cups seal and let go 100 ms later.
        if now - since > 0.1 {
            cell.set_input("$IN[1]", pump).expect("an input");
        }
    });
    assert_eq!(
        *cell.state(),
        ControllerState::Finished,
        "after {seconds} s"
    );
    assert_eq!(edges, [1.0, 0.0, 1.0, 0.0]);
    assert!(cell.is_standing());
}

#[test]
fn an_interrupt_with_resume_ends_the_search() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN $IN[1] DO found( )\nINTERRUPT ON 5\n$VEL.CP = 0.1\nsearch( )\n$OUT[1] = TRUE\nLIN {X 0.0, Y 0.0, Z 900.0, A 0.0, B 0.0, C 0.0}\n$OUT[2] = TRUE\nEND\nDEF search( )\nLIN {X 0.0, Y 0.0, Z 1000.0, A 0.0, B 0.0, C 0.0}\nLIN {X 1000.0}\nWAIT SEC 0\n$OUT[3] = TRUE\nEND\nDEF found( )\nBRAKE\nRESUME\nEND";
    let mut cell = controller(&[("main.src", source)]);
    let seconds = run(&mut cell, |cell, now| {
        if now > 12.0 {
            cell.set_input("$IN[1]", 1.0).expect("an input");
        }
    });
    assert_eq!(
        *cell.state(),
        ControllerState::Finished,
        "after {seconds} s"
    );
    let outputs = ["$OUT[1]", "$OUT[2]", "$OUT[3]"].map(|name| cell.output(name).expect("there"));
    assert_eq!(outputs, [1.0, 1.0, 0.0]);
    assert!(seconds < 20.0, "{seconds}");
}
