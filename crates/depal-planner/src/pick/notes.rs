use depal_motion::MotionError;

use crate::refusal::{RejectReason, Stage, Touch};

/// What stood in the way of a group: the touch that came farthest, and how far reach was the trouble.
#[derive(Default)]
pub(super) struct Notes {
    touch: Option<Touch>,
    pub poses: usize,
    pub reached_pick: bool,
    pub reached_place: bool,
    pub straight: Option<Stage>,
    /// Why a way that is free cannot be driven.
    pub driving: Option<Box<MotionError>>,
}

impl Notes {
    /// Of touches that came equally far the first one stays.
    pub fn touched(&mut self, touch: Touch) {
        if self.touch.as_ref().is_none_or(|t| t.stage < touch.stage) {
            self.touch = Some(touch);
        }
    }

    /// Adds what was noted after these.
    pub fn append(&mut self, later: Self) {
        if let Some(touch) = later.touch {
            self.touched(touch);
        }
        self.poses += later.poses;
        self.reached_pick |= later.reached_pick;
        self.reached_place |= later.reached_place;
        self.straight = later.straight.or(self.straight);
        self.driving = self.driving.take().or(later.driving);
    }

    /// All in one, after `tried` attempts.
    pub fn reason(&self, tried: usize) -> RejectReason {
        let unreachable = |stage, tried| RejectReason::Unreachable { stage, tried };
        if !self.reached_pick {
            return unreachable(Stage::Pick, self.poses);
        }
        if let Some(error) = self.driving.as_deref().cloned() {
            return RejectReason::CannotDrive { error };
        }
        match (&self.touch, self.straight) {
            (Some(touch), _) if tried > 0 || self.reached_place || touch.stage == Stage::Pick => {
                RejectReason::Collision {
                    touch: touch.clone(),
                    tried: tried.max(self.poses),
                }
            }
            (_, Some(stage)) => unreachable(stage, tried),
            _ if !self.reached_place => unreachable(Stage::Place, self.poses),
            _ => unreachable(Stage::TransferToPlace, tried),
        }
    }
}
