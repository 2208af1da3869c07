//! The Viz project of one session, and commands 200 to 206 and 210.

use std::collections::BTreeMap;

use depal_frames::{JointPositions, Pose};
use depal_wire::{
    GetDoList, GetPlanData, GetVizPath, Reply, RunViz, SetBranch, SetIndex, StartViz, Status,
    VizStartPayload,
};

use crate::dispatch::{Answer, Asked};
use crate::job::{Job, JobId, PlannedPath, RobotPose};
use crate::path_fetch::PathFetch;
use crate::session::Session;

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
        /// An exit has been chosen in this run: too late for 204.
        has_branched: bool,
    },
    Finished(PathFetch),
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
        let pose = match &request.start {
            VizStartPayload::NotSent => RobotPose::NotSent,
            VizStartPayload::JointsAndFlange { joints_deg, flange } => RobotPose::Current {
                joints: Some(JointPositions::from_degrees(joints_deg)),
                base_from_flange: match self.viz_flange(flange.as_ref()) {
                    Ok(base_from_flange) => base_from_flange,
                    Err(status) => return status,
                },
            },
            VizStartPayload::StartJoints(joints_deg) => {
                RobotPose::PathStart(JointPositions::from_degrees(joints_deg))
            }
            VizStartPayload::UnknownType(_) => return Status::InvalidVizPoseType,
        };
        self.begin_viz(pose)
    }

    /// The flange of a start of the Viz project. One out of any reach is refused where a camera hangs on
    /// it, and left aside where it is of no use.
    fn viz_flange(&self, sent: Option<&[f64; 6]>) -> Result<Option<Pose>, Status> {
        match sent.map(|values| self.near_pose(values)) {
            Some(None) if self.needs_robot_pose => Err(Status::InvalidVizPose),
            known => Ok(known.flatten()),
        }
    }

    fn begin_viz(&mut self, pose: RobotPose) -> Status {
        if matches!(self.viz, VizRun::Running { .. }) {
            return Status::VizRunning;
        }
        if self.needs_robot_pose && !pose.is_current() {
            return Status::InvalidVizPose;
        }
        let job_id = self.next_job_id();
        let runs = self.vision.iter();
        let job = Job::StartViz {
            job_id,
            pose,
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
            has_branched: false,
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
        let exit = match self.exit_of(request.step, request.port) {
            Ok(exit) => exit,
            Err(status) => return status,
        };
        match &mut self.viz {
            VizRun::Running {
                job_id,
                waiting_at,
                latched,
                has_branched,
            } => {
                *has_branched = true;
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
            VizRun::Finished(path) if path.is_untouched() => Status::BranchSet,
            VizRun::Failed { is_told: false, .. } => Status::BranchSet,
            _ => Status::VizNoResult,
        }
    }

    /// The exit, from 0, that a port of a branch step stands for.
    fn exit_of(&self, step: i32, port: i32) -> Result<usize, Status> {
        let mut branches = self.viz_project.iter().flat_map(|viz| &viz.branches);
        let branch = branches
            .find(|branch| branch.step == step)
            .ok_or(Status::BadBranchStep)?;
        if port < 1 || port > branch.exits {
            return Err(Status::BadExitPort);
        }
        Ok(port as usize - 1)
    }

    /// Possible from 201 until the first 203 of the run.
    pub(crate) fn set_index(&mut self, request: &SetIndex) -> Status {
        let mut steps = self.viz_project.iter().flat_map(|viz| &viz.index_steps);
        let Some(step) = steps.find(|step| step.step == request.step) else {
            return Status::BadIndexStep;
        };
        if request.index < 1 || request.index > step.places {
            return Status::BadIndex;
        }
        match &self.viz {
            VizRun::NotStarted => Status::VizNoResult,
            VizRun::Running {
                job_id,
                has_branched: false,
                ..
            } => {
                self.jobs.push_back(Job::SetIndex {
                    job_id: *job_id,
                    step: request.step,
                    index: request.index as usize - 1,
                });
                Status::IndexSet
            }
            VizRun::Running { .. } | VizRun::Finished(_) | VizRun::Failed { .. } => {
                Status::IndexFailed
            }
        }
    }

    pub(crate) fn take_branch_wait(&mut self, waiting: JobId, step: i32) {
        let VizRun::Running {
            job_id,
            waiting_at,
            latched,
            ..
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

    pub(crate) fn take_viz_outcome(
        &mut self,
        finished: JobId,
        outcome: Result<PlannedPath, Status>,
    ) {
        if !matches!(&self.viz, VizRun::Running { job_id, .. } if *job_id == finished) {
            return;
        }
        let failed = |status| VizRun::Failed {
            status,
            is_told: false,
        };
        self.viz = match outcome.and_then(PathFetch::new) {
            Ok(path) if path.is_empty() => failed(Status::VizNoResult),
            Ok(path) => VizRun::Finished(path),
            Err(Status::PosesNotCustomData) => failed(Status::NoCustomData),
            Err(status) => failed(status),
        };
    }

    /// 201, 203 and 205 in one; nothing starts unless all three could be carried out.
    pub(crate) fn run_viz(&mut self, request: &RunViz, asked: Asked) -> Answer {
        const COMMAND: i32 = 200;
        let refuse = |status| Answer::Reply(Reply::status(COMMAND, status));
        if asked == Asked::Again {
            return self.next_viz_part(COMMAND, request.pose_type);
        }
        if self.viz_project.is_none() {
            return refuse(Status::VizNoAutoload);
        }
        if !matches!(request.pose_type, 1 | 2) {
            return refuse(Status::InvalidVizPathType);
        }
        let exit = match request.step {
            0 => None,
            step => match self.exit_of(step, request.port) {
                Ok(exit) => Some((step, exit)),
                Err(status) => return refuse(status),
            },
        };
        let is_sent = |values: &[f64; 6]| values.iter().any(|value| *value != 0.0);
        let flange = is_sent(&request.flange).then_some(&request.flange);
        let pose = match self.viz_flange(flange) {
            Err(status) => return refuse(status),
            Ok(None) if !is_sent(&request.joints_deg) => RobotPose::NotSent,
            Ok(base_from_flange) => RobotPose::Current {
                joints: is_sent(&request.joints_deg)
                    .then(|| JointPositions::from_degrees(&request.joints_deg)),
                base_from_flange,
            },
        };
        match self.begin_viz(pose) {
            Status::VizStarted => {}
            status => return refuse(status),
        }
        if let (
            Some((step, exit)),
            VizRun::Running {
                latched,
                has_branched,
                ..
            },
        ) = (exit, &mut self.viz)
        {
            latched.insert(step, exit);
            *has_branched = true;
        }
        self.next_viz_part(COMMAND, request.pose_type)
    }

    pub(crate) fn get_viz_path(&mut self, request: &GetVizPath) -> Answer {
        const COMMAND: i32 = 205;
        if !matches!(request.pose_type, 1 | 2) {
            return Answer::Reply(Reply::status(COMMAND, Status::InvalidVizPathType));
        }
        self.next_viz_part(COMMAND, request.pose_type)
    }

    /// The next part of the path, for 205, or for 200 in its form.
    fn next_viz_part(&mut self, command: i32, pose_type: i32) -> Answer {
        let port = self.settings.clone();
        match self.path_to_fetch(command, 205) {
            Err(answer) => answer,
            Ok(path) => Answer::Reply(Reply::Points {
                command,
                status: Status::VizFinished,
                list: path.next_part(port.profile.pose_cap, pose_type == 1, &port),
            }),
        }
    }

    pub(crate) fn get_plan_data(&mut self, request: &GetPlanData) -> Answer {
        const COMMAND: i32 = 210;
        if !(1..=4).contains(&request.format) {
            return Answer::Reply(Reply::status(COMMAND, Status::InvalidVizPathType));
        }
        let (wants_joints, wants_plan) = (matches!(request.format, 1 | 3), request.format >= 3);
        let euler = self.settings.euler;
        match self.path_to_fetch(COMMAND, COMMAND) {
            Err(answer) => answer,
            Ok(path) => Answer::Reply(Reply::PlanPoint(Box::new(path.next_plan_point(
                wants_joints,
                wants_plan,
                euler,
            )))),
        }
    }

    /// The path, at least one waypoint being left, reserved for `kind`; or the answer to `command` instead.
    fn path_to_fetch(&mut self, command: i32, kind: i32) -> Result<&mut PathFetch, Answer> {
        let refuse = |status| Err(Answer::Reply(Reply::status(command, status)));
        match &mut self.viz {
            VizRun::NotStarted => refuse(Status::VizNoResult),
            VizRun::Running { .. } => Err(Answer::Wait {
                on_timeout: Reply::status(command, Status::VizTimeout),
            }),
            VizRun::Failed { status, is_told } => {
                *is_told = true;
                refuse(*status)
            }
            VizRun::Finished(path) => {
                if path.is_drained() {
                    return refuse(Status::VizNoResult);
                }
                if path.fetched_by.is_some_and(|other| other != kind) {
                    return refuse(Status::NoPlanData);
                }
                path.fetched_by = Some(kind);
                Ok(path)
            }
        }
    }

    /// The list stays until the next 201, so it may be fetched before or after the path.
    pub(crate) fn get_do_list(&self, request: &GetDoList) -> Reply {
        let list = match &self.viz {
            VizRun::Finished(path) => path.do_list(request.sections),
            _ => None,
        };
        list.map_or_else(
            || Reply::status(206, Status::VizDoListMissing),
            |list| Reply::DoList(Box::new(list)),
        )
    }
}
