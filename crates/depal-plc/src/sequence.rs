//! The sequence: what comes after what.

mod moves;
mod stage;

use std::collections::VecDeque;
use std::task::Poll;

use depal_time::SimTime;
use depal_vm::execution::Step;
use depal_vm::system::{Fault, LogKind, MoveId, MoveRequest, MoveZone, ProgramLocation, System};
use depal_wire::s7::{DataBlock, Field};

use crate::call::{Call, Registers};
use crate::path::Path;
use crate::{Fetch, PlcSettings, Source};
use stage::Stage;

/// Share of the acceleration with a carton on the gripper.
const LOADED: f64 = 0.7;
/// Percent of the way home and of the retreat.
const SLOW_PERCENT: f64 = 50.0;

/// The program's memory besides the block.
#[derive(Debug, Clone)]
pub(crate) struct Sequence {
    settings: PlcSettings,
    stage: Stage,
    call: Option<Call>,
    /// Still to be handed to the motion queue.
    moves: VecDeque<MoveRequest>,
    last_move: Option<MoveId>,
    /// The heartbeat at the start, and when that was.
    first_beat: Option<(bool, SimTime)>,
    path: Path,
    /// A carton was released, and the arm stands over it.
    is_at_place: bool,
    failures: u32,
    moved: u32,
}

impl Sequence {
    pub(crate) fn new(settings: PlcSettings) -> Self {
        Self {
            settings,
            stage: Stage::AwaitVision,
            call: None,
            moves: VecDeque::new(),
            last_move: None,
            first_beat: None,
            path: Path::default(),
            is_at_place: false,
            failures: 0,
            moved: 0,
        }
    }

    pub(crate) fn location(&self) -> ProgramLocation {
        let (routine, line) = self.stage.name();
        ProgramLocation {
            task: "PLC".to_owned(),
            module: "Sequence".to_owned(),
            routine: routine.to_owned(),
            line,
        }
    }

    /// One step; `Blocked` if it waits for vision, the arm or the vacuum.
    pub(crate) fn step(&mut self, block: &mut DataBlock, system: &mut dyn System) -> Step {
        match self.advance(block, system) {
            Ok(step) => step,
            Err(reason) => {
                system.stop_motion();
                system.log(LogKind::EventLog, &self.location(), &reason);
                Step::Stopped(reason)
            }
        }
    }

    fn advance(&mut self, block: &mut DataBlock, system: &mut dyn System) -> Result<Step, String> {
        if let Some(call) = &mut self.call {
            return match call.poll(system.now(), block) {
                Poll::Pending => Ok(Step::Blocked),
                Poll::Ready(status) => {
                    self.call = None;
                    self.answered(status?, block, system)?;
                    Ok(Step::Ran)
                }
            };
        }
        if let Some(request) = self.moves.front() {
            return match system.start_move(request) {
                Poll::Pending => Ok(Step::Blocked),
                Poll::Ready(started) => {
                    self.last_move = Some(started.map_err(|fault| words(&fault))?);
                    self.moves.pop_front();
                    Ok(Step::Ran)
                }
            };
        }
        self.act(block, system)
    }

