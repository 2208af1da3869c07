use std::collections::BTreeMap;
use std::sync::Arc;

use depal_arm::Arm;
use depal_frames::JointPositions;
use depal_time::{SimTime, TICK};
use depal_vm::execution::{RobotTask, Step};
use depal_vm::system::{Fault, ProgramLocation};

use crate::shared::SharedData;
use crate::system::CabinetSystem;
use crate::task::{TaskRecord, Tasks, overall};
use crate::{
    Cabinet, ControllerError, ControllerEvent, ControllerSpec, ControllerState, FreeSpec, Network,
    Signal, TaskRole,
};

/// A cabinet with its tasks.
pub struct Controller {
    cabinet: Cabinet,
    tasks: Tasks,
}

impl Controller {
    /// A cabinet without a task; the arm stands.
    pub fn new(spec: ControllerSpec) -> Result<Self, ControllerError> {
        Ok(Self {
            cabinet: Cabinet::new(spec)?,
            tasks: Tasks::new(),
        })
    }

    /// A cabinet for programs whose arm is not known: every target is reached.
    ///
    /// Its joint positions are not those of an arm: the first three are the flange position in metres, the
    /// last three its rotation vector. A move takes its distance by its programmed speed, without acceleration,
    /// or its largest joint difference by 180 degrees/s; corners are driven to their ends.
    pub fn without_arm(spec: FreeSpec) -> Result<Self, ControllerError> {
        Ok(Self {
            cabinet: Cabinet::without_arm(spec)?,
            tasks: Tasks::new(),
        })
    }

    /// Runs on from a saved cabinet, with its tasks as they were saved at the same time, in the same order.
    /// A task that is left out does not run on.
    pub fn resume(cabinet: Cabinet, tasks: impl IntoIterator<Item = Box<dyn RobotTask>>) -> Self {
        Self {
            cabinet,
            tasks: tasks.into_iter().collect(),
        }
    }

    /// The state without the tasks, to be cloned and saved.
    pub fn cabinet(&self) -> &Cabinet {
        &self.cabinet
    }

    /// Loads the task that moves the arm, in place of all that were loaded; it begins to run in the next cycle.
    pub fn set_task(&mut self, task: Box<dyn RobotTask>) {
        self.tasks.clear();
        self.cabinet.tasks.clear();
        self.cabinet.shared = SharedData::default();
        self.cabinet.meetings.clear();
        let name = task.location().task;
        self.add_task(TaskRole::motion(&name), task);
    }

    /// Loads one more task; it begins to run in the next cycle. Tasks run one after the other in each cycle, in the
    /// order in which they were added, each with the whole time of the cycle. What one changes of the data that
    /// they share is carried to the others behind its part of the cycle; of two initial values the first counts.
    pub fn add_task(&mut self, role: TaskRole, task: Box<dyn RobotTask>) {
        self.tasks.push(task);
        self.cabinet.tasks.push(TaskRecord::new(role));
        self.cabinet.state = overall(&self.cabinet.tasks);
    }

    /// Starts the tasks again that stopped themselves, behind the statements with which they did, as an operator
    /// does. Whether there were any. Moves that were dropped when they stopped are not made up for.
    pub fn restart(&mut self) -> bool {
        let mut any = false;
        for (record, task) in self.cabinet.tasks.iter_mut().zip(&mut self.tasks) {
            if matches!(record.state, ControllerState::Stopped(_)) && task.restart() {
                record.state = ControllerState::Running;
                any = true;
            }
        }
        self.cabinet.state = overall(&self.cabinet.tasks);
        any
    }

    /// Name and state of each task, in their order.
    pub fn task_states(&self) -> impl Iterator<Item = (&str, &ControllerState)> {
        let tasks = self.cabinet.tasks.iter();
        tasks.map(|task| (task.role.name.as_str(), &task.state))
    }

