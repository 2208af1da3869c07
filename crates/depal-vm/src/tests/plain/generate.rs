//! Random programs of plain statements, and of some that are not.

use proptest::prelude::*;

use crate::BinaryOp;

/// A number. Globals 0 to 2 and locals 0 to 2 hold numbers; local 2 holds a reference to global 2.
#[derive(Debug, Clone)]
pub(super) enum Number {
    Constant(i8),
    Global(u32),
    Local(u32),
    /// An element of the array in global 3, with any index.
    Element(Box<Number>),
    Negate(Box<Number>),
    Binary(BinaryOp, Box<Number>, Box<Number>),
    /// What a function gives for a number, which counts in global 0.
    Call(Box<Number>),
    /// What a function that calls itself gives.
    Recursion(Box<Number>),
    /// The number of characters is of no form that the plain one knows: text equal to text, as 0 or 1.
    FromText,
}

/// A truth value. Global 4 and local 3 hold truth values.
#[derive(Debug, Clone)]
pub(super) enum Truth {
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
pub(super) enum Statement {
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
    /// A procedure with a number and a truth value, which it may write to global 4.
    Procedure(Number, Truth),
}

pub(super) fn number() -> impl Strategy<Value = Number> {
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
            inner.clone().prop_map(|n| Number::Call(Box::new(n))),
            inner.clone().prop_map(|n| Number::Recursion(Box::new(n))),
            (op, inner.clone(), inner).prop_map(|(op, a, b)| Number::Binary(
                op,
                Box::new(a),
                Box::new(b)
            )),
        ]
    })
}

pub(super) fn truth() -> impl Strategy<Value = Truth> {
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

pub(super) fn statements() -> impl Strategy<Value = Vec<Statement>> {
    let leaf = prop_oneof![
        (0..3u32, number()).prop_map(|(slot, n)| Statement::SetGlobal(slot, n)),
        (0..3u32, number()).prop_map(|(slot, n)| Statement::SetLocal(slot, n)),
        (number(), number()).prop_map(|(i, n)| Statement::SetElement(i, n)),
        (any::<bool>(), truth()).prop_map(|(global, t)| Statement::SetTruth(global, t)),
        any::<bool>().prop_map(Statement::Copy),
        Just(Statement::Text),
        number().prop_map(Statement::Call),
        (number(), truth()).prop_map(|(n, t)| Statement::Procedure(n, t)),
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
