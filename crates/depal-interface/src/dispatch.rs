//! From a typed request to its answer: one arm a command.

use depal_wire::{Reply, Request, Status};

use crate::session::Session;

/// What a request leads to.
pub(crate) enum Answer {
    /// Send this now.
    Reply(Reply),
    /// The run is not over: ask again when it is, or answer this when the time is up.
    Wait {
        /// The status of giving up.
        on_timeout: Status,
    },
}

impl Session {
    pub(crate) fn dispatch(&mut self, request: &Request) -> Answer {
        let status = match request {
            Request::StartVision(body) => self.start_vision(body),
            Request::GetVisionPoints(body) => return self.get_vision_points(body),
            Request::SwitchRecipe(body) => self.switch_recipe(body),
            Request::StartViz(body) => self.start_viz(body),
            Request::StopViz(_) => self.stop_viz(),
            Request::SetBranch(body) => self.set_branch(body),
            Request::GetVizPath(body) => return self.get_viz_path(body),
            Request::GetDoList(_) => return Answer::Reply(self.get_do_list()),
            Request::GetPlanData(body) => return self.get_plan_data(body),
            Request::SetBoxSize(body) => self.set_box_size(body),
            Request::GetState(_) if self.projects.is_empty() => Status::VisionNotRegistered,
            Request::GetState(_) => Status::VisionReady,
            _ => Status::InvalidCommand,
        };
        Answer::Reply(Reply::status(request.code(), status))
    }
}
