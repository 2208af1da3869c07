use std::collections::BTreeMap;

use depal_vm::execution::RobotTask;
use depal_vm::system::LogKind;
use depal_vm::{SharingConflict, Value};

use crate::network::Network;
use crate::system::CabinetSystem;
use crate::{Cabinet, ControllerEvent};

/// A datum that tasks of a cabinet have in common.
#[derive(Debug, Clone)]
struct Datum {
    kind: String,
    value: Value,
    /// Whether a declaration gave the value.
    has_value: bool,
    /// Number of the task that declared it first.
    owner: usize,
}

/// The data that tasks have in common, by name.
#[derive(Debug, Clone, Default)]
pub(crate) struct SharedData {
    data: Vec<Datum>,
    by_name: BTreeMap<String, usize>,
    /// How many tasks have been connected.
    connected: usize,
}

impl SharedData {
    /// Whether tasks came that are not connected yet.
    pub fn lacks(&self, tasks: usize) -> bool {
        tasks > 1 && self.connected < tasks
    }
}

impl Cabinet {
    /// Connects the shared data of tasks that came since the last time. The first initial value of a datum counts.
    pub(crate) fn connect_shared(
        &mut self,
        tasks: &mut [Box<dyn RobotTask>],
        network: &mut dyn Network,
    ) {
        for index in self.shared.connected..tasks.len() {
            self.current = index;
            tasks[index].initialize(&mut CabinetSystem {
                cabinet: &mut *self,
                network: &mut *network,
            });
            let data = tasks[index].shared_data().to_vec();
            let mut shares = Vec::with_capacity(data.len());
            for (position, datum) in data.iter().enumerate() {
                let value = tasks[index].shared_value(position).cloned();
                let value = value.unwrap_or_default();
                let key = datum.name.to_lowercase();
                let Some(&place) = self.shared.by_name.get(&key) else {
                    let place = self.shared.data.len();
                    self.shared.by_name.insert(key, place);
                    self.shared.data.push(Datum {
                        kind: datum.kind.clone(),
                        value,
                        has_value: datum.has_value,
                        owner: index,
                    });
                    shares.push(Some(place));
                    continue;
                };
                let known = &mut self.shared.data[place];
                let first = self.tasks[known.owner].role.name.clone();
                let second = self.tasks[index].role.name.clone();
                let name = datum.name.clone();
                if known.kind != datum.kind {
                    let conflict = SharingConflict::Kind {
                        name,
                        first,
                        first_kind: known.kind.clone(),
                        second,
                        second_kind: datum.kind.clone(),
                    };
                    self.warn(tasks[index].as_ref(), &conflict);
                    shares.push(None);
                    continue;
                }
                shares.push(Some(place));
                if datum.has_value && !known.has_value {
                    (known.has_value, known.owner) = (true, index);
                    known.value = value;
                    self.hand_out(place, tasks, Some(index));
                } else {
                    let differs = datum.has_value && known.value != value;
                    let common = known.value.clone();
                    tasks[index].set_shared(position, common);
                    if differs {
                        let conflict = SharingConflict::Value {
                            name,
                            first,
                            second,
                        };
                        self.warn(tasks[index].as_ref(), &conflict);
                    }
                }
            }
            self.tasks[index].shares = shares;
        }
        self.shared.connected = tasks.len();
    }

    fn warn(&mut self, task: &dyn RobotTask, conflict: &SharingConflict) {
        self.fresh.push(ControllerEvent::Log {
            at: self.cursor,
            kind: LogKind::EventLog,
            location: task.location(),
            text: conflict.to_string(),
        });
    }

    /// Gives a shared datum to all connected tasks but one.
    fn hand_out(&self, place: usize, tasks: &mut [Box<dyn RobotTask>], but: Option<usize>) {
        let value = &self.shared.data[place].value;
        for (index, task) in tasks.iter_mut().enumerate() {
            if Some(index) == but {
                continue;
            }
            let shares = &self.tasks[index].shares;
            if let Some(position) = shares.iter().position(|share| *share == Some(place)) {
                task.set_shared(position, value.clone());
            }
        }
    }

    /// Carries what a task changed in its slice to the others.
    pub(crate) fn carry_shared(&mut self, from: usize, tasks: &mut [Box<dyn RobotTask>]) {
        for position in 0..self.tasks[from].shares.len() {
            let Some(place) = self.tasks[from].shares[position] else {
                continue;
            };
            let value = tasks[from].shared_value(position);
            let known = &mut self.shared.data[place].value;
            if let Some(value) = value
                && value != known
            {
                known.clone_from(value);
                self.looked.set(true);
                self.hand_out(place, tasks, Some(from));
            }
        }
    }
}
