use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use depal_arm::{Arm, Load};
use depal_frames::JointPositions;
use depal_motion::Trajectory;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, PathAction, SignalCheck};

use crate::free_motion::FreeMotion;
use crate::mechanism::Mechanism;
use crate::meeting::Meeting;
use crate::motion_queue::MotionQueue;
use crate::path_events::Fired;
use crate::shared::SharedData;
use crate::signals::SignalTable;
use crate::sockets::Sockets;
use crate::task::TaskRecord;
use crate::{
    ConfigurationData, ControllerError, ControllerEvent, ControllerState, CrossConnection,
    SignalFamily, SignalSpec,
};

/// What a cabinet is built from.
#[derive(Debug, Clone)]
pub struct ControllerSpec {
    /// Name of the controller, its address on the network side.
    pub name: String,
    /// The arm.
    pub arm: Arc<Arm>,
    /// Where it stands at the start, radians.
    pub start: JointPositions,
    /// What hangs on the flange, as it was told at commissioning: it counts where the program says nothing of its tool's
    /// load, and only for an arm with torque limits.
    pub mounted: Load,
    /// All signals.
    pub signals: Vec<SignalSpec>,
    /// Signals that need no definition.
    pub families: Vec<SignalFamily>,
    /// Simulated time of one statement.
    /// 20 us: about the 44 simple instructions per millisecond measured on a current cabinet, rounded up.
    pub statement_cost: SimDuration,
    /// Moves that may wait behind the one under way before the program has to wait.
    pub queue_depth: usize,
    /// Signals that follow others.
    pub connections: Vec<CrossConnection>,
    /// What the operator answers, in this order; without answers a question waits for ever.
    pub answers: VecDeque<String>,
    /// Files of the program's folder by their path in it.
    pub files: BTreeMap<String, Vec<u8>>,
    /// What its configuration files say.
    pub configuration: ConfigurationData,
}

impl ControllerSpec {
    /// A cabinet without signals and with nothing on the flange, 20 us per statement and 5 waiting moves.
    pub fn new(name: &str, arm: Arc<Arm>, start: JointPositions) -> Self {
        Self {
            name: name.to_owned(),
            arm,
            start,
            mounted: Load::NONE,
            signals: Vec::new(),
            families: Vec::new(),
            statement_cost: SimDuration::from_micros(20),
            queue_depth: 5,
            connections: Vec::new(),
            answers: VecDeque::new(),
            files: BTreeMap::new(),
            configuration: ConfigurationData::default(),
        }
    }

    /// A cabinet that moves no known arm but a mechanism which reaches every target; see
    /// [`Controller::without_arm`](crate::Controller::without_arm).
    pub fn without_arm(name: &str) -> FreeSpec {
        FreeSpec {
            name: name.to_owned(),
            signals: Vec::new(),
            families: Vec::new(),
            connections: Vec::new(),
            answers: VecDeque::new(),
            files: BTreeMap::new(),
            configuration: ConfigurationData::default(),
        }
    }
}

/// What a cabinet without an arm is built from. Statements cost 20 us, 5 moves may wait.
#[derive(Debug, Clone)]
pub struct FreeSpec {
    /// Name of the controller.
    pub name: String,
    /// All signals.
    pub signals: Vec<SignalSpec>,
    /// Signals that need no definition.
    pub families: Vec<SignalFamily>,
    /// Signals that follow others.
    pub connections: Vec<CrossConnection>,
    /// What the operator answers, in this order.
    pub answers: VecDeque<String>,
    /// Files of the program's folder by their path in it.
    pub files: BTreeMap<String, Vec<u8>>,
    /// What its configuration files say.
    pub configuration: ConfigurationData,
}

/// The whole state of a controller but for its tasks. A clone can be run on with
/// [`Controller::resume`](crate::Controller::resume).
#[derive(Debug, Clone)]
pub struct Cabinet {
    pub(crate) name: String,
    pub(crate) statement_cost: SimDuration,
    pub(crate) signals: SignalTable,
    pub(crate) sockets: Sockets,
    pub(crate) motion: Mechanism,
    /// Signal changes to come.
    pub(crate) later: Vec<(SimTime, String, f64)>,
    pub(crate) answers: VecDeque<String>,
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    pub(crate) configuration: ConfigurationData,
    /// Whether a task looked at the clock or polled a socket since this was last cleared.
    pub(crate) looked: Cell<bool>,
    /// What the tasks do together.
    pub(crate) state: ControllerState,
    pub(crate) tasks: Vec<TaskRecord>,
    /// Number of the task under way.
    pub(crate) current: usize,
    pub(crate) shared: SharedData,
    /// How often moves gave each notice.
    pub(crate) notices: BTreeMap<String, u64>,
    /// Where tasks wait for each other, by name in lower case.
    pub(crate) meetings: BTreeMap<String, Meeting>,
    /// End of the last cycle.
    pub(crate) cycle_end: SimTime,
    /// End of the cycle under way.
    pub(crate) cycle_limit: SimTime,
    /// When the next statement of the task under way begins.
    pub(crate) cursor: SimTime,
    /// Events of the cycle under way, unsorted.
    pub(crate) fresh: Vec<ControllerEvent>,
    pub(crate) events: VecDeque<ControllerEvent>,
}

