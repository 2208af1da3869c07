//! Both forms of the code do the same: on random programs, statement by statement and in batches.

mod generate;
mod lower;

use std::sync::Arc;

use proptest::prelude::*;

use crate::execution::{RobotTask, Step};
use crate::testing::EmptyCabinet;
use crate::{BinaryOp, ErrorHandler, Machine, Op, Program, Reference, Root, Routine, Value};

use generate::{Statement, statements};
use lower::Lowering;

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
    let mut system = EmptyCabinet::new(grants + 1);
    let mut states = Vec::new();
    for _ in 0..20_000 {
        match machine.step(&mut system) {
            Step::Ran => states.push(bits(&machine)),
            end => {
                return (
                    states,
                    system.statements(),
                    format!("{end:?} {}", bits(&machine)),
                );
            }
        }
        if system.statements() > 3000 {
            break;
        }
    }
    let end = bits(&machine);
    (states, system.statements(), end)
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