    /// One cycle, from `now` to `now` + [`TICK`]. Then drain [`poll_event`](Self::poll_event).
    pub fn tick(&mut self, now: SimTime, network: &mut dyn Network) {
        let end = now + TICK;
        self.cabinet.cursor = self.cabinet.cursor.max(now);
        self.cabinet.cycle_limit = end;
        // A move that ends within this cycle is seen by the program in the next one only.
        let moving = !self.cabinet.motion.is_resting(now);
        self.cabinet.looked.set(moving);
        self.cabinet.change_due(end);
        if self.cabinet.shared.lacks(self.tasks.len()) {
            self.cabinet.connect_shared(&mut self.tasks, network);
        }
        for index in 0..self.tasks.len() {
            let cabinet = &mut self.cabinet;
            cabinet.current = index;
            cabinet.cursor = cabinet.tasks[index].cursor.max(now);
            run_task(cabinet, self.tasks[index].as_mut(), end, network);
            cabinet.tasks[index].cursor = cabinet.cursor;
            if cabinet.tasks[index].role.moves_arm && !cabinet.motion.is_resting(cabinet.cursor) {
                // A move that begins and ends within this cycle is seen in the next one only.
                cabinet.looked.set(true);
            }
            cabinet.carry_shared(index, &mut self.tasks);
        }
        let cabinet = &mut self.cabinet;
        for fired in cabinet.motion.advance(now, end, &mut cabinet.fresh) {
            cabinet.looked.set(true);
            cabinet.pass(fired, end);
        }
        cabinet.cycle_end = end;
        cabinet.publish();
    }

    /// The next thing that happened; none when all is told. Ask after every [`tick`](Self::tick),
    /// [`set_input`](Self::set_input) and [`report_collision`](Self::report_collision).
    pub fn poll_event(&mut self) -> Option<ControllerEvent> {
        self.cabinet.events.pop_front()
    }

    /// Name of the controller.
    pub fn name(&self) -> &str {
        &self.cabinet.name
    }

    /// The arm, if there is one.
    pub fn arm(&self) -> Option<&Arc<Arm>> {
        self.cabinet.motion.arm()
    }

    /// Files of the program's folder, with what the program wrote.
    pub fn files(&self) -> &BTreeMap<String, Vec<u8>> {
        &self.cabinet.files
    }

    /// Whether nothing can ever happen unless the cell sets an input: all tasks that run waited at the end of the
    /// last cycle without a look at the clock or a socket, the arm stands and no signal change is to come.
    pub fn waits_for_ever(&self) -> bool {
        let cabinet = &self.cabinet;
        let waits = |task: &TaskRecord| task.waiting || task.state != ControllerState::Running;
        cabinet.state == ControllerState::Running
            && cabinet.tasks.iter().all(waits)
            && !cabinet.looked.get()
            && cabinet.later.is_empty()
            && cabinet.motion.is_resting(cabinet.cycle_end)
    }

    /// What the tasks do: running as long as one of them runs that is not in the background, then how they ended;
    /// a failure that stops all counts first.
    pub fn state(&self) -> &ControllerState {
        &self.cabinet.state
    }

    /// Where the program pointer of the first task stands; none without a task.
    pub fn location(&self) -> Option<ProgramLocation> {
        self.tasks.first().map(|task| task.location())
    }

    /// Joint positions at the end of the last cycle, radians.
    pub fn commanded_joints(&self) -> JointPositions {
        self.cabinet.motion.joints(self.cabinet.cycle_end)
    }

    /// Joint positions at the end of all queued moves, radians.
    pub fn planned_joints(&self) -> JointPositions {
        self.cabinet.motion.planned_joints()
    }

    /// Whether the arm stands and nothing is queued, at the end of the last cycle.
    pub fn is_standing(&self) -> bool {
        self.cabinet.motion.is_standing(self.cabinet.cycle_end)
    }

    /// Fly-by moves that became stops so far.
    pub fn corner_failures(&self) -> usize {
        self.cabinet.motion.corner_failures()
    }

    /// All signals by name.
    pub fn signals(&self) -> impl Iterator<Item = &Signal> {
        self.cabinet.signals.iter()
    }

