mod cabinet;
mod channels;
mod commands;
mod faults;

use depal_time::{SimDuration, TICK};
use depal_vm::execution::{RobotTask, Step};
use depal_vm::{Machine, Value};

use self::cabinet::Cabinet;

const MODULE: &str = include_str!("../../../../../assets/krl/mm_module.src");
const MODULE_DATA: &str = include_str!("../../../../../assets/krl/mm_module.dat");
const MODULE_2_X: &str = include_str!("../../../../../assets/krl/mm_module_2_x.src");
const MODULE_2_X_DATA: &str = include_str!("../../../../../assets/krl/mm_module_2_x.dat");
const CHANNEL: &str = include_str!("../../../../../assets/krl/XML_Kuka_MMIND.xml");

/// A task with these files and channels.
fn task(files: &[(&str, &str)], channels: &[(&str, &str)]) -> Machine {
    let files: Vec<_> = files
        .iter()
        .map(|(name, text)| depal_syntax::SourceFile::new(*name, *text))
        .collect();
    let channels: Vec<_> = channels
        .iter()
        .map(|(name, text)| depal_syntax::SourceFile::new(*name, *text))
        .collect();
    let outputs: Vec<_> = (1..=64).map(|n| format!("$OUT[{n}]")).collect();
    let loaded = crate::with_channels(
        crate::load(&files, &outputs, "main"),
        files.len(),
        &channels,
    );
    let all = [files, channels].concat();
    let says: Vec<_> = loaded.diagnostics.iter().map(|d| d.plain(&all)).collect();
    assert_eq!(says, Vec::<String>::new());
    Machine::new(loaded.program.expect("no errors"), "T_ROB1")
}

/// A program of one file with its data, and the interface module.
fn with_module(body: &str, data: &str) -> Machine {
    let source = format!("DEF main( )\n{body}\nEND\n");
    let data = format!("DEFDAT MAIN PUBLIC\n{data}\nENDDAT\n");
    let files = [
        ("main.src", source.as_str()),
        ("main.dat", data.as_str()),
        ("mm_module.src", MODULE),
        ("mm_module.dat", MODULE_DATA),
    ];
    task(&files, &[("XML_Kuka_MMIND.xml", CHANNEL)])
}

/// Runs to the end, at most two minutes of simulated time.
fn run(machine: &mut Machine, cabinet: &mut Cabinet) -> Step {
    for _ in 0..2_000_000 {
        assert!(
            cabinet.now.as_secs_f64() <= 120.0,
            "still running at {:?}: {:?}",
            machine.location(),
            cabinet.log
        );
        match machine.step(cabinet) {
            Step::Ran => cabinet.advance(SimDuration::from_micros(20)),
            Step::Blocked => cabinet.advance(TICK),
            end => return end,
        }
    }
    panic!("too many steps at {:?}", machine.location());
}

#[track_caller]
fn finished(machine: &mut Machine, cabinet: &mut Cabinet) {
    let end = run(machine, cabinet);
    assert_eq!(end, Step::Finished, "{:?}", cabinet.log);
}

fn int(machine: &Machine, name: &str) -> i64 {
    match machine.global(name) {
        Some(Value::Int(value)) => *value,
        other => panic!("{name} is {other:?}"),
    }
}

fn ints(machine: &Machine, name: &str, count: usize) -> Vec<i64> {
    let Some(Value::Array(items)) = machine.global(name) else {
        panic!("{name} is no array");
    };
    items[..count]
        .iter()
        .map(|item| match item {
            Value::Int(value) => *value,
            other => panic!("{name} holds {other:?}"),
        })
        .collect()
}

/// The first six components of a position or of axes, rounded to a hundredth.
fn six(machine: &Machine, name: &str) -> [f64; 6] {
    let Some(Value::Record(parts)) = machine.global(name) else {
        panic!("{name} is no record");
    };
    std::array::from_fn(|i| {
        let number = parts[i].as_number().unwrap_or(f64::NAN);
        (number * 100.0).round() / 100.0 + 0.0
    })
}

fn reals(machine: &Machine, name: &str, count: usize) -> Vec<f64> {
    let Some(Value::Array(items)) = machine.global(name) else {
        panic!("{name} is no array");
    };
    let number = |item: &Value| item.as_number().expect("a number");
    items[..count].iter().map(number).collect()
}
