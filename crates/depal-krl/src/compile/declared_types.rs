use depal_syntax::{Diagnostic, Span};

use super::data::is_configuration;
use super::program::Unit;
use super::scope::*;
use super::types::*;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// STRUC and ENUM of all modules: first the names, then what they consist of.
    pub(super) fn type_declarations(&mut self, units: &[Unit]) {
        let mut strucs = Vec::new();
        for (module, unit) in units.iter().enumerate() {
            for statement in unit_statements(unit) {
                let StatementKind::Declare(declaration) = &statement.kind else {
                    continue;
                };
                match declaration {
                    Declaration::Struc {
                        global,
                        name,
                        fields,
                    } => {
                        self.types.strucs.push(StrucType {
                            name: name.text.clone(),
                            fields: Vec::new(),
                            complete: false,
                            size: 0,
                            depth: 0,
                        });
                        let index = self.types.strucs.len() - 1;
                        self.declare_type(module, unit, *global, name, Type::Struc(index));
                        strucs.push((module, index, fields));
                    }
                    Declaration::Enum {
                        global,
                        name,
                        constants,
                    } => {
                        self.types.enums.push(EnumType {
                            name: name.text.clone(),
                            constants: constants.iter().map(|c| c.text.clone()).collect(),
                        });
                        let index = self.types.enums.len() - 1;
                        self.declare_type(module, unit, *global, name, Type::Enum(index));
                    }
                    _ => {}
                }
            }
        }
        self.complete_strucs(strucs);
    }

    /// Structures whose components are complete, until no more are; the rest contain themselves.
    fn complete_strucs(&mut self, mut open: Vec<(usize, usize, &Vec<(Name, DataItem)>)>) {
        loop {
            let before = open.len();
            let mut later = Vec::new();
            for (module, index, fields) in open {
                self.module = module;
                let waits = fields.iter().any(|(kind, _)| {
                    let kind = self.lookup_type(&kind.key());
                    matches!(kind, Some(Type::Struc(other)) if !self.types.strucs[other].complete)
                });
                if waits {
                    later.push((module, index, fields));
                } else {
                    self.complete_struc(index, fields);
                }
            }
            open = later;
            if open.is_empty() {
                return;
            }
            if open.len() == before {
                break;
            }
        }
        for (_, index, fields) in open {
            let name = self.types.strucs[index].name.clone();
            let span = fields.first().map_or(Span::default(), |f| f.0.span);
            self.error(Diagnostic::error(
                "KRL0118",
                span,
                format!("the structure {name} contains itself, or one that does"),
            ));
        }
    }

    fn complete_struc(&mut self, index: usize, fields: &[(Name, DataItem)]) {
        let mut complete = Vec::new();
        let (mut size, mut depth) = (0usize, 0);
        for (kind, item) in fields {
            let kind = self.item_type(kind, item);
            size = size.saturating_add(self.types.size(&kind));
            depth = depth.max(self.types.depth(&kind));
            complete.push((item.name.text.clone(), kind));
        }
        let struc = &mut self.types.strucs[index];
        struc.fields = complete;
        struc.complete = true;
        struc.size = size;
        struc.depth = depth + 1;
    }

    fn declare_type(&mut self, module: usize, unit: &Unit, global: bool, name: &Name, kind: Type) {
        let global = global || module == 0 || is_configuration(unit);
        let names = if global {
            &mut self.type_names
        } else {
            &mut self.module_types[module]
        };
        let earlier = names.insert(name.key(), (kind, name.span));
        // A program may declare again what is predefined.
        let earlier = earlier.map(|(_, span)| span).filter(|s| s.file != u32::MAX);
        self.declare_once(earlier, &name.text, name.span);
    }
}

/// All statements that may declare a type: data lists, and the top of routines.
fn unit_statements(unit: &Unit) -> impl Iterator<Item = &Statement> {
    unit.files.iter().flat_map(|(_, file)| {
        let bodies = file.routines.iter().flat_map(|r| r.body.iter());
        file.data.iter().chain(bodies)
    })
}