    /// Value of a signal, input or output.
    pub fn signal(&self, name: &str) -> Result<f64, Fault> {
        self.cabinet.signals.get(name).map(|signal| signal.value)
    }

    /// Value of an output; an input is a [`Fault::SignalValue`].
    pub fn output(&self, name: &str) -> Result<f64, Fault> {
        let signal = self.cabinet.signals.get(name)?;
        if signal.spec.kind.is_input() {
            return Err(Fault::SignalValue {
                signal: name.to_owned(),
                message: "is an input, expected an output".to_owned(),
            });
        }
        Ok(signal.value)
    }

    /// The cell sets an input, at the end of the last cycle; the task sees it in the next one.
    pub fn set_input(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        let at = self.cabinet.cycle_end;
        self.cabinet.change(at, name, value, true)?;
        let edges = self.cabinet.fresh.drain(..);
        self.cabinet.events.extend(edges);
        Ok(())
    }

    /// The arm hit something: it brakes from the end of the last cycle on as hard as its limits allow,
    /// queued moves are dropped, and the task hears [`Fault::MotionSupervision`] with its current or next move.
    pub fn report_collision(&mut self, message: &str) {
        let cabinet = &mut self.cabinet;
        cabinet
            .motion
            .supervise(cabinet.cycle_end, message, &mut cabinet.fresh);
        cabinet.publish();
    }
}

/// Runs the task under way until it waits, ends, or the cycle is over.
fn run_task(
    cabinet: &mut Cabinet,
    task: &mut dyn RobotTask,
    end: SimTime,
    network: &mut dyn Network,
) {
    let own = cabinet.current;
    cabinet.tasks[own].waiting = false;
    while cabinet.tasks[own].state == ControllerState::Running && cabinet.cursor < end {
        let step = task.step(&mut CabinetSystem {
            cabinet: &mut *cabinet,
            network: &mut *network,
        });
        let at = cabinet.cursor;
        let (state, brakes) = match step {
            Step::Ran => {
                cabinet.cursor += cabinet.statement_cost;
                continue;
            }
            Step::Blocked => {
                cabinet.tasks[own].waiting = true;
                break;
            }
            // Queued moves are carried out, unless the program held them.
            Step::Finished => (
                ControllerState::Finished,
                cabinet
                    .motion
                    .is_held()
                    .then(|| "the program ended with its motion stopped".to_owned()),
            ),
            Step::Stopped(reason) => {
                let brakes = format!("the program stopped: {reason}");
                (ControllerState::Stopped(reason), Some(brakes))
            }
            Step::Failed(error) => {
                let brakes = format!("the program failed: {}", error.message);
                (ControllerState::Failed(error), Some(brakes))
            }
        };
        let role = cabinet.tasks[own].role.clone();
        let stops_all = role.stops_all && matches!(state, ControllerState::Failed(_));
        if let Some(reason) = brakes
            && (role.moves_arm || stops_all)
        {
            cabinet.motion.stop(at, &reason, &mut cabinet.fresh);
        }
        end_task(cabinet, own, state, network);
        if stops_all {
            for other in 0..cabinet.tasks.len() {
                if cabinet.tasks[other].state == ControllerState::Running {
                    let reason = format!("task {} failed", role.name);
                    end_task(cabinet, other, ControllerState::Stopped(reason), network);
                }
            }
        }
        cabinet.state = overall(&cabinet.tasks);
    }
}

/// Notes the end of a task and closes its sockets.
fn end_task(
    cabinet: &mut Cabinet,
    index: usize,
    state: ControllerState,
    network: &mut dyn Network,
) {
    let at = cabinet.cursor;
    cabinet.sockets.close_all(network, at, &cabinet.name, index);
    cabinet.tasks[index].state = state.clone();
    let task = cabinet.tasks[index].role.name.clone();
    cabinet
        .fresh
        .push(ControllerEvent::TaskEnded { at, task, state });
}
