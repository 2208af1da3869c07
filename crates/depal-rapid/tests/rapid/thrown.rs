//! What is thrown at the front end and at the machine, by tests and by the fuzz targets: it may be refused, it may
//! fail, it must not panic or hang.

use depal_rapid::{check, check_syntax, load, normal_form};
use depal_syntax::SourceFile;
use depal_time::{SimDuration, SimTime, TICK};
use depal_vm::Machine;
use depal_vm::execution::{RobotTask, Step};

use crate::fake_system::{FakeSystem, signals};
use crate::generate::program;

/// Any text: every message can be drawn, and what reads without one reads the same after printing.
pub fn throw(text: &str) {
    let source = [SourceFile::new("x.mod", text)];
    for diagnostic in check(&source).diagnostics {
        diagnostic.plain(&source);
    }
    load(&source, &signals(), "main");
    check_syntax(&source);
    if let Ok(printed) = normal_form(&source[0]) {
        let again = normal_form(&SourceFile::new("y.mod", printed.as_str()));
        assert_eq!(again.as_ref(), Ok(&printed), "{text}");
    }
}

/// A program made from bytes runs for a while; a copy of the machine taken on the way does the same.
pub fn run_generated(bytes: &[u8]) -> Step {
    let source = [SourceFile::new("generated.mod", program(bytes))];
    let loaded = load(&source, &signals(), "main");
    let shown = || {
        let lines: Vec<_> = loaded
            .diagnostics
            .iter()
            .map(|d| d.plain(&source))
            .collect();
        lines.join("\n")
    };
    let Some(program) = loaded.program.clone() else {
        panic!(
            "a generated program is right:\n{}\n{}",
            shown(),
            source[0].text
        )
    };
    let mut machine = Machine::new(program, "T_ROB1");
    let mut system = FakeSystem::default();
    if let Some(end) = run_steps(&mut machine, &mut system, 50) {
        return end;
    }
    let (mut copy, mut copied) = (machine.clone(), system.clone());
    let end = run_steps(&mut machine, &mut system, 2000);
    assert_eq!(end, run_steps(&mut copy, &mut copied, 2000));
    assert_eq!(
        (system.now, &system.trace, format!("{:?}", machine.memory())),
        (copied.now, &copied.trace, format!("{:?}", copy.memory()))
    );
    end.unwrap_or(Step::Ran)
}

/// So many steps at most; the end, if it is reached.
fn run_steps(machine: &mut Machine, system: &mut FakeSystem, most: usize) -> Option<Step> {
    for _ in 0..most {
        match machine.step(system) {
            Step::Ran => system.now += SimDuration::from_micros(20),
            Step::Blocked => {
                let ticks = system.now.as_nanos() / TICK.as_nanos() + 1;
                system.now = SimTime::from_nanos(ticks * TICK.as_nanos());
            }
            end => return Some(end),
        }
    }
    None
}
