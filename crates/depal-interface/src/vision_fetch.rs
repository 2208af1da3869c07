//! What fetches the result of a vision project: commands 100, 102, 105, 106, 110 and 111.

use depal_wire::{
    CustomPoint, GetCustomData, GetVisionDoList, GetVisionPath, GetVisionPlanData, GetVisionPoints,
    PointList, PointRecord, Reply, RobotPosePayload, RunVision, Status, SwitchRecipe,
};

use crate::dispatch::{Answer, Asked};
use crate::job::{RobotPose, VisionPoint};
use crate::path_fetch::PathFetch;
use crate::session::Session;
use crate::settings::{OutputPort, PortSettings};
use crate::vision_run::{PointFetch, VisionState};
use crate::wire_values::{pose_values, tcp_of_object};

impl Session {
    /// 101 and one of 102, 105 and 110 in one. Only the first asking starts a run.
    pub(crate) fn run_vision(&mut self, request: &RunVision, asked: Asked) -> Answer {
        const COMMAND: i32 = 100;
        if asked == Asked::First {
            let status = self.begin_one_shot(request);
            if status != Status::VisionTriggered {
                return Answer::Reply(Reply::status(COMMAND, status));
            }
        }
        match request.format {
            1 => self.next_points(COMMAND, request.job),
            2 => self.next_custom_point(COMMAND, request.job),
            format => self.next_path_part(COMMAND, request.job, format == 3),
        }
    }

    fn begin_one_shot(&mut self, request: &RunVision) -> Status {
        let Some(project) = self.projects.get(&request.job) else {
            return self.unknown_job();
        };
        let fits = match request.format {
            1 => project.output != OutputPort::Path,
            2 => project.output == OutputPort::Custom,
            3 | 4 => project.output == OutputPort::Path,
            _ => return Status::InvalidPathType,
        };
        if !fits {
            return Status::WrongOutputPort;
        }
        let is_sent = |values: &[f64; 6]| values.iter().any(|v| *v != 0.0);
        let pose = if is_sent(&request.joints_deg) || is_sent(&request.flange) {
            self.robot_pose(&RobotPosePayload::JointsAndFlange {
                joints_deg: request.joints_deg,
                flange: is_sent(&request.flange).then_some(request.flange),
            })
        } else {
            Ok(RobotPose::NotSent)
        };
        let pose = match pose {
            Ok(pose) => pose,
            Err(status) => return status,
        };
        if request.recipe != 0 {
            let switched = self.switch_recipe(&SwitchRecipe {
                job: request.job,
                recipe: request.recipe,
            });
            if switched != Status::RecipeSwitched {
                return switched;
            }
        }
        self.begin_vision(request.job, 0, pose)
    }

    pub(crate) fn get_vision_points(&mut self, request: &GetVisionPoints) -> Answer {
        self.next_points(102, request.job)
    }

    fn next_points(&mut self, command: i32, job: i32) -> Answer {
        let port = self.settings.clone();
        let fetch = match self.points_to_fetch(command, job, 102, |o| o != OutputPort::Path) {
            Ok(fetch) => fetch,
            Err(answer) => return answer,
        };
        let rest = &fetch.points[fetch.sent..];
        let part = &rest[..rest.len().min(port.profile.pose_cap)];
        fetch.sent += part.len();
        let list = PointList {
            is_last: part.len() == rest.len(),
            vision_move: 0,
            points: part
                .iter()
                .map(|point| PointRecord {
                    values: point_values(point, &port),
                    label: point.label,
                    cell8: 0,
                })
                .collect(),
        };
        Answer::Reply(Reply::Points {
            command,
            status: Status::VisionResult,
            list,
        })
    }

    pub(crate) fn get_custom_data(&mut self, request: &GetCustomData) -> Answer {
        self.next_custom_point(110, request.job)
    }

    fn next_custom_point(&mut self, command: i32, job: i32) -> Answer {
        let port = self.settings.clone();
        let fetch = match self.points_to_fetch(command, job, 110, |o| o == OutputPort::Custom) {
            Ok(fetch) => fetch,
            Err(answer) => return answer,
        };
        let point = &fetch.points[fetch.sent];
        let custom = fetch.custom.get(fetch.sent).cloned().unwrap_or_default();
        fetch.sent += 1;
        Answer::Reply(Reply::CustomPoint {
            command,
            point: Box::new(CustomPoint {
                is_last: fetch.sent == fetch.points.len(),
                values: point_values(point, &port),
                label: point.label,
                custom,
            }),
        })
    }

    pub(crate) fn get_vision_path(&mut self, request: &GetVisionPath) -> Answer {
        const COMMAND: i32 = 105;
        if let Some(refusal) = self.refused_path_type(COMMAND, request.job, request.pose_type) {
            return refusal;
        }
        self.next_path_part(COMMAND, request.job, request.pose_type == 1)
    }

