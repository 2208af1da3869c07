use crate::configuration::{ConfigurationError, Entry, entries, required};

/// A task of the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskSpec {
    /// Its name, `T_ROB1`.
    pub name: String,
    /// The procedure that it starts.
    pub entry: String,
    /// Whether it moves the robot.
    pub moves_robot: bool,
    /// Whether it begins with the controller and cannot be stopped (`STATIC` and `SEMISTATIC`).
    pub is_background: bool,
    /// Whether its failure stops the tasks of the production, too (all of -TrustLevel but `NoSafety`).
    pub stops_all: bool,
}

/// A module that a task loads by itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskModule {
    /// Its file as the controller names it.
    pub file: String,
    /// The task; empty for every task.
    pub task: String,
}

/// A routine that runs when something happens to the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EventRoutine {
    /// `POWER_ON`, `START`, `STOP`, `RESET`, `RESTART`, `STEP`.
    pub event: String,
    /// The procedure.
    pub routine: String,
    /// The task; empty for every task.
    pub task: String,
    /// Its place among those of the same event.
    pub order: i32,
}

/// What a controller backup's SYS.cfg says about tasks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SysConfiguration {
    /// The tasks of `CAB_TASKS`.
    pub tasks: Vec<TaskSpec>,
    /// The modules of `CAB_TASK_MODULES`.
    pub modules: Vec<TaskModule>,
    /// The event routines of `CAB_EXEC_HOOKS`, in their order.
    pub events: Vec<EventRoutine>,
    /// How often a statement may be retried (`NoOfRetry` of `SYS_MISC`).
    pub retry_limit: Option<u32>,
}

impl SysConfiguration {
    /// Reads the text of a SYS.cfg. Other sections are passed over.
    ///
    /// # Errors
    /// All entries that cannot be understood.
    pub fn parse(text: &str) -> Result<Self, Vec<ConfigurationError>> {
        let mut read = Self::default();
        let mut errors = Vec::new();
        for entry in entries(text, "SYS")? {
            let result = match entry.section.as_str() {
                "CAB_TASKS" => task(&entry).and_then(|task| {
                    if read.task(&task.name).is_some() {
                        return Err(format!("task {} is defined twice", task.name));
                    }
                    read.tasks.push(task);
                    Ok(())
                }),
                "CAB_TASK_MODULES" => module(&entry).map(|module| read.modules.push(module)),
                "CAB_EXEC_HOOKS" => event(&entry).map(|event| read.events.push(event)),
                "SYS_MISC" => retry_limit(&entry).map(|limit| {
                    if limit.is_some() {
                        read.retry_limit = limit;
                    }
                }),
                _ => Ok(()),
            };
            if let Err(message) = result {
                errors.push(ConfigurationError {
                    line: entry.line,
                    message,
                });
            }
        }
        read.events.sort_by_key(|event| event.order);
        if errors.is_empty() {
            Ok(read)
        } else {
            Err(errors)
        }
    }

    /// The task of this name, without regard to case.
    pub fn task(&self, name: &str) -> Option<&TaskSpec> {
        self.tasks
            .iter()
            .find(|task| task.name.eq_ignore_ascii_case(name))
    }

    /// The task that moves the robot: the one that says so, else the first that is no background task.
    pub fn motion_task(&self) -> Option<&TaskSpec> {
        let moves = |task: &&TaskSpec| task.moves_robot;
        let normal = |task: &&TaskSpec| !task.is_background;
        self.tasks
            .iter()
            .find(moves)
            .or_else(|| self.tasks.iter().find(normal))
    }

    /// The procedures of a task for an event, in their order.
    pub fn routines(&self, event: &str, task: &str) -> Vec<&EventRoutine> {
        self.events
            .iter()
            .filter(|e| e.event.eq_ignore_ascii_case(event))
            .filter(|e| e.task.is_empty() || e.task.eq_ignore_ascii_case(task))
            .collect()
    }
}

fn text(entry: &Entry, key: &str) -> String {
    entry.fields.get(key).cloned().unwrap_or_default()
}

fn task(entry: &Entry) -> Result<TaskSpec, String> {
    let name = required(entry, "Name")?.to_owned();
    let kind = text(entry, "type").to_uppercase();
    let is_background = match kind.as_str() {
        // Without a type a task is static.
        "STATIC" | "SEMISTATIC" | "" => true,
        "NORMAL" => false,
        other => {
            return Err(format!(
                "task {name}: -Type is {other}, expected NORMAL, STATIC or SEMISTATIC"
            ));
        }
    };
    let entry_routine = text(entry, "entry");
    Ok(TaskSpec {
        name,
        entry: if entry_routine.is_empty() {
            "main".to_owned()
        } else {
            entry_routine
        },
        moves_robot: entry.fields.contains_key("motiontask"),
        stops_all: !is_background || !text(entry, "trustlevel").eq_ignore_ascii_case("NoSafety"),
        is_background,
    })
}

fn module(entry: &Entry) -> Result<TaskModule, String> {
    Ok(TaskModule {
        file: required(entry, "File")?.to_owned(),
        task: text(entry, "task"),
    })
}

fn event(entry: &Entry) -> Result<EventRoutine, String> {
    const EVENTS: [&str; 6] = ["POWER_ON", "START", "STOP", "RESET", "RESTART", "STEP"];
    let event = required(entry, "Shelf")
        .or_else(|_| required(entry, "Event"))
        .map_err(|_| "the CAB_EXEC_HOOKS entry has no -Shelf".to_owned())?;
    let key = event.to_uppercase().replace([' ', '-'], "_");
    let Some(event) = EVENTS
        .into_iter()
        .find(|known| key == *known || key.replace('_', "") == known.replace('_', ""))
    else {
        return Err(format!(
            "the event is {event}, expected one of {}",
            EVENTS.join(", ")
        ));
    };
    let order = text(entry, "orderno");
    let order = if order.is_empty() {
        0
    } else {
        order
            .parse()
            .map_err(|_| format!("-OrderNo is {order:?}, expected a number"))?
    };
    Ok(EventRoutine {
        event: event.to_owned(),
        routine: required(entry, "Routine")?.to_owned(),
        task: text(entry, "task"),
        order,
    })
}

fn retry_limit(entry: &Entry) -> Result<Option<u32>, String> {
    if !text(entry, "name").eq_ignore_ascii_case("NoOfRetry") {
        return Ok(None);
    }
    let value = required(entry, "Value")?;
    value
        .parse()
        .map(Some)
        .map_err(|_| format!("NoOfRetry is {value:?}, expected a number"))
}