    /// Nothing is under way: what the stage is about.
    fn act(&mut self, block: &mut DataBlock, system: &mut dyn System) -> Result<Step, String> {
        let now = system.now();
        match self.stage {
            Stage::AwaitVision => {
                let beat = block.bool(Field::Heartbeat);
                let (first, since) = *self.first_beat.get_or_insert((beat, now));
                if first == beat {
                    let patience = self.settings.vision_time;
                    if since + patience > now {
                        return Ok(Step::Blocked);
                    }
                    return Err(format!(
                        "no heartbeat of vision within {:.0} s: it does not write this data block",
                        patience.as_secs_f64()
                    ));
                }
                self.enter(Stage::CheckState, system);
            }
            Stage::CheckState => self.start_call(now, block, 901, |_| {}),
            Stage::SetBoxSize => {
                let Some(size) = self.settings.box_size_mm else {
                    self.enter(Stage::GoHome, system);
                    return Ok(Step::Ran);
                };
                let project = self.settings.project;
                self.start_call(now, block, 501, |registers| {
                    registers.project = project;
                    registers.box_size_mm = Some(size);
                });
            }
            Stage::GoHome => {
                self.set_sections(system, &[])?;
                self.go_home(SLOW_PERCENT, MoveZone::Fine);
                self.enter(Stage::StartRun, system);
            }
            Stage::StartRun => self.start_run(now, block),
            Stage::ChooseBranch(place) => {
                let Some(branch) = self.settings.branches.get(place).copied() else {
                    let next = if self.is_at_place {
                        Stage::AwaitRelease
                    } else {
                        Stage::FetchPath
                    };
                    self.enter(next, system);
                    return Ok(Step::Ran);
                };
                self.start_call(now, block, 203, |registers| registers.branch = Some(branch));
            }
            Stage::FetchPath => self.fetch_path(now, block),
            Stage::FetchOutputs => {
                let (project, sections) = (self.planning_project(), self.settings.sections);
                self.start_call(now, block, 206, |registers| {
                    registers.project = project;
                    registers.sections = sections;
                });
            }
            Stage::GoToPick => {
                self.follow(0..=self.path.pick, 1.0, system);
                self.enter(Stage::Grip, system);
            }
            Stage::Grip => {
                if !self.has_arrived(system)? {
                    return Ok(Step::Blocked);
                }
                let outputs: Vec<i16> = (0..Field::DigitalOutput.spec().len())
                    .map(|place| block.int(Field::DigitalOutput, place))
                    .collect();
                self.set_sections(system, &outputs)?;
                self.enter(Stage::AwaitVacuum(now), system);
            }
            Stage::AwaitVacuum(since) => {
                if self.has_vacuum(system)? {
                    self.enter(Stage::GoToPlace, system);
                } else if since + self.settings.vacuum_time <= now {
                    self.count_failure("no vacuum", system)?;
                    self.enter(Stage::GiveUpPick, system);
                } else {
                    return Ok(Step::Blocked);
                }
            }
            Stage::GoToPlace => {
                let last = self.path.points.len() - 1;
                self.follow(self.path.pick + 1..=last, LOADED, system);
                self.enter(Stage::Release, system);
            }
            Stage::Release => {
                if !self.has_arrived(system)? {
                    return Ok(Step::Blocked);
                }
                if self.has_vacuum(system)? {
                    self.failures = 0;
                    self.moved += 1;
                } else {
                    self.count_failure("carton lost on the way", system)?;
                }
                self.set_sections(system, &[])?;
                self.is_at_place = true;
                // The arm is out of the camera's view: the next run takes no time of its own.
                self.enter(Stage::StartRun, system);
            }
            Stage::AwaitRelease => {
                if self.has_vacuum(system)? {
                    return Ok(Step::Blocked);
                }
                self.retreat(system);
                self.is_at_place = false;
                self.enter(Stage::FetchPath, system);
            }
            Stage::GiveUpPick => {
                self.set_sections(system, &[])?;
                self.follow((0..self.path.pick).rev(), 1.0, system);
                self.go_home(SLOW_PERCENT, MoveZone::Fine);
                self.enter(Stage::StartRun, system);
            }
            Stage::GoToEnd => {
                self.go_home(SLOW_PERCENT, MoveZone::Fine);
                self.enter(Stage::End, system);
            }
            Stage::End => {
                if !self.has_arrived(system)? {
                    return Ok(Step::Blocked);
                }
                let text = format!("Pallet empty, cartons moved: {}", self.moved);
                system.log(LogKind::Operator, &self.location(), &text);
                return Ok(Step::Finished);
            }
        }
        Ok(Step::Ran)
    }

    /// Vision has answered the call of this stage.
    fn answered(
        &mut self,
        status: i16,
        block: &mut DataBlock,
        system: &mut dyn System,
    ) -> Result<(), String> {
        let next = match (self.stage, status) {
            (Stage::CheckState, 1101) => Stage::SetBoxSize,
            (Stage::SetBoxSize, 1108) => Stage::GoHome,
            (Stage::StartRun, 2103 | 1102) => Stage::ChooseBranch(0),
            (Stage::ChooseBranch(place), 2105) => Stage::ChooseBranch(place + 1),
            (Stage::FetchPath, 2100 | 1103) => {
                self.path = Path::of_block(block, &self.settings)?;
                // Read: vision may send new data.
                block.set_bool(Field::PoseSent, false);
                Stage::FetchOutputs
            }
            (Stage::FetchPath, 1002 | 1003 | 2037 | 2038) => Stage::GoToEnd,
            (Stage::FetchOutputs, 2102 | 1106) => Stage::GoToPick,
            (stage, status) => {
                let (name, _) = stage.name();
                return Err(format!("{name}: vision answers with status {status}"));
            }
        };
        self.enter(next, system);
        Ok(())
    }

