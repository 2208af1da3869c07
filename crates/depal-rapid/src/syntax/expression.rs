use depal_syntax::{Span, Token};

use super::keywords::is_keyword;
use super::parser::Parser;
use super::tree::*;

impl Parser<'_> {
    /// `[NOT] term { (OR | XOR) [NOT] term }`: NOT, OR and XOR bind weakest.
    pub(crate) fn expression(&mut self) -> Expression {
        let start = self.span();
        if self.inside == 0 {
            self.begin_operators();
        }
        self.inside += 1;
        let read = self.nested(Self::disjunction);
        self.inside -= 1;
        read.unwrap_or_else(|| broken(start))
    }

    fn disjunction(&mut self) -> Expression {
        let mut left = self.maybe_not(Self::logical_term);
        loop {
            let operator = if self.maybe_word("OR") {
                Operator::Or
            } else if self.maybe_word("XOR") {
                Operator::Xor
            } else {
                break;
            };
            if !self.count_operator() {
                break;
            }
            let right = self.maybe_not(Self::logical_term);
            left = binary(operator, left, right);
        }
        left
    }

    fn maybe_not(&mut self, inner: fn(&mut Self) -> Expression) -> Expression {
        let start = self.span();
        if !self.maybe_word("NOT") {
            return inner(self);
        }
        let Some(operand) = self.nested(|parser| parser.maybe_not(inner)) else {
            return broken(start);
        };
        Expression {
            span: start.to(operand.span),
            kind: ExpressionKind::Not(Box::new(operand)),
        }
    }

    fn logical_term(&mut self) -> Expression {
        let mut left = self.relation();
        while self.maybe_word("AND") && self.count_operator() {
            let right = self.maybe_not(Self::relation);
            left = binary(Operator::And, left, right);
        }
        left
    }

    fn relation(&mut self) -> Expression {
        let left = self.sum();
        let operator = match self.peek() {
            Token::Mark("=") => Operator::Equal,
            Token::Mark("<>") => Operator::NotEqual,
            Token::Mark("<") => Operator::Less,
            Token::Mark("<=") => Operator::LessOrEqual,
            Token::Mark(">") => Operator::Greater,
            Token::Mark(">=") => Operator::GreaterOrEqual,
            _ => return left,
        };
        self.advance();
        let right = self.sum();
        binary(operator, left, right)
    }

    fn sum(&mut self) -> Expression {
        let mut left = self.product();
        loop {
            let operator = if self.maybe_mark("+") {
                Operator::Add
            } else if self.maybe_mark("-") {
                Operator::Subtract
            } else {
                return left;
            };
            if !self.count_operator() {
                return left;
            }
            let right = self.product();
            left = binary(operator, left, right);
        }
    }

    fn product(&mut self) -> Expression {
        let mut left = self.signed();
        loop {
            let operator = if self.maybe_mark("*") {
                Operator::Multiply
            } else if self.maybe_mark("/") {
                Operator::Divide
            } else if self.maybe_word("DIV") {
                Operator::Div
            } else if self.maybe_word("MOD") {
                Operator::Mod
            } else {
                return left;
            };
            if !self.count_operator() {
                return left;
            }
            let right = self.signed();
            left = binary(operator, left, right);
        }
    }

    fn signed(&mut self) -> Expression {
        let start = self.span();
        if !self.is_mark("-") && !self.is_mark("+") {
            return self.postfix();
        }
        let negative = self.is_mark("-");
        self.advance();
        let Some(operand) = self.nested(Self::signed) else {
            return broken(start);
        };
        if !negative {
            return operand;
        }
        let span = start.to(operand.span);
        let kind = match operand.kind {
            ExpressionKind::Number { value, integer } => ExpressionKind::Number {
                value: -value,
                integer,
            },
            kind => ExpressionKind::Negate(Box::new(Expression {
                kind,
                span: operand.span,
            })),
        };
        Expression { kind, span }
    }

    /// A primary with `.field` and `{index}` behind it; each counts as an operator.
    pub(crate) fn postfix(&mut self) -> Expression {
        let mut value = self.primary();
        loop {
            if (self.is_mark(".") || self.is_mark("{")) && !self.count_operator() {
                return value;
            }
            if self.maybe_mark(".") {
                let Some(field) = self.expect_name("the name of a record component") else {
                    return value;
                };
                value = Expression {
                    span: value.span.to(field.span),
                    kind: ExpressionKind::Field(Box::new(value), field),
                };
            } else if self.is_mark("{") {
                let opened = self.span();
                self.advance();
                let mut indexes = Vec::new();
                loop {
                    indexes.push(self.expression());
                    if !self.maybe_mark(",") {
                        break;
                    }
                }
                self.expect_closing("}", opened, "behind the array index");
                value = Expression {
                    span: value.span.to(self.last_span()),
                    kind: ExpressionKind::Index(Box::new(value), indexes),
                };
            } else {
                return value;
            }
        }
    }

    fn primary(&mut self) -> Expression {
        let span = self.span();
        match self.peek().clone() {
            Token::Number { value, integer } => {
                self.advance();
                Expression {
                    kind: ExpressionKind::Number { value, integer },
                    span,
                }
            }
            Token::Text(text) => {
                self.advance();
                Expression {
                    kind: ExpressionKind::Text(text),
                    span,
                }
            }
            Token::Name(word) if word.eq_ignore_ascii_case("TRUE") => {
                self.advance();
                Expression {
                    kind: ExpressionKind::Bool(true),
                    span,
                }
            }
            Token::Name(word) if word.eq_ignore_ascii_case("FALSE") => {
                self.advance();
                Expression {
                    kind: ExpressionKind::Bool(false),
                    span,
                }
            }
            Token::Name(word) if !is_keyword(&word) => {
                self.advance();
                let opened = self.span();
                if !self.maybe_mark("(") {
                    return Expression {
                        kind: ExpressionKind::Name(word),
                        span,
                    };
                }
                let arguments = self.arguments(")");
                self.expect_closing(")", opened, "behind the arguments");
                Expression {
                    kind: ExpressionKind::Call {
                        name: Name { text: word, span },
                        arguments,
                    },
                    span: span.to(self.last_span()),
                }
            }
            Token::Mark("(") => {
                self.advance();
                let mut inner = self.expression();
                self.expect_closing(")", span, "behind the expression");
                inner.span = span.to(self.last_span());
                inner
            }
            Token::Mark("[") => {
                self.advance();
                let mut items = Vec::new();
                while !self.is_mark("]") && !self.is_end() {
                    items.push(self.expression());
                    if !self.maybe_mark(",") {
                        break;
                    }
                }
                self.expect_closing("]", span, "behind the aggregate");
                Expression {
                    kind: ExpressionKind::Aggregate(items),
                    span: span.to(self.last_span()),
                }
            }
            Token::Mark("<") if self.placeholder() => broken(span),
            _ => {
                let found = self.describe();
                self.report("RAPID0017", format!("expected a value, found {found}"));
                broken(span)
            }
        }
    }

    /// Arguments up to `end`, which is left standing. Optional ones begin with a backslash,
    /// with or without a comma before it.
    pub(crate) fn arguments(&mut self, end: &str) -> Vec<Argument> {
        let mut arguments = Vec::new();
        while !self.is_mark(end) && !self.is_end() {
            let before = self.position();
            if self.maybe_mark("\\") {
                let Some(name) = self.expect_name("the name of an optional argument") else {
                    break;
                };
                if self.maybe_mark("?") {
                    let Some(from) = self.expect_name("the name of an optional parameter") else {
                        break;
                    };
                    arguments.push(Argument::Conditional { name, from });
                } else {
                    let value = self.maybe_mark(":=").then(|| self.expression());
                    arguments.push(Argument::Named { name, value });
                }
            } else if matches!(self.peek(), Token::Name(_))
                && matches!(self.peek_after(1), Token::Mark(":="))
            {
                let Some(name) = self.expect_name("the name of an argument") else {
                    break;
                };
                self.advance();
                let value = Some(self.expression());
                arguments.push(Argument::Named { name, value });
            } else {
                arguments.push(Argument::Positional(self.expression()));
            }
            if self.maybe_mark(",") || self.is_mark("\\") {
                continue;
            }
            if !self.is_mark(end) || self.position() == before {
                break;
            }
        }
        arguments
    }
}

fn binary(operator: Operator, left: Expression, right: Expression) -> Expression {
    Expression {
        span: left.span.to(right.span),
        kind: ExpressionKind::Binary(operator, Box::new(left), Box::new(right)),
    }
}

pub(crate) fn broken(span: Span) -> Expression {
    Expression {
        kind: ExpressionKind::Broken,
        span,
    }
}
