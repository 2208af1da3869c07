//! One vision project of one session, and commands 101, 102, 103 and 501.

use depal_frames::{BoxSize, JointPositions};
use depal_wire::{
    GetVisionPoints, PointList, PointRecord, Reply, RobotPosePayload, SetBoxSize, StartVision,
    Status, SwitchRecipe,
};

use crate::dispatch::Answer;
use crate::job::{Job, JobId, RobotPose, VisionOutcome, VisionPoint};
use crate::session::Session;
use crate::settings::OutputPort;
use crate::wire_values::{pose_values, tcp_of_object};

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
    state: VisionState,
}

#[derive(Debug, Clone, Default)]
enum VisionState {
    #[default]
    NotStarted,
    Running {
        job_id: JobId,
        /// Wanted points, 0 for all.
        count: usize,
    },
    Ready {
        points: Vec<VisionPoint>,
        /// Points already sent.
        sent: usize,
    },
    Failed(Status),
}

impl VisionRun {
    fn is_running(&self) -> bool {
        matches!(self.state, VisionState::Running { .. })
    }
}

impl Session {
    pub(crate) fn start_vision(&mut self, request: &StartVision) -> Status {
        let Some(run) = self.vision.get(&request.job) else {
            return Status::UnknownJob;
        };
        let pose = match self.robot_pose(&request.pose) {
            Ok(pose) => pose,
            Err(status) => return status,
        };
        let Ok(count) = usize::try_from(request.count) else {
            return Status::InvalidPointCount;
        };
        if run.is_running() {
            return Status::VisionRunning;
        }
        let (recipe, box_size) = (run.recipe, run.box_size);
        let job_id = self.next_job_id();
        if let Some(run) = self.vision.get_mut(&request.job) {
            run.state = VisionState::Running { job_id, count };
        }
        self.jobs.push_back(Job::RunVision {
            job_id,
            project: request.job,
            recipe,
            box_size,
            pose,
        });
        Status::VisionTriggered
    }

    fn robot_pose(&self, payload: &RobotPosePayload) -> Result<RobotPose, Status> {
        let flange_pose = |values: &[f64; 6]| {
            let near = values[..3].iter().all(|v| v.abs() <= FARTHEST_FLANGE_MM)
                && values[3..].iter().all(|v| v.abs() <= LARGEST_ANGLE_DEG);
            if near {
                Ok(self.settings.euler.pose_from_mm_deg(*values))
            } else {
                Err(Status::InvalidVisionPose)
            }
        };
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

    pub(crate) fn get_vision_points(&mut self, request: &GetVisionPoints) -> Answer {
        const COMMAND: i32 = 102;
        let refuse = |status| Answer::Reply(Reply::status(COMMAND, status));
        let (cap, euler) = (self.settings.profile.pose_cap, self.settings.euler);
        let Some(project) = self.projects.get(&request.job) else {
            return refuse(Status::UnknownJob);
        };
        if project.output != OutputPort::Poses {
            return refuse(Status::WrongOutputPort);
        }
        let Some(run) = self.vision.get_mut(&request.job) else {
            return refuse(Status::UnknownJob);
        };
        match &mut run.state {
            VisionState::NotStarted => refuse(Status::VisionNotStarted),
            VisionState::Running { .. } => Answer::Wait {
                on_timeout: Status::VisionTimeout,
            },
            VisionState::Failed(status) => refuse(*status),
            VisionState::Ready { points, sent } if *sent == points.len() => {
                refuse(self.settings.all_fetched)
            }
            VisionState::Ready { points, sent } => {
                let part = &points[*sent..points.len().min(*sent + cap)];
                *sent += part.len();
                let list = PointList {
                    is_last: *sent == points.len(),
                    vision_move: 0,
                    points: part
                        .iter()
                        .map(|point| PointRecord {
                            values: pose_values(euler, &tcp_of_object(&point.base_from_object)),
                            label: point.label,
                            cell8: 0,
                        })
                        .collect(),
                };
                Answer::Reply(Reply::Points {
                    command: COMMAND,
                    status: Status::VisionResult,
                    list,
                })
            }
        }
    }

    pub(crate) fn switch_recipe(&mut self, request: &SwitchRecipe) -> Status {
        let (Some(project), Some(run)) = (
            self.projects.get(&request.job),
            self.vision.get_mut(&request.job),
        ) else {
            return Status::UnknownJob;
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
            return Status::UnknownJob;
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

    pub(crate) fn take_vision_outcome(&mut self, finished: JobId, outcome: VisionOutcome) {
        for run in self.vision.values_mut() {
            let VisionState::Running { job_id, count } = run.state else {
                continue;
            };
            if job_id != finished {
                continue;
            }
            run.state = match outcome {
                Err(status) => VisionState::Failed(status),
                Ok(points) if points.is_empty() => VisionState::Failed(Status::NoVisionResult),
                Ok(mut points) => {
                    if count > 0 {
                        points.truncate(count);
                    }
                    VisionState::Ready { points, sent: 0 }
                }
            };
            return;
        }
    }
}
