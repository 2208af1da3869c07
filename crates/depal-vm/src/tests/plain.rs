//! Both forms of the code do the same: on random programs, statement by statement and in batches.

use std::sync::Arc;
use std::task::Poll;

use depal_frames::{JointPositions, Pose};
use depal_time::SimTime;
use proptest::prelude::*;

use crate::execution::{RobotTask, Step};
use crate::system::*;
use crate::{
    BinaryOp, ErrorHandler, Machine, Op, Program, Reference, Root, Routine, UnaryOp, Value,
};

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

/// A number. Globals 0 to 2 and locals 0 to 2 hold numbers; local 2 holds a reference to global 2.
#[derive(Debug, Clone)]
enum Number {
    Constant(i8),
    Global(u32),
    Local(u32),
    /// An element of the array in global 3, with any index.
    Element(Box<Number>),
    Negate(Box<Number>),
    Binary(BinaryOp, Box<Number>, Box<Number>),
    /// The number of characters is of no form that the plain one knows: text equal to text, as 0 or 1.
    FromText,
}

/// A truth value. Global 4 and local 3 hold truth values.
#[derive(Debug, Clone)]
enum Truth {
    Constant(bool),
    Global,
    Local,
    Compare(BinaryOp, Number, Number),
    Not(Box<Truth>),
    /// With the short cut.
    And(Box<Truth>, Box<Truth>),
    Or(Box<Truth>, Box<Truth>),
    Xor(Box<Truth>, Box<Truth>),
    SameText,
}

#[derive(Debug, Clone)]
enum Statement {
    SetGlobal(u32, Number),
    SetLocal(u32, Number),
    SetElement(Number, Number),
    SetTruth(bool, Truth),
    /// Copies variable to variable of any kind, as far as kinds are equal.
    Copy(bool),
    If(Truth, Vec<Statement>, Vec<Statement>),
    For(Number, i8, Vec<Statement>),
    Text,
    Call(Number),
}

fn number() -> impl Strategy<Value = Number> {
    let leaf = prop_oneof![
        any::<i8>().prop_map(Number::Constant),
        (0..3u32).prop_map(Number::Global),
        (0..3u32).prop_map(Number::Local),
        Just(Number::FromText),
    ];
    leaf.prop_recursive(4, 12, 2, |inner| {
        let op = prop::sample::select(vec![
            BinaryOp::Add,
            BinaryOp::Subtract,
            BinaryOp::Multiply,
            BinaryOp::Divide,
            BinaryOp::IntegerDivide,
            BinaryOp::Remainder,
        ]);
        prop_oneof![
            inner.clone().prop_map(|n| Number::Element(Box::new(n))),
            (1..6i8).prop_map(|i| Number::Element(Box::new(Number::Constant(i)))),
            inner.clone().prop_map(|n| Number::Negate(Box::new(n))),
            (op, inner.clone(), inner).prop_map(|(op, a, b)| Number::Binary(
                op,
                Box::new(a),
                Box::new(b)
            )),
        ]
    })
}

fn truth() -> impl Strategy<Value = Truth> {
    let test = prop::sample::select(vec![
        BinaryOp::Equal,
        BinaryOp::NotEqual,
        BinaryOp::Less,
        BinaryOp::LessOrEqual,
        BinaryOp::Greater,
        BinaryOp::GreaterOrEqual,
    ]);
    let leaf = prop_oneof![
        any::<bool>().prop_map(Truth::Constant),
        Just(Truth::Global),
        Just(Truth::Local),
        Just(Truth::SameText),
        (test, number(), number()).prop_map(|(op, a, b)| Truth::Compare(op, a, b)),
    ];
    leaf.prop_recursive(3, 8, 2, |inner| {
        let pair = || (inner.clone(), inner.clone());
        prop_oneof![
            inner.clone().prop_map(|t| Truth::Not(Box::new(t))),
            pair().prop_map(|(a, b)| Truth::And(Box::new(a), Box::new(b))),
            pair().prop_map(|(a, b)| Truth::Or(Box::new(a), Box::new(b))),
            pair().prop_map(|(a, b)| Truth::Xor(Box::new(a), Box::new(b))),
        ]
    })
}

