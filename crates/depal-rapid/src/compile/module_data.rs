use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use depal_syntax::Diagnostic;
use depal_vm::{NamedDatum, Op, Routine as Lowered, SharedDatum, Value};

use super::scope::*;
use super::types::Type;
use crate::syntax::tree::*;

/// Module data with what is needed to compute their initial values.
pub(super) struct Declared<'x> {
    pub(super) module: usize,
    data: &'x Data,
    slot: u32,
    kind: Type,
}

/// Which initial values are computed, and which have been begun.
#[derive(Default)]
pub(super) struct Progress {
    done: BTreeSet<usize>,
    open: BTreeSet<usize>,
}
impl Compiler<'_> {
    pub(super) fn declare(&mut self, module: usize, local: bool, name: &Name, symbol: Symbol) {
        let scope = if module == 0 {
            &mut self.predefined
        } else if local {
            &mut self.module_scopes[module]
        } else {
            &mut self.task
        };
        if let Some(first) = scope.get(&name.key()) {
            let first = first.span();
            self.error(
                Diagnostic::error(
                    "RAPID0110",
                    name.span,
                    format!("{} is declared twice", name.text),
                )
                .secondary(first, "first declared here"),
            );
            return;
        }
        scope.insert(name.key(), symbol);
    }

    pub(super) fn module_data<'x>(&mut self, modules: &'x [Module]) -> Vec<Declared<'x>> {
        let mut declared = Vec::new();
        // Names first, so that sizes and values may use what is declared later.
        for (module, tree) in modules.iter().enumerate() {
            self.module = module;
            for data in &tree.data {
                let kind = self.resolve_type(&data.type_name);
                let slot = self.program.globals.len() as u32;
                self.program.globals.push(Value::Absent);
                self.program.global_names.push(data.name.text.clone());
                self.program.data.push(NamedDatum {
                    name: data.name.text.clone(),
                    module: match module {
                        0 => String::new(),
                        _ => tree.name.text.clone(),
                    },
                    kind: data.type_name.key(),
                    is_local: data.local,
                    is_persistent: data.storage == Storage::Pers,
                    is_constant: data.storage == Storage::Const,
                });
                let symbol = Symbol::Data(DataSymbol {
                    name: data.name.text.clone(),
                    slot: Slot::Global(slot),
                    kind: kind.clone(),
                    access: Access::Stored(data.storage),
                    optional: false,
                    span: data.name.span,
                    constant: constant_of(data),
                });
                self.declare(module, data.local, &data.name, symbol);
                declared.push(Declared {
                    module,
                    data,
                    slot,
                    kind,
                });
            }
        }
        for item in &mut declared {
            self.module = item.module;
            item.kind = self.array_type(item.kind.clone(), item.data);
            let kind = item.kind.clone();
            let scope = if item.module == 0 {
                &mut self.predefined
            } else if item.data.local {
                &mut self.module_scopes[item.module]
            } else {
                &mut self.task
            };
            if let Some(Symbol::Data(symbol)) = scope.get_mut(&item.data.name.key())
                && symbol.slot == Slot::Global(item.slot)
            {
                symbol.kind = kind.clone();
            }
            self.program.globals[item.slot as usize] = kind.default_value(&self.records);
            self.share(item, &kind);
        }
        declared
    }

    /// Notes what other tasks may have in common with this one: persistents that are neither LOCAL nor TASK.
    /// The name of a meeting point is that of its variable.
    fn share(&mut self, item: &Declared<'_>, kind: &Type) {
        let data = item.data;
        if data.type_name.key() == "syncident"
            && let Value::Record(fields) = &mut self.program.globals[item.slot as usize]
        {
            *fields = vec![Value::Str(data.name.key())];
        }
        let common = data.storage == Storage::Pers && !data.local && !data.of_task;
        if common && item.module > 0 && *kind != Type::Broken {
            self.program.shared.push(SharedDatum {
                name: data.name.text.clone(),
                kind: self.type_name(kind),
                global: item.slot,
                has_value: data.value.is_some(),
            });
        }
    }

    /// Initial values in an order in which each is there before it is used.
    pub(super) fn initial_values(&mut self, declared: &[Declared<'_>]) {
        self.body = Body::default();
        let by_slot: BTreeMap<u32, usize> = declared
            .iter()
            .enumerate()
            .map(|(i, d)| (d.slot, i))
            .collect();
        let mut progress = Progress::default();
        for index in 0..declared.len() {
            self.initial_value(declared, &by_slot, index, &mut progress, 0);
        }
        self.emit(Op::Return { value: false });
        let body = std::mem::take(&mut self.body);
        if body.code.len() > 1 {
            self.program.initializer = Some(self.program.routines.len() as u32);
            self.program.routines.push(Lowered {
                name: "(initial values)".into(),
                module: String::new(),
                line: 1,
                locals: body.locals,
                code: body.code,
                ..Lowered::default()
            });
        }
    }

    pub(super) fn initial_value(
        &mut self,
        declared: &[Declared<'_>],
        by_slot: &BTreeMap<u32, usize>,
        index: usize,
        progress: &mut Progress,
        depth: usize,
    ) {
        let item = &declared[index];
        if progress.done.contains(&index) {
            return;
        }
        if depth > 100 || !progress.open.insert(index) {
            self.error(Diagnostic::error(
                "RAPID0135",
                item.data.name.span,
                format!(
                    "the value of {} depends on itself, or on more than 100 others in a chain",
                    item.data.name.text
                ),
            ));
            return;
        }
        let Some(value) = &item.data.value else {
            progress.done.insert(index);
            if item.data.storage == Storage::Const {
                self.error(Diagnostic::error(
                    "RAPID0133",
                    item.data.name.span,
                    format!("the constant {} has no value", item.data.name.text),
                ));
            }
            return;
        };
        self.module = item.module;
        let mut names = Vec::new();
        names_in(value, &mut names);
        for name in names {
            if let Some(Symbol::Data(data)) = self.lookup(&name)
                && let Slot::Global(slot) = data.slot
            {
                self.initial_value(declared, by_slot, by_slot[&slot], progress, depth + 1);
            }
        }
        self.module = item.module;
        progress.done.insert(index);
        let begin = self.body.code.len();
        self.value(value, Some(&item.kind));
        if let [Op::Push(constant)] = &self.body.code[begin..] {
            if constant.is_present() {
                self.program.globals[item.slot as usize] = constant.clone();
            }
            self.body.code.truncate(begin);
        } else {
            self.emit(Op::StoreGlobal(item.slot));
        }
    }
}

/// The value of a constant that is no array.
pub(super) fn constant_of(data: &Data) -> Option<Rc<Expression>> {
    match (data.storage, &data.value) {
        (Storage::Const, Some(value)) if data.sizes.is_empty() => Some(Rc::new(value.clone())),
        _ => None,
    }
}

/// Keys of all names that an expression uses.
fn names_in(expression: &Expression, names: &mut Vec<String>) {
    match &expression.kind {
        ExpressionKind::Name(name) => names.push(name.to_lowercase()),
        ExpressionKind::Field(inner, _)
        | ExpressionKind::Negate(inner)
        | ExpressionKind::Not(inner) => names_in(inner, names),
        ExpressionKind::Index(inner, indexes) => {
            names_in(inner, names);
            for index in indexes {
                names_in(index, names);
            }
        }
        ExpressionKind::Call { arguments, .. } => {
            for argument in arguments {
                match argument {
                    Argument::Positional(value)
                    | Argument::Named {
                        value: Some(value), ..
                    } => names_in(value, names),
                    _ => {}
                }
            }
        }
        ExpressionKind::Aggregate(items) => {
            for item in items {
                names_in(item, names);
            }
        }
        ExpressionKind::Binary(_, left, right) => {
            names_in(left, names);
            names_in(right, names);
        }
        _ => {}
    }
}
