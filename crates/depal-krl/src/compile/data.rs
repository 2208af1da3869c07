use depal_syntax::{Diagnostic, Span, nearest_name};
use depal_vm::{Reference, Root, Value};

use super::program::Unit;
use super::scope::*;
use super::types::*;
use crate::syntax::tree::*;

/// Most elements of an array, so that no text can exhaust the memory.
const ELEMENT_LIMIT: usize = 100_000;

/// Most structures and arrays inside each other.
const DEPTH_LIMIT: usize = 16;

impl Compiler<'_> {
    /// Data lists of all modules.
    pub(super) fn data(&mut self, units: &[Unit]) {
        for (module, unit) in units.iter().enumerate() {
            self.module = module;
            self.module_name.clone_from(&unit.name);
            for (_, file) in &unit.files {
                for statement in &file.data {
                    match &statement.kind {
                        StatementKind::Declare(declaration) => {
                            self.data_declaration(unit, declaration);
                        }
                        StatementKind::Assign { target, value } => {
                            self.initial_value(target, value);
                        }
                        StatementKind::Broken => {}
                        _ => self.error(Diagnostic::error(
                            "KRL0119",
                            statement.span,
                            "only declarations and initial values stand here",
                        )),
                    }
                }
            }
        }
    }

    fn data_declaration(&mut self, unit: &Unit, declaration: &Declaration) {
        match declaration {
            Declaration::Data {
                global,
                constant,
                type_name,
                items,
            } => {
                for item in items {
                    let kind = self.item_type(type_name, item);
                    let mut initial = if self.module == 0 && !item.sizes.is_empty() {
                        self.types.zero(&kind)
                    } else {
                        self.types.unset(&kind)
                    };
                    if let Some(value) = &item.value
                        && let Some(value) = self.constant(value, &kind)
                    {
                        initial = value;
                    }
                    let slot = self.data_slot(unit, item, &kind, initial);
                    let symbol = Symbol::Data(DataSymbol {
                        name: item.name.text.clone(),
                        slot: Slot::Global(slot),
                        kind,
                        constant: *constant,
                        span: item.name.span,
                    });
                    self.declare_in_module(unit, *global, &item.name, symbol);
                }
            }
            Declaration::Signal {
                global,
                name,
                from,
                to,
            } => {
                if let Some(signal) = self.signal_symbol(name, from, to.as_ref()) {
                    self.declare_in_module(unit, *global, name, Symbol::Signal(signal));
                }
            }
            Declaration::Struc { .. } | Declaration::Enum { .. } | Declaration::External { .. } => {
            }
        }
    }

    /// `$CONFIG.DAT` may declare what is predefined: it is the same variable then.
    fn data_slot(&mut self, unit: &Unit, item: &DataItem, kind: &Type, initial: Value) -> u32 {
        if is_configuration(unit)
            && let Some(Symbol::Data(data)) = self.predefined.get(&item.name.key())
            && data.kind == *kind
            && let Slot::Global(slot) = data.slot
        {
            self.program.globals[slot as usize] = initial;
            return slot;
        }
        self.new_global(&item.name.text, initial)
    }

    fn declare_in_module(&mut self, unit: &Unit, global: bool, name: &Name, symbol: Symbol) {
        let scope = if self.module == 0 {
            &mut self.predefined
        } else if global || is_configuration(unit) {
            &mut self.global
        } else {
            &mut self.module_scopes[self.module]
        };
        let earlier = scope.insert(name.key(), symbol).map(|s| s.span());
        self.declare_once(earlier, &name.text, name.span);
    }

    /// The type of a declared name with its sizes.
    pub(super) fn item_type(&mut self, type_name: &Name, item: &DataItem) -> Type {
        let element = self.resolve_type(type_name);
        let kind = self.sized(element, item);
        let (size, depth) = (self.types.size(&kind), self.types.depth(&kind));
        if size > ELEMENT_LIMIT || depth > DEPTH_LIMIT {
            self.error(Diagnostic::error(
                "KRL0114",
                item.name.span,
                format!(
                    "{} has {size} values in {depth} levels, at most {ELEMENT_LIMIT} in {DEPTH_LIMIT} fit",
                    item.name.text
                ),
            ));
            return Type::Broken;
        }
        kind
    }

    fn sized(&mut self, element: Type, item: &DataItem) -> Type {
        if item.sizes.is_empty() || element == Type::Broken {
            return element;
        }
        if item.sizes.len() > 3 {
            self.error(Diagnostic::error(
                "KRL0114",
                item.name.span,
                format!(
                    "{} has {} dimensions, at most 3 are possible",
                    item.name.text,
                    item.sizes.len()
                ),
            ));
            return Type::Broken;
        }
        let mut sizes = Vec::new();
        for size in &item.sizes {
            let Some(expression) = size else {
                // Without a size: a parameter, or a string with its initial value.
                sizes.push(match item.value.as_ref().map(|v| &v.kind) {
                    Some(ExpressionKind::Text(text)) => text.chars().count(),
                    _ => 0,
                });
                continue;
            };
            match self.constant(expression, &Type::Int) {
                Some(Value::Int(size)) if size >= 1 => sizes.push(size as usize),
                Some(_) => {
                    self.error(Diagnostic::error(
                        "KRL0114",
                        expression.span,
                        "the size of an array is an integer from 1",
                    ));
                    return Type::Broken;
                }
                None => return Type::Broken,
            }
        }
        Type::Array {
            element: Box::new(element),
            sizes,
        }
    }

    pub(crate) fn resolve_type(&mut self, name: &Name) -> Type {
        if let Some(kind) = self.lookup_type(&name.key()) {
            return kind;
        }
        let own = self.module_types.get(self.module).into_iter().flatten();
        let names = own
            .chain(&self.type_names)
            .map(|(key, _)| key.to_uppercase());
        let simple = ["INT", "REAL", "BOOL", "CHAR"].map(str::to_owned);
        let near = nearest_name(&name.text, names.chain(simple));
        let mut diagnostic = Diagnostic::error(
            "KRL0103",
            name.span,
            format!("there is no type named {}", name.text),
        );
        if let Some(near) = near {
            diagnostic = diagnostic.help(format!("did you mean {near}?"));
        }
        self.error(diagnostic);
        Type::Broken
    }

    /// `A[3]=5` in a data list.
    fn initial_value(&mut self, target: &Expression, value: &Expression) {
        let Some((reference, kind)) = self.constant_place(target) else {
            return;
        };
        let Some(value) = self.constant(value, &kind) else {
            return;
        };
        let Root::Global(slot) = reference.root else {
            return;
        };
        let mut place = self.program.globals.get_mut(slot as usize);
        for index in reference.path {
            place = match place {
                Some(Value::Record(items) | Value::Array(items)) => items.get_mut(index as usize),
                _ => None,
            };
        }
        if let Some(place) = place {
            *place = value;
        }
    }

    /// A variable of a data list or a part of it, with constant indexes.
    fn constant_place(&mut self, target: &Expression) -> Option<(Reference, Type)> {
        match &target.kind {
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()).cloned() {
                Some(Symbol::Data(data)) => {
                    let Slot::Global(slot) = data.slot else {
                        return None;
                    };
                    let root = Root::Global(slot);
                    Some((
                        Reference {
                            root,
                            path: Vec::new(),
                        },
                        data.kind,
                    ))
                }
                Some(_) => {
                    self.error(Diagnostic::error(
                        "KRL0108",
                        target.span,
                        format!("{name} is no variable of a data list"),
                    ));
                    None
                }
                None => {
                    self.unknown_name(name, target.span);
                    None
                }
            },
            ExpressionKind::Field(inner, field) => {
                let (mut reference, kind) = self.constant_place(inner)?;
                let (index, kind) = self.field(&kind, field);
                reference.path.push(index);
                Some((reference, kind))
            }
            ExpressionKind::Index(inner, indexes) => {
                let (mut reference, kind) = self.constant_place(inner)?;
                let Type::Array { element, sizes } = kind else {
                    self.error(Diagnostic::error(
                        "KRL0114",
                        target.span,
                        "this is no array",
                    ));
                    return None;
                };
                let given = indexes.iter().flatten().count();
                for (index, size) in indexes.iter().flatten().zip(&sizes) {
                    let value = self.constant(index, &Type::Int)?;
                    let value = value.as_number().unwrap_or(0.0);
                    if value < 1.0 || value > *size as f64 {
                        self.error(Diagnostic::error(
                            "KRL0114",
                            index.span,
                            format!("the index {value} is outside 1..{size}"),
                        ));
                        return None;
                    }
                    reference.path.push(value as u32 - 1);
                }
                let rest = sizes.get(given..).unwrap_or_default().to_vec();
                let kind = if rest.is_empty() {
                    *element
                } else {
                    Type::Array {
                        element,
                        sizes: rest,
                    }
                };
                Some((reference, kind))
            }
            _ => {
                self.error(Diagnostic::error(
                    "KRL0108",
                    target.span,
                    "a variable is needed here, not a value",
                ));
                None
            }
        }
    }

    pub(super) fn unknown_name(&mut self, name: &str, span: Span) {
        if super::system::REFUSED
            .iter()
            .any(|r| r.eq_ignore_ascii_case(name))
        {
            self.error(Diagnostic::error(
                "KRL0120",
                span,
                format!("the system variable {name} is not simulated"),
            ));
            return;
        }
        let mut diagnostic = Diagnostic::error("KRL0100", span, format!("{name} is not declared"));
        let near = self.nearest(name, |s| !matches!(s, Symbol::Routine(_)));
        diagnostic = match near {
            Some(near) => diagnostic.help(format!("did you mean {near}?")),
            None if name.starts_with('$') => {
                diagnostic.help("this system variable is not known here")
            }
            None => diagnostic.help(format!(
                "declare it, for instance DECL INT {name}, or DECL E6POS {name} for a point; is its .dat file given too?"
            )),
        };
        self.error(diagnostic);
    }
}

/// `$config.dat`: all its data are global.
pub(super) fn is_configuration(unit: &Unit) -> bool {
    unit.name.eq_ignore_ascii_case("$config")
}
