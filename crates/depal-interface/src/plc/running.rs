//! A command of the controller that the session is working on.

use depal_wire::{CustomPoint, PlanPoint, Reply, Request, Status};

use super::result::{Data, Outcome};

/// The request, and what was answered so far.
#[derive(Debug, Clone)]
pub(super) struct Running {
    pub(super) request: Request,
    has_plan: bool,
    /// Rows so far of a call that is answered one point a time.
    custom: Vec<CustomPoint>,
    plan: Vec<PlanPoint>,
}

impl Running {
    pub(super) fn new(request: Request, has_plan: bool) -> Self {
        Self {
            request,
            has_plan,
            custom: Vec::new(),
            plan: Vec::new(),
        }
    }

    /// The outcome, or `None` if the request is to be repeated for the next row.
    pub(super) fn take(&mut self, reply: Reply, cap: usize) -> Option<Outcome> {
        let status = reply.verdict();
        let has_tools = !matches!(self.request, Request::GetVisionPoints(_));
        let data = match reply {
            Reply::CustomPoint { point, .. } => {
                let is_last = point.is_last;
                self.custom.push(*point);
                return (is_last || self.custom.len() == cap).then(|| self.all_rows(status));
            }
            Reply::PlanPoint(point) | Reply::VisionPlanPoint(point) => {
                let is_last = point.is_last;
                self.plan.push(*point);
                return (is_last || self.plan.len() == cap).then(|| self.all_rows(status));
            }
            // Rows that came before something went wrong are still the robot's.
            Reply::Status { .. } if !self.custom.is_empty() => {
                return Some(self.all_rows(Some(Status::VisionResult)));
            }
            Reply::Status { .. } if !self.plan.is_empty() => {
                let is_viz = matches!(self.request, Request::GetPlanData(_));
                let (viz, vision) = (Status::VizFinished, Status::VisionPathSent);
                return Some(self.all_rows(Some(if is_viz { viz } else { vision })));
            }
            Reply::Points { list, .. } => Data::Points { list, has_tools },
            Reply::DoList(list) | Reply::VisionDoList(list) => Data::DoList(list),
            Reply::Message(message) => Data::Message(message),
            _ => Data::None,
        };
        Some(Outcome { status, data })
    }

    fn all_rows(&mut self, status: Option<Status>) -> Outcome {
        let custom = std::mem::take(&mut self.custom);
        let data = if custom.is_empty() {
            Data::Plan {
                points: std::mem::take(&mut self.plan),
                has_plan: self.has_plan,
            }
        } else {
            Data::Custom(custom)
        };
        Outcome { status, data }
    }
}
