use depal_syntax::{Span, Token};

use super::keywords::is_keyword;
use super::parser::Parser;
use super::tree::*;

fn made(kind: ExpressionKind, span: Span) -> Expression {
    Expression { kind, span }
}

impl Parser<'_> {
    pub(super) fn expression(&mut self) -> Expression {
        let begin = self.span();
        let read = self.nested(|parser| parser.operation(0));
        read.unwrap_or_else(|| {
            self.skip_line();
            made(ExpressionKind::Broken, begin)
        })
    }

    fn operator(&self) -> Option<Operator> {
        let text = match self.peek() {
            Token::Mark(mark) => *mark,
            Token::Name(name) => name.as_str(),
            _ => return None,
        };
        let found = Operator::ALL
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(text));
        found.map(|(_, operator)| *operator)
    }

    /// Operators of at least this strength.
    fn operation(&mut self, least: u8) -> Expression {
        let mut left = self.operand();
        while let Some(operator) = self.operator()
            && operator.strength() > least
        {
            if !self.one_more_operator() {
                self.skip_line();
                return made(ExpressionKind::Broken, left.span);
            }
            self.advance();
            let right = self.operation(operator.strength());
            let span = left.span.to(right.span);
            left = made(
                ExpressionKind::Binary(operator, Box::new(left), Box::new(right)),
                span,
            );
        }
        left
    }

    fn operand(&mut self) -> Expression {
        let begin = self.span();
        let sign: Option<fn(Box<Expression>) -> ExpressionKind> = if self.is_mark("-") {
            Some(ExpressionKind::Negate)
        } else if self.is_word("not") {
            Some(ExpressionKind::Not)
        } else if self.is_word("b_not") {
            Some(ExpressionKind::BitNot)
        } else {
            None
        };
        if let Some(sign) = sign {
            self.advance();
            let inner = self.nested(Self::operand);
            let Some(inner) = inner else {
                self.skip_line();
                return made(ExpressionKind::Broken, begin);
            };
            let span = begin.to(inner.span);
            return made(sign(Box::new(inner)), span);
        }
        if self.is_mark("+") {
            // A plus sign says nothing.
            self.advance();
        }
        let mut operand = self.primary();
        loop {
            if self.maybe_mark(".") {
                let Some(field) = self.constant_name() else {
                    return made(ExpressionKind::Broken, operand.span);
                };
                let span = operand.span.to(field.span);
                operand = made(ExpressionKind::Field(Box::new(operand), field), span);
            } else if let Some(opening) = self.opening("[") {
                let indexes = self.indexes(opening);
                let span = operand.span.to(self.last_span());
                operand = made(ExpressionKind::Index(Box::new(operand), indexes), span);
            } else {
                return operand;
            }
            if !self.one_more_operator() {
                self.skip_line();
                return made(ExpressionKind::Broken, operand.span);
            }
        }
    }

    fn primary(&mut self) -> Expression {
        let span = self.span();
        let kind = match self.peek().clone() {
            Token::Number { value, integer } => {
                self.advance();
                if integer {
                    ExpressionKind::Integer(value as i64)
                } else {
                    ExpressionKind::Real(value)
                }
            }
            Token::Text(text) => {
                self.advance();
                ExpressionKind::Text(text)
            }
            Token::Mark("#") => {
                self.advance();
                match self.constant_name() {
                    Some(name) => {
                        let span = span.to(name.span);
                        return made(ExpressionKind::Constant(name), span);
                    }
                    None => ExpressionKind::Broken,
                }
            }
            Token::Mark("(") => {
                self.advance();
                let inner = self.expression();
                self.expect_closing(")", span, "behind the expression");
                let span = span.to(self.last_span());
                return made(ExpressionKind::Group(Box::new(inner)), span);
            }
            Token::Mark("{") => {
                self.advance();
                return self.aggregate(span);
            }
            Token::Name(word) if word.eq_ignore_ascii_case("true") => {
                self.advance();
                ExpressionKind::Bool(true)
            }
            Token::Name(word) if word.eq_ignore_ascii_case("false") => {
                self.advance();
                ExpressionKind::Bool(false)
            }
            Token::Name(word) if !is_keyword(&word) => {
                self.advance();
                if self.is_mark("(") {
                    let name = Name { text: word, span };
                    let arguments = self.arguments();
                    let span = span.to(self.last_span());
                    return made(ExpressionKind::Call { name, arguments }, span);
                }
                ExpressionKind::Name(word)
            }
            _ => {
                let found = self.describe();
                self.report("KRL0011", format!("expected a value, found {found}"));
                ExpressionKind::Broken
            }
        };
        made(kind, span)
    }

    /// `(a, , b)`, with the parenthesis next.
    pub(super) fn arguments(&mut self) -> Arguments {
        let mut arguments = Vec::new();
        let Some(opening) = self.opening("(") else {
            return arguments;
        };
        if !self.is_mark(")") {
            loop {
                if self.is_mark(",") || self.is_mark(")") {
                    arguments.push(None);
                } else {
                    arguments.push(Some(self.expression()));
                }
                if !self.maybe_mark(",") {
                    break;
                }
            }
        }
        self.expect_closing(")", opening, "behind the arguments");
        arguments
    }

    /// `{X 1.0, Y 2}`, `{E6POS: X 1}`, with the brace behind.
    fn aggregate(&mut self, opening: Span) -> Expression {
        let mut type_name = None;
        if let (Token::Name(_), Token::Mark(":")) = (self.peek(), self.peek_after(1)) {
            type_name = self.expect_name("a type");
            self.advance();
        }
        let mut fields = Vec::new();
        while !self.is_mark("}") && !self.is_line_end() {
            let Some(name) = self.constant_name() else {
                break;
            };
            let whole = self.brackets() > 0;
            let value = self.expression();
            fields.push(AggregateField { name, whole, value });
            if !self.maybe_mark(",") {
                break;
            }
        }
        self.expect_closing("}", opening, "behind the components");
        let span = opening.to(self.last_span());
        made(ExpressionKind::Aggregate { type_name, fields }, span)
    }
}
