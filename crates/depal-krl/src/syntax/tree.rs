//! What a program says. Places do not take part in comparisons, so that trees can be compared.

pub(crate) use depal_syntax::Name;
use depal_syntax::Node;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileKind {
    /// Routines.
    Source,
    /// Data.
    Data,
    /// Routines of a task that runs beside the robot's program.
    Submit,
}

/// One file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct File {
    pub(crate) kind: FileKind,
    /// Name in DEFDAT.
    pub(crate) name: Option<Name>,
    pub(crate) public: bool,
    /// What stands in DEFDAT, or before the first DEF.
    pub(crate) data: Vec<Statement>,
    pub(crate) routines: Vec<Routine>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mode {
    In,
    Out,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) name: Name,
    /// Dimensions in its brackets; 0 without brackets.
    pub(crate) dimensions: usize,
    pub(crate) mode: Option<Mode>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Routine {
    pub(crate) global: bool,
    /// Type of the result, for a function; with brackets.
    pub(crate) result: Option<(Name, bool)>,
    pub(crate) name: Name,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) body: Vec<Statement>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DataItem {
    pub(crate) name: Name,
    pub(crate) sizes: Vec<Option<Expression>>,
    pub(crate) value: Option<Expression>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Declaration {
    Data {
        global: bool,
        constant: bool,
        type_name: Name,
        items: Vec<DataItem>,
    },
    Struc {
        global: bool,
        name: Name,
        fields: Vec<(Name, DataItem)>,
    },
    Enum {
        global: bool,
        name: Name,
        constants: Vec<Name>,
    },
    Signal {
        global: bool,
        name: Name,
        from: Expression,
        to: Option<Expression>,
    },
    /// EXT, EXTFCT: the routine stands in another file.
    External {
        result: Option<Name>,
        name: Name,
        parameters: Vec<(Name, bool, Option<Mode>)>,
    },
}

pub(crate) type Statement = Node<StatementKind>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InterruptAction {
    On,
    Off,
    Enable,
    Disable,
}

impl InterruptAction {
    pub(crate) const ALL: [(&'static str, Self); 4] = [
        ("ON", Self::On),
        ("OFF", Self::Off),
        ("ENABLE", Self::Enable),
        ("DISABLE", Self::Disable),
    ];

    pub(crate) fn text(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, action)| *action == self);
        found.map_or("", |(text, _)| text)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MoveWord {
    Ptp,
    Lin,
    Circ,
    PtpRel,
    LinRel,
    CircRel,
    Sptp,
    Slin,
    Scirc,
}

impl MoveWord {
    pub(crate) const ALL: [(&'static str, Self); 9] = [
        ("PTP", Self::Ptp),
        ("LIN", Self::Lin),
        ("CIRC", Self::Circ),
        ("PTP_REL", Self::PtpRel),
        ("LIN_REL", Self::LinRel),
        ("CIRC_REL", Self::CircRel),
        ("SPTP", Self::Sptp),
        ("SLIN", Self::Slin),
        ("SCIRC", Self::Scirc),
    ];

    pub(crate) fn text(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, word)| *word == self);
        found.map_or("", |(text, _)| text)
    }

    pub(crate) fn is_circular(self) -> bool {
        matches!(self, Self::Circ | Self::CircRel | Self::Scirc)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Move {
    pub(crate) word: MoveWord,
    /// One point, or the way point and the end of an arc.
    pub(crate) points: Vec<Expression>,
    /// CA: how far along the circle, degrees.
    pub(crate) angle: Option<Expression>,
    /// C_PTP, C_DIS, C_VEL, C_ORI, C_SPL.
    pub(crate) approximation: Vec<Name>,
    /// #BASE or #TOOL of a relative move.
    pub(crate) frame: Option<Name>,
    /// System variables of this move alone.
    pub(crate) with: Vec<(Expression, Expression)>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum TriggerPlace {
    Distance(Expression),
    Path {
        distance: Expression,
        on_start: bool,
    },
}

pub(crate) type Arguments = Vec<Option<Expression>>;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum StatementKind {
    Declare(Declaration),
    Assign {
        target: Expression,
        value: Expression,
    },
    Call {
        name: Name,
        arguments: Arguments,
    },
    If {
        condition: Expression,
        body: Vec<Statement>,
        otherwise: Option<Vec<Statement>>,
    },
    For {
        variable: Expression,
        from: Expression,
        to: Expression,
        step: Option<Expression>,
        body: Vec<Statement>,
    },
    While {
        condition: Expression,
        body: Vec<Statement>,
    },
    Repeat {
        body: Vec<Statement>,
        until: Expression,
    },
    Loop(Vec<Statement>),
    Exit,
    Switch {
        subject: Expression,
        cases: Vec<(Vec<Expression>, Vec<Statement>)>,
        default: Option<Vec<Statement>>,
    },
    Goto(Name),
    Label(Name),
    Return(Option<Expression>),
    Halt,
    Continue,
    WaitFor(Expression),
    WaitSec(Expression),
    InterruptDecl {
        global: bool,
        number: Expression,
        condition: Expression,
        routine: Name,
        arguments: Arguments,
    },
    Interrupt {
        action: InterruptAction,
        number: Option<Expression>,
    },
    Brake {
        hard: bool,
    },
    Resume,
    Trigger {
        place: TriggerPlace,
        delay: Expression,
        action: Box<Statement>,
        priority: Option<Expression>,
    },
    Move(Box<Move>),
    /// Known and not simulated.
    Refused(Name),
    /// Could not be read; already reported.
    Broken,
}

pub(crate) type Expression = Node<ExpressionKind>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    /// The product of frames.
    Frame,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    And,
    Or,
    Exor,
    BitAnd,
    BitOr,
    BitExor,
}

impl Operator {
    pub(crate) const ALL: [(&'static str, Self); 17] = [
        ("+", Self::Add),
        ("-", Self::Subtract),
        ("*", Self::Multiply),
        ("/", Self::Divide),
        (":", Self::Frame),
        ("==", Self::Equal),
        ("<>", Self::NotEqual),
        ("<", Self::Less),
        ("<=", Self::LessOrEqual),
        (">", Self::Greater),
        (">=", Self::GreaterOrEqual),
        ("AND", Self::And),
        ("OR", Self::Or),
        ("EXOR", Self::Exor),
        ("B_AND", Self::BitAnd),
        ("B_OR", Self::BitOr),
        ("B_EXOR", Self::BitExor),
    ];

    /// As programs write it.
    pub(crate) fn text(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, operator)| *operator == self);
        found.map_or("", |(text, _)| text)
    }

    /// Binds tighter the greater it is. A comparison binds tighter than AND, OR and EXOR here.
    pub(crate) fn strength(self) -> u8 {
        match self {
            Self::Or => 1,
            Self::Exor => 2,
            Self::And => 3,
            Self::Equal
            | Self::NotEqual
            | Self::Less
            | Self::LessOrEqual
            | Self::Greater
            | Self::GreaterOrEqual => 4,
            Self::BitOr => 5,
            Self::BitExor => 6,
            Self::BitAnd => 7,
            Self::Add | Self::Subtract => 8,
            Self::Multiply | Self::Divide => 9,
            Self::Frame => 10,
        }
    }

    pub(crate) fn is_comparison(self) -> bool {
        self.strength() == 4
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AggregateField {
    pub(crate) name: Name,
    /// Written with empty brackets: `NAME[] "x"`.
    pub(crate) whole: bool,
    pub(crate) value: Expression,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ExpressionKind {
    Integer(i64),
    Real(f64),
    Text(String),
    Bool(bool),
    /// `#NAME`.
    Constant(Name),
    Name(String),
    Field(Box<Expression>, Name),
    /// `a[1]`, `a[]`, `a[1,]`.
    Index(Box<Expression>, Vec<Option<Expression>>),
    Call {
        name: Name,
        arguments: Arguments,
    },
    Aggregate {
        type_name: Option<Name>,
        fields: Vec<AggregateField>,
    },
    /// In parentheses.
    Group(Box<Expression>),
    Negate(Box<Expression>),
    Not(Box<Expression>),
    BitNot(Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// Could not be read; already reported.
    Broken,
}
