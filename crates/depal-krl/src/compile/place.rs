use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, UnaryOp};

use super::scope::*;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// What the leftmost name of an expression means, if it is a name with components and indexes.
    pub(super) fn root(&self, expression: &Expression) -> Option<&Symbol> {
        match &expression.kind {
            ExpressionKind::Name(name) => self.lookup(&name.to_lowercase()),
            ExpressionKind::Field(inner, _) | ExpressionKind::Index(inner, _) => self.root(inner),
            _ => None,
        }
    }

    /// Whether an expression is a variable or a part of one.
    pub(super) fn is_place(&self, expression: &Expression) -> bool {
        matches!(self.root(expression), Some(Symbol::Data(_)))
    }

    pub(super) fn field(&mut self, kind: &Type, field: &Name) -> (u32, Type) {
        let Type::Struc(struc) = kind else {
            if *kind != Type::Broken {
                let got = self.type_name(kind);
                self.error(Diagnostic::error(
                    "KRL0113",
                    field.span,
                    format!("{got} has no components, so no {}", field.text),
                ));
            }
            return (0, Type::Broken);
        };
        let fields = &self.types.strucs[*struc].fields;
        if let Some(index) = fields
            .iter()
            .position(|(name, _)| name.eq_ignore_ascii_case(&field.text))
        {
            return (index as u32, fields[index].1.clone());
        }
        let names: Vec<String> = fields.iter().map(|(name, _)| name.clone()).collect();
        let struc = self.types.strucs[*struc].name.clone();
        self.error(
            Diagnostic::error(
                "KRL0113",
                field.span,
                format!("{struc} has no component {}", field.text),
            )
            .help(format!("it has {}", names.join(", "))),
        );
        (0, Type::Broken)
    }

    /// Puts the indexes that are given; how many, and the type of what they choose.
    pub(super) fn indexes(
        &mut self,
        kind: &Type,
        indexes: &[Option<Expression>],
        span: Span,
    ) -> (u32, Type) {
        let given: Vec<_> = indexes.iter().flatten().collect();
        let Type::Array { element, sizes } = kind else {
            if *kind != Type::Broken {
                let got = self.type_name(kind);
                self.error(Diagnostic::error(
                    "KRL0114",
                    span,
                    format!("{got} is no array"),
                ));
            }
            return (0, Type::Broken);
        };
        let trailing = indexes
            .iter()
            .rposition(Option::is_some)
            .map_or(0, |i| i + 1);
        if sizes.len() != indexes.len() || trailing != given.len() {
            self.error(Diagnostic::error(
                "KRL0114",
                span,
                format!(
                    "the array has {} dimensions, {} indexes are given",
                    sizes.len(),
                    indexes.len()
                ),
            ));
            return (0, Type::Broken);
        }
        for (index, size) in given.iter().zip(sizes) {
            let found = self.value(index, None);
            match found {
                Type::Real => {
                    self.emit(Op::Unary(UnaryOp::ToInteger));
                }
                found if found.is_number() => {}
                found => self.mismatch(index.span, &Type::Int, &found),
            }
            if let ExpressionKind::Integer(value) = index.kind
                && *size > 0
                && !(1..=*size as i64).contains(&value)
            {
                // The controller says so when the line runs.
                self.error(Diagnostic::warning(
                    "KRL0115",
                    index.span,
                    format!("the index {value} is outside 1..{size}"),
                ));
            }
        }
        let rest = sizes[given.len()..].to_vec();
        let kind = if rest.is_empty() {
            (**element).clone()
        } else {
            Type::Array {
                element: element.clone(),
                sizes: rest,
            }
        };
        (given.len() as u32, kind)
    }

    /// Puts a reference to data or a part of them.
    pub(super) fn place(&mut self, expression: &Expression) -> Type {
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
                let (count, kind) = self.indexes(&kind, indexes, expression.span);
                if count > 0 {
                    self.emit(Op::PlaceIndex(count));
                }
                kind
            }
            _ => {
                self.error(Diagnostic::error(
                    "KRL0108",
                    expression.span,
                    "a variable is needed here, not a value",
                ));
                Type::Broken
            }
        }
    }
}
