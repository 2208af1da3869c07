//! From a typed request to its answer: one arm a command.

use depal_time::SimTime;
use depal_wire::{Reply, Request, StateFields, StateReply, Status};

use crate::session::Session;

/// What a request leads to.
pub(crate) enum Answer {
    /// Send this now.
    Reply(Reply),
    /// What it wants is not there yet: ask again when it may be, or answer this when the time is up.
    Wait {
        /// The answer of giving up.
        on_timeout: Reply,
    },
}

/// Commands that start something do so only once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// The request has just come.
    First,
    /// It waits, and something has happened.
    Again,
}

impl Session {
    pub(crate) fn dispatch(&mut self, now: SimTime, request: &Request, asked: Asked) -> Answer {
        let status = match request {
            Request::RunVision(body) => return self.run_vision(body, asked),
            Request::StartVision(body) => self.start_vision(body),
            Request::GetVisionPoints(body) => return self.get_vision_points(body),
            Request::SwitchRecipe(body) => self.switch_recipe(body),
            Request::SwitchSolution(body) => self.switch_solution(body),
            Request::GetVisionPath(body) => return self.get_vision_path(body),
            Request::GetVisionDoList(body) => return Answer::Reply(self.get_vision_do_list(body)),
            Request::GetCustomData(body) => return self.get_custom_data(body),
            Request::GetVisionPlanData(body) => return self.get_vision_plan_data(body),
            Request::RunViz(body) => return self.run_viz(body, asked),
            Request::StartViz(body) => self.start_viz(body),
            Request::StopViz(_) => self.stop_viz(),
            Request::SetBranch(body) => self.set_branch(body),
            Request::SetIndex(body) => self.set_index(body),
            Request::GetVizPath(body) => return self.get_viz_path(body),
            Request::GetDoList(body) => return Answer::Reply(self.get_do_list(body)),
            Request::ReadParameter(body) => return Answer::Reply(self.read_parameter(body)),
            Request::WriteParameter(body) => self.write_parameter(body),
            Request::GetPlanData(body) => return self.get_plan_data(body),
            Request::SetBoxSize(body) => self.set_box_size(body),
            Request::SetOuterPose(body) => self.set_outer_pose(body),
            Request::SetInputPose(body) => self.set_input_pose(body),
            Request::SetNumber(body) => self.set_number(body),
            Request::SetNumbers(body) => self.set_numbers(body),
            Request::SetText(body) => self.set_text(body),
            Request::SetTexts(body) => self.set_texts(body),
            Request::GetNotify(_) => return self.get_notify(now),
            Request::Calibrate(body) => return Answer::Reply(self.calibrate(body)),
            Request::GetState(_) => return Answer::Reply(self.state(now)),
            _ => Status::InvalidCommand,
        };
        Answer::Reply(Reply::status(request.code(), status))
    }

    fn state(&self, now: SimTime) -> Reply {
        let has_vision = !self.projects.is_empty();
        match self.settings.profile.state_reply {
            StateReply::Fields => Reply::State(StateFields {
                has_vision,
                has_viz: self.viz_project.is_some(),
                has_camera: self.has_camera && !self.faults.camera_is_lost(now),
            }),
            StateReply::Ready if has_vision => Reply::status(901, Status::VisionReady),
            StateReply::Ready => Reply::status(901, Status::VisionNotRegistered),
        }
    }
}
