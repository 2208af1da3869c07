pub(crate) use depal_syntax::Name;
use depal_syntax::{Node, Span};

/// A module, its declarations by kind, each kind in the order of the source.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Module {
    pub(crate) name: Name,
    pub(crate) attributes: Vec<Name>,
    pub(crate) records: Vec<Record>,
    pub(crate) aliases: Vec<Alias>,
    pub(crate) data: Vec<Data>,
    pub(crate) routines: Vec<Routine>,
}

/// Another name of a type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Alias {
    pub(crate) local: bool,
    pub(crate) known: Name,
    pub(crate) name: Name,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Record {
    pub(crate) local: bool,
    pub(crate) name: Name,
    /// Type and name.
    pub(crate) fields: Vec<(Name, Name)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Storage {
    Var,
    Pers,
    Const,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Data {
    pub(crate) local: bool,
    /// TASK: an instance of its own in each task.
    pub(crate) of_task: bool,
    pub(crate) storage: Storage,
    pub(crate) type_name: Name,
    pub(crate) name: Name,
    pub(crate) sizes: Vec<Expression>,
    pub(crate) value: Option<Expression>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mode {
    Value,
    Var,
    Inout,
    Pers,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) mode: Mode,
    pub(crate) optional: bool,
    /// Parameters with the same group exclude each other.
    pub(crate) group: usize,
    pub(crate) type_name: Name,
    pub(crate) name: Name,
    /// Number of `*` in braces.
    pub(crate) dimensions: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RoutineKind {
    Procedure,
    /// With the type of the result.
    Function(Name),
    Trap,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Routine {
    pub(crate) local: bool,
    pub(crate) kind: RoutineKind,
    pub(crate) name: Name,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) data: Vec<Data>,
    pub(crate) body: Vec<Statement>,
    pub(crate) handler: Option<Handler>,
    pub(crate) undo: Option<Vec<Statement>>,
    /// Read and checked; the simulated robot never runs a path backwards.
    pub(crate) backward: Option<Vec<Statement>>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Handler {
    pub(crate) numbers: Option<Vec<Expression>>,
    pub(crate) body: Vec<Statement>,
}

pub(crate) type Statement = Node<StatementKind>;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum StatementKind {
    Assign {
        target: Expression,
        value: Expression,
    },
    Call {
        name: Name,
        arguments: Vec<Argument>,
    },
    If {
        arms: Vec<(Expression, Vec<Statement>)>,
        otherwise: Option<Vec<Statement>>,
    },
    For {
        variable: Name,
        from: Expression,
        to: Expression,
        step: Option<Expression>,
        body: Vec<Statement>,
    },
    While {
        condition: Expression,
        body: Vec<Statement>,
    },
    Test {
        subject: Expression,
        cases: Vec<(Vec<Expression>, Vec<Statement>)>,
        default: Option<Vec<Statement>>,
    },
    Goto(Name),
    Label(Name),
    Return(Option<Expression>),
    Raise(Option<Expression>),
    Retry,
    TryNext,
    Exit,
    /// `CONNECT variable WITH trap;`
    Connect {
        variable: Expression,
        trap: Name,
    },
    /// `%"name"% arguments;`
    CallByName {
        name: Expression,
        arguments: Vec<Argument>,
    },
    /// Could not be read, or is not supported; already reported.
    Broken,
}

pub(crate) type Expression = Node<ExpressionKind>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Div,
    Mod,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    And,
    Or,
    Xor,
}

impl Operator {
    /// As programs write it.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Div => "DIV",
            Self::Mod => "MOD",
            Self::Equal => "=",
            Self::NotEqual => "<>",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
            Self::And => "AND",
            Self::Or => "OR",
            Self::Xor => "XOR",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ExpressionKind {
    Number {
        value: f64,
        integer: bool,
    },
    Text(String),
    Bool(bool),
    Name(String),
    Field(Box<Expression>, Name),
    Index(Box<Expression>, Vec<Expression>),
    Call {
        name: Name,
        arguments: Vec<Argument>,
    },
    Aggregate(Vec<Expression>),
    Negate(Box<Expression>),
    Not(Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// Could not be read; already reported.
    Broken,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Argument {
    Positional(Expression),
    /// `\x`, `\x:=value`, or `x:=value`.
    Named {
        name: Name,
        value: Option<Expression>,
    },
    /// `\x?y`: given if `y` was given.
    Conditional {
        name: Name,
        from: Name,
    },
}

impl Argument {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Positional(value) => value.span,
            Self::Named { name, value } => {
                value.as_ref().map_or(name.span, |v| name.span.to(v.span))
            }
            Self::Conditional { name, from } => name.span.to(from.span),
        }
    }
}
