use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::scope::Compiler;
use super::types::*;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// The structure that components are given for: by its name, by what is expected, or by their names.
    pub(super) fn aggregate_type(
        &mut self,
        type_name: Option<&Name>,
        fields: &[AggregateField],
        expected: Option<&Type>,
    ) -> Type {
        if let Some(name) = type_name {
            return self.resolve_type(name);
        }
        if let Some(Type::Struc(_)) = expected {
            return expected.cloned().unwrap_or(Type::Broken);
        }
        let has = |key: &str| fields.iter().any(|f| f.name.text.eq_ignore_ascii_case(key));
        if (1..=6).any(|axis| has(&format!("a{axis}"))) {
            self.types.struc("E6AXIS")
        } else {
            self.types.struc("E6POS")
        }
    }

    /// Makes a record; components that are not given have no value.
    pub(super) fn aggregate(
        &mut self,
        type_name: Option<&Name>,
        fields: &[AggregateField],
        span: Span,
        expected: Option<&Type>,
    ) -> Type {
        let kind = self.aggregate_type(type_name, fields, expected);
        let Type::Struc(index) = kind else {
            if kind != Type::Broken {
                let got = self.type_name(&kind);
                self.error(Diagnostic::error(
                    "KRL0104",
                    span,
                    format!("{got} has no components"),
                ));
            }
            self.emit(Op::Push(Value::Unset));
            return Type::Broken;
        };
        let known = self.types.strucs[index].fields.clone();
        let mut given: Vec<Option<&AggregateField>> = vec![None; known.len()];
        for field in fields {
            let (at, _) = self.field(&kind, &field.name);
            let Some(place) = given.get_mut(at as usize) else {
                continue;
            };
            let is_it = known[at as usize].0.eq_ignore_ascii_case(&field.name.text);
            if is_it && let Some(first) = place.replace(field) {
                let (first, second) = (first.name.span, field.name.span);
                self.declare_once(Some(first), &field.name.text, second);
            }
        }
        for (field, (_, kind)) in given.into_iter().zip(&known) {
            if let Some(field) = field {
                self.value(&field.value, Some(kind));
            } else {
                let unset = self.types.unset(kind);
                self.emit(Op::Push(unset));
            }
        }
        self.emit(Op::MakeRecord(known.len() as u32));
        kind
    }
}
