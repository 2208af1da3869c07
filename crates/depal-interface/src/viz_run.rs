//! The Viz project of one session, and commands 201, 202, 203, 205, 206 and 210.

use std::collections::BTreeMap;

use depal_frames::JointPositions;
use depal_wire::{
    DO_LIST_LEN, DoList, GetPlanData, GetVizPath, PLAN_VALUES, PlanPoint, PointCell8, PointList,
    PointRecord, Reply, SetBranch, StartViz, Status, VisionMoveCells, VizStartPayload,
};

use crate::dispatch::Answer;
use crate::job::{Job, JobId, Motion, PathPoint, VisionMoveData, VizOutcome, VizPath};
use crate::session::Session;
use crate::wire_values::{joint_values, pose_values};

/// What a session remembers of its Viz project.
#[derive(Debug, Clone, Default)]
pub(crate) enum VizRun {
    #[default]
    NotStarted,
    Running {
        job_id: JobId,
        /// The branch step that the run stands at.
        waiting_at: Option<i32>,
        /// Exits chosen before their step was reached, by step id.
        latched: BTreeMap<i32, usize>,
    },
    Finished {
        path: VizPath,
        /// Waypoints already sent.
        sent: usize,
        /// The command that fetches them: 205 and 210 are not to be mixed.
        fetched_by: Option<i32>,
    },
    Failed {
        status: Status,
        /// A client has heard of it.
        is_told: bool,
    },
}

impl Session {
    pub(crate) fn start_viz(&mut self, request: &StartViz) -> Status {
        if self.viz_project.is_none() {
            return Status::VizNoAutoload;
        }
        let start = match &request.start {
            VizStartPayload::NotSent => None,
            VizStartPayload::JointsAndFlange { joints_deg, .. }
            | VizStartPayload::StartJoints(joints_deg) => {
                Some(JointPositions::from_degrees(joints_deg))
            }
            VizStartPayload::UnknownType(_) => return Status::InvalidVizPoseType,
        };
        if matches!(self.viz, VizRun::Running { .. }) {
            return Status::VizRunning;
        }
        let job_id = self.next_job_id();
        let runs = self.vision.iter();
        let job = Job::StartViz {
            job_id,
            start,
            box_sizes: runs
                .clone()
                .filter_map(|(id, run)| Some((*id, run.box_size?)))
                .collect(),
            recipes: runs
                .filter_map(|(id, run)| Some((*id, run.recipe?)))
                .collect(),
        };
        self.viz = VizRun::Running {
            job_id,
            waiting_at: None,
            latched: BTreeMap::new(),
        };
        self.jobs.push_back(job);
        Status::VizStarted
    }

    pub(crate) fn stop_viz(&mut self) -> Status {
        if let VizRun::Running { job_id, .. } = self.viz {
            self.jobs.push_back(Job::StopViz { job_id });
        }
        self.viz = VizRun::NotStarted;
        Status::VizStopped
    }

    /// Accepted from 201 until the run's result is fetched: a program that sends 203 straight after 201
    /// must not depend on how fast the run is.
    pub(crate) fn set_branch(&mut self, request: &SetBranch) -> Status {
        let branches = self.viz_project.iter().flat_map(|viz| &viz.branches);
        let Some(branch) = branches.into_iter().find(|b| b.step == request.step) else {
            return Status::BadBranchStep;
        };
        if request.port < 1 || request.port > branch.exits {
            return Status::BadExitPort;
        }
        let exit = request.port as usize - 1;
        match &mut self.viz {
            VizRun::Running {
                job_id,
                waiting_at,
                latched,
            } => {
                if *waiting_at == Some(request.step) {
                    *waiting_at = None;
                    self.jobs.push_back(Job::SetBranch {
                        job_id: *job_id,
                        step: request.step,
                        exit,
                    });
                } else {
                    latched.insert(request.step, exit);
                }
                Status::BranchSet
            }
            VizRun::Finished { sent: 0, .. } | VizRun::Failed { is_told: false, .. } => {
                Status::BranchSet
            }
            _ => Status::VizNoResult,
        }
    }

    pub(crate) fn take_branch_wait(&mut self, waiting: JobId, step: i32) {
        let VizRun::Running {
            job_id,
            waiting_at,
            latched,
        } = &mut self.viz
        else {
            return;
        };
        if *job_id != waiting {
            return;
        }
        match latched.remove(&step) {
            Some(exit) => self.jobs.push_back(Job::SetBranch {
                job_id: waiting,
                step,
                exit,
            }),
            None => *waiting_at = Some(step),
        }
    }

    pub(crate) fn take_viz_outcome(&mut self, finished: JobId, outcome: VizOutcome) {
        if !matches!(&self.viz, VizRun::Running { job_id, .. } if *job_id == finished) {
            return;
        }
        self.viz = match outcome {
            Ok(path) if path.points.is_empty() => VizRun::Failed {
                status: Status::VizNoResult,
                is_told: false,
            },
            Ok(path) => VizRun::Finished {
                path,
                sent: 0,
                fetched_by: None,
            },
            Err(status) => VizRun::Failed {
                status,
                is_told: false,
            },
        };
    }

