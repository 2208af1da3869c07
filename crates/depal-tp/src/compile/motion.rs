//! Moves.

use depal_syntax::Diagnostic;
use depal_vm::{Op, Value};

use super::Compiler;
use super::expression::Known;
use crate::state;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn motion(&mut self, motion: &Motion) {
        let in_corner = std::mem::take(&mut self.body.in_corner);
        let options = &motion.options;
        if options.remote_tcp {
            self.refuse(motion.span, "RTCP");
            return;
        }
        if options.skip.is_some() && self.skip_conditions.is_empty() {
            self.error(
                Diagnostic::error(
                    "TP0240",
                    motion.span,
                    "this move has Skip, but there is no SKIP CONDITION",
                )
                .help("write SKIP CONDITION DI[1]=ON (or another condition) before the move"),
            );
            return;
        }
        let (outputs, actions): (Vec<&Along>, Vec<&Along>) = options
            .along
            .iter()
            .partition(|along| output(along).is_some());
        for along in &actions {
            self.error(
                Diagnostic::warning(
                    "TP0292",
                    along.span,
                    "only outputs are switched on the way; this runs when the move is over",
                )
                .help("DO[...]=ON and OFF, RO, GO and AO are exact"),
            );
        }
        let waits = options.skip.is_none();
        let mut count = 12;
        self.push_number(match motion.kind {
            MotionKind::Joint => 0.0,
            MotionKind::Linear | MotionKind::Circular => 1.0,
        });
        self.value_for_move(&motion.target);
        self.push_text(place_name(&motion.target));
        match &motion.via {
            Some(via) => self.value_for_move(via),
            None => self.absent(),
        }
        self.optional(motion.speed.as_ref());
        self.push_number(match motion.unit {
            SpeedUnit::Percent => 0.0,
            SpeedUnit::MmPerSec => 1.0,
            SpeedUnit::CmPerMin => 2.0,
            SpeedUnit::InchPerMin => 3.0,
            SpeedUnit::DegPerSec => 4.0,
            SpeedUnit::Seconds => 5.0,
            SpeedUnit::Milliseconds => 6.0,
            SpeedUnit::Most => 7.0,
        });
        match &motion.termination {
            Termination::Fine => self.absent(),
            Termination::Continuous(value) => self.amount(value),
        }
        self.optional(options.acceleration.as_ref());
        for (offset, which) in [
            (&options.offset, state::OFFSET),
            (&options.tool_offset, state::TOOL_OFFSET),
        ] {
            match offset {
                OffsetBy::Nothing => self.absent(),
                OffsetBy::Register(index) => {
                    self.amount(index);
                    self.call_builtin("pr get", 1, true);
                }
                OffsetBy::Condition => {
                    self.emit(Op::Push(Value::Int(which as i64)));
                }
            }
        }
        self.emit(Op::Push(Value::Bool(options.incremental)));
        self.emit(Op::Push(Value::Bool(waits)));
        for along in outputs.into_iter().chain(&in_corner) {
            let Some((item, value)) = output(along) else {
                continue;
            };
            self.push_number(match along.when {
                AlongWhen::TimeBefore => 0.0,
                AlongWhen::TimeAfter => 1.0,
                AlongWhen::DistanceBefore => 2.0,
            });
            self.amount(&along.amount);
            self.push_text(item.kind.name());
            self.amount(&item.indexes[0]);
            self.demand(value, &[Known::Switch, Known::Number], "here");
            self.value(value);
            count += 5;
        }
        let held = self.new_local();
        self.call_builtin("move", count, true);
        self.emit(Op::SetLocal(held));
        if let Some(label) = &options.skip {
            self.skip(held, label, options.skip_position.as_ref());
        }
        for along in actions {
            self.emit(Op::LoadLocal(held));
            self.call_builtin("move wait", 1, false);
            self.action(&along.action, along.span);
        }
    }

    /// A position whose values are looked at when the move begins, with its name.
    fn value_for_move(&mut self, target: &Expr) {
        self.value(target);
    }

    fn absent(&mut self) {
        self.emit(Op::Push(Value::Absent));
    }

    fn optional(&mut self, value: Option<&Expr>) {
        match value {
            Some(value) => self.amount(value),
            None => self.absent(),
        }
    }

    /// Watches the condition until the move is over: then on to the label; if it comes true, the arm stops there
    /// and the next line runs.
    fn skip(&mut self, held: u32, label: &Expr, keep: Option<&(Item, Expr)>) {
        let again = self.here();
        let mut stops = Vec::new();
        let conditions: Vec<&Expr> = self.skip_conditions.iter().map(|(_, c)| *c).collect();
        for (index, condition) in conditions.into_iter().enumerate() {
            self.push_number(index as f64);
            self.call_builtin("skip is", 1, true);
            let other = self.emit(Op::JumpIfFalse(0));
            self.condition(condition);
            let not_yet = self.emit(Op::JumpIfFalse(0));
            stops.push(self.emit(Op::Jump(0)));
            self.land(other);
            self.land(not_yet);
        }
        self.emit(Op::LoadLocal(held));
        self.call_builtin("move over", 1, true);
        let moving = self.emit(Op::JumpIfFalse(0));
        self.jump(label);
        self.land(moving);
        self.emit(Op::Block(again));
        for stop in stops {
            self.land(stop);
        }
        if let Some((item, value)) = keep {
            self.demand(value, &[Known::Position], "for PR");
            self.write(item, &|compiler| compiler.value(value));
        }
        self.call_builtin("move stop", 0, false);
    }
}

/// The output that an action switches, if that is what it does.
fn output(along: &Along) -> Option<(&Item, &Expr)> {
    match &along.action {
        Action::Assign(item, Change::Value(value))
            if matches!(
                item.kind,
                ItemKind::Do
                    | ItemKind::Ro
                    | ItemKind::Go
                    | ItemKind::Ao
                    | ItemKind::So
                    | ItemKind::Uo
            ) =>
        {
            Some((item, value))
        }
        _ => None,
    }
}

/// `P[3]`, `PR[R[1]]` as the messages of the move name it.
fn place_name(target: &Expr) -> String {
    match &target.kind {
        ExprKind::Item(item) => {
            let name = item.kind.name();
            match item.indexes.first().map(|i| &i.kind) {
                Some(ExprKind::Number { value, .. }) => format!("{name}[{value}]"),
                _ => format!("{name}[...]"),
            }
        }
        _ => "the target".into(),
    }
}