    fn enter(&mut self, stage: Stage, system: &mut dyn System) {
        self.stage = stage;
        system.statement(&self.location());
    }

    fn start_call(
        &mut self,
        now: SimTime,
        block: &mut DataBlock,
        command: i16,
        fill: impl FnOnce(&mut Registers),
    ) {
        let mut registers = Registers {
            command,
            ..Registers::default()
        };
        fill(&mut registers);
        self.call = Some(Call::start(now, block, &registers));
    }

    fn start_run(&mut self, now: SimTime, block: &mut DataBlock) {
        let mut joints_deg = [0.0; 6];
        for (value, joint) in joints_deg.iter_mut().zip(self.settings.home.iter()) {
            *value = joint.to_degrees() as f32;
        }
        // Both types mean: the path starts at these joints.
        let (command, pose_type, project) = match self.settings.source {
            Source::Viz => (201, 2, 0),
            Source::Vision => (101, 3, self.settings.project),
        };
        self.start_call(now, block, command, |registers| {
            registers.pose_type = pose_type;
            registers.project = project;
            registers.joints_deg = Some(joints_deg);
        });
    }

    fn fetch_path(&mut self, now: SimTime, block: &mut DataBlock) {
        let project = self.planning_project();
        // Joints; from the Viz project with the plan data of the Vision Move.
        let (command, pose_type) = match (self.settings.fetch, self.settings.source) {
            (Fetch::PlanData, Source::Viz) => (210, 3),
            (Fetch::PlanData, Source::Vision) => (210, 1),
            (Fetch::Path, Source::Viz) => (205, 1),
            (Fetch::Path, Source::Vision) => (105, 1),
        };
        self.start_call(now, block, command, |registers| {
            registers.project = project;
            registers.pose_type = pose_type;
        });
    }

    /// 0 for the Viz project.
    fn planning_project(&self) -> i16 {
        match self.settings.source {
            Source::Viz => 0,
            Source::Vision => self.settings.project,
        }
    }

    /// Whether the last move is over. A fault of the motion ends the program.
    fn has_arrived(&self, system: &dyn System) -> Result<bool, String> {
        match self.last_move {
            Some(id) => system.is_move_done(id).map_err(|fault| words(&fault)),
            None => Ok(true),
        }
    }

    fn has_vacuum(&self, system: &dyn System) -> Result<bool, String> {
        let value = system.signal(&self.settings.vacuum_signal);
        Ok(value.map_err(|fault| words(&fault))? != 0.0)
    }

    /// Switches exactly these outputs on; negative numbers are fillers.
    fn set_sections(&self, system: &mut dyn System, outputs: &[i16]) -> Result<(), String> {
        for (group, signal) in self.settings.section_groups.iter().enumerate() {
            let bits = outputs
                .iter()
                .filter_map(|output| usize::try_from(*output).ok())
                .filter(|output| output / 16 == group)
                .fold(0_u32, |bits, output| bits | 1 << (output % 16));
            system
                .set_signal(signal, f64::from(bits))
                .map_err(|fault| words(&fault))?;
        }
        Ok(())
    }

    fn count_failure(&mut self, what: &str, system: &mut dyn System) -> Result<(), String> {
        self.failures += 1;
        let text = format!("{what}, attempt {}", self.failures);
        system.log(LogKind::Operator, &self.location(), &text);
        if self.failures > self.settings.most_failures {
            return Err(format!("too many failed picks in a row: {what}"));
        }
        Ok(())
    }
}

/// A fault for people.
pub(crate) fn words(fault: &Fault) -> String {
    match fault {
        Fault::UnknownSignal(name) => format!("there is no signal {name}"),
        Fault::SignalValue { signal, message } => format!("signal {signal}: {message}"),
        Fault::OutOfReach { message }
        | Fault::MotionSupervision { message }
        | Fault::SocketState { message }
        | Fault::NotThere { message } => message.clone(),
        Fault::AddressInUse { address } => format!("address {address} is taken"),
        other => format!("{other:?}"),
    }
}
