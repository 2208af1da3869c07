//! One vision project of one session, and commands 101, 103, 501 and 503.

use depal_frames::{BoxSize, JointPositions, Pose};
use depal_wire::{RobotPosePayload, SetBoxSize, SetInputPose, StartVision, Status, SwitchRecipe};

use crate::job::{Job, JobId, PlannedPath, RobotPose, VisionPoint, VisionResult};
use crate::path_fetch::{PathFetch, joined_rows};
use crate::session::Session;
use crate::settings::{OutputPort, VisionProject};

/// Largest flange coordinate that is taken for a pose, mm.
const FARTHEST_FLANGE_MM: f64 = 10_000.0;
/// Largest angle that is taken for a pose, degrees.
const LARGEST_ANGLE_DEG: f64 = 360.0;
/// Longest side of a box, mm.
const LONGEST_SIDE_MM: f64 = 10_000.0;

/// What a session remembers of one vision project.
#[derive(Debug, Clone, Default)]
pub(crate) struct VisionRun {
    /// Chosen by 103.
    pub(crate) recipe: Option<i32>,
    /// Set by 501.
    pub(crate) box_size: Option<BoxSize>,
    pub(crate) state: VisionState,
}

#[derive(Debug, Clone, Default)]
pub(crate) enum VisionState {
    #[default]
    NotStarted,
    Running {
        job_id: JobId,
        /// Wanted points, or waypoints of a reply; 0 for all.
        count: usize,
    },
    Points(PointFetch),
    Path {
        path: PathFetch,
        /// Waypoints of a reply, 0 for as many as fit.
        count: usize,
    },
    Failed(Status),
}

/// Vision points and how many are sent.
#[derive(Debug, Clone)]
pub(crate) struct PointFetch {
    pub(crate) points: Vec<VisionPoint>,
    /// Custom values by point; empty without custom ports.
    pub(crate) custom: Vec<Vec<f64>>,
    /// Points already sent.
    pub(crate) sent: usize,
    /// The command that fetches them: 102 and 110 are not to be mixed on one result.
    pub(crate) fetched_by: Option<i32>,
}

/// What a run found.
#[derive(Debug, Clone)]
pub(crate) enum VisionOutput {
    Points(VisionResult),
    Path(PlannedPath),
}

impl VisionRun {
    pub(crate) fn is_running(&self) -> bool {
        matches!(self.state, VisionState::Running { .. })
    }
}

impl Session {
    pub(crate) fn start_vision(&mut self, request: &StartVision) -> Status {
        if !self.vision.contains_key(&request.job) {
            return self.unknown_job();
        }
        let pose = match self.robot_pose(&request.pose) {
            Ok(pose) => pose,
            Err(status) => return status,
        };
        let Ok(count) = usize::try_from(request.count) else {
            return Status::InvalidPointCount;
        };
        self.begin_vision(request.job, count, pose)
    }

    /// 1011, or 1001 if there is no project at all.
    pub(crate) fn unknown_job(&self) -> Status {
        if self.projects.is_empty() {
            Status::VisionNotRegistered
        } else {
            Status::UnknownJob
        }
    }

    pub(crate) fn begin_vision(&mut self, project: i32, count: usize, pose: RobotPose) -> Status {
        let Some(run) = self.vision.get(&project) else {
            return self.unknown_job();
        };
        if run.is_running() {
            return Status::VisionRunning;
        }
        if self.needs_robot_pose && !pose.is_current() {
            return Status::InvalidVisionPose;
        }
        let (recipe, box_size) = (run.recipe, run.box_size);
        let job_id = self.next_job_id();
        if let Some(run) = self.vision.get_mut(&project) {
            run.state = VisionState::Running { job_id, count };
        }
        self.jobs.push_back(Job::RunVision {
            job_id,
            project,
            recipe,
            box_size,
            pose,
        });
        Status::VisionTriggered
    }

    pub(crate) fn robot_pose(&self, payload: &RobotPosePayload) -> Result<RobotPose, Status> {
        let flange_pose =
            |values: &[f64; 6]| self.near_pose(values).ok_or(Status::InvalidVisionPose);
        Ok(match payload {
            RobotPosePayload::NotSent => RobotPose::NotSent,
            RobotPosePayload::JointsAndFlange { joints_deg, flange } => RobotPose::Current {
                joints: Some(JointPositions::from_degrees(joints_deg)),
                base_from_flange: flange.as_ref().map(flange_pose).transpose()?,
            },
            RobotPosePayload::Flange(values) => RobotPose::Current {
                joints: None,
                base_from_flange: Some(flange_pose(values)?),
            },
            RobotPosePayload::StartJoints(joints_deg) => {
                RobotPose::PathStart(JointPositions::from_degrees(joints_deg))
            }
            RobotPosePayload::UnknownType(_) => return Err(Status::InvalidVisionPoseType),
        })
    }

