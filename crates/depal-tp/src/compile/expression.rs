//! Values and conditions.

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::Compiler;
use crate::state;
use crate::syntax::tree::*;

/// What is known of a value before the program runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    Number,
    Switch,
    Text,
    Position,
    /// Arguments and system variables.
    Any,
}

impl Known {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Switch => "ON or OFF",
            Self::Text => "a text",
            Self::Position => "a position",
            Self::Any => "any value",
        }
    }
}

pub(super) fn kind_of_item(item: &Item) -> Known {
    match item.kind {
        ItemKind::Pr | ItemKind::P if item.indexes.len() > 1 => Known::Number,
        ItemKind::R
        | ItemKind::Gi
        | ItemKind::Go
        | ItemKind::Ai
        | ItemKind::Ao
        | ItemKind::Timer
        | ItemKind::TimerOverflow
        | ItemKind::UframeNum
        | ItemKind::UtoolNum
        | ItemKind::Override => Known::Number,
        ItemKind::Pr
        | ItemKind::P
        | ItemKind::Uframe
        | ItemKind::Utool
        | ItemKind::Lpos
        | ItemKind::Jpos => Known::Position,
        ItemKind::Sr => Known::Text,
        ItemKind::Ar | ItemKind::System => Known::Any,
        _ => Known::Switch,
    }
}

pub(super) fn kind_of(expr: &Expr) -> Known {
    match &expr.kind {
        ExprKind::Number { .. } | ExprKind::Negate(_) => Known::Number,
        ExprKind::Text(_) | ExprKind::Function(Function::Substr, _) => Known::Text,
        ExprKind::Function(..) => Known::Number,
        ExprKind::Switch(_) | ExprKind::Not(_) => Known::Switch,
        ExprKind::Item(item) => kind_of_item(item),
        ExprKind::Binary(operator, left, right) => match operator.binding() {
            1..=3 => Known::Switch,
            _ => match (kind_of(left), kind_of(right)) {
                (Known::Any, other) | (other, _) => other,
            },
        },
    }
}

