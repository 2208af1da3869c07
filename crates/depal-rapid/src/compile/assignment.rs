use depal_syntax::{Diagnostic, Span};
use depal_vm::Op;

use super::place::is_place;
use super::scope::{Compiler, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn assign(&mut self, target: &Expression, value: &Expression) {
        if !is_place(target) {
            self.error(Diagnostic::error(
                "RAPID0108",
                target.span,
                "only variables can be assigned to",
            ));
            return;
        }
        if let ExpressionKind::Name(name) = &target.kind {
            let key = name.to_lowercase();
            if self.lookup(&key).is_none()
                && let Some((signal, kind)) = self.lookup_signal(&key)
            {
                self.error(
                    Diagnostic::error(
                        "RAPID0130",
                        target.span,
                        format!("{signal} is a signal and is not assigned to"),
                    )
                    .help(match kind {
                        crate::SignalKind::Go => format!("write SetGO {signal}, value;"),
                        _ => format!("write SetDO {signal}, value;"),
                    }),
                );
                return;
            }
            match self.lookup(&key).cloned() {
                Some(Symbol::Data(data)) => {
                    self.check_assignable(target);
                    self.value(value, Some(&data.kind));
                    self.check_value_type(&data.kind, target.span);
                    match data.slot {
                        Slot::Global(slot) => self.emit(Op::StoreGlobal(slot)),
                        Slot::Local(slot) => self.emit(Op::StoreLocal(slot)),
                    };
                    return;
                }
                Some(Symbol::Routine(_)) => {}
                None => {
                    let mut diagnostic = Diagnostic::error(
                        "RAPID0100",
                        target.span,
                        format!("there are no data named {name}"),
                    );
                    if let Some(near) = self.nearest(name, |s| matches!(s, Symbol::Data(_))) {
                        diagnostic = diagnostic.help(format!("did you mean {near}?"));
                    }
                    self.error(diagnostic);
                    self.value(value, None);
                    self.emit(Op::Pop);
                    return;
                }
            }
        }
        self.check_assignable(target);
        let kind = self.place(target);
        self.value(value, Some(&kind));
        self.check_value_type(&kind, target.span);
        self.emit(Op::StorePlace);
    }

    pub(super) fn check_value_type(&mut self, kind: &Type, span: Span) {
        if matches!(kind, Type::Socket | Type::Clock | Type::Raw) {
            let name = self.type_name(kind);
            let mut diagnostic = Diagnostic::error(
                "RAPID0131",
                span,
                format!("data of type {name} cannot be assigned"),
            );
            if *kind == Type::Raw {
                diagnostic = diagnostic.help("copy with CopyRawBytes");
            }
            self.error(diagnostic);
        }
    }
}
