//! The section /POS.

use depal_syntax::{Diagnostic, Span};

use super::cursor::{Cursor, Parsed};
use super::lexer::{Kind, Token};
use super::tree::Taught;
use crate::position::Position;

/// All taught positions of a section.
pub(super) fn positions(
    tokens: &[Token],
    end: Span,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Taught> {
    let mut cursor = Cursor::new(tokens, end, diagnostics);
    let mut taught = Vec::new();
    while !cursor.is_at_end() {
        match one(&mut cursor) {
            Ok(position) => taught.push(position),
            Err(_) => recover(&mut cursor),
        }
    }
    taught
}

/// On to the next `P[`.
fn recover(cursor: &mut Cursor<'_>) {
    cursor.advance();
    let begins = |cursor: &Cursor<'_>| cursor.keyword() == "P" && cursor.is_symbol_at(1, "[");
    while !cursor.is_at_end() && !begins(cursor) {
        cursor.advance();
    }
}

fn one(cursor: &mut Cursor<'_>) -> Parsed<Taught> {
    let start = cursor.span();
    if !cursor.accept_keyword("P") {
        return cursor.expected("P[...]");
    }
    cursor.expect("[")?;
    let number = match cursor.peek() {
        Some(Kind::Number {
            value,
            is_real: false,
        }) if *value >= 1.0 && *value <= 32767.0 => *value as u32,
        _ => return cursor.expected("the number of a position, 1 to 32767"),
    };
    cursor.advance();
    cursor.expect_closing("]", start)?;
    let span = start.to(cursor.last_span());
    let opened = cursor.span();
    cursor.expect("{")?;
    let mut position = Position::cartesian([f64::NAN; 6]);
    let mut in_group = 1;
    loop {
        if cursor.accept("}") {
            break;
        }
        if cursor.is_at_end() {
            return cursor.expect_closing("}", opened).map(|()| Taught {
                number,
                span,
                position: position.clone(),
            });
        }
        if cursor.accept(",") {
            continue;
        }
        value(cursor, &mut position, &mut in_group)?;
    }
    cursor.accept(";");
    Ok(Taught {
        number,
        span,
        position,
    })
}

fn value(cursor: &mut Cursor<'_>, position: &mut Position, in_group: &mut u32) -> Parsed<()> {
    let word = cursor.keyword();
    if word.is_empty() {
        return cursor.expected("a value of the position");
    }
    cursor.advance();
    if super::lexer::is_group(&word) && (cursor.is_symbol(":") || cursor.is_symbol("=")) {
        cursor.advance();
        *in_group = word
            .trim_start_matches(|c: char| !c.is_ascii_digit())
            .parse()
            .unwrap_or(0);
        return Ok(());
    }
    if !cursor.accept("=") {
        cursor.expect(":")?;
    }
    match word.as_str() {
        "UF" | "UT" => {
            let found = match cursor.peek() {
                Some(Kind::Number { value, .. }) => Some(*value as u32),
                // `F`: whatever is in use.
                Some(Kind::Word(_)) => None,
                _ => return cursor.expected("a number"),
            };
            cursor.advance();
            if *in_group == 1 {
                if word == "UF" {
                    position.frame = found;
                } else {
                    position.tool = found;
                }
            }
        }
        "CONFIG" => {
            let Some(Kind::Text(text)) = cursor.peek() else {
                return cursor.expected("a configuration in quotes, 'N U T, 0, 0, 0'");
            };
            cursor.advance();
            if *in_group == 1 {
                position.config.clone_from(text);
            }
        }
        _ => {
            let name_span = cursor.last_span();
            let negative = cursor.accept("-");
            let number = match cursor.peek() {
                Some(Kind::Number { value, .. }) => *value * if negative { -1.0 } else { 1.0 },
                Some(Kind::Stars) => f64::NAN,
                _ => return cursor.expected("a number"),
            };
            cursor.advance();
            if matches!(cursor.keyword().as_str(), "MM" | "DEG" | "INCH") {
                cursor.advance();
            }
            let axis = match word.as_str() {
                "X" => Some((false, 0)),
                "Y" => Some((false, 1)),
                "Z" => Some((false, 2)),
                "W" => Some((false, 3)),
                "P" => Some((false, 4)),
                "R" => Some((false, 5)),
                "J1" => Some((true, 0)),
                "J2" => Some((true, 1)),
                "J3" => Some((true, 2)),
                "J4" => Some((true, 3)),
                "J5" => Some((true, 4)),
                "J6" => Some((true, 5)),
                "J7" | "J8" | "J9" | "E1" | "E2" | "E3" => None,
                _ => {
                    return cursor.fail(
                        Diagnostic::error(
                            "TP0110",
                            name_span,
                            format!("a position has no value {word}"),
                        )
                        .help("X, Y, Z, W, P, R or J1 to J6"),
                    );
                }
            };
            if let (Some((is_joint, index)), 1) = (axis, *in_group) {
                if is_joint {
                    position.config.clear();
                }
                position.is_joint = is_joint;
                position.values[index] = number;
            }
        }
    }
    Ok(())
}