impl Compiler<'_> {
    /// Code that puts a value.
    pub(super) fn value(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number { value, .. } => self.push_number(state::stored(*value)),
            ExprKind::Text(text) => self.push_text(text.clone()),
            ExprKind::Switch(on) => {
                self.emit(Op::Push(Value::Bool(*on)));
            }
            ExprKind::Item(item) => self.read(item),
            ExprKind::Negate(inner) => {
                self.demand(inner, &[Known::Number], "behind a minus");
                self.value(inner);
                self.call_builtin("negate", 1, true);
            }
            ExprKind::Not(inner) => {
                self.demand(inner, &[Known::Switch], "behind !");
                self.value(inner);
                self.call_builtin("not", 1, true);
            }
            ExprKind::Binary(operator, left, right) => {
                self.binary(*operator, left, right, expr.span);
            }
            ExprKind::Function(function, arguments) => {
                let at = Function::TABLE.iter().position(|(_, f, _)| f == function);
                self.push_number(at.unwrap_or(0) as f64);
                for (index, argument) in arguments.iter().enumerate() {
                    let wanted = match function {
                        Function::Strlen | Function::Findstr => Known::Text,
                        Function::Substr if index == 0 => Known::Text,
                        _ => Known::Number,
                    };
                    self.demand(argument, &[wanted], "here");
                    self.value(argument);
                }
                self.call_builtin("function", arguments.len() as u32 + 1, true);
            }
        }
    }

    /// Reports a value that can never be of the kinds wanted.
    pub(super) fn demand(&mut self, expr: &Expr, wanted: &[Known], place: &str) {
        let found = kind_of(expr);
        if found == Known::Any || wanted.contains(&found) {
            return;
        }
        let wanted: Vec<_> = wanted.iter().map(|w| w.name()).collect();
        let message = format!(
            "expected {} {place}, found {}",
            wanted.join(" or "),
            found.name()
        );
        self.error(Diagnostic::error("TP0210", expr.span, message));
    }

    fn binary(&mut self, operator: Operator, left: &Expr, right: &Expr, span: Span) {
        let (a, b) = (kind_of(left), kind_of(right));
        use Known::{Any, Number, Position, Switch};
        let fits = match operator {
            Operator::And | Operator::Or => matches!(a, Switch | Any) && matches!(b, Switch | Any),
            Operator::Equal | Operator::NotEqual => {
                a == b && a != Position
                    || a == Any
                    || b == Any
                    || matches!((a, b), (Switch, Number) | (Number, Switch))
            }
            Operator::Add => a == b && a != Switch || a == Any || b == Any,
            Operator::Subtract => a == b && matches!(a, Number | Position) || a == Any || b == Any,
            _ => matches!(a, Number | Any) && matches!(b, Number | Any),
        };
        if !fits {
            let message = format!(
                "{} does not go with {} and {}",
                operator.text(),
                a.name(),
                b.name()
            );
            self.error(
                Diagnostic::error("TP0211", span, message)
                    .secondary(left.span, format!("this is {}", a.name()))
                    .secondary(right.span, format!("this is {}", b.name())),
            );
        }
        let which = Operator::ALL.iter().position(|(o, ..)| *o == operator);
        self.push_number(which.unwrap_or(0) as f64);
        self.value(left);
        self.value(right);
        self.call_builtin("operate", 3, true);
    }

    /// Code that puts a truth value.
    pub(super) fn condition(&mut self, expr: &Expr) {
        self.demand(expr, &[Known::Switch], "as a condition");
        self.value(expr);
        if kind_of(expr) != Known::Switch {
            self.call_builtin("truth", 1, true);
        }
    }

    /// Code that puts an index or an amount.
    pub(super) fn amount(&mut self, expr: &Expr) {
        self.demand(expr, &[Known::Number], "here");
        self.value(expr);
    }

    fn indexes(&mut self, item: &Item) -> u32 {
        for index in &item.indexes {
            self.amount(index);
        }
        item.indexes.len() as u32
    }

    fn read(&mut self, item: &Item) {
        let two = item.indexes.len() > 1;
        match item.kind {
            ItemKind::R => self.read_by("r get", item),
            ItemKind::Pr if two => self.read_by("pr element get", item),
            ItemKind::Pr => self.read_by("pr get", item),
            ItemKind::Sr => self.read_by("sr get", item),
            ItemKind::Ar => self.read_by("ar get", item),
            ItemKind::P => {
                self.push_number(f64::from(state::COUNT) + self.program as f64);
                let count = self.indexes(item);
                let name = if two { "p element get" } else { "p get" };
                self.call_builtin(name, count + 1, true);
            }
            ItemKind::Flag | ItemKind::Marker => {
                self.push_number(f64::from(bit_slot(item.kind)));
                self.indexes(item);
                self.call_builtin("bit get", 2, true);
            }
            ItemKind::Timer | ItemKind::TimerOverflow => {
                self.settle();
                self.indexes(item);
                self.call_builtin("timer get", 1, true);
            }
            ItemKind::Uframe | ItemKind::Utool => {
                self.push_number(f64::from(frame_slot(item.kind)));
                self.indexes(item);
                self.call_builtin("frame get", 2, true);
            }
            ItemKind::UframeNum | ItemKind::UtoolNum | ItemKind::Override => {
                self.push_number(number_slot(item.kind) as f64);
                self.call_builtin("number get", 1, true);
            }
            ItemKind::Lpos => {
                self.settle();
                self.call_builtin("lpos", 0, true);
            }
            ItemKind::Jpos => {
                self.settle();
                self.call_builtin("jpos", 0, true);
            }
            ItemKind::System => {
                self.push_text(item.path.clone());
                self.call_builtin("system get", 1, true);
            }
            _ => {
                self.settle();
                self.push_text(item.kind.name());
                self.indexes(item);
                self.call_builtin("signal get", 2, true);
            }
        }
    }

    fn read_by(&mut self, builtin: &str, item: &Item) {
        let count = self.indexes(item);
        self.call_builtin(builtin, count, true);
    }

    /// Code that assigns; `value` puts the value behind the indexes.
    pub(super) fn write(&mut self, item: &Item, value: &dyn Fn(&mut Self)) {
        let two = item.indexes.len() > 1;
        let mut begin = 0;
        let name = match item.kind {
            ItemKind::R => "r set",
            ItemKind::Pr if two => "pr element set",
            ItemKind::Pr => "pr set",
            ItemKind::Sr => "sr set",
            ItemKind::P => {
                self.push_number(f64::from(state::COUNT) + self.program as f64);
                begin = 1;
                if two { "p element set" } else { "p set" }
            }
            ItemKind::Flag | ItemKind::Marker => {
                self.push_number(f64::from(bit_slot(item.kind)));
                begin = 1;
                "bit set"
            }
            ItemKind::Timer => {
                self.settle();
                "timer set"
            }
            ItemKind::Uframe | ItemKind::Utool => {
                self.push_number(f64::from(frame_slot(item.kind)));
                begin = 1;
                "frame set"
            }
            ItemKind::UframeNum | ItemKind::UtoolNum | ItemKind::Override => {
                self.push_number(number_slot(item.kind) as f64);
                begin = 1;
                "number set"
            }
            ItemKind::System => {
                self.push_text(item.path.clone());
                begin = 1;
                "system set"
            }
            ItemKind::Do
            | ItemKind::Ro
            | ItemKind::Go
            | ItemKind::Ao
            | ItemKind::So
            | ItemKind::Uo => {
                self.settle();
                self.push_text(item.kind.name());
                begin = 1;
                "signal set"
            }
            _ => {
                let message = format!("{} cannot be assigned", item.kind.name());
                self.error(Diagnostic::error("TP0212", item.span, message));
                return;
            }
        };
        let count = self.indexes(item);
        value(self);
        self.call_builtin(name, begin + count + 1, false);
    }
}

fn bit_slot(kind: ItemKind) -> u32 {
    match kind {
        ItemKind::Flag => state::FLAG,
        _ => state::MARKER,
    }
}

fn frame_slot(kind: ItemKind) -> u32 {
    match kind {
        ItemKind::Uframe => state::FRAMES,
        _ => state::TOOLS,
    }
}

fn number_slot(kind: ItemKind) -> usize {
    match kind {
        ItemKind::UframeNum => state::UFRAME_NUM,
        ItemKind::UtoolNum => state::UTOOL_NUM,
        _ => state::OVERRIDE,
    }
}
