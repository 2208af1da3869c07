//! Signals and other system variables that are asked from the cabinet.

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, UnaryOp, Value};

use super::scope::*;
use super::system::Live;
use super::types::Type;
use crate::syntax::tree::*;

/// Arrays of signals.
const ARRAYS: [&str; 4] = ["$IN", "$OUT", "$ANIN", "$ANOUT"];

/// Inputs of the system itself: one that is always TRUE, one that is always FALSE.
const CONSTANT_INPUTS: [i64; 2] = [1025, 1026];

impl Compiler<'_> {
    /// `SIGNAL x $OUT[1] TO $OUT[8]`.
    pub(super) fn signal_symbol(
        &mut self,
        name: &Name,
        from: &Expression,
        to: Option<&Expression>,
    ) -> Option<SignalSymbol> {
        let (array, first) = self.signal_place(from)?;
        let last = match to {
            None => None,
            Some(to) => Some(self.signal_place(to)?),
        };
        if let Some((other, last)) = last {
            let count = last - first + 1;
            if other != array || !(1..=32).contains(&count) || array.starts_with("$AN") {
                let span = from.span.to(to.map_or(from.span, |t| t.span));
                self.error(Diagnostic::error(
                    "KRL0122",
                    span,
                    "a group runs over 1 to 32 neighbouring inputs, or outputs",
                ));
                return None;
            }
        }
        let to = last.map(|(_, last)| last);
        for number in first..=to.unwrap_or(first) {
            self.use_signal(array, number, from.span);
        }
        Some(SignalSymbol {
            name: name.text.clone(),
            array,
            from: first,
            to,
            span: name.span,
        })
    }

    fn signal_place(&mut self, expression: &Expression) -> Option<(&'static str, i64)> {
        if let ExpressionKind::Index(inner, indexes) = &expression.kind
            && let ExpressionKind::Name(name) = &inner.kind
            && let [Some(index)] = indexes.as_slice()
        {
            let array = ARRAYS.iter().find(|a| a.eq_ignore_ascii_case(name));
            if let Some(array) = array {
                return match self.constant(index, &Type::Int)? {
                    Value::Int(number) if number >= 1 => Some((array, number)),
                    _ => {
                        self.error(Diagnostic::error(
                            "KRL0114",
                            index.span,
                            "signals are numbered from 1",
                        ));
                        None
                    }
                };
            }
        }
        if expression.kind != ExpressionKind::Broken {
            self.error(
                Diagnostic::error("KRL0122", expression.span, "a signal is needed here")
                    .help("write $IN[1], $OUT[1], $ANIN[1] or $ANOUT[1]"),
            );
        }
        None
    }

    /// A signal that the program uses must be one of the cabinet.
    fn use_signal(&mut self, array: &str, number: i64, span: Span) {
        if array == "$IN" && CONSTANT_INPUTS.contains(&number) {
            return;
        }
        let name = format!("{array}[{number}]");
        if let Some(signals) = &self.signals
            && !signals.contains(&name.to_lowercase())
            && self.missing_signals.insert(name.clone())
        {
            self.error(
                Diagnostic::error("KRL0101", span, format!("the cabinet has no signal {name}"))
                    .help("define it in the cell, or let the signals be added automatically"),
            );
        }
    }

    fn note_live(&mut self, live: &Live, index: &Expression) {
        let array = match live.name {
            "$OUT_C" => "$OUT",
            name => name,
        };
        if ARRAYS.contains(&array)
            && let ExpressionKind::Integer(number) = index.kind
        {
            self.use_signal(array, number, index.span);
        }
    }

    pub(super) fn read_live(&mut self, live: &'static Live) -> Type {
        if live.stops_advance {
            self.stop_advance();
        }
        match live.read {
            Some(read) => self.emit_builtin(read, u32::from(live.indexed), true),
            None => {
                self.emit(Op::Push(Value::Unset));
            }
        }
        self.lookup_type(&live.kind.to_lowercase())
            .unwrap_or(Type::Broken)
    }

    /// An element of a system variable that is asked; `None` if it is something else.
    pub(super) fn live_element(
        &mut self,
        array: &Expression,
        indexes: &[Option<Expression>],
        span: Span,
    ) -> Option<Type> {
        let live = self.live_array(array)?;
        if live.read.is_none() {
            self.error(Diagnostic::error(
                "KRL0109",
                span,
                format!("{} can only be written", live.name),
            ));
        }
        if live.stops_advance {
            self.stop_advance();
        }
        self.live_index(live, indexes, span);
        let waited = std::mem::replace(&mut self.body.waited, true);
        let kind = self.read_live(live);
        self.body.waited = waited;
        Some(kind)
    }

    fn live_array(&self, array: &Expression) -> Option<&'static Live> {
        match self.root(array) {
            Some(Symbol::Live(live))
                if live.indexed && matches!(array.kind, ExpressionKind::Name(_)) =>
            {
                Some(live)
            }
            _ => None,
        }
    }

    /// Puts the index.
    fn live_index(&mut self, live: &'static Live, indexes: &[Option<Expression>], span: Span) {
        if let [Some(index)] = indexes {
            self.note_live(live, index);
            self.value(index, Some(&Type::Int));
        } else {
            self.error(Diagnostic::error(
                "KRL0114",
                span,
                format!("{} takes one index", live.name),
            ));
            self.emit(Op::Push(Value::Int(1)));
        }
    }

    pub(super) fn read_signal(&mut self, signal: &SignalSymbol) -> Type {
        self.stop_advance();
        self.emit(Op::Push(Value::Int(signal.from)));
        if let Some(to) = signal.to {
            self.emit(Op::Push(Value::Int(to)));
            let name = if signal.array == "$IN" {
                "read in group"
            } else {
                "read out group"
            };
            self.emit_builtin(name, 2, true);
            return Type::Int;
        }
        let (name, kind) = match signal.array {
            "$IN" => ("read in", Type::Bool),
            "$OUT" => ("read out", Type::Bool),
            "$ANIN" => ("read anin", Type::Real),
            _ => ("read anout", Type::Real),
        };
        self.emit_builtin(name, 1, true);
        kind
    }

    /// Assigns to a signal or another system variable that is asked; `false` if the target is none.
    pub(super) fn assign_live(&mut self, target: &Expression, value: &Expression) -> bool {
        match (&target.kind, self.root(target).cloned()) {
            (_, Some(Symbol::Live(live))) => {
                let (ExpressionKind::Index(_, indexes), Some(write)) = (&target.kind, live.write)
                else {
                    self.error(Diagnostic::error(
                        "KRL0109",
                        target.span,
                        format!("{} can only be read", live.name),
                    ));
                    return true;
                };
                if live.stops_advance {
                    self.stop_advance();
                }
                self.live_index(live, indexes, target.span);
                let kind = self.lookup_type(&live.kind.to_lowercase());
                self.value(value, kind.as_ref());
                self.emit_builtin(write, 2, false);
                true
            }
            (ExpressionKind::Name(_), Some(Symbol::Signal(signal))) => {
                self.write_signal(&signal, target.span, value);
                true
            }
            (_, Some(Symbol::Signal(signal))) => {
                self.error(Diagnostic::error(
                    "KRL0113",
                    target.span,
                    format!("the signal {} has no parts", signal.name),
                ));
                true
            }
            _ => false,
        }
    }

    fn write_signal(&mut self, signal: &SignalSymbol, span: Span, value: &Expression) {
        if !matches!(signal.array, "$OUT" | "$ANOUT") {
            self.error(
                Diagnostic::error(
                    "KRL0109",
                    span,
                    format!("{} is an input, it cannot be written", signal.name),
                )
                .secondary(signal.span, "declared here"),
            );
            return;
        }
        self.stop_advance();
        self.emit(Op::Push(Value::Int(signal.from)));
        match (signal.array, signal.to) {
            ("$ANOUT", _) => {
                self.value(value, Some(&Type::Real));
                self.emit_builtin("write anout", 2, false);
            }
            (_, Some(to)) => {
                self.emit(Op::Push(Value::Int(to)));
                let found = self.value(value, Some(&Type::Int));
                if found == Type::Real {
                    self.emit(Op::Unary(UnaryOp::ToInteger));
                }
                self.emit_builtin("write out group", 3, false);
            }
            _ => {
                self.value(value, Some(&Type::Bool));
                self.emit_builtin("write out", 2, false);
            }
        }
    }

    /// Puts the number of a single digital output.
    pub(super) fn output_number(&mut self, expression: &Expression) -> bool {
        if let ExpressionKind::Index(array, indexes) = &expression.kind
            && let Some(live) = self.live_array(array)
            && live.name == "$OUT"
        {
            self.live_index(live, indexes, expression.span);
            return true;
        }
        if let (ExpressionKind::Name(_), Some(Symbol::Signal(signal))) =
            (&expression.kind, self.root(expression))
            && signal.array == "$OUT"
            && signal.to.is_none()
        {
            let number = signal.from;
            self.emit(Op::Push(Value::Int(number)));
            return true;
        }
        false
    }
}
