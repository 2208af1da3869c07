//! A listing as a tree.

use depal_syntax::Span;

/// A value with its place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ExprKind {
    Number { value: f64, is_real: bool },
    Text(String),
    Switch(bool),
    Item(Item),
    Negate(Box<Expr>),
    Not(Box<Expr>),
    Binary(Operator, Box<Expr>, Box<Expr>),
    Function(Function, Vec<Expr>),
}

/// Something with a name and indexes in brackets.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Item {
    pub kind: ItemKind,
    /// Of a system variable: its path as spelled.
    pub path: String,
    pub indexes: Vec<Expr>,
    pub span: Span,
}

macro_rules! items {
    ($($name:ident $text:literal $indexes:literal)*) => {
        /// What can be read or assigned.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum ItemKind { $($name,)* System }

        impl ItemKind {
            /// The word of the listing and how many indexes it takes at least.
            pub(crate) const TABLE: &'static [(&'static str, Self, usize)] =
                &[$(($text, Self::$name, $indexes)),*];

            pub(crate) fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)* Self::System => "$" }
            }
        }
    };
}

items! {
    R "R" 1
    Pr "PR" 1
    Sr "SR" 1
    Ar "AR" 1
    P "P" 1
    Di "DI" 1
    Do "DO" 1
    Ri "RI" 1
    Ro "RO" 1
    Gi "GI" 1
    Go "GO" 1
    Ai "AI" 1
    Ao "AO" 1
    Ui "UI" 1
    Uo "UO" 1
    Si "SI" 1
    So "SO" 1
    Flag "F" 1
    Marker "M" 1
    Timer "TIMER" 1
    TimerOverflow "TIMER_OVERFLOW" 1
    Uframe "UFRAME" 1
    Utool "UTOOL" 1
    UframeNum "UFRAME_NUM" 0
    UtoolNum "UTOOL_NUM" 0
    Override "OVERRIDE" 0
    Lpos "LPOS" 0
    Jpos "JPOS" 0
}

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
}

impl Operator {
    pub(crate) const ALL: [(Self, &'static str, u8); 14] = [
        (Self::Or, "OR", 1),
        (Self::And, "AND", 2),
        (Self::Equal, "=", 3),
        (Self::NotEqual, "<>", 3),
        (Self::Less, "<", 3),
        (Self::LessOrEqual, "<=", 3),
        (Self::Greater, ">", 3),
        (Self::GreaterOrEqual, ">=", 3),
        (Self::Add, "+", 4),
        (Self::Subtract, "-", 4),
        (Self::Multiply, "*", 5),
        (Self::Divide, "/", 5),
        (Self::Div, "DIV", 5),
        (Self::Mod, "MOD", 5),
    ];

    fn row(self) -> (Self, &'static str, u8) {
        Self::ALL[Self::ALL.iter().position(|(o, ..)| *o == self).unwrap_or(0)]
    }

    pub(crate) fn text(self) -> &'static str {
        self.row().1
    }

    /// How tightly it binds; 1 is loosest.
    pub(crate) fn binding(self) -> u8 {
        self.row().2
    }
}

macro_rules! functions {
    ($($name:ident $text:literal $count:literal)*) => {
        /// Functions on numbers (arguments in brackets) and on strings (arguments after a blank).
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Function { $($name),* }

        impl Function {
            pub(crate) const TABLE: &'static [(&'static str, Self, usize)] =
                &[$(($text, Self::$name, $count)),*];

            pub(crate) fn row(self) -> (&'static str, Self, usize) {
                let at = Self::TABLE.iter().position(|(_, f, _)| *f == self);
                Self::TABLE[at.unwrap_or(0)]
            }

            pub(crate) fn is_on_strings(self) -> bool {
                matches!(self, Self::Strlen | Self::Findstr | Self::Substr)
            }
        }
    };
}

functions! {
    Strlen "STRLEN" 1
    Findstr "FINDSTR" 2
    Substr "SUBSTR" 3
    Sqrt "SQRT" 1
    Sin "SIN" 1
    Cos "COS" 1
    Tan "TAN" 1
    Asin "ASIN" 1
    Acos "ACOS" 1
    Atan "ATAN" 1
    Atan2 "ATAN2" 2
    Abs "ABS" 1
    Exp "EXP" 1
    Ln "LN" 1
    Round "ROUND" 1
    Trunc "TRUNC" 1
}

