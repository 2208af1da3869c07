use std::collections::VecDeque;
use std::sync::Arc;

use depal_arm::Arm;
use depal_frames::JointPositions;
use depal_motion::Trajectory;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::ProgramLocation;

use crate::motion_queue::MotionQueue;
use crate::signals::SignalTable;
use crate::sockets::Sockets;
use crate::{ControllerError, ControllerEvent, ControllerState, SignalSpec};

/// What a cabinet is built from.
#[derive(Debug, Clone)]
pub struct ControllerSpec {
    /// Name of the controller, its address on the network side.
    pub name: String,
    /// The arm.
    pub arm: Arc<Arm>,
    /// Where it stands at the start, radians.
    pub start: JointPositions,
    /// All signals.
    pub signals: Vec<SignalSpec>,
    /// Simulated time of one statement.
    /// 20 us: about the 44 simple instructions per millisecond measured on a current cabinet, rounded up.
    pub statement_cost: SimDuration,
    /// Moves that may wait behind the one under way before the program has to wait.
    pub queue_depth: usize,
}

impl ControllerSpec {
    /// A cabinet without signals, 20 us per statement and 5 waiting moves.
    pub fn new(name: &str, arm: Arc<Arm>, start: JointPositions) -> Self {
        Self {
            name: name.to_owned(),
            arm,
            start,
            signals: Vec::new(),
            statement_cost: SimDuration::from_micros(20),
            queue_depth: 5,
        }
    }
}

/// The whole state of a controller but for its task. A clone can be run on with
/// [`Controller::resume`](crate::Controller::resume).
#[derive(Debug, Clone)]
pub struct Cabinet {
    pub(crate) name: String,
    pub(crate) arm: Arc<Arm>,
    pub(crate) statement_cost: SimDuration,
    pub(crate) signals: SignalTable,
    pub(crate) sockets: Sockets,
    pub(crate) motion: MotionQueue,
    pub(crate) state: ControllerState,
    /// End of the last cycle.
    pub(crate) cycle_end: SimTime,
    /// When the next statement begins.
    pub(crate) cursor: SimTime,
    /// Place of the last statement, and the one told last.
    pub(crate) statement: Option<(SimTime, ProgramLocation)>,
    pub(crate) statement_told: Option<ProgramLocation>,
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
        Ok(Self {
            signals: SignalTable::new(&spec.signals)?,
            sockets: Sockets::default(),
            motion: MotionQueue::new(
                Trajectory::new(Arc::clone(&spec.arm), spec.start),
                spec.queue_depth,
            ),
            name: spec.name,
            arm: spec.arm,
            statement_cost: spec.statement_cost,
            state: ControllerState::Idle,
            cycle_end: SimTime::ZERO,
            cursor: SimTime::ZERO,
            statement: None,
            statement_told: None,
            fresh: Vec::new(),
            events: VecDeque::new(),
        })
    }

    /// Hands over the events since the last time, by time.
    pub(crate) fn publish(&mut self) {
        if let Some((at, location)) = self.statement.take()
            && self.statement_told.as_ref() != Some(&location)
        {
            self.statement_told = Some(location.clone());
            self.fresh.push(ControllerEvent::Statement { at, location });
        }
        self.fresh.sort_by_key(ControllerEvent::at);
        self.events.extend(self.fresh.drain(..));
    }
}
