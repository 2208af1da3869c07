//! Both forms of the code do the same: on random programs, statement by statement and in batches.

mod generate;
mod lower;

use std::sync::Arc;
use std::task::Poll;

use depal_frames::{JointPositions, Pose};
use depal_time::SimTime;
use proptest::prelude::*;

use crate::execution::{RobotTask, Step};
use crate::system::*;
use crate::{BinaryOp, ErrorHandler, Machine, Op, Program, Reference, Root, Routine, Value};

use generate::{Statement, statements};
use lower::Lowering;

/// Writes down each statement that it is told of, or their number.
#[derive(Default)]
struct Listener {
    grants: u32,
    ran: u64,
}

impl System for Listener {
    fn spare_statements(&self) -> u32 {
        self.grants
    }
    fn statements_ran(&mut self, count: u32) {
        assert!(count <= self.grants);
        self.ran += u64::from(count);
    }
    fn statement(&mut self, _: &ProgramLocation) {
        self.ran += 1;
    }
    fn now(&self) -> SimTime {
        SimTime::ZERO
    }
    fn signal(&self, name: &str) -> Result<f64, Fault> {
        Err(Fault::UnknownSignal(name.to_owned()))
    }
    fn set_signal(&mut self, name: &str, _: f64) -> Result<(), Fault> {
        Err(Fault::UnknownSignal(name.to_owned()))
    }
    fn start_move(&mut self, _: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        Poll::Pending
    }
    fn is_move_done(&self, _: MoveId) -> Result<bool, Fault> {
        Ok(true)
    }
    fn is_standing(&self) -> bool {
        true
    }
    fn stop_motion(&mut self) {}
    fn joints(&self) -> JointPositions {
        JointPositions::from_degrees(&[0.0; 6])
    }
    fn planned_joints(&self) -> JointPositions {
        self.joints()
    }
    fn forward(&self, _: &JointPositions) -> Pose {
        Pose::identity()
    }
    fn inverse(&self, _: &Pose, near: &JointPositions) -> Result<JointPositions, Fault> {
        Ok(*near)
    }
    fn socket_create(&mut self) -> SocketId {
        SocketId(0)
    }
    fn socket_connect(&mut self, _: SocketId, _: &str, _: u16) -> Poll<Result<(), Fault>> {
        Poll::Pending
    }
    fn socket_send(&mut self, _: SocketId, _: &[u8]) -> Result<(), Fault> {
        Ok(())
    }
    fn socket_receive(&mut self, _: SocketId, _: usize) -> Poll<Result<Received, Fault>> {
        Poll::Pending
    }
    fn socket_close(&mut self, _: SocketId) {}
    fn socket_state(&self, _: SocketId) -> SocketState {
        SocketState::Closed
    }
    fn log(&mut self, _: LogKind, _: &ProgramLocation, _: &str) {}
}

fn program(statements: &[Statement]) -> Program {
    let mut lowering = Lowering {
        locals: vec![
            Value::Num(1.0),
            Value::Num(2.0),
            Value::Reference(Reference {
                root: Root::Global(2),
                path: Vec::new(),
            }),
            Value::Bool(false),
        ],
        ..Lowering::default()
    };
    lowering.block(statements);
    lowering.emit(Op::Return { value: false });
    let entry = lowering.code.len() as u32;
    // Whatever fails is passed over.
    lowering.begin();
    lowering.emit(Op::TryNext);
    lowering.emit(Op::Reraise);
    let main = Routine {
        name: "main".into(),
        locals: lowering.locals,
        code: lowering.code,
        handler: Some(ErrorHandler {
            entry,
            numbers: None,
        }),
        ..Routine::default()
    };
    let [half, halves, note] = callees();
    Program {
        routines: vec![main, half, halves, note],
        globals: vec![
            Value::Num(3.0),
            Value::Num(-1.5),
            Value::Num(0.0),
            Value::Array((0..5).map(|i| Value::Num(i as f32)).collect()),
            Value::Bool(true),
        ],
        ..Program::default()
    }
}

