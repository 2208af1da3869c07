use crate::{MachineFault, Value};

/// An operator with one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnaryOp {
    /// Minus, on numbers and records of numbers.
    Negate,
    /// Not.
    Not,
    /// To a 64-bit number.
    ToDnum,
    /// To a 32-bit number.
    ToNum,
    /// To an integer: the nearest, a half away from zero.
    ToInteger,
    /// All bits of an integer inverted.
    BitNot,
}

/// An operator with two operands of the same kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinaryOp {
    /// Sum; strings are joined.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Integer quotient, towards zero.
    IntegerDivide,
    /// Remainder of the integer quotient; sign of the dividend.
    Remainder,
    /// Equal, on any value.
    Equal,
    /// Not equal, on any value.
    NotEqual,
    /// Less.
    Less,
    /// Less or equal.
    LessOrEqual,
    /// Greater.
    Greater,
    /// Greater or equal.
    GreaterOrEqual,
    /// Both.
    And,
    /// At least one.
    Or,
    /// Exactly one.
    Xor,
    /// Bits that both integers have.
    BitAnd,
    /// Bits that at least one has.
    BitOr,
    /// Bits that exactly one has.
    BitXor,
}

pub(crate) fn unary(op: UnaryOp, value: Value) -> Result<Value, MachineFault> {
    Ok(match (op, value) {
        (UnaryOp::Negate, Value::Num(v)) => Value::Num(-v),
        (UnaryOp::Negate, Value::Dnum(v)) => Value::Dnum(-v),
        (UnaryOp::Negate, Value::Int(v)) => Value::Int(v.wrapping_neg()),
        (UnaryOp::Negate, Value::Record(fields)) => Value::Record(
            fields
                .into_iter()
                .map(|f| unary(op, f))
                .collect::<Result<_, _>>()?,
        ),
        (UnaryOp::Not, Value::Bool(v)) => Value::Bool(!v),
        (UnaryOp::ToDnum, v) => Value::Dnum(number(&v)?),
        (UnaryOp::ToNum, v) => Value::Num(number(&v)? as f32),
        (UnaryOp::ToInteger, Value::Int(v)) => Value::Int(v),
        (UnaryOp::ToInteger, v) => Value::Int(number(&v)?.round() as i64),
        (UnaryOp::BitNot, Value::Int(v)) => Value::Int(!v),
        (_, v) => return Err(mismatch(&v)),
    })
}

pub(crate) fn binary(
    op: BinaryOp,
    left: Value,
    right: Value,
    string_limit: usize,
) -> Result<Value, MachineFault> {
    match op {
        BinaryOp::Equal => return Ok(Value::Bool(left == right)),
        BinaryOp::NotEqual => return Ok(Value::Bool(left != right)),
        _ => {}
    }
    match (left, right) {
        (Value::Num(a), Value::Num(b)) => {
            // Sums, products and quotients in f64 and rounded once to f32 are the f32 operations.
            let wrap = |v: f64| Value::Num(v as f32);
            arithmetic(op, f64::from(a), f64::from(b), wrap)
        }
        (Value::Dnum(a), Value::Dnum(b)) => arithmetic(op, a, b, Value::Dnum),
        (Value::Int(a), Value::Int(b)) => integer(op, a, b),
        (Value::Bool(a), Value::Bool(b)) => Ok(Value::Bool(match op {
            BinaryOp::And => a && b,
            BinaryOp::Or => a || b,
            BinaryOp::Xor => a != b,
            _ => return Err(mismatch(&Value::Bool(a))),
        })),
        (Value::Str(mut a), Value::Str(b)) if op == BinaryOp::Add => {
            a.push_str(&b);
            let length = a.chars().count();
            if length > string_limit {
                return Err(MachineFault::StringTooLong {
                    length,
                    limit: string_limit,
                });
            }
            Ok(Value::Str(a))
        }
        (a, _) => Err(mismatch(&a)),
    }
}

fn arithmetic(
    op: BinaryOp,
    a: f64,
    b: f64,
    wrap: impl Fn(f64) -> Value,
) -> Result<Value, MachineFault> {
    let divisor = |b: f64| {
        if b == 0.0 {
            Err(MachineFault::DivisionByZero)
        } else {
            Ok(b)
        }
    };
    Ok(match op {
        BinaryOp::Add => wrap(a + b),
        BinaryOp::Subtract => wrap(a - b),
        BinaryOp::Multiply => wrap(a * b),
        BinaryOp::Divide => wrap(a / divisor(b)?),
        BinaryOp::IntegerDivide => wrap((a / divisor(b)?).trunc()),
        BinaryOp::Remainder => wrap(a % divisor(b)?),
        BinaryOp::Less => Value::Bool(a < b),
        BinaryOp::LessOrEqual => Value::Bool(a <= b),
        BinaryOp::Greater => Value::Bool(a > b),
        BinaryOp::GreaterOrEqual => Value::Bool(a >= b),
        _ => return Err(mismatch(&wrap(a))),
    })
}

fn integer(op: BinaryOp, a: i64, b: i64) -> Result<Value, MachineFault> {
    let zero = MachineFault::DivisionByZero;
    Ok(match op {
        BinaryOp::Add => Value::Int(a.wrapping_add(b)),
        BinaryOp::Subtract => Value::Int(a.wrapping_sub(b)),
        BinaryOp::Multiply => Value::Int(a.wrapping_mul(b)),
        BinaryOp::Divide | BinaryOp::IntegerDivide => Value::Int(a.checked_div(b).ok_or(zero)?),
        BinaryOp::Remainder => Value::Int(a.checked_rem(b).ok_or(zero)?),
        BinaryOp::BitAnd => Value::Int(a & b),
        BinaryOp::BitOr => Value::Int(a | b),
        BinaryOp::BitXor => Value::Int(a ^ b),
        BinaryOp::Less => Value::Bool(a < b),
        BinaryOp::LessOrEqual => Value::Bool(a <= b),
        BinaryOp::Greater => Value::Bool(a > b),
        BinaryOp::GreaterOrEqual => Value::Bool(a >= b),
        _ => return Err(mismatch(&Value::Int(a))),
    })
}

fn number(value: &Value) -> Result<f64, MachineFault> {
    value.as_number().ok_or_else(|| mismatch(value))
}

fn mismatch(value: &Value) -> MachineFault {
    match value {
        Value::Absent => MachineFault::NotPresent,
        Value::Unset => MachineFault::NotInitialized {
            name: "a variable".into(),
        },
        other => MachineFault::Argument {
            message: format!("the operator does not take {}", other.kind_name()),
        },
    }
}
