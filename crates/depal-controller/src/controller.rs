use std::collections::BTreeMap;
use std::sync::Arc;

use depal_arm::Arm;
use depal_frames::JointPositions;
use depal_time::{SimTime, TICK};
use depal_vm::execution::{RobotTask, Step};
use depal_vm::system::{Fault, ProgramLocation};

use crate::system::CabinetSystem;
use crate::{
    Cabinet, ControllerError, ControllerEvent, ControllerSpec, ControllerState, FreeSpec, Network,
    Signal,
};

/// A cabinet with its task.
pub struct Controller {
    cabinet: Cabinet,
    task: Option<Box<dyn RobotTask>>,
}

impl Controller {
    /// A cabinet without a task; the arm stands.
    pub fn new(spec: ControllerSpec) -> Result<Self, ControllerError> {
        Ok(Self {
            cabinet: Cabinet::new(spec)?,
            task: None,
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
            task: None,
        })
    }

    /// Runs on from a saved cabinet, with the task as it was saved at the same time.
    pub fn resume(cabinet: Cabinet, task: Option<Box<dyn RobotTask>>) -> Self {
        Self { cabinet, task }
    }

    /// The state without the task, to be cloned and saved.
    pub fn cabinet(&self) -> &Cabinet {
        &self.cabinet
    }

    /// Loads a task; it begins to run in the next cycle.
    pub fn set_task(&mut self, task: Box<dyn RobotTask>) {
        self.task = Some(task);
        self.cabinet.state = ControllerState::Running;
    }

    /// One cycle, from `now` to `now` + [`TICK`]. Then drain [`poll_event`](Self::poll_event).
    pub fn tick(&mut self, now: SimTime, network: &mut dyn Network) {
        let end = now + TICK;
        self.cabinet.cursor = self.cabinet.cursor.max(now);
        self.cabinet.cycle_limit = end;
        // A move that ends within this cycle is seen by the program in the next one only.
        let moving = !self.cabinet.motion.is_resting(now);
        self.cabinet.looked.set(moving);
        self.cabinet.waiting = false;
        self.cabinet.change_due(end);
        if let Some(task) = &mut self.task {
            run_task(&mut self.cabinet, task.as_mut(), end, network);
        }
        let cabinet = &mut self.cabinet;
        if !cabinet.motion.is_resting(cabinet.cursor) {
            // A move that begins and ends within this cycle is seen in the next one only.
            cabinet.looked.set(true);
        }
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

    /// Whether nothing can ever happen unless the cell sets an input: the task waited at the end of the last
    /// cycle without a look at the clock or a socket, the arm stands and no signal change is to come.
    pub fn waits_for_ever(&self) -> bool {
        let cabinet = &self.cabinet;
        cabinet.state == ControllerState::Running
            && cabinet.waiting
            && !cabinet.looked.get()
            && cabinet.later.is_empty()
            && cabinet.motion.is_resting(cabinet.cycle_end)
    }

    /// What the task does.
    pub fn state(&self) -> &ControllerState {
        &self.cabinet.state
    }

    /// Where the program pointer stands; none without a task.
    pub fn location(&self) -> Option<ProgramLocation> {
        self.task.as_ref().map(|task| task.location())
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

/// Runs the task until it waits, ends, or the cycle is over.
fn run_task(
    cabinet: &mut Cabinet,
    task: &mut dyn RobotTask,
    end: SimTime,
    network: &mut dyn Network,
) {
    while cabinet.state == ControllerState::Running && cabinet.cursor < end {
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
                cabinet.waiting = true;
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
        if let Some(reason) = brakes {
            cabinet.motion.stop(at, &reason, &mut cabinet.fresh);
        }
        cabinet.sockets.close_all(network, at, &cabinet.name);
        cabinet.state = state.clone();
        cabinet.fresh.push(ControllerEvent::TaskEnded { at, state });
    }
}