impl Cabinet {
    pub(crate) fn new(spec: ControllerSpec) -> Result<Self, ControllerError> {
        if !spec.arm.within_limits(&spec.start) {
            return Err(ControllerError::StartJoints {
                arm: spec.arm.name().to_owned(),
                start_deg: spec.start.to_degrees(),
            });
        }
        if spec.statement_cost == SimDuration::ZERO {
            return Err(ControllerError::StatementCost);
        }
        let trajectory = Trajectory::new(Arc::clone(&spec.arm), spec.start);
        let queue = MotionQueue::new(trajectory, spec.queue_depth, spec.mounted);
        let motion = Mechanism::Arm(spec.arm, Box::new(queue));
        let parts = FreeSpec {
            name: spec.name,
            signals: spec.signals,
            families: spec.families,
            connections: spec.connections,
            answers: spec.answers,
            files: spec.files,
            configuration: spec.configuration,
        };
        Self::assemble(parts, motion, spec.statement_cost)
    }

    pub(crate) fn without_arm(spec: FreeSpec) -> Result<Self, ControllerError> {
        let motion = Mechanism::Free(FreeMotion::new(5));
        Self::assemble(spec, motion, SimDuration::from_micros(20))
    }

    fn assemble(
        spec: FreeSpec,
        motion: Mechanism,
        statement_cost: SimDuration,
    ) -> Result<Self, ControllerError> {
        let mut signals = SignalTable::new(&spec.signals)?;
        signals.add_families(&spec.families);
        signals.connect(&spec.connections)?;
        signals.follow(SimTime::ZERO);
        Ok(Self {
            signals,
            sockets: Sockets::default(),
            motion,
            later: Vec::new(),
            answers: spec.answers,
            files: spec.files,
            configuration: spec.configuration,
            looked: Cell::new(false),
            name: spec.name,
            statement_cost,
            state: ControllerState::Idle,
            tasks: Vec::new(),
            current: 0,
            shared: SharedData::default(),
            notices: BTreeMap::new(),
            meetings: BTreeMap::new(),
            cycle_end: SimTime::ZERO,
            cycle_limit: SimTime::ZERO,
            cursor: SimTime::ZERO,
            fresh: Vec::new(),
            events: VecDeque::new(),
        })
    }

    /// Sets a signal and what is connected to it, and notes the edges.
    pub(crate) fn change(
        &mut self,
        at: SimTime,
        name: &str,
        value: f64,
        input: bool,
    ) -> Result<(), Fault> {
        let Some(signal) = self.signals.set(at, name, value, input)? else {
            return Ok(());
        };
        let name = signal.spec.name.clone();
        self.fresh
            .push(ControllerEvent::SignalEdge { at, name, value });
        for (name, value) in self.signals.follow(at) {
            self.fresh
                .push(ControllerEvent::SignalEdge { at, name, value });
        }
        Ok(())
    }

    /// Carries out the signal changes that are due before `end`, in the order of their times.
    pub(crate) fn change_due(&mut self, end: SimTime) {
        if self.later.is_empty() {
            return;
        }
        let (mut due, later): (Vec<_>, Vec<_>) =
            self.later.drain(..).partition(|(at, ..)| *at < end);
        self.later = later;
        due.sort_by_key(|(at, ..)| *at);
        for (at, name, value) in due {
            // The value was checked when the change was asked for.
            let _ = self.change(at, &name, value, false);
        }
    }

    /// Does what was to be done where the arm passed, before `end` or later.
    pub(crate) fn pass(&mut self, fired: Fired, end: SimTime) {
        match fired.action {
            PathAction::Set { signal, value } if fired.at < end => {
                // The value was checked when the move was asked for.
                let _ = self.change(fired.at, &signal, value, false);
            }
            PathAction::Set { signal, value } => self.later.push((fired.at, signal, value)),
            PathAction::Check(check) => self.look(&check, fired.at),
            PathAction::Notify(name) => *self.notices.entry(name).or_default() += 1,
        }
    }

    /// Compares a signal as it is now; when it is not as it must be, a notice is given and the arm may stop.
    fn look(&mut self, check: &SignalCheck, at: SimTime) {
        // That the signal is there was found out when the check was made.
        let value = self.signals.get(&check.signal).map_or(0.0, |s| s.value);
        if check.relation.holds(value, check.value) {
            return;
        }
        *self.notices.entry(check.notice.clone()).or_default() += 1;
        if check.stops {
            // It is asked again, or taken up, by the program.
            let from = at.max(self.cycle_limit);
            let _ = self.motion.hold(from, &mut self.fresh);
        }
    }

    /// Hands over the events since the last time, by time.
    pub(crate) fn publish(&mut self) {
        for task in &mut self.tasks {
            if let Some((at, location)) = task.statement.take()
                && task.statement_told.as_ref() != Some(&location)
            {
                task.statement_told = Some(location.clone());
                self.fresh.push(ControllerEvent::Statement { at, location });
            }
        }
        self.fresh.sort_by_key(ControllerEvent::at);
        self.events.extend(self.fresh.drain(..));
    }
}
