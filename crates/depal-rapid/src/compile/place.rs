use depal_syntax::{Diagnostic, Span};
use depal_vm::Op;

use super::scope::{Compiler, DataSymbol, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// A component of what a function returned.
    pub(super) fn part_of_value(&mut self, expression: &Expression) -> Type {
        match &expression.kind {
            ExpressionKind::Field(inner, field) => {
                let kind = self.any_value(inner, None);
                let (index, kind) = self.field(&kind, field);
                self.emit(Op::Field(index));
                kind
            }
            ExpressionKind::Index(inner, indexes) => {
                let kind = self.any_value(inner, None);
                let kind = self.indexes(&kind, indexes, expression.span);
                self.emit(Op::Index(indexes.len() as u32));
                kind
            }
            _ => self.any_value(expression, None),
        }
    }

    pub(super) fn field(&mut self, kind: &Type, field: &Name) -> (u32, Type) {
        let Type::Record(record) = kind else {
            if *kind != Type::Broken {
                let got = self.type_name(kind);
                self.error(Diagnostic::error(
                    "RAPID0113",
                    field.span,
                    format!("{got} has no components, so no {}", field.text),
                ));
            }
            return (0, Type::Broken);
        };
        let fields = &self.records[*record].fields;
        if let Some(index) = fields
            .iter()
            .position(|(name, _)| name.eq_ignore_ascii_case(&field.text))
        {
            return (index as u32, fields[index].1.clone());
        }
        let names: Vec<String> = fields.iter().map(|(name, _)| name.clone()).collect();
        let record = self.records[*record].name.clone();
        self.error(
            Diagnostic::error(
                "RAPID0113",
                field.span,
                format!("{record} has no component {}", field.text),
            )
            .help(format!("it has {}", names.join(", "))),
        );
        (0, Type::Broken)
    }

    pub(super) fn indexes(&mut self, kind: &Type, indexes: &[Expression], span: Span) -> Type {
        for index in indexes {
            let found = self.value(index, None);
            if !found.is_number() {
                self.mismatch(index.span, &Type::Num, &found);
            }
        }
        match kind {
            Type::Array { element, sizes } => {
                if sizes.len() != indexes.len() {
                    self.error(Diagnostic::error(
                        "RAPID0114",
                        span,
                        format!(
                            "the array has {} dimensions, {} indexes are given",
                            sizes.len(),
                            indexes.len()
                        ),
                    ));
                    return Type::Broken;
                }
                for (index, size) in indexes.iter().zip(sizes) {
                    if let ExpressionKind::Number { value, .. } = index.kind
                        && *size > 0
                        && !(1.0..=*size as f64).contains(&value.round())
                    {
                        self.error(Diagnostic::error(
                            "RAPID0114",
                            index.span,
                            format!("the index {value} is outside 1..{size}"),
                        ));
                    }
                }
                (**element).clone()
            }
            Type::Broken => Type::Broken,
            other => {
                let got = self.type_name(other);
                self.error(Diagnostic::error(
                    "RAPID0114",
                    span,
                    format!("{got} is no array"),
                ));
                Type::Broken
            }
        }
    }

    /// Puts a reference to data or a part of them.
    pub(crate) fn place(&mut self, expression: &Expression) -> Type {
        match &expression.kind {
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()).cloned() {
                Some(Symbol::Data(data)) => {
                    match data.slot {
                        Slot::Global(slot) => self.emit(Op::PlaceGlobal(slot)),
                        Slot::Local(slot) => self.emit(Op::PlaceLocal(slot)),
                    };
                    data.kind
                }
                _ => self.name_value(name, expression.span),
            },
            ExpressionKind::Field(inner, field) => {
                let kind = self.place(inner);
                let (index, kind) = self.field(&kind, field);
                self.emit(Op::PlaceField(index));
                kind
            }
            ExpressionKind::Index(inner, indexes) => {
                let kind = self.place(inner);
                let kind = self.indexes(&kind, indexes, expression.span);
                self.emit(Op::PlaceIndex(indexes.len() as u32));
                kind
            }
            _ => {
                self.error(Diagnostic::error(
                    "RAPID0108",
                    expression.span,
                    "a variable is needed here, not a value",
                ));
                Type::Broken
            }
        }
    }

    /// The data that a place is part of.
    pub(crate) fn root_data(&self, expression: &Expression) -> Option<DataSymbol> {
        match &expression.kind {
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()) {
                Some(Symbol::Data(data)) => Some(data.clone()),
                _ => None,
            },
            ExpressionKind::Field(inner, _) | ExpressionKind::Index(inner, _) => {
                self.root_data(inner)
            }
            _ => None,
        }
    }
}

/// Data, or components and elements of them.
pub(crate) fn is_place(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Name(_) => true,
        ExpressionKind::Field(inner, _) | ExpressionKind::Index(inner, _) => is_place(inner),
        _ => false,
    }
}
