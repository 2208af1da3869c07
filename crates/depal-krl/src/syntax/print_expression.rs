//! Expressions as text.

use std::fmt::Write;

use super::tree::*;

/// An expression in one line, for messages.
pub(crate) fn expression_text(expression: &Expression) -> String {
    let mut text = String::new();
    write_expression(&mut text, expression);
    text
}

pub(super) fn call_text(name: &Name, arguments: &Arguments) -> String {
    let mut text = name.text.clone();
    write_arguments(&mut text, arguments);
    text
}

pub(super) fn write_arguments(text: &mut String, arguments: &Arguments) {
    text.push('(');
    for (i, argument) in arguments.iter().enumerate() {
        if i > 0 {
            text.push_str(", ");
        }
        if let Some(argument) = argument {
            write_expression(text, argument);
        }
    }
    text.push(')');
}

pub(super) fn write_indexes(text: &mut String, indexes: &[Option<Expression>]) {
    text.push('[');
    for (i, index) in indexes.iter().enumerate() {
        if i > 0 {
            text.push(',');
        }
        if let Some(index) = index {
            write_expression(text, index);
        }
    }
    text.push(']');
}

pub(super) fn write_expression(text: &mut String, expression: &Expression) {
    use ExpressionKind::{
        Aggregate, Binary, BitNot, Bool, Broken, Call, Constant, Field, Group, Index, Integer,
        Name, Negate, Not, Real, Text,
    };
    match &expression.kind {
        Integer(value) if *value < 0 => {
            let _ = write!(text, "'H{:X}'", *value as u32);
        }
        Integer(value) => text.push_str(&value.to_string()),
        Real(value) => {
            let mut number = format!("{value:?}");
            if !number.contains(['.', 'e']) {
                number.push_str(".0");
            }
            text.push_str(&number);
        }
        Text(value) => {
            text.push('"');
            text.push_str(value);
            text.push('"');
        }
        Bool(value) => text.push_str(if *value { "TRUE" } else { "FALSE" }),
        Constant(name) => {
            text.push('#');
            text.push_str(&name.text);
        }
        Name(name) => text.push_str(name),
        Field(inner, name) => {
            write_expression(text, inner);
            text.push('.');
            text.push_str(&name.text);
        }
        Index(inner, indexes) => {
            write_expression(text, inner);
            write_indexes(text, indexes);
        }
        Call { name, arguments } => {
            text.push_str(&name.text);
            write_arguments(text, arguments);
        }
        Aggregate { type_name, fields } => {
            text.push('{');
            if let Some(name) = type_name {
                text.push_str(&name.text);
                text.push_str(": ");
            }
            for (i, field) in fields.iter().enumerate() {
                if i > 0 {
                    text.push_str(", ");
                }
                text.push_str(&field.name.text);
                if field.whole {
                    text.push_str("[]");
                }
                text.push(' ');
                write_expression(text, &field.value);
            }
            text.push('}');
        }
        Group(inner) => {
            text.push('(');
            write_expression(text, inner);
            text.push(')');
        }
        Negate(inner) => {
            text.push('-');
            write_expression(text, inner);
        }
        Not(inner) => {
            text.push_str("NOT ");
            write_expression(text, inner);
        }
        BitNot(inner) => {
            text.push_str("B_NOT ");
            write_expression(text, inner);
        }
        Binary(operator, left, right) => {
            write_expression(text, left);
            text.push(' ');
            text.push_str(operator.text());
            text.push(' ');
            write_expression(text, right);
        }
        Broken => text.push('?'),
    }
}
