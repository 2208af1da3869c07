use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::scope::Compiler;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn aggregate(
        &mut self,
        items: &[Expression],
        span: Span,
        expected: Option<&Type>,
    ) -> Type {
        let Some(expected) = expected.filter(|t| **t != Type::Any) else {
            self.error(
                Diagnostic::error(
                    "RAPID0123",
                    span,
                    "the type of this aggregate cannot be told here",
                )
                .help("assign it to declared data first"),
            );
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        };
        let (wanted, kinds, op): (usize, Vec<Type>, Op) = match expected {
            Type::Record(record) => {
                let kinds: Vec<Type> = self.records[*record]
                    .fields
                    .iter()
                    .map(|(_, kind)| kind.clone())
                    .collect();
                (kinds.len(), kinds, Op::MakeRecord(items.len() as u32))
            }
            Type::Array { element, sizes } => {
                let inner = if sizes.len() > 1 {
                    Type::Array {
                        element: element.clone(),
                        sizes: sizes[1..].to_vec(),
                    }
                } else {
                    (**element).clone()
                };
                let size = if sizes[0] == 0 { items.len() } else { sizes[0] };
                let op = Op::MakeArray(items.len() as u32);
                (size, vec![inner; items.len()], op)
            }
            Type::Broken => {
                self.emit(Op::Push(Value::Absent));
                return Type::Broken;
            }
            other => {
                let wanted = self.type_name(other);
                self.error(Diagnostic::error(
                    "RAPID0104",
                    span,
                    format!("expected {wanted}, found an aggregate"),
                ));
                self.emit(Op::Push(Value::Absent));
                return Type::Broken;
            }
        };
        if wanted != items.len() {
            let name = self.type_name(expected);
            self.error(Diagnostic::error(
                "RAPID0124",
                span,
                format!(
                    "{name} has {wanted} components, this aggregate has {}",
                    items.len()
                ),
            ));
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        }
        let begin = self.body.code.len();
        for (item, kind) in items.iter().zip(&kinds) {
            self.value(item, Some(kind));
        }
        let constant = self.body.code[begin..]
            .iter()
            .all(|op| matches!(op, Op::Push(_)));
        if constant && self.body.code.len() - begin == items.len() {
            let values: Vec<Value> = self
                .body
                .code
                .drain(begin..)
                .map(|op| match op {
                    Op::Push(value) => value,
                    _ => Value::Absent,
                })
                .collect();
            self.emit(Op::Push(match op {
                Op::MakeRecord(_) => Value::Record(values),
                _ => Value::Array(values),
            }));
        } else {
            self.emit(op);
        }
        expected.clone()
    }
}
