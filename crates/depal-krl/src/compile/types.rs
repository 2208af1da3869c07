use depal_vm::Value;

/// A KRL type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Type {
    Int,
    Real,
    Bool,
    Char,
    Enum(usize),
    Struc(usize),
    /// Sizes from the outermost dimension; 0 is any size.
    Array {
        element: Box<Type>,
        sizes: Vec<usize>,
    },
    /// Any type, for built-ins: the type's name goes with the value.
    Any,
    /// An output, for built-ins: its number is handed over.
    Output,
    /// Unknown because of an error that has been reported.
    Broken,
}

#[derive(Debug, Clone)]
pub(crate) struct StrucType {
    pub(crate) name: String,
    /// Name and type.
    pub(crate) fields: Vec<(String, Type)>,
    /// All components are known.
    pub(crate) complete: bool,
    /// Simple values in it.
    pub(crate) size: usize,
    /// Structures inside each other.
    pub(crate) depth: usize,
}

#[derive(Debug, Clone)]
pub(crate) struct EnumType {
    pub(crate) name: String,
    pub(crate) constants: Vec<String>,
}

/// All structures and enumerations.
#[derive(Debug, Clone, Default)]
pub(crate) struct Types {
    pub(crate) strucs: Vec<StrucType>,
    pub(crate) enums: Vec<EnumType>,
}

/// Which structures convert into each other, component by component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    Pose,
    Axes,
}

/// The simple types.
pub(crate) fn simple_type(key: &str) -> Option<Type> {
    Some(match key {
        "int" => Type::Int,
        "real" => Type::Real,
        "bool" => Type::Bool,
        "char" => Type::Char,
        _ => return None,
    })
}

impl Types {
    pub(crate) fn family(&self, kind: &Type) -> Option<Family> {
        let Type::Struc(index) = kind else {
            return None;
        };
        match self.strucs[*index].name.to_lowercase().as_str() {
            "frame" | "pos" | "e6pos" => Some(Family::Pose),
            "axis" | "e6axis" => Some(Family::Axes),
            _ => None,
        }
    }

    pub(crate) fn struc(&self, name: &str) -> Type {
        let mut all = self.strucs.iter();
        let found = all.position(|s| s.name.eq_ignore_ascii_case(name));
        found.map_or(Type::Broken, Type::Struc)
    }

    /// Whether a value of type `found` may be assigned to `expected`, with a conversion where numbers differ.
    pub(crate) fn accepts(&self, expected: &Type, found: &Type) -> bool {
        match (expected, found) {
            (Type::Broken | Type::Any, _) | (_, Type::Broken) => true,
            (Type::Int | Type::Real, Type::Int | Type::Real) => true,
            (Type::Char, Type::Int | Type::Char) | (Type::Int, Type::Char) => true,
            (Type::Array { .. }, Type::Array { .. }) => same(expected, found),
            (a, b) if a == b => true,
            (a, b) => self.family(a).is_some() && self.family(a) == self.family(b),
        }
    }

    pub(crate) fn name(&self, kind: &Type) -> String {
        match kind {
            Type::Int => "INT".into(),
            Type::Real => "REAL".into(),
            Type::Bool => "BOOL".into(),
            Type::Char => "CHAR".into(),
            Type::Enum(index) => self.enums[*index].name.clone(),
            Type::Struc(index) => self.strucs[*index].name.clone(),
            Type::Array { element, sizes } => {
                let sizes: Vec<_> = sizes
                    .iter()
                    .map(|s| {
                        if *s == 0 {
                            String::new()
                        } else {
                            s.to_string()
                        }
                    })
                    .collect();
                format!("{}[{}]", self.name(element), sizes.join(","))
            }
            Type::Any => "any type".into(),
            Type::Output => "an output".into(),
            Type::Broken => "?".into(),
        }
    }

    /// How many simple values a variable of this type holds.
    pub(crate) fn size(&self, kind: &Type) -> usize {
        match kind {
            Type::Struc(index) => self.strucs[*index].size,
            Type::Array { element, sizes } => sizes
                .iter()
                .fold(self.size(element), |size, n| size.saturating_mul(*n)),
            _ => 1,
        }
    }

    /// How many structures and arrays stand inside each other.
    pub(crate) fn depth(&self, kind: &Type) -> usize {
        match kind {
            Type::Struc(index) => self.strucs[*index].depth,
            Type::Array { element, .. } => self.depth(element) + 1,
            _ => 0,
        }
    }

    /// Zeros and FALSE: the tables of the system before anybody sets them.
    pub(crate) fn zero(&self, kind: &Type) -> Value {
        match kind {
            Type::Real => Value::Num(0.0),
            Type::Bool => Value::Bool(false),
            Type::Int => Value::Int(0),
            Type::Struc(index) => {
                let fields = self.strucs[*index].fields.iter();
                Value::Record(fields.map(|(_, kind)| self.zero(kind)).collect())
            }
            Type::Array { element, sizes } => {
                let mut value = self.zero(element);
                for size in sizes.iter().rev() {
                    value = Value::Array(vec![value; *size]);
                }
                value
            }
            _ => Value::Unset,
        }
    }

    /// A variable that was given no value.
    pub(crate) fn unset(&self, kind: &Type) -> Value {
        match kind {
            Type::Struc(index) => Value::Record(
                self.strucs[*index]
                    .fields
                    .iter()
                    .map(|(_, kind)| self.unset(kind))
                    .collect(),
            ),
            Type::Array { element, sizes } => {
                let mut value = self.unset(element);
                for size in sizes.iter().rev() {
                    value = Value::Array(vec![value; *size]);
                }
                value
            }
            _ => Value::Unset,
        }
    }
}

impl Type {
    pub(crate) fn is_number(&self) -> bool {
        matches!(self, Self::Int | Self::Real | Self::Char | Self::Broken)
    }

    /// A string: an array of characters in one dimension.
    pub(crate) fn is_text(&self) -> bool {
        matches!(self, Self::Array { element, sizes } if **element == Self::Char && sizes.len() == 1)
    }

    pub(crate) fn text(size: usize) -> Self {
        Self::Array {
            element: Box::new(Self::Char),
            sizes: vec![size],
        }
    }
}

/// Whether a variable of type `found` may be lent as one of type `expected`.
pub(crate) fn same(expected: &Type, found: &Type) -> bool {
    match (expected, found) {
        (Type::Broken | Type::Any, _) | (_, Type::Broken) => true,
        (
            Type::Array { element, sizes },
            Type::Array {
                element: other,
                sizes: found,
            },
        ) => {
            let text = **element == Type::Char;
            same(element, other)
                && sizes.len() == found.len()
                && sizes
                    .iter()
                    .zip(found)
                    .all(|(a, b)| text || *a == 0 || *b == 0 || a == b)
        }
        (a, b) => a == b,
    }
}

/// The codes of a string's characters; ISO 8859-1, with `?` for what is not in it.
pub(crate) fn codes(text: &str) -> Value {
    let code = |c: char| u8::try_from(u32::from(c)).unwrap_or(b'?');
    Value::Array(
        text.chars()
            .map(|c| Value::Int(i64::from(code(c))))
            .collect(),
    )
}
