//! What a single value may be.

use std::marker::PhantomData;

use serde::Serialize;
use serde_json::{Value as Json, json};

use crate::document::{Node, Value};
use crate::reader::{Reader, Rule, Section};

/// A finite number within limits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Number {
    low: f64,
    high: f64,
    low_excluded: bool,
}

/// A number of `low..=high`.
pub(crate) const fn number(low: f64, high: f64) -> Number {
    Number {
        low,
        high,
        low_excluded: false,
    }
}

/// A number above `low`, at most `high`.
pub(crate) const fn above(low: f64, high: f64) -> Number {
    Number {
        low,
        high,
        low_excluded: true,
    }
}

/// A coordinate: any place within 100 m.
pub(crate) const COORDINATE_MM: Number = number(-100_000.0, 100_000.0);
/// An edge length: above zero, at most 100 m.
pub(crate) const LENGTH_MM: Number = above(0.0, 100_000.0);
/// An angle: at most one turn either way.
pub(crate) const ANGLE_DEG: Number = number(-360.0, 360.0);
/// A share.
pub(crate) const SHARE: Number = number(0.0, 1.0);

impl Number {
    fn expected(self) -> String {
        if self.low_excluded {
            format!("a number above {} and at most {}", self.low, self.high)
        } else {
            format!("a number of {} to {}", self.low, self.high)
        }
    }

    fn holds(self, number: f64) -> bool {
        // A NaN fails every comparison.
        let above_low = if self.low_excluded {
            number > self.low
        } else {
            number >= self.low
        };
        above_low && number <= self.high
    }
}

impl Rule for Number {
    type Output = f64;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<f64> {
        let number = match node.value {
            Value::Integer(number) => Some(number as f64),
            Value::Float(number) => Some(number),
            _ => None,
        };
        let Some(number) = number.filter(|number| self.holds(*number)) else {
            reader.unexpected(node, key, &self.expected());
            return None;
        };
        // `-0.0` would write itself differently from `0.0`.
        Some(number + 0.0)
    }

    fn schema(&self) -> Json {
        if self.low_excluded {
            json!({"type": "number", "exclusiveMinimum": self.low, "maximum": self.high})
        } else {
            json!({"type": "number", "minimum": self.low, "maximum": self.high})
        }
    }
}

/// Every value of a list as `rule` reads it; each that is wrong is told.
fn each_of<R: Rule>(
    rule: &R,
    items: &[Node],
    key: &str,
    reader: &mut Reader<'_>,
) -> Option<Vec<R::Output>> {
    let read: Vec<Option<R::Output>> = items
        .iter()
        .enumerate()
        .map(|(position, item)| rule.read(item, &format!("{key}[{position}]"), reader))
        .collect();
    read.into_iter().collect()
}

/// As [`each_of`], of a list of `N`.
fn exactly<R: Rule, const N: usize>(
    rule: &R,
    expected: &str,
    node: &Node,
    key: &str,
    reader: &mut Reader<'_>,
) -> Option<[R::Output; N]> {
    match &node.value {
        Value::List(items) if items.len() == N => {
            each_of(rule, items, key, reader)?.try_into().ok()
        }
        _ => {
            reader.unexpected(node, key, expected);
            None
        }
    }
}

/// `N` numbers in a list.
pub(crate) struct Numbers<const N: usize>(pub(crate) Number);

impl<const N: usize> Rule for Numbers<N> {
    type Output = [f64; N];

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<[f64; N]> {
        let expected = format!("{N} numbers, each {}", self.0.expected());
        exactly(&self.0, &expected, node, key, reader)
    }

    fn schema(&self) -> Json {
        json!({"type": "array", "items": self.0.schema(), "minItems": N, "maxItems": N})
    }
}

/// A smallest and a largest value; equal when the scene gives a single number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

impl Span {
    /// A span of one value.
    pub const fn of(value: f64) -> Self {
        Self {
            min: value,
            max: value,
        }
    }
}

impl Serialize for Span {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.min, self.max].serialize(serializer)
    }
}

/// A number, or a list of a smallest and a largest one.
pub(crate) struct SpanOf(pub(crate) Number);

impl Rule for SpanOf {
    type Output = Span;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Span> {
        match &node.value {
            Value::Integer(_) | Value::Float(_) => self.0.read(node, key, reader).map(Span::of),
            Value::List(items) if items.len() == 2 => {
                let [min, max] = Numbers::<2>(self.0).read(node, key, reader)?;
                if min > max {
                    let message = format!("expected [smallest, largest], found [{min}, {max}]");
                    reader.problem(&node.place, key, message, Some("swap them".to_owned()));
                    return None;
                }
                Some(Span { min, max })
            }
            _ => {
                let expected = format!("{} or [smallest, largest]", self.0.expected());
                reader.unexpected(node, key, &expected);
                None
            }
        }
    }

    fn schema(&self) -> Json {
        json!({"oneOf": [self.0.schema(), Numbers::<2>(self.0).schema()]})
    }
}

/// A whole number of `low..=high`, as a type that holds it.
pub(crate) struct Whole<T> {
    low: i64,
    high: i64,
    kind: PhantomData<T>,
}