fn statements() -> impl Strategy<Value = Vec<Statement>> {
    let leaf = prop_oneof![
        (0..3u32, number()).prop_map(|(slot, n)| Statement::SetGlobal(slot, n)),
        (0..3u32, number()).prop_map(|(slot, n)| Statement::SetLocal(slot, n)),
        (number(), number()).prop_map(|(i, n)| Statement::SetElement(i, n)),
        (any::<bool>(), truth()).prop_map(|(global, t)| Statement::SetTruth(global, t)),
        any::<bool>().prop_map(Statement::Copy),
        Just(Statement::Text),
        number().prop_map(Statement::Call),
    ];
    let statement = leaf.prop_recursive(3, 24, 4, |inner| {
        let block = || prop::collection::vec(inner.clone(), 0..4);
        prop_oneof![
            (truth(), block(), block()).prop_map(|(t, a, b)| Statement::If(t, a, b)),
            (number(), -3..4i8, block()).prop_map(|(n, step, b)| Statement::For(n, step, b)),
        ]
    });
    prop::collection::vec(statement, 1..8)
}

/// Lowers as a language does.
#[derive(Default)]
struct Lowering {
    code: Vec<Op>,
    locals: Vec<Value>,
}

impl Lowering {
    fn emit(&mut self, op: Op) -> usize {
        self.code.push(op);
        self.code.len() - 1
    }

    fn patch(&mut self, at: usize) {
        let here = self.code.len() as u32;
        match &mut self.code[at] {
            Op::Jump(target)
            | Op::JumpIfFalse(target)
            | Op::JumpIfFalseKeep(target)
            | Op::JumpIfTrueKeep(target)
            | Op::Statement { next: target, .. }
            | Op::ForTest { exit: target, .. } => *target = here,
            _ => unreachable!(),
        }
    }

    fn same_text(&mut self) {
        self.emit(Op::Push(Value::Str("a".into())));
        self.emit(Op::Push(Value::Str("a".into())));
        self.emit(Op::Binary(BinaryOp::Equal));
    }

    fn number(&mut self, number: &Number) {
        match number {
            Number::Constant(value) => {
                self.emit(Op::Push(Value::Num(f32::from(*value) / 4.0)));
            }
            Number::Global(slot) => {
                self.emit(Op::LoadGlobal(*slot));
            }
            Number::Local(slot) => {
                self.emit(Op::LoadLocal(*slot));
            }
            Number::Element(index) => {
                self.emit(Op::PlaceGlobal(3));
                self.number(index);
                self.emit(Op::PlaceIndex(1));
                self.emit(Op::LoadPlace);
            }
            Number::Negate(inner) => {
                self.number(inner);
                self.emit(Op::Unary(UnaryOp::Negate));
            }
            Number::Binary(op, left, right) => {
                self.number(left);
                self.number(right);
                self.emit(Op::Binary(*op));
            }
            Number::FromText => {
                self.same_text();
                let no = self.emit(Op::JumpIfFalse(0));
                self.emit(Op::Push(Value::Num(1.0)));
                let over = self.emit(Op::Jump(0));
                self.patch(no);
                self.emit(Op::Push(Value::Num(0.0)));
                self.patch(over);
            }
        }
    }

    fn short_cut(&mut self, left: &Truth, right: &Truth, jump: Op, op: BinaryOp) {
        self.truth(left);
        let skip = self.emit(jump);
        self.truth(right);
        self.emit(Op::Binary(op));
        self.patch(skip);
    }