/// Half of a number, after counting in global 0; the number of halvings to below 1, by calling itself; a procedure
/// that fails for what is no number it can divide by.
fn callees() -> [Routine; 3] {
    let half = Routine {
        name: "half".into(),
        locals: vec![Value::Absent],
        code: vec![
            Op::Statement { line: 1, next: 5 },
            Op::LoadGlobal(0),
            Op::Push(Value::Num(1.0)),
            Op::Binary(BinaryOp::Add),
            Op::StoreGlobal(0),
            Op::Statement { line: 2, next: 10 },
            Op::LoadLocal(0),
            Op::Push(Value::Num(0.5)),
            Op::Binary(BinaryOp::Multiply),
            Op::Return { value: true },
            Op::MissingReturn,
        ],
        ..Routine::default()
    };
    let halves = Routine {
        name: "halves".into(),
        locals: vec![Value::Absent, Value::Num(7.0), Value::Bool(false)],
        code: vec![
            // A value of its own, before the first statement.
            Op::Push(Value::Num(1.0)),
            Op::SetLocal(1),
            Op::Statement { line: 1, next: 8 },
            Op::LoadLocal(0),
            Op::Push(Value::Num(1.0)),
            Op::Binary(BinaryOp::Less),
            Op::JumpIfFalse(10),
            Op::Statement { line: 2, next: 10 },
            Op::Push(Value::Num(0.0)),
            Op::Return { value: true },
            Op::Statement { line: 3, next: 20 },
            Op::LoadLocal(1),
            Op::LoadLocal(0),
            Op::Call {
                routine: 1,
                arguments: 1,
            },
            Op::Call {
                routine: 2,
                arguments: 1,
            },
            Op::Binary(BinaryOp::Add),
            Op::LoadGlobal(1),
            Op::Push(Value::Num(0.0)),
            Op::Binary(BinaryOp::Multiply),
            Op::Binary(BinaryOp::Add),
            Op::Return { value: true },
            Op::MissingReturn,
        ],
        ..Routine::default()
    };
    let note = Routine {
        name: "note".into(),
        locals: vec![Value::Absent, Value::Absent, Value::Num(0.0)],
        code: vec![
            Op::Statement { line: 1, next: 5 },
            Op::Push(Value::Num(1.0)),
            Op::LoadLocal(0),
            Op::Binary(BinaryOp::Divide),
            Op::StoreLocal(2),
            Op::Statement { line: 2, next: 8 },
            Op::LoadLocal(1),
            Op::StoreGlobal(4),
            Op::Return { value: false },
        ],
        ..Routine::default()
    };
    [half, halves, note]
}

/// Values as bits, so that no number is a number too equal.
fn bits(machine: &Machine) -> String {
    format!("{:?}", machine.memory())
}

/// Steps until the end; at most so many.
fn finish(mut machine: Machine, grants: u32) -> (Vec<String>, u64, String) {
    let mut system = Listener {
        grants,
        ..Listener::default()
    };
    let mut states = Vec::new();
    for _ in 0..20_000 {
        match machine.step(&mut system) {
            Step::Ran => states.push(bits(&machine)),
            end => return (states, system.ran, format!("{end:?} {}", bits(&machine))),
        }
        if system.ran > 3000 {
            break;
        }
    }
    let end = bits(&machine);
    (states, system.ran, end)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 160, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn both_forms_do_the_same(statements in statements()) {
        let program = Arc::new(program(&statements));
        let general = Machine::new(Arc::clone(&program), "T").without_plain();
        let plain = Machine::new(program, "T");
        let (states, count, end) = finish(general, 0);
        // Statement by statement: the same state after each.
        prop_assert_eq!(finish(plain.clone(), 0), (states.clone(), count, end.clone()));
        // In batches: fewer steps, the same number of statements, the same end.
        if count <= 3000 {
            let (batches, batched, batched_end) = finish(plain, 7);
            prop_assert!(batches.len() <= states.len());
            prop_assert_eq!((batched, batched_end), (count, end));
        }
    }
}
