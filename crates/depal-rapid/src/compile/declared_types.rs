use std::rc::Rc;

use depal_syntax::{Diagnostic, Span, nearest_name};

use super::scope::*;
use super::types::{REFUSED_TYPES, RecordType, Type, simple_type};
use crate::syntax::tree::*;

/// Largest array that a program may declare, in elements.
const ARRAY_LIMIT: f64 = 1_000_000.0;

impl Compiler<'_> {
    pub(super) fn records(&mut self, modules: &[Module]) {
        let mut declared = Vec::new();
        for (module, tree) in modules.iter().enumerate() {
            for record in &tree.records {
                let index = self.records.len();
                self.records.push(RecordType {
                    name: record.name.text.clone(),
                    fields: Vec::new(),
                });
                declared.push((module, record));
                let scope = if record.local {
                    &mut self.local_types[module]
                } else {
                    &mut self.types
                };
                let known = simple_type(&record.name.key()).is_some()
                    || scope.contains_key(&record.name.key());
                scope.insert(record.name.key(), Type::Record(index));
                if known {
                    self.error(Diagnostic::error(
                        "RAPID0110",
                        record.name.span,
                        format!("the type {} is declared twice", record.name.text),
                    ));
                }
            }
        }
        for (module, tree) in modules.iter().enumerate() {
            self.module = module;
            for alias in &tree.aliases {
                let kind = self.resolve_type(&alias.known);
                let scope = if alias.local {
                    &mut self.local_types[module]
                } else {
                    &mut self.types
                };
                scope.insert(alias.name.key(), kind);
            }
        }
        for (index, (module, record)) in declared.iter().enumerate() {
            self.module = *module;
            for (kind, name) in &record.fields {
                let resolved = self.resolve_type(kind);
                // Only records declared before may be components, so that no record holds itself.
                let resolved = match resolved {
                    Type::Record(inner) if inner >= index => {
                        self.error(Diagnostic::error(
                            "RAPID0132",
                            kind.span,
                            format!("{} must be declared before it is a component", kind.text),
                        ));
                        Type::Broken
                    }
                    other => other,
                };
                self.records[index]
                    .fields
                    .push((name.text.clone(), resolved));
            }
        }
    }

    pub(super) fn resolve_type(&mut self, name: &Name) -> Type {
        let key = name.key();
        if let Some(kind) = self.lookup_type(&key) {
            return kind;
        }
        if REFUSED_TYPES.contains(&key.as_str()) {
            self.error(Diagnostic::error(
                "RAPID0112",
                name.span,
                format!("the type {} is not simulated", name.text),
            ));
            return Type::Broken;
        }
        const SIMPLE: [&str; 13] = [
            "num",
            "dnum",
            "bool",
            "string",
            "rawbytes",
            "socketdev",
            "clock",
            "switch",
            "errnum",
            "signaldi",
            "signaldo",
            "signalgi",
            "signalgo",
        ];
        let names = SIMPLE
            .iter()
            .map(|s| (*s).to_owned())
            .chain(self.records.iter().map(|r| r.name.clone()));
        let mut diagnostic = Diagnostic::error(
            "RAPID0103",
            name.span,
            format!("there is no type named {}", name.text),
        );
        if let Some(near) = nearest_name(&name.text, names) {
            diagnostic = diagnostic.help(format!("did you mean {near}?"));
        }
        self.error(diagnostic);
        Type::Broken
    }

    pub(super) fn signature(&mut self, routine: &Routine) -> Signature {
        let parameters = routine
            .parameters
            .iter()
            .map(|parameter| {
                let element = self.resolve_type(&parameter.type_name);
                let kind = if parameter.dimensions == 0 {
                    element
                } else {
                    Type::Array {
                        element: Box::new(element),
                        sizes: vec![0; parameter.dimensions],
                    }
                };
                ParameterType {
                    name: parameter.name.text.clone(),
                    key: parameter.name.key(),
                    kind,
                    mode: parameter.mode,
                    optional: parameter.optional,
                    group: parameter.group,
                }
            })
            .collect();
        let result = match &routine.kind {
            RoutineKind::Function(kind) => Some(self.resolve_type(kind)),
            _ => None,
        };
        Signature {
            name: routine.name.text.clone(),
            parameters,
            result,
        }
    }

    pub(super) fn builtins(&mut self) {
        self.module = 0;
        for (heading, callee) in self.table.headings() {
            let signature = Rc::new(self.signature(heading));
            let symbol = Symbol::Routine(RoutineSymbol {
                signature,
                callee,
                span: Span::new(u32::MAX, 0, 0),
            });
            self.predefined.insert(heading.name.key(), symbol);
        }
    }

    pub(super) fn array_type(&mut self, element: Type, data: &Data) -> Type {
        if data.sizes.is_empty() {
            return element;
        }
        if data.sizes.len() > 3 {
            let span = data.name.span;
            self.error(Diagnostic::error(
                "RAPID0114",
                span,
                "an array has at most 3 dimensions",
            ));
            return Type::Broken;
        }
        let mut sizes = Vec::new();
        let mut total = 1.0;
        for size in &data.sizes {
            let value = self.constant(size, 0);
            total *= value.unwrap_or(1.0);
            match value {
                Some(value) if value >= 1.0 && value.fract() == 0.0 && total <= ARRAY_LIMIT => {
                    sizes.push(value as usize);
                }
                Some(value) => {
                    self.error(Diagnostic::error(
                        "RAPID0114",
                        size.span,
                        format!("{value} cannot be the size of an array"),
                    ));
                    return Type::Broken;
                }
                None => {
                    self.error(Diagnostic::error(
                        "RAPID0116",
                        size.span,
                        "the size of an array is a number or a constant",
                    ));
                    return Type::Broken;
                }
            }
        }
        Type::Array {
            element: Box::new(element),
            sizes,
        }
    }

    /// Value of a constant expression of numbers.
    pub(super) fn constant(&self, expression: &Expression, depth: usize) -> Option<f64> {
        if depth > 32 {
            return None;
        }
        match &expression.kind {
            ExpressionKind::Number { value, .. } => Some(*value),
            ExpressionKind::Negate(inner) => Some(-self.constant(inner, depth + 1)?),
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()) {
                Some(Symbol::Data(data)) => {
                    let value = data.constant.clone()?;
                    self.constant(&value, depth + 1)
                }
                Some(Symbol::Routine(_)) => None,
                None => crate::errors::ERRORS
                    .iter()
                    .find(|(error, _)| error.eq_ignore_ascii_case(name))
                    .map(|(_, number)| *number as f64),
            },
            ExpressionKind::Binary(operator, left, right) => {
                let (a, b) = (
                    self.constant(left, depth + 1)?,
                    self.constant(right, depth + 1)?,
                );
                match operator {
                    Operator::Add => Some(a + b),
                    Operator::Subtract => Some(a - b),
                    Operator::Multiply => Some(a * b),
                    Operator::Divide if b != 0.0 => Some(a / b),
                    Operator::Div if b != 0.0 => Some((a / b).trunc()),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}