    fn next_path_part(&mut self, command: i32, job: i32, wants_joints: bool) -> Answer {
        let port = self.settings.clone();
        match self.vision_path_to_fetch(command, job, 105) {
            Err(answer) => answer,
            Ok((path, count)) => {
                let cap = port.profile.pose_cap;
                let limit = if count == 0 { cap } else { count.min(cap) };
                Answer::Reply(Reply::Points {
                    command,
                    status: Status::VisionPathSent,
                    list: path.next_part(limit, wants_joints, &port),
                })
            }
        }
    }

    pub(crate) fn get_vision_plan_data(&mut self, request: &GetVisionPlanData) -> Answer {
        const COMMAND: i32 = 111;
        if let Some(refusal) = self.refused_path_type(COMMAND, request.job, request.pose_type) {
            return refusal;
        }
        let euler = self.settings.euler;
        match self.vision_path_to_fetch(COMMAND, request.job, COMMAND) {
            Err(answer) => answer,
            Ok((path, _)) => Answer::Reply(Reply::VisionPlanPoint(Box::new(path.next_plan_point(
                request.pose_type == 1,
                true,
                euler,
            )))),
        }
    }

    /// The list stays until the next 101, so it may be fetched before or after the path. It is never waited for.
    pub(crate) fn get_vision_do_list(&self, request: &GetVisionDoList) -> Reply {
        let status = match self.vision.get(&request.job).map(|run| &run.state) {
            None => self.unknown_job(),
            Some(VisionState::NotStarted) => Status::VisionNotStarted,
            Some(VisionState::Path { path, .. }) => match path.do_list(request.sections) {
                Some(list) => return Reply::VisionDoList(Box::new(list)),
                None => Status::VisionDoListMissing,
            },
            Some(_) => Status::VisionDoListMissing,
        };
        Reply::status(106, status)
    }

    /// A job that does not exist comes before a type that does not.
    fn refused_path_type(&self, command: i32, job: i32, pose_type: i32) -> Option<Answer> {
        let known = self.projects.contains_key(&job);
        (known && !matches!(pose_type, 1 | 2))
            .then(|| Answer::Reply(Reply::status(command, Status::InvalidPathType)))
    }

    /// The state of a project's run, if the output fits and the run is over; or the answer instead.
    fn state_to_fetch(
        &mut self,
        command: i32,
        job: i32,
        fits: impl Fn(OutputPort) -> bool,
    ) -> Result<&mut VisionState, Answer> {
        let unknown = self.unknown_job();
        let refuse = |status| Err(Answer::Reply(Reply::status(command, status)));
        let (Some(project), Some(run)) = (self.projects.get(&job), self.vision.get_mut(&job))
        else {
            return refuse(unknown);
        };
        if !fits(project.output) {
            return refuse(Status::WrongOutputPort);
        }
        match &mut run.state {
            VisionState::NotStarted => refuse(Status::VisionNotStarted),
            VisionState::Running { .. } => Err(Answer::Wait {
                on_timeout: Reply::status(command, Status::VisionTimeout),
            }),
            VisionState::Failed(status) => refuse(*status),
            ready => Ok(ready),
        }
    }

    /// The points, at least one being left, reserved for `kind`; or the answer to `command` instead.
    fn points_to_fetch(
        &mut self,
        command: i32,
        job: i32,
        kind: i32,
        fits: impl Fn(OutputPort) -> bool,
    ) -> Result<&mut PointFetch, Answer> {
        let all_fetched = self.settings.all_fetched;
        let refuse = |status| Err(Answer::Reply(Reply::status(command, status)));
        match self.state_to_fetch(command, job, fits)? {
            VisionState::Points(fetch) => {
                if fetch.sent == fetch.points.len() {
                    return refuse(all_fetched);
                }
                if fetch.fetched_by.is_some_and(|other| other != kind) {
                    return refuse(Status::WrongOutputPort);
                }
                fetch.fetched_by = Some(kind);
                Ok(fetch)
            }
            _ => refuse(Status::WrongOutputPort),
        }
    }

    /// The path, at least one waypoint being left, reserved for `kind`, and the count of 101.
    fn vision_path_to_fetch(
        &mut self,
        command: i32,
        job: i32,
        kind: i32,
    ) -> Result<(&mut PathFetch, usize), Answer> {
        let all_fetched = self.settings.all_fetched;
        let refuse = |status| Err(Answer::Reply(Reply::status(command, status)));
        match self.state_to_fetch(command, job, |o| o == OutputPort::Path)? {
            VisionState::Path { path, count } => {
                if path.is_drained() {
                    return refuse(all_fetched);
                }
                if path.fetched_by.is_some_and(|other| other != kind) {
                    return refuse(Status::WrongOutputPort);
                }
                path.fetched_by = Some(kind);
                Ok((path, *count))
            }
            _ => refuse(Status::WrongOutputPort),
        }
    }
}

fn point_values(point: &VisionPoint, port: &PortSettings) -> [f64; 6] {
    pose_values(port.euler, &tcp_of_object(&point.base_from_object))
}
