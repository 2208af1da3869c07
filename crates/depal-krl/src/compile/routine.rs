use std::collections::BTreeMap;
use std::rc::Rc;

use depal_syntax::Diagnostic;
use depal_vm::{Op, Value};

use super::program::Unit;
use super::scope::*;
use super::types::Type;
use crate::syntax::tree::*;

/// All declarations of a routine, wherever they stand in it.
fn declarations<'a>(statements: &'a [Statement], found: &mut Vec<&'a Declaration>) {
    for statement in statements {
        match &statement.kind {
            StatementKind::Declare(declaration) => found.push(declaration),
            StatementKind::If {
                body, otherwise, ..
            } => {
                declarations(body, found);
                declarations(otherwise.as_deref().unwrap_or_default(), found);
            }
            StatementKind::For { body, .. }
            | StatementKind::While { body, .. }
            | StatementKind::Repeat { body, .. }
            | StatementKind::Loop(body) => declarations(body, found),
            StatementKind::Switch { cases, default, .. } => {
                for (_, body) in cases {
                    declarations(body, found);
                }
                declarations(default.as_deref().unwrap_or_default(), found);
            }
            _ => {}
        }
    }
}

impl Compiler<'_> {
    /// Names all routines; the first one of a file is known to all modules.
    pub(super) fn headings<'a>(&mut self, units: &'a [Unit]) -> Vec<(usize, &'a Routine, u32)> {
        let mut routines = Vec::new();
        for (module, unit) in units.iter().enumerate() {
            self.module = module;
            for (_, file) in &unit.files {
                for (position, routine) in file.routines.iter().enumerate() {
                    let signature = Rc::new(self.signature(routine));
                    let index = self.program.routines.len() as u32;
                    self.program.routines.push(depal_vm::Routine {
                        name: routine.name.text.clone(),
                        module: unit.name.clone(),
                        line: self.line(routine.name.span),
                        ..depal_vm::Routine::default()
                    });
                    let symbol = Symbol::Routine(RoutineSymbol {
                        signature,
                        callee: Callee::Routine(index),
                        span: routine.name.span,
                    });
                    let first = position == 0;
                    if first && !routine.name.text.eq_ignore_ascii_case(&unit.name) {
                        self.error(
                            Diagnostic::warning(
                                "KRL0132",
                                routine.name.span,
                                format!(
                                    "the first routine of the file {} is {}",
                                    unit.name, routine.name.text
                                ),
                            )
                            .help("the controller wants it to have the name of the file"),
                        );
                    }
                    let scope = if first || routine.global {
                        &mut self.global
                    } else {
                        &mut self.module_scopes[module]
                    };
                    let earlier = scope.insert(routine.name.key(), symbol);
                    let earlier = earlier.map(|s| s.span());
                    self.declare_once(earlier, &routine.name.text, routine.name.span);
                    routines.push((module, routine, index));
                }
            }
        }
        routines
    }

    fn signature(&mut self, routine: &Routine) -> Signature {
        let mut found = Vec::new();
        declarations(&routine.body, &mut found);
        let mut kinds: BTreeMap<String, (&Name, &DataItem)> = BTreeMap::new();
        for declaration in found {
            if let Declaration::Data {
                type_name, items, ..
            } = declaration
            {
                kinds.extend(
                    items
                        .iter()
                        .map(|item| (item.name.key(), (type_name, item))),
                );
            }
        }
        let parameters = routine.parameters.iter().map(|parameter| {
            let kind = if let Some((type_name, item)) = kinds.get(&parameter.name.key()) {
                self.item_type(type_name, item)
            } else {
                let name = &parameter.name;
                self.error(
                    Diagnostic::error(
                        "KRL0107",
                        name.span,
                        format!("the parameter {} has no type", name.text),
                    )
                    .help(format!("declare it in the routine: DECL INT {}", name.text)),
                );
                Type::Broken
            };
            ParameterType {
                name: parameter.name.text.clone(),
                kind,
                mode: parameter.mode.unwrap_or(Mode::Out),
                optional: false,
            }
        });
        let parameters = parameters.collect();
        let result = routine.result.as_ref().map(|(name, brackets)| {
            let kind = self.resolve_type(name);
            match (kind, brackets) {
                (Type::Char, true) => Type::text(0),
                (kind, _) => kind,
            }
        });
        Signature {
            name: routine.name.text.clone(),
            parameters,
            more: None,
            result,
            stops_advance: false,
        }
    }

    /// The signature made with the headings.
    fn signature_of(&self, routine: &Routine) -> Option<Rc<Signature>> {
        let own = self.module_scopes.get(self.module);
        let scopes = [own, Some(&self.global)];
        scopes
            .into_iter()
            .flatten()
            .find_map(|scope| match scope.get(&routine.name.key()) {
                Some(Symbol::Routine(symbol)) if symbol.span == routine.name.span => {
                    Some(Rc::clone(&symbol.signature))
                }
                _ => None,
            })
    }

    pub(super) fn routine(&mut self, routine: &Routine, index: u32) {
        // One that is declared twice was replaced by the second.
        let Some(signature) = self.signature_of(routine) else {
            return;
        };
        self.body = Body {
            result: signature.result.clone(),
            is_function: routine.result.is_some(),
            ..Body::default()
        };
        for (parameter, kind) in routine.parameters.iter().zip(&signature.parameters) {
            let slot = self.new_local(Value::Absent);
            self.declare_local(&parameter.name, kind.kind.clone(), slot, false);
        }
        self.local_declarations(routine);
        self.statements(&routine.body);
        if self.body.is_function {
            self.emit(Op::MissingReturn);
            self.check_returns(routine);
        } else {
            let end = self.line(routine.name.span);
            let _ = end;
            self.emit(Op::Return { value: false });
        }
        self.resolve_gotos();
        let body = std::mem::take(&mut self.body);
        let made = &mut self.program.routines[index as usize];
        made.locals = body.locals;
        made.code = body.code;
    }

    fn check_returns(&mut self, routine: &Routine) {
        let mut code = self.body.code.iter();
        if !code.any(|op| matches!(op, Op::Return { value: true })) {
            self.error(
                Diagnostic::warning(
                    "KRL0133",
                    routine.name.span,
                    format!("the function {} has no RETURN", routine.name.text),
                )
                .help("add RETURN and the value"),
            );
        }
    }

    fn local_declarations(&mut self, routine: &Routine) {
        let mut found = Vec::new();
        declarations(&routine.body, &mut found);
        for declaration in found {
            match declaration {
                Declaration::Data {
                    type_name,
                    items,
                    constant,
                    ..
                } => {
                    for item in items {
                        let mut parameters = routine.parameters.iter();
                        let is_parameter = parameters.any(|p| p.name.key() == item.name.key());
                        if is_parameter {
                            continue;
                        }
                        let kind = self.item_type(type_name, item);
                        let slot = self.new_local(self.types.unset(&kind));
                        self.declare_local(&item.name, kind, slot, *constant);
                    }
                }
                Declaration::Signal { name, from, to, .. } => {
                    if let Some(signal) = self.signal_symbol(name, from, to.as_ref()) {
                        let symbol = Symbol::Signal(signal);
                        let earlier = self.body.scope.insert(name.key(), symbol);
                        let earlier = earlier.map(|s| s.span());
                        self.declare_once(earlier, &name.text, name.span);
                    }
                }
                _ => {}
            }
        }
    }

    fn declare_local(&mut self, name: &Name, kind: Type, slot: u32, constant: bool) {
        let symbol = Symbol::Data(DataSymbol {
            name: name.text.clone(),
            slot: Slot::Local(slot),
            kind,
            constant,
            span: name.span,
        });
        let earlier = self.body.scope.insert(name.key(), symbol);
        let earlier = earlier.map(|s| s.span());
        self.declare_once(earlier, &name.text, name.span);
    }

    /// The first value of a variable, where it is declared.
    pub(super) fn local_value(&mut self, item: &DataItem) {
        let Some(value) = &item.value else { return };
        let target = Expression {
            kind: ExpressionKind::Name(item.name.text.clone()),
            span: item.name.span,
        };
        let Some(Symbol::Data(data)) = self.root(&target).cloned() else {
            return;
        };
        let target = match data.kind {
            Type::Array { ref sizes, .. } => Expression {
                span: target.span,
                kind: ExpressionKind::Index(Box::new(target), vec![None; sizes.len()]),
            },
            _ => target,
        };
        self.store(&target, &data, value);
    }
}