/// A whole number of `low..=high`.
pub(crate) const fn whole<T>(low: i64, high: i64) -> Whole<T> {
    Whole {
        low,
        high,
        kind: PhantomData,
    }
}

impl<T: TryFrom<i64>> Rule for Whole<T> {
    type Output = T;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<T> {
        if let Value::Integer(number) = node.value
            && (self.low..=self.high).contains(&number)
            && let Ok(number) = T::try_from(number)
        {
            return Some(number);
        }
        let expected = if self.low == self.high {
            self.low.to_string()
        } else {
            format!("a whole number of {} to {}", self.low, self.high)
        };
        reader.unexpected(node, key, &expected);
        None
    }

    fn schema(&self) -> Json {
        json!({"type": "integer", "minimum": self.low, "maximum": self.high})
    }
}

/// `N` whole numbers in a list.
pub(crate) struct Wholes<const N: usize>(pub(crate) Whole<u32>);

impl<const N: usize> Rule for Wholes<N> {
    type Output = [u32; N];

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<[u32; N]> {
        let expected = format!("a list of {N} whole numbers");
        exactly(&self.0, &expected, node, key, reader)
    }

    fn schema(&self) -> Json {
        json!({"type": "array", "items": self.0.schema(), "minItems": N, "maxItems": N})
    }
}

/// A text that is not empty.
pub(crate) struct Text;

/// The text of a node; an override's value counts as text however it looks.
pub(crate) fn text_of(node: &Node, reader: &Reader<'_>) -> Option<String> {
    match (
        &node.value,
        &reader.sources[node.place.source].override_value,
    ) {
        (Value::Text(text), _) => Some(text.clone()),
        (Value::List(_) | Value::Table(_), _) | (_, None) => None,
        (_, Some(raw)) => Some(raw.clone()),
    }
}

impl Rule for Text {
    type Output = String;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<String> {
        let text = text_of(node, reader).filter(|text| !text.trim().is_empty());
        if text.is_none() {
            reader.unexpected(node, key, "a text that is not empty");
        }
        text
    }

    fn schema(&self) -> Json {
        json!({"type": "string", "minLength": 1})
    }
}

/// `true` or `false`.
pub(crate) struct Flag;

impl Rule for Flag {
    type Output = bool;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<bool> {
        if let Value::Flag(flag) = node.value {
            return Some(flag);
        }
        reader.unexpected(node, key, "true or false");
        None
    }

    fn schema(&self) -> Json {
        json!({"type": "boolean"})
    }
}

/// A list of `low..=high` values of one rule.
pub(crate) struct ListOf<R>(pub(crate) R, pub(crate) usize, pub(crate) usize);

impl<R: Rule> Rule for ListOf<R> {
    type Output = Vec<R::Output>;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Self::Output> {
        match &node.value {
            Value::List(items) if (self.1..=self.2).contains(&items.len()) => {
                each_of(&self.0, items, key, reader)
            }
            _ => {
                let expected = format!("a list of {} to {} values", self.1, self.2);
                reader.unexpected(node, key, &expected);
                None
            }
        }
    }

    fn schema(&self) -> Json {
        json!({"type": "array", "items": self.0.schema(), "minItems": self.1, "maxItems": self.2})
    }
}

/// A value that may be left out.
pub(crate) struct Maybe<R>(pub(crate) R);

impl<R: Rule> Rule for Maybe<R> {
    type Output = Option<R::Output>;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Self::Output> {
        self.0.read(node, key, reader).map(Some)
    }

    fn schema(&self) -> Json {
        self.0.schema()
    }
}

/// A table of a section.
pub(crate) struct TableOf<S>(PhantomData<S>);

/// A table of a section.
pub(crate) const fn table<S>() -> TableOf<S> {
    TableOf(PhantomData)
}

impl<S: Section> Rule for TableOf<S> {
    type Output = S;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<S> {
        if let Value::Table(table) = &node.value {
            return S::read(table, &node.place, key, &[], reader);
        }
        reader.unexpected(node, key, "a table");
        None
    }

    fn schema(&self) -> Json {
        S::schema()
    }
}

/// One rule's value alone, or a list of them.
pub(crate) struct OneOrMore<R>(pub(crate) R, pub(crate) usize);

impl<R: Rule> Rule for OneOrMore<R> {
    type Output = Vec<R::Output>;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Self::Output> {
        // A list whose first value is no list is a single value where that value is itself a list.
        let single = match &node.value {
            Value::List(items) => {
                self.0.schema()["type"] == "array"
                    && !matches!(items.first().map(|item| &item.value), Some(Value::List(_)))
            }
            _ => true,
        };
        if single {
            return self.0.read(node, key, reader).map(|value| vec![value]);
        }
        let Value::List(items) = &node.value else {
            unreachable!("a single value was read above")
        };
        if items.is_empty() || items.len() > self.1 {
            let expected = format!("one value or a list of 1 to {}", self.1);
            reader.unexpected(node, key, &expected);
            return None;
        }
        each_of(&self.0, items, key, reader)
    }

    fn schema(&self) -> Json {
        let one = self.0.schema();
        json!({"oneOf": [one.clone(), {"type": "array", "items": one, "minItems": 1, "maxItems": self.1}]})
    }
}