    fn truth(&mut self, truth: &Truth) {
        match truth {
            Truth::Constant(value) => {
                self.emit(Op::Push(Value::Bool(*value)));
            }
            Truth::Global => {
                self.emit(Op::LoadGlobal(4));
            }
            Truth::Local => {
                self.emit(Op::LoadLocal(3));
            }
            Truth::Compare(op, left, right) => {
                self.number(left);
                self.number(right);
                self.emit(Op::Binary(*op));
            }
            Truth::Not(inner) => {
                self.truth(inner);
                self.emit(Op::Unary(UnaryOp::Not));
            }
            Truth::And(a, b) => self.short_cut(a, b, Op::JumpIfFalseKeep(0), BinaryOp::And),
            Truth::Or(a, b) => self.short_cut(a, b, Op::JumpIfTrueKeep(0), BinaryOp::Or),
            Truth::Xor(a, b) => {
                self.truth(a);
                self.truth(b);
                self.emit(Op::Binary(BinaryOp::Xor));
            }
            Truth::SameText => self.same_text(),
        }
    }

    fn begin(&mut self) -> usize {
        let line = self.code.len() as u32 + 1;
        self.emit(Op::Statement { line, next: 0 })
    }

    fn block(&mut self, statements: &[Statement]) {
        for statement in statements {
            let begin = self.begin();
            self.statement(statement);
            self.patch(begin);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::SetGlobal(slot, value) => {
                self.number(value);
                self.emit(Op::StoreGlobal(*slot));
            }
            Statement::SetLocal(slot, value) => {
                self.number(value);
                self.emit(Op::StoreLocal(*slot));
            }
            Statement::SetElement(index, value) => {
                self.emit(Op::PlaceGlobal(3));
                self.number(index);
                self.emit(Op::PlaceIndex(1));
                self.number(value);
                self.emit(Op::StorePlace);
            }
            Statement::SetTruth(global, value) => {
                self.truth(value);
                self.emit(if *global {
                    Op::StoreGlobal(4)
                } else {
                    Op::StoreLocal(3)
                });
            }
            Statement::Copy(numbers) => {
                let (from, to) = if *numbers { (1, 0) } else { (4, 3) };
                self.emit(Op::LoadGlobal(from));
                self.emit(Op::StoreLocal(to));
            }
            Statement::If(condition, yes, no) => {
                self.truth(condition);
                let skip = self.emit(Op::JumpIfFalse(0));
                self.block(yes);
                let over = self.emit(Op::Jump(0));
                self.patch(skip);
                self.block(no);
                self.patch(over);
            }
            Statement::For(start, step, body) => self.counting(start, *step, body),
            Statement::Text => {
                self.emit(Op::Push(Value::Str("text".into())));
                self.emit(Op::Pop);
            }
            Statement::Call(value) => {
                self.number(value);
                self.emit(Op::Call {
                    routine: 1,
                    arguments: 1,
                });
                self.emit(Op::StoreGlobal(0));
            }
        }
    }

    fn counting(&mut self, start: &Number, step: i8, body: &[Statement]) {
        let slot = self.locals.len() as u32;
        self.locals.extend(vec![Value::Num(0.0); 3]);
        // Five times round at most, from a start that an expression gives.
        self.number(start);
        self.number(start);
        self.emit(Op::Push(Value::Num(f32::from(step) * 4.0)));
        self.emit(Op::Binary(BinaryOp::Add));
        if step != 0 {
            self.emit(Op::Push(Value::Num(f32::from(step))));
        }
        self.emit(Op::ForBegin {
            slot,
            stepped: step != 0,
        });
        let first = self.emit(Op::Jump(0));
        let top = self.begin();
        self.patch(first);
        let test = self.emit(Op::ForTest { slot, exit: 0 });
        self.block(body);
        self.emit(Op::ForStep { slot });
        self.emit(Op::Jump(top as u32));
        self.patch(test);
        self.patch(top);
    }
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
    let half = Routine {
        name: "half".into(),
        locals: vec![Value::Absent],
        code: vec![
            Op::Statement { line: 1, next: 5 },
            Op::LoadLocal(0),
            Op::Push(Value::Num(0.5)),
            Op::Binary(BinaryOp::Multiply),
            Op::Return { value: true },
        ],
        ..Routine::default()
    };
    Program {
        routines: vec![main, half],
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
