//! When a run is over, how it ended, and why.

use depal_controller::ControllerState;
use depal_time::{SimDuration, SimTime};

use super::Cell;
use crate::event::FailureReason;
use crate::score::{CartonFate, Score};

/// After the program's end the belt may run on for this long, to carry out what lies on it.
const RUN_OUT: SimDuration = SimDuration::from_millis(20_000);

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndState {
    /// The program's entry routine returned.
    Finished,
    /// The program stopped itself.
    Stopped,
    /// The program failed with an error of its own.
    Failed,
    /// The scene's time limit passed.
    TimeLimit,
}

impl EndState {
    /// The name in logs and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
            Self::TimeLimit => "time_limit",
        }
    }
}

/// What a run came to.
#[derive(Debug, Clone)]
pub struct RunOutcome {
    /// How it ended.
    pub end: EndState,
    /// In words.
    pub end_detail: String,
    /// Simulated time of the run.
    pub sim_time: SimTime,
    /// Digest over the whole run, 16 hexadecimal digits.
    pub state_hash: String,
    /// Picks, losses and vision errors.
    pub score: Score,
}

impl Cell {
    /// Whether the run is over, and how.
    pub(super) fn end(&mut self) -> Option<(EndState, String)> {
        if self.program_end.is_none() {
            let ended = match self.controller.state() {
                ControllerState::Idle | ControllerState::Running => None,
                ControllerState::Finished => {
                    Some((EndState::Finished, "the program came to its end".to_owned()))
                }
                ControllerState::Stopped(reason) => {
                    let at = self.controller.location().unwrap_or_default();
                    let said = match self.last_message.as_str() {
                        "" => String::new(),
                        said => format!("; its last message: {said}"),
                    };
                    Some((
                        EndState::Stopped,
                        format!("{reason} at {}/{}:{}{said}", at.module, at.routine, at.line),
                    ))
                }
                ControllerState::Failed(error) => {
                    let place = error.call_stack.first().map_or(String::new(), |at| {
                        format!("{}/{}:{}: ", at.module, at.routine, at.line)
                    });
                    Some((
                        EndState::Failed,
                        format!("{place}{}: {}", error.name, error.message),
                    ))
                }
            };
            self.program_end = ended.map(|(state, detail)| (self.now, state, detail));
        }
        if let Some((at, state, detail)) = &self.program_end {
            let on_belt = self.score.count(|fate| fate == CartonFate::OnConveyor);
            let settled = self.now - *at >= SimDuration::from_millis(500);
            let is_over = on_belt == 0 && settled && !self.picks.awaits_stand();
            if is_over || self.now - *at >= RUN_OUT {
                return Some((*state, detail.clone()));
            }
        }
        if self.now.as_nanos() >= self.spec.time_limit.as_nanos() {
            let at = self.controller.location().unwrap_or_default();
            return Some((
                EndState::TimeLimit,
                format!(
                    "{:.0} s have passed; the program stands at {}/{}:{}",
                    self.now.as_secs_f64(),
                    at.module,
                    at.routine,
                    at.line
                ),
            ));
        }
        None
    }

    /// What ended the run before the pallet was empty.
    pub(super) fn run_failure(
        &self,
        end: EndState,
        detail: &str,
    ) -> Option<(FailureReason, String)> {
        let left = self
            .score
            .count(|fate| matches!(fate, CartonFate::InCell | CartonFate::OnConveyor));
        let reason = match end {
            EndState::TimeLimit => FailureReason::Timeout,
            _ if self.picks.collided() && end != EndState::Finished => FailureReason::Collision,
            // A program that gives up after failed picks ended for their reason, not for one of its own.
            EndState::Failed | EndState::Stopped => self
                .score
                .picks
                .last()
                .and_then(|(_, reason)| *reason)
                .or_else(|| self.vision.dialogue_failure())
                .unwrap_or(FailureReason::ProgramError),
            EndState::Finished if left == 0 || self.spec.may_leave_cartons => return None,
            EndState::Finished => self
                .vision
                .last_failure()
                .unwrap_or(FailureReason::NoDetection),
        };
        Some((reason, format!("{left} cartons left; {detail}")))
    }
}
