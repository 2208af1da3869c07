use depal_syntax::Diagnostic;
use depal_vm::Op;

use super::scope::*;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn assign(&mut self, target: &Expression, value: &Expression) {
        if self.assign_live(target, value) {
            return;
        }
        match self.root(target).cloned() {
            Some(Symbol::Data(data)) => {
                if data.constant {
                    self.error(
                        Diagnostic::error(
                            "KRL0109",
                            target.span,
                            format!("{} is a constant", data.name),
                        )
                        .secondary(data.span, "declared here"),
                    );
                }
                if data.name.eq_ignore_ascii_case("$cycflag") {
                    self.error(Diagnostic::warning(
                        "KRL0131",
                        target.span,
                        "the condition of a cyclic flag is computed once, here",
                    ));
                }
                self.store(target, &data, value);
            }
            Some(Symbol::Routine(routine)) => {
                let name = routine.signature.name.clone();
                self.error(
                    Diagnostic::error(
                        "KRL0111",
                        target.span,
                        format!("{name} is a routine, not data"),
                    )
                    .secondary(routine.span, "declared here"),
                );
            }
            _ => {
                self.place(target);
                self.emit(Op::Pop);
            }
        }
    }

    pub(super) fn store(&mut self, target: &Expression, data: &DataSymbol, value: &Expression) {
        if let (ExpressionKind::Name(_), false) = (
            &target.kind,
            matches!(data.kind, Type::Struc(_) | Type::Array { .. }),
        ) {
            self.value(value, Some(&data.kind));
            match data.slot {
                Slot::Global(slot) => self.emit(Op::StoreGlobal(slot)),
                Slot::Local(slot) => self.emit(Op::StoreLocal(slot)),
            };
            return;
        }
        let kind = self.place(target);
        if let (ExpressionKind::Name(name), Type::Array { .. }) = (&target.kind, &kind) {
            self.error(
                Diagnostic::error("KRL0114", target.span, format!("{name} is an array"))
                    .help(format!("write {name}[] for the whole array")),
            );
        }
        self.value(value, Some(&kind));
        if kind.is_text() {
            self.emit_builtin("assign text", 2, false);
        } else if matches!(value.kind, ExpressionKind::Aggregate { .. }) {
            self.emit_builtin("assign partly", 2, false);
        } else {
            self.emit(Op::StorePlace);
        }
    }
}