/// A name with its place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Name {
    pub text: String,
    pub span: Span,
}

/// Whom a CALL means.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Callee {
    Name(Name),
    /// The program whose name a string register holds.
    Register(Expr),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Call {
    pub callee: Callee,
    pub arguments: Vec<Expr>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Change {
    Value(Expr),
    /// A pulse of so many seconds.
    Pulse(Option<Expr>),
    TimerStart,
    TimerStop,
    TimerReset,
}

/// What can stand behind a condition.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Action {
    Jump(Expr),
    Call(Call),
    Assign(Item, Change),
    Pause,
    Abort,
    End,
    Unsupported(String),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MotionKind {
    Joint,
    Linear,
    Circular,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SpeedUnit {
    Percent,
    MmPerSec,
    CmPerMin,
    InchPerMin,
    DegPerSec,
    Seconds,
    Milliseconds,
    /// `max_speed`.
    Most,
}

impl SpeedUnit {
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Percent => "%",
            Self::MmPerSec => "mm/sec",
            Self::CmPerMin => "cm/min",
            Self::InchPerMin => "inch/min",
            Self::DegPerSec => "deg/sec",
            Self::Seconds => "sec",
            Self::Milliseconds => "msec",
            Self::Most => "max_speed",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Termination {
    Fine,
    Continuous(Expr),
}

/// An action tied to a place or time of a move.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Along {
    pub when: AlongWhen,
    pub amount: Expr,
    pub action: Action,
    pub span: Span,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AlongWhen {
    /// TB: seconds before the end.
    TimeBefore,
    /// TA: seconds after the end.
    TimeAfter,
    /// DB: millimetres before the end.
    DistanceBefore,
}

/// What a target is moved by.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) enum OffsetBy {
    #[default]
    Nothing,
    /// `Offset`: the register of the condition.
    Condition,
    /// `Offset,PR[]`.
    Register(Expr),
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct MotionOptions {
    pub acceleration: Option<Expr>,
    pub offset: OffsetBy,
    pub tool_offset: OffsetBy,
    pub incremental: bool,
    pub skip: Option<Expr>,
    /// `Skip,LBL[],PR[]=LPOS`: where to keep the place.
    pub skip_position: Option<(Item, Expr)>,
    pub wrist_joint: bool,
    pub remote_tcp: bool,
    pub along: Vec<Along>,
    /// A block of lines follows (`P-SPS`).
    pub block: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    pub kind: MotionKind,
    pub via: Option<Expr>,
    pub target: Expr,
    pub speed: Option<Expr>,
    pub unit: SpeedUnit,
    pub termination: Termination,
    pub options: MotionOptions,
    pub span: Span,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Statement {
    Empty,
    Comment(String),
    Label(Expr),
    Action(Action),
    Run(Call),
    If(Expr, Action),
    IfThen(Expr),
    Else,
    EndIf,
    For {
        counter: Item,
        from: Expr,
        to: Expr,
        down: bool,
    },
    EndFor,
    Select {
        subject: Expr,
        value: Expr,
        action: Action,
    },
    Case {
        value: Expr,
        action: Action,
    },
    CaseElse(Action),
    WaitSeconds(Expr),
    WaitUntil {
        condition: Expr,
        timeout: Option<Expr>,
    },
    Motion(Box<Motion>),
    SkipCondition(Expr),
    OffsetCondition {
        offset: Expr,
        frame: Option<Expr>,
    },
    ToolOffsetCondition {
        offset: Expr,
        tool: Option<Expr>,
    },
    Payload(Expr),
    UserAlarm(Expr),
    Message(String),
    /// Instructions without effect here, as spelled.
    Nothing(String),
}

/// A line of /MN.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    /// As numbered in the listing.
    pub number: u32,
    pub span: Span,
    pub statement: Statement,
}

/// A taught position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Taught {
    pub number: u32,
    pub span: Span,
    pub position: crate::position::Position,
}

/// One /PROG ... /END.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Listing {
    pub name: Name,
    pub comment: String,
    pub lines: Vec<Line>,
    pub positions: Vec<Taught>,
    /// Line of the file where it begins, from 1.
    pub file_line: u32,
}
