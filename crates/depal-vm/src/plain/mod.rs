//! A second form of the code for the statements most loops consist of: 32-bit numbers and truth values in
//! variables, elements of arrays, jumps and counting loops.
//!
//! [`translate`] makes it once for each routine from its operations: three operands an instruction, no operand
//! stack, no [`Value`](crate::Value) is made or dropped. Whatever is not of that kind becomes a `Leave`: there
//! the loop over [`Op`](crate::Op)s goes on. An instruction that does not find a number where it needs one
//! (a parameter given by reference, one that is absent, an index out of range, a division by zero) leaves, too,
//! before it has changed anything, to the operation where its expression begins. So this form is never the one
//! that raises an error, and both forms do the same.
//!
//! Calls and returns of routines stay in this form: what an expression has computed before a call goes onto the
//! operand stack of its frame, as in the other form, so that each frame can go on in either.

mod run;
mod translate;

pub(crate) use run::Runner;
pub(crate) use translate::translate;

/// Temporaries of an expression; two for each level of the operand stack.
const TEMPORARIES: usize = 16;

/// Where an operand lies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Operand {
    Local(u32),
    Global(u32),
    /// A truth value is 1 or 0 here.
    Temporary(u32),
    Constant(f32),
    /// On the operand stack of the frame, where a call left it.
    Stacked(u32),
}

/// What is known of a value without running.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Truth,
    /// A variable or a result: whoever uses it finds out.
    Variable,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Arithmetic {
    Subtract,
    Multiply,
    Divide,
    IntegerDivide,
    Remainder,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Logic {
    And,
    Or,
    Xor,
}

/// One instruction. Targets are indexes into the same list.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Instruction {
    /// A statement begins; its index in the list of statements.
    Statement(u32),
    /// Adds, the most frequent of all, a number.
    Add {
        to: Operand,
        left: Operand,
        right: Operand,
    },
    Arithmetic {
        op: Arithmetic,
        to: Operand,
        left: Operand,
        right: Operand,
    },
    Negate {
        to: Operand,
        value: Operand,
    },
    Compare {
        test: Comparison,
        to: Operand,
        left: Operand,
        right: Operand,
    },
    Logic {
        op: Logic,
        to: Operand,
        left: Operand,
        right: Operand,
    },
    Not {
        to: Operand,
        value: Operand,
    },
    /// Copies a number.
    Set {
        to: Operand,
        value: Operand,
    },
    /// Copies a truth value.
    SetTruth {
        to: Operand,
        value: Operand,
    },
    /// Copies a variable of either kind to one of the same kind.
    Copy {
        to: Operand,
        value: Operand,
    },
    LoadElement {
        to: Operand,
        array: Operand,
        index: Operand,
    },
    StoreElement {
        array: Operand,
        index: Operand,
        value: Operand,
    },
    Jump(u32),
    JumpIfFalse {
        value: Operand,
        target: u32,
    },
    JumpIfTrue {
        value: Operand,
        target: u32,
    },
    /// A comparison and a jump in one.
    JumpUnless {
        test: Comparison,
        left: Operand,
        right: Operand,
        target: u32,
    },
    ForTest {
        slot: u32,
        exit: u32,
    },
    ForStep {
        slot: u32,
    },
    /// The end of a counting loop: step, the loop's statement, its test, in one.
    ForNext {
        slot: u32,
        statement: u32,
        body: u32,
        exit: u32,
    },
    /// Calls a routine; its index in the list of calls.
    Call(u32),
    /// Ends a procedure.
    Return,
    /// Ends a function.
    ReturnValue {
        value: Operand,
        kind: Kind,
    },
    /// Goes on in the list of operations, there.
    Leave(u32),
}

/// A call, in the middle of an expression or not.
#[derive(Debug, Clone, PartialEq)]
struct CallSite {
    routine: u32,
    /// So many values lie on the operand stack already and stay there.
    kept: usize,
    /// These come on top of them, to be found again behind the call.
    spilled: Vec<(Operand, Kind)>,
    arguments: Vec<(Operand, Kind)>,
    /// Where the caller goes on.
    next: u32,
}

/// What a frame notes when a statement begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct StatementMark {
    pc: u32,
    line: u32,
    next: u32,
}

/// No instruction begins here.
const NONE: u32 = u32::MAX;

/// The second form of a routine.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct PlainCode {
    instructions: Vec<Instruction>,
    /// For each instruction the operation at which its expression begins, and how many values lie on the operand
    /// stack there: those that calls in it have left.
    resume: Vec<(u32, u32)>,
    /// For each operation its instruction, or [`NONE`].
    at: Vec<u32>,
    statements: Vec<StatementMark>,
    calls: Vec<CallSite>,
}

impl PlainCode {
    /// Whether the statement at this operation can begin here.
    pub(crate) fn has(&self, pc: u32) -> bool {
        self.at.get(pc as usize).is_some_and(|at| *at != NONE)
    }
}
