//! The page of instructions, made from the table by running each entry.

use std::cell::Cell;
use std::fmt::Write;
use std::task::Poll;

use depal_frames::{JointPositions, Pose};
use depal_time::SimTime;
use depal_vm::system::*;
use depal_vm::{CallContext, Interrupt, LanguageRules, Memory, Outcome, Program, Trigger, Value};

use super::refused;
use super::table::{LOWERED, Table, entries, name_of};
use crate::catalogue::tests::up_to_date;
use crate::syntax::tree::{Mode, Routine, RoutineKind};

/// Notes that it was asked for anything.
#[derive(Default)]
struct Untouched {
    asked: Cell<bool>,
}

impl Untouched {
    fn note(&self) {
        self.asked.set(true);
    }
}

impl System for Untouched {
    fn now(&self) -> SimTime {
        self.note();
        SimTime::ZERO
    }
    fn signal(&self, name: &str) -> Result<f64, Fault> {
        self.note();
        Err(Fault::UnknownSignal(name.to_owned()))
    }
    fn set_signal(&mut self, name: &str, _: f64) -> Result<(), Fault> {
        self.note();
        Err(Fault::UnknownSignal(name.to_owned()))
    }
    fn start_move(&mut self, _: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        self.note();
        Poll::Pending
    }
    fn is_move_done(&self, _: MoveId) -> Result<bool, Fault> {
        self.note();
        Ok(true)
    }
    fn is_standing(&self) -> bool {
        self.note();
        true
    }
    fn stop_motion(&mut self) {
        self.note();
    }
    fn joints(&self) -> JointPositions {
        self.note();
        JointPositions::from_degrees(&[0.0; 6])
    }
    fn planned_joints(&self) -> JointPositions {
        self.joints()
    }
    fn forward(&self, _: &JointPositions) -> Pose {
        self.note();
        Pose::identity()
    }
    fn inverse(&self, _: &Pose, near: &JointPositions) -> Result<JointPositions, Fault> {
        self.note();
        Ok(*near)
    }
    fn socket_create(&mut self) -> SocketId {
        self.note();
        SocketId(0)
    }
    fn socket_connect(&mut self, _: SocketId, _: &str, _: u16) -> Poll<Result<(), Fault>> {
        self.note();
        Poll::Pending
    }
    fn socket_send(&mut self, _: SocketId, _: &[u8]) -> Result<(), Fault> {
        self.note();
        Ok(())
    }
    fn socket_receive(&mut self, _: SocketId, _: usize) -> Poll<Result<Received, Fault>> {
        self.note();
        Poll::Pending
    }
    fn socket_close(&mut self, _: SocketId) {
        self.note();
    }
    fn socket_state(&self, _: SocketId) -> SocketState {
        self.note();
        SocketState::Closed
    }
    fn log(&mut self, _: LogKind, _: &ProgramLocation, _: &str) {
        self.note();
    }
    fn statement(&mut self, _: &ProgramLocation) {}
}

/// Memories to run in: nothing there, and an interrupt connected while they are held back and tasks move in step.
fn memories() -> [Memory; 2] {
    let mut busy = Memory::default();
    busy.interrupts.disabled = true;
    busy.partners.push("T_ROB1".into());
    busy.interrupts.connected.push(Interrupt {
        number: 0,
        routine: 0,
        trigger: Trigger::None,
        ..Interrupt::default()
    });
    [Memory::default(), busy]
}

/// Whether a built-in called without any argument is over at once, without a result, and has neither asked the
/// cabinet nor changed the program's data. What has work to do fails for want of its arguments, or does it.
fn has_no_effect(run: depal_vm::BuiltinFn) -> bool {
    memories()
        .into_iter()
        .all(|memory| leaves_alone(run, memory))
}

