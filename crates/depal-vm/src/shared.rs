use std::collections::BTreeMap;

use crate::{Program, Value};

/// A datum of a program that all tasks of a cabinet which declare one of its name and type have in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SharedDatum {
    /// As spelled in the source; case does not matter.
    pub name: String,
    /// Its type in the program's language, with the sizes of an array. Data of one name and two types are not shared.
    pub kind: String,
    /// Its slot.
    pub global: u32,
    /// Whether its declaration gives a value. One without takes that of another task.
    pub has_value: bool,
}

/// Two tasks that declare one datum differently.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SharingConflict {
    /// Two initial values: that of the task loaded first counts.
    #[error(
        "{name} has another initial value in task {second} than in task {first}, with which it is shared; the value of {first} counts"
    )]
    Value {
        /// The datum.
        name: String,
        /// The task loaded first.
        first: String,
        /// The other.
        second: String,
    },
    /// Two types: they are two data.
    #[error(
        "{name} is {second_kind} in task {second} and {first_kind} in task {first}: data of two types are not shared"
    )]
    Kind {
        /// The datum.
        name: String,
        /// The task loaded first.
        first: String,
        /// Its type there.
        first_kind: String,
        /// The other task.
        second: String,
        /// Its type there.
        second_kind: String,
    },
}

/// What tasks, in the order in which they are loaded, declare differently: as far as initial values are constants.
pub fn sharing_conflicts(tasks: &[(&str, &Program)]) -> Vec<SharingConflict> {
    let mut first: BTreeMap<String, (&str, &str, Option<&Value>)> = BTreeMap::new();
    let mut conflicts = Vec::new();
    for (task, program) in tasks {
        for datum in &program.shared {
            let value = program.globals.get(datum.global as usize);
            let value = value.filter(|_| datum.has_value);
            let Some((owner, kind, known)) = first.get_mut(&datum.name.to_lowercase()) else {
                let entry = (*task, datum.kind.as_str(), value);
                first.insert(datum.name.to_lowercase(), entry);
                continue;
            };
            let (name, second) = (datum.name.clone(), (*task).to_owned());
            if *kind != datum.kind {
                conflicts.push(SharingConflict::Kind {
                    name,
                    first: (*owner).to_owned(),
                    first_kind: (*kind).to_owned(),
                    second,
                    second_kind: datum.kind.clone(),
                });
            } else if known.is_none() {
                (*owner, *known) = (*task, value);
            } else if value.is_some() && value != *known {
                conflicts.push(SharingConflict::Value {
                    name,
                    first: (*owner).to_owned(),
                    second,
                });
            }
        }
    }
    conflicts
}