    pub(crate) fn get_viz_path(&mut self, request: &GetVizPath) -> Answer {
        const COMMAND: i32 = 205;
        if !matches!(request.pose_type, 1 | 2) {
            return Answer::Reply(Reply::status(COMMAND, Status::InvalidVizPathType));
        }
        let (cap, euler) = (self.settings.profile.pose_cap, self.settings.euler);
        let cell8 = self.settings.profile.point_cell8;
        let (path, sent) = match self.path_to_fetch(COMMAND) {
            Ok(fetch) => fetch,
            Err(answer) => return answer,
        };
        let first = *sent;
        let part = &path.points[first..path.points.len().min(first + cap)];
        *sent += part.len();
        let list = PointList {
            is_last: *sent == path.points.len(),
            vision_move: path.points[first..]
                .iter()
                .position(|p| p.vision_move.is_some())
                .map_or(0, |place| place as i32 + 1),
            points: part
                .iter()
                .map(|point| PointRecord {
                    values: waypoint_values(point, request.pose_type == 1, euler),
                    label: point.label,
                    cell8: match cell8 {
                        PointCell8::Velocity => whole_percent(point.velocity_percent),
                        PointCell8::ToolId => point.tool,
                    },
                })
                .collect(),
        };
        Answer::Reply(Reply::Points {
            command: COMMAND,
            status: Status::VizFinished,
            list,
        })
    }

    pub(crate) fn get_plan_data(&mut self, request: &GetPlanData) -> Answer {
        const COMMAND: i32 = 210;
        if !(1..=4).contains(&request.format) {
            return Answer::Reply(Reply::status(COMMAND, Status::InvalidVizPathType));
        }
        let euler = self.settings.euler;
        let (path, sent) = match self.path_to_fetch(COMMAND) {
            Ok(fetch) => fetch,
            Err(answer) => return answer,
        };
        let point = &path.points[*sent];
        *sent += 1;
        Answer::Reply(Reply::PlanPoint(Box::new(PlanPoint {
            is_last: *sent == path.points.len(),
            values: waypoint_values(point, matches!(request.format, 1 | 3), euler),
            move_type: match point.motion {
                Motion::Joint => 1,
                Motion::Linear => 2,
            },
            tool: point.tool,
            velocity_percent: whole_percent(point.velocity_percent),
            vision_move: point.vision_move.as_ref().map(|data| VisionMoveCells {
                plan: (request.format >= 3).then(|| plan_values(data)),
                custom: Vec::new(),
            }),
        })))
    }

    /// The path and how much of it is sent, at least one waypoint being left; or the answer instead.
    fn path_to_fetch(&mut self, command: i32) -> Result<(&VizPath, &mut usize), Answer> {
        let refuse = |status| Err(Answer::Reply(Reply::status(command, status)));
        match &mut self.viz {
            VizRun::NotStarted => refuse(Status::VizNoResult),
            VizRun::Running { .. } => Err(Answer::Wait {
                on_timeout: Status::VizTimeout,
            }),
            VizRun::Failed { status, is_told } => {
                *is_told = true;
                refuse(*status)
            }
            VizRun::Finished {
                path,
                sent,
                fetched_by,
            } => {
                if *sent == path.points.len() {
                    return refuse(Status::VizNoResult);
                }
                if fetched_by.is_some_and(|other| other != command) {
                    return refuse(Status::NoPlanData);
                }
                *fetched_by = Some(command);
                Ok((path, sent))
            }
        }
    }

    /// The list of this round; it stays until the next 201, so it may be fetched before or after the path.
    pub(crate) fn get_do_list(&self) -> Reply {
        let missing = Reply::status(206, Status::VizDoListMissing);
        let VizRun::Finished { path, .. } = &self.viz else {
            return missing;
        };
        if path.digital_outputs.is_empty() {
            return missing;
        }
        let mut list = [-1; DO_LIST_LEN];
        for (place, number) in list.iter_mut().zip(&path.digital_outputs) {
            *place = i32::from(*number);
        }
        Reply::DoList(Box::new(DoList(list)))
    }
}

fn waypoint_values(
    point: &PathPoint,
    wants_joints: bool,
    euler: depal_frames::EulerConvention,
) -> [f64; 6] {
    if wants_joints {
        joint_values(&point.joints)
    } else {
        pose_values(euler, &point.base_from_tcp)
    }
}

/// Velocities are whole percentages; a moving robot never gets 0.
fn whole_percent(percent: f64) -> i32 {
    percent.round().clamp(1.0, 100.0) as i32
}

/// The 21 plan values in their order on the wire; millimetres.
fn plan_values(data: &VisionMoveData) -> [f64; PLAN_VALUES] {
    let mut values = [0.0; PLAN_VALUES];
    for (value, label) in values.iter_mut().zip(data.labels) {
        *value = f64::from(label);
    }
    let offset_mm = data.group_from_tcp_offset * 1e3;
    let size_mm = data.group_size.to_mm();
    values[10..].copy_from_slice(&[
        f64::from(data.picked_total),
        f64::from(data.picked_now),
        f64::from(data.edge_or_corner),
        offset_mm.x,
        offset_mm.y,
        offset_mm.z,
        f64::from(u8::from(data.is_group_square)),
        f64::from(u8::from(data.is_box_square)),
        size_mm[0],
        size_mm[1],
        size_mm[2],
    ]);
    values
}
