/// How two numbers compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// Below.
    Less,
    /// Not above.
    LessOrEqual,
    /// The same.
    Equal,
    /// Not the same.
    NotEqual,
    /// Not below.
    GreaterOrEqual,
    /// Above.
    Greater,
}

impl Relation {
    /// Whether `left` and `right` compare so.
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::LessOrEqual => left <= right,
            Self::Equal => left == right,
            Self::NotEqual => left != right,
            Self::GreaterOrEqual => left >= right,
            Self::Greater => left > right,
        }
    }
}

/// What is looked at when the arm passes a place of its way.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalCheck {
    /// The signal.
    pub signal: String,
    /// How its value must compare with `value`.
    pub relation: Relation,
    /// What it is compared with.
    pub value: f64,
    /// The notice that is given when it does not.
    pub notice: String,
    /// Whether the arm then stops on its path, which is kept.
    pub stops: bool,
}