    /// A pose from the wire, unless it is out of any reach.
    pub(crate) fn near_pose(&self, values: &[f64; 6]) -> Option<Pose> {
        let near = values[..3].iter().all(|v| v.abs() <= FARTHEST_FLANGE_MM)
            && values[3..].iter().all(|v| v.abs() <= LARGEST_ANGLE_DEG);
        near.then(|| self.settings.euler.pose_from_mm_deg(*values))
    }

    pub(crate) fn switch_recipe(&mut self, request: &SwitchRecipe) -> Status {
        let (Some(project), Some(run)) = (
            self.projects.get(&request.job),
            self.vision.get_mut(&request.job),
        ) else {
            return self.unknown_job();
        };
        if run.is_running() {
            Status::VisionRunning
        } else if project.recipes.is_empty() {
            Status::RecipesNotConfigured
        } else if project.recipes.contains(&request.recipe) {
            run.recipe = Some(request.recipe);
            Status::RecipeSwitched
        } else {
            Status::UnknownRecipe
        }
    }

    pub(crate) fn set_box_size(&mut self, request: &SetBoxSize) -> Status {
        let Some(run) = self.vision.get_mut(&request.job) else {
            return self.unknown_job();
        };
        if run.is_running() {
            return Status::VisionRunning;
        }
        let possible = |side: &f64| *side > 0.0 && *side <= LONGEST_SIDE_MM;
        if !request.size_mm.iter().all(possible) {
            return Status::InvalidBoxSize;
        }
        run.box_size = Some(BoxSize::from_mm(request.size_mm));
        Status::BoxSizeSet
    }

    pub(crate) fn set_input_pose(&mut self, request: &SetInputPose) -> Status {
        let (Some(project), Some(run)) = (
            self.projects.get(&request.job),
            self.vision.get(&request.job),
        ) else {
            return self.unknown_job();
        };
        if run.is_running() {
            return Status::VisionRunning;
        }
        let Some(pose) = self.near_pose(&request.pose) else {
            return Status::PoseNotSet;
        };
        if !project.input_steps.contains(&request.step) {
            return Status::PoseNotSet;
        }
        self.jobs.push_back(Job::SetInputPose {
            port: self.port,
            project: request.job,
            step: request.step.clone(),
            pose,
        });
        Status::PoseSet
    }

    pub(crate) fn take_vision_outcome(
        &mut self,
        finished: JobId,
        outcome: Result<VisionOutput, Status>,
    ) {
        for (id, run) in &mut self.vision {
            let VisionState::Running { job_id, count } = run.state else {
                continue;
            };
            if job_id != finished {
                continue;
            }
            let project = self.projects.get(id);
            let state = project
                .ok_or(Status::UnknownJob)
                .and_then(|project| ready_state(project, count, outcome?));
            run.state = state.unwrap_or_else(VisionState::Failed);
            return;
        }
    }
}

/// What a run leaves for the commands that fetch; the result has to fit the project's output.
fn ready_state(
    project: &VisionProject,
    count: usize,
    output: VisionOutput,
) -> Result<VisionState, Status> {
    match (project.output, output) {
        (OutputPort::Path, VisionOutput::Path(path)) => {
            let path = PathFetch::new(path)?;
            if path.is_empty() {
                return Err(Status::NoVisionResult);
            }
            Ok(VisionState::Path { path, count })
        }
        (OutputPort::Poses | OutputPort::Custom, VisionOutput::Points(mut result)) => {
            if result.points.is_empty() {
                return Err(Status::NoVisionResult);
            }
            let mut custom = Vec::new();
            if project.output == OutputPort::Custom {
                if result.custom_ports.is_empty() {
                    return Err(Status::PosesNotCustomData);
                }
                custom = joined_rows(result.custom_ports, result.points.len())?;
            }
            if count > 0 {
                result.points.truncate(count);
            }
            Ok(VisionState::Points(PointFetch {
                points: result.points,
                custom,
                sent: 0,
                fetched_by: None,
            }))
        }
        _ => Err(Status::WrongOutputPort),
    }
}
