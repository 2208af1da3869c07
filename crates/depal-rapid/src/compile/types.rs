use depal_vm::{ClockState, RawBytes, Value};

/// Direction and width of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SignalKind {
    /// Digital input.
    Di,
    /// Digital output.
    Do,
    /// Group input: an unsigned number over several digital inputs.
    Gi,
    /// Group output.
    Go,
    /// Analogue input.
    Ai,
    /// Analogue output.
    Ao,
}

impl SignalKind {
    /// The name of its RAPID type.
    pub fn type_name(self) -> &'static str {
        match self {
            Self::Di => "signaldi",
            Self::Do => "signaldo",
            Self::Gi => "signalgi",
            Self::Go => "signalgo",
            Self::Ai => "signalai",
            Self::Ao => "signalao",
        }
    }
}

/// A RAPID type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Type {
    Num,
    Dnum,
    Bool,
    Text,
    Raw,
    Socket,
    Clock,
    /// `None`: a signal of unknown kind, when no signals were given.
    Signal(Option<SignalKind>),
    Switch,
    Record(usize),
    /// Sizes from the outermost dimension; 0 is any size.
    Array {
        element: Box<Type>,
        sizes: Vec<usize>,
    },
    /// Any type, for built-ins.
    Any,
    /// num or dnum, for built-ins.
    Numeric,
    /// Unknown because of an error that has been reported.
    Broken,
}

#[derive(Debug, Clone)]
pub(crate) struct RecordType {
    pub(crate) name: String,
    /// Name and type.
    pub(crate) fields: Vec<(String, Type)>,
}

/// Types that are another name of a number or a string.
pub(crate) fn simple_type(name: &str) -> Option<Type> {
    Some(match name {
        "num" | "errnum" | "intnum" | "btnres" | "tpnum" | "symnum" | "icondata" | "buttondata"
        | "socketstatus" | "byte" | "inttypes" | "opcalc" | "opnum" | "errdomain" | "errtype"
        | "identno" => Type::Num,
        "dnum" => Type::Dnum,
        "bool" => Type::Bool,
        "string" | "stringdig" | "errstr" => Type::Text,
        "rawbytes" => Type::Raw,
        "socketdev" => Type::Socket,
        "clock" => Type::Clock,
        "switch" => Type::Switch,
        "signaldi" => Type::Signal(Some(SignalKind::Di)),
        "signaldo" => Type::Signal(Some(SignalKind::Do)),
        "signalgi" => Type::Signal(Some(SignalKind::Gi)),
        "signalgo" => Type::Signal(Some(SignalKind::Go)),
        "signalai" => Type::Signal(Some(SignalKind::Ai)),
        "signalao" => Type::Signal(Some(SignalKind::Ao)),
        "anytype" => Type::Any,
        "numeric" => Type::Numeric,
        "anysignal" => Type::Signal(None),
        _ => return None,
    })
}

/// Types of the controller that are known and not simulated.
pub(crate) const REFUSED_TYPES: [&str; 8] = [
    "wztemporary",
    "wzstationary",
    "shapedata",
    "mecunit",
    "progdisp",
    "egmident",
    "paridnum",
    "dir",
];

impl Type {
    /// Whether a value of type `found` may go where this type is expected.
    pub(crate) fn accepts(&self, found: &Self) -> bool {
        match (self, found) {
            (Self::Broken | Self::Any, _) | (_, Self::Broken) => true,
            (Self::Numeric, Self::Num | Self::Dnum | Self::Numeric) => true,
            (Self::Signal(a), Self::Signal(b)) => a.is_none() || b.is_none() || a == b,
            (
                Self::Array { element, sizes },
                Self::Array {
                    element: other,
                    sizes: found,
                },
            ) => {
                element.accepts(other)
                    && sizes.len() == found.len()
                    && sizes
                        .iter()
                        .zip(found)
                        .all(|(a, b)| *a == 0 || *b == 0 || a == b)
            }
            (a, b) => a == b,
        }
    }

    pub(crate) fn is_number(&self) -> bool {
        matches!(
            self,
            Self::Num | Self::Dnum | Self::Numeric | Self::Broken | Self::Any
        )
    }

    pub(crate) fn name(&self, records: &[RecordType]) -> String {
        match self {
            Self::Num => "num".into(),
            Self::Dnum => "dnum".into(),
            Self::Bool => "bool".into(),
            Self::Text => "string".into(),
            Self::Raw => "rawbytes".into(),
            Self::Socket => "socketdev".into(),
            Self::Clock => "clock".into(),
            Self::Signal(Some(kind)) => kind.type_name().into(),
            Self::Signal(None) => "a signal".into(),
            Self::Switch => "switch".into(),
            Self::Record(index) => records[*index].name.clone(),
            Self::Array { element, sizes } => {
                let sizes: Vec<_> = sizes
                    .iter()
                    .map(|s| if *s == 0 { "*".into() } else { s.to_string() })
                    .collect();
                format!("{}{{{}}}", element.name(records), sizes.join(","))
            }
            Self::Any => "any type".into(),
            Self::Numeric => "num or dnum".into(),
            Self::Broken => "?".into(),
        }
    }

    /// The value of data without an initial one.
    pub(crate) fn default_value(&self, records: &[RecordType]) -> Value {
        match self {
            Self::Num | Self::Numeric => Value::Num(0.0),
            Self::Dnum => Value::Dnum(0.0),
            Self::Bool => Value::Bool(false),
            Self::Text => Value::Str(String::new()),
            Self::Raw => Value::Raw(Box::<RawBytes>::default()),
            Self::Socket => Value::Socket(None),
            Self::Clock => Value::Clock(ClockState::default()),
            Self::Record(index) => Value::Record(
                records[*index]
                    .fields
                    .iter()
                    .map(|(_, kind)| kind.default_value(records))
                    .collect(),
            ),
            Self::Array { element, sizes } => {
                let mut value = element.default_value(records);
                for size in sizes.iter().rev() {
                    value = Value::Array(vec![value; *size]);
                }
                value
            }
            Self::Signal(_) | Self::Switch | Self::Any | Self::Broken => Value::Absent,
        }
    }
}
