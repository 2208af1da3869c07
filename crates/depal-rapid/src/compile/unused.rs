use std::collections::BTreeSet;

use depal_syntax::Diagnostic;
use depal_vm::Op;

use super::scope::{Callee, Compiler, Symbol};
use crate::syntax::tree::Module;

/// Which module each global and each routine belongs to.
pub(super) struct Homes {
    pub(super) globals: Vec<usize>,
    pub(super) routines: Vec<usize>,
}

impl Compiler<'_> {
    /// Warns about modules that nothing uses, from where the task starts. A program that calls procedures by
    /// names which it computes may use any.
    pub(super) fn unused_modules(&mut self, modules: &[Module], homes: &Homes, entry: &str) {
        let Some(Symbol::Routine(entry)) = self.task.get(&entry.to_lowercase()) else {
            return;
        };
        let Callee::Routine(entry) = entry.callee else {
            return;
        };
        let events = &self.program.events;
        let lists = [&events.before_start, &events.on_stop, &events.on_restart];
        let events = lists.into_iter().flatten().map(|routine| *routine as usize);
        let mut open: Vec<usize> = events.chain([entry as usize]).collect();
        open.extend(self.program.initializer.map(|i| i as usize));
        let mut seen = BTreeSet::new();
        let mut used: BTreeSet<usize> = BTreeSet::new();
        while let Some(routine) = open.pop() {
            if !seen.insert(routine) {
                continue;
            }
            used.extend(homes.routines.get(routine));
            for op in &self.program.routines[routine].code {
                match op {
                    Op::Call { routine, .. } | Op::Connect(routine) => open.push(*routine as usize),
                    Op::LoadGlobal(slot) | Op::PlaceGlobal(slot) => {
                        used.extend(homes.globals.get(*slot as usize));
                    }
                    // Every initial value is stored; that is no use.
                    Op::StoreGlobal(slot) if homes.routines.get(routine).is_some() => {
                        used.extend(homes.globals.get(*slot as usize));
                    }
                    Op::CallByName { .. } => return,
                    _ => {}
                }
            }
        }
        for (index, module) in modules.iter().enumerate().skip(1) {
            let is_system = |name: &str| name.eq_ignore_ascii_case("SYSMODULE");
            if used.contains(&index)
                || module.routines.is_empty()
                || module.attributes.iter().any(|a| is_system(&a.text))
            {
                continue;
            }
            self.error(
                Diagnostic::warning(
                    "RAPID0120",
                    module.name.span,
                    format!("nothing of module {} is used", module.name.text),
                )
                .help("the task never gets there; leave the file out, or call what it has"),
            );
        }
    }
}
