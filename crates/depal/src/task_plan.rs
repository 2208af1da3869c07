//! Which tasks a program consists of, and what each is, out of its files and the controller's SYS.cfg.

use std::sync::Arc;

use depal_controller::{SysConfiguration, TaskRole, TaskSpec};
use depal_rapid::{Loaded, SignalDefinition, TaskEntry, TaskEvent};
use depal_vm::{Machine, Program, SourceFile};

use crate::diagnostics::tell_all;
use crate::failure::Failure;
use crate::task_folder::{TaskFiles, sources};

/// Events before the entry, in the order in which a controller has them when it is switched on, its program is
/// set to the beginning and started.
const BEFORE_START: [&str; 3] = ["POWER_ON", "RESET", "START"];

/// A task before it is loaded.
pub struct TaskPlan {
    /// What it is to the cabinet.
    pub role: TaskRole,
    /// The procedure that it starts.
    pub entry: String,
    /// Its modules.
    pub sources: Vec<SourceFile>,
}

/// The tasks in the order in which they run: the one that moves the robot first, then by number.
pub fn plan(
    files: &TaskFiles,
    system: &SysConfiguration,
    only: Option<usize>,
) -> Result<Vec<TaskPlan>, Failure> {
    let main = system.motion_task();
    if files.tasks.is_empty() {
        let modules = sources(&files.modules)?;
        return Ok(vec![TaskPlan::new(main, "T_ROB1", modules, true)]);
    }
    let alone = files.tasks.len() == 1;
    let mut plans = Vec::new();
    for task in &files.tasks {
        let told = files.task_names.get(&task.number);
        let named = told.and_then(|name| system.task(name));
        let counted = system.tasks.get(task.number.saturating_sub(1));
        let spec = match (told, only) {
            (Some(_), _) => named,
            (None, None) if alone => main,
            (None, _) => counted,
        };
        if spec.is_none() && !alone && only.is_none() && task.number != 1 {
            tell!(
                "note: RAPID/TASK{} is left out: SYS.cfg names no such task",
                task.number
            );
            continue;
        }
        let mut modules = sources(&task.modules)?;
        let moves = alone || spec.is_none() || spec.map(|s| &s.name) == main.map(|s| &s.name);
        if moves {
            // Modules given beside the backup belong to the task that moves the robot.
            modules.extend(sources(&files.modules)?);
        }
        let name = told.map_or("T_ROB1", String::as_str);
        plans.push(TaskPlan::new(spec, name, modules, moves));
    }
    plans.sort_by_key(|plan| !plan.role.moves_arm);
    Ok(plans)
}

impl TaskPlan {
    fn new(spec: Option<&TaskSpec>, name: &str, sources: Vec<SourceFile>, moves: bool) -> Self {
        let role = TaskRole {
            moves_arm: moves || spec.is_some_and(|spec| spec.moves_robot),
            is_background: !moves && spec.is_some_and(|spec| spec.is_background),
            stops_all: spec.is_none_or(|spec| spec.stops_all),
            ..TaskRole::motion(spec.map_or(name, |spec| &spec.name))
        };
        Self {
            role,
            entry: spec.map_or("main", |spec| &spec.entry).to_owned(),
            sources,
        }
    }

    /// Loads the program of the task; the signals that it made, if it may make some.
    pub fn load(
        &self,
        system: &SysConfiguration,
        known: &[SignalDefinition],
        auto_signals: bool,
    ) -> (Loaded, Vec<SignalDefinition>) {
        let mut entry = TaskEntry::new(&self.entry);
        let events = BEFORE_START.map(|event| (event, TaskEvent::BeforeStart));
        let others = [("STOP", TaskEvent::Stop), ("RESTART", TaskEvent::Restart)];
        for (event, moment) in events.into_iter().chain(others) {
            for routine in system.routines(event, &self.role.name) {
                // A routine for all tasks need not be in those of the background.
                let needed = !routine.task.is_empty() || self.role.moves_arm;
                entry.events.push((moment, &routine.routine, needed));
            }
        }
        if auto_signals {
            depal_rapid::load_with_auto_signals(&self.sources, known, &entry)
        } else {
            let loaded = depal_rapid::load_task(&self.sources, known, &entry);
            (loaded, Vec::new())
        }
    }

    /// The machine that runs it: a task of the background begins anew when its entry returns.
    pub fn machine(&self, program: Arc<Program>) -> Machine {
        let machine = Machine::new(program, &self.role.name);
        if self.role.is_background {
            machine.cyclic()
        } else {
            machine.single_cycle()
        }
    }

    /// Tells what was found in the program.
    pub fn tell(&self, loaded: &Loaded) {
        tell_all(&loaded.diagnostics, &self.sources);
    }
}