fn leaves_alone(run: depal_vm::BuiltinFn, mut memory: Memory) -> bool {
    let mut system = Untouched::default();
    let before = format!("{memory:?}");
    let (mut arguments, mut notes) = (Vec::new(), Vec::new());
    let location = ProgramLocation::default();
    let rules = LanguageRules::default();
    let program = Program::default();
    let mut context = CallContext {
        arguments: &mut arguments,
        started: SimTime::ZERO,
        notes: &mut notes,
        memory: &mut memory,
        location: &location,
        rules: &rules,
        program: &program,
    };
    let outcome = run(&mut context, &mut system);
    matches!(outcome, Ok(Outcome::Done(Value::Absent)))
        && !system.asked.get()
        && format!("{memory:?}") == before
}

/// The heading as programs call it.
fn usage(routine: &Routine) -> String {
    let function = matches!(routine.kind, RoutineKind::Function(_));
    let mut text = routine.name.text.clone();
    if function {
        text.push('(');
    }
    for (i, parameter) in routine.parameters.iter().enumerate() {
        let alternative = i > 0 && routine.parameters[i - 1].group == parameter.group;
        let before = match (alternative, parameter.optional, i) {
            (true, ..) => " \\| ",
            (_, true, 0) if function => "\\",
            (_, true, _) => " \\",
            (_, _, 0) if function => "",
            (_, _, 0) => " ",
            _ => ", ",
        };
        text.push_str(before);
        text.push_str(match parameter.mode {
            Mode::Value => "",
            Mode::Var => "VAR ",
            Mode::Inout => "INOUT ",
            Mode::Pers => "PERS ",
        });
        text.push_str(&parameter.name.text);
        if parameter.type_name.text != "switch" {
            let _ = write!(text, ": {}", parameter.type_name.text);
        }
    }
    if let RoutineKind::Function(kind) = &routine.kind {
        let _ = write!(text, "): {}", kind.text);
    }
    text
}

#[test]
fn the_page_of_instructions_is_up_to_date() {
    let table = Table::new();
    let runs = entries();
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut names = Vec::new();
    for (routine, _) in table.headings() {
        let name = routine.name.text.as_str();
        names.push(name.to_lowercase());
        let run = runs.iter().find(|(heading, _)| name_of(heading) == name);
        let status = match run {
            Some((_, run)) if has_no_effect(*run) => "no-op",
            _ => "real",
        };
        rows.push((
            name.to_lowercase(),
            format!("| `{}` | {status} |\n", usage(routine)),
        ));
    }
    assert_eq!(rows.len(), runs.len() + LOWERED.len());
    rows.push((
        "present".into(),
        "| `Present(OptPar): bool` | real |\n".into(),
    ));
    rows.sort();
    let mut text = String::from(
        "# Instructions and functions\n\nMade from the table of built-ins by its tests; do not edit.\nreal: it does what the controller does, as far as the simulated cell goes. no-op: it is accepted and has no effect here. refused: the program is told so before it runs.\nOptional arguments wear a backslash, alternatives are separated by a bar.\n",
    );
    let no_op = rows
        .iter()
        .filter(|(_, row)| row.ends_with("no-op |\n"))
        .count();
    let refused: Vec<_> = refused::all()
        .into_iter()
        .filter(|(name, _)| !names.contains(&name.to_lowercase()))
        .collect();
    let _ = write!(
        text,
        "\n{} real, {no_op} without effect, {} refused.\n\n## What runs\n\n| Instruction or function | Status |\n|---|---|\n",
        rows.len() - no_op,
        refused.len()
    );
    for (_, row) in &rows {
        text.push_str(row);
    }
    text.push_str("\n## What is refused\n\n| Name | Why | Instead |\n|---|---|---|\n");
    for (name, theme) in refused {
        let _ = writeln!(text, "| `{name}` | {} | {} |", theme.why, theme.instead);
    }
    up_to_date("instructions.md", &text);
}

#[test]
fn a_no_op_is_told_from_what_works() {
    let status = |name: &str| {
        let found = entries().into_iter().find(|(h, _)| name_of(h) == name);
        found.map(|(_, run)| has_no_effect(run))
    };
    for real in [
        "AccSet",
        "ExitCycle",
        "IDisable",
        "IEnable",
        "IDelete",
        "SetDO",
        "Incr",
        "ClkReset",
        "Abs",
    ] {
        assert_eq!(status(real), Some(false), "{real}");
    }
}
