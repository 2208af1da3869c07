//! What the server asks for, and how its work begins.

use std::collections::BTreeSet;

use depal_frames::{JointPositions, Pose};
use depal_interface::{Job, PortId, RobotPose, VariableValue};
use depal_time::SimTime;

use super::results::configured;
use super::{Owner, StepRun, VisionSide};
use crate::event::EventKind;
use crate::score::Score;
use crate::spec::CellSpec;

impl VisionSide {
    /// Starts the work that the server asks for.
    pub(crate) fn take_jobs(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        while let Some(job) = self.server.poll_job() {
            match job {
                Job::RunVision {
                    job_id,
                    project,
                    recipe,
                    box_size,
                    pose,
                } => {
                    let owner = Owner::Vision(job_id);
                    if let Some(engine) = self.path_engines.get(&project) {
                        let run = StepRun {
                            owner,
                            engine: engine.clone(),
                            start: start_of(spec, &pose),
                            reported: reported_flange(spec, &pose),
                            box_sizes: box_size.map(|size| (project, size)).into_iter().collect(),
                            recipes: recipe.map(|recipe| (project, recipe)).into_iter().collect(),
                            picture: None,
                            taken: BTreeSet::new(),
                        };
                        self.begin(now, spec, run, score, events);
                    } else {
                        let project = configured(spec, project, recipe, box_size);
                        let reported = reported_flange(spec, &pose);
                        self.expose(now, spec, owner, project, reported, score, events);
                    }
                }
                Job::StartViz {
                    job_id,
                    pose,
                    box_sizes,
                    recipes,
                } => {
                    let run = StepRun {
                        owner: Owner::Viz(job_id),
                        engine: self.engine.clone(),
                        start: start_of(spec, &pose),
                        reported: reported_flange(spec, &pose),
                        box_sizes,
                        recipes,
                        picture: None,
                        taken: BTreeSet::new(),
                    };
                    self.begin(now, spec, run, score, events);
                }
                Job::StopViz { job_id } => self.stop_viz(job_id),
                Job::SetIndex {
                    job_id,
                    step,
                    index,
                } => {
                    // The server knows the step's places; the engine takes the number of the command.
                    if let Some(run) = self.run_of(Owner::Viz(job_id)) {
                        let _taken = run.engine.set_index(step, index as i32 + 1);
                    }
                }
                Job::WriteParameter {
                    port,
                    step,
                    key,
                    value,
                } => self.write_parameter(port, step, &key, value),
                Job::SetOuterPose { base_from_tcp, .. } => {
                    self.engine.set_external_pose(base_from_tcp);
                }
                Job::SetInputPose { project, step, .. } => note(
                    events,
                    format!("project {project}: step {step} has a new input pose"),
                ),
                Job::SetVariable { name, value, .. } => {
                    note(events, format!("variable {name} is {}", text_of(&value)));
                }
                Job::SwitchSolution { solution, .. } => {
                    note(events, format!("solution {solution}"));
                }
                Job::CaptureCalibration {
                    number,
                    base_from_flange,
                    ..
                } => self.calibration.ask(now, number, base_from_flange),
                Job::NoCalibration { .. } => note(
                    events,
                    "command 701 is refused: no calibration is set up, the scene has no [calibration]"
                        .to_owned(),
                ),
                Job::SetBranch { job_id, exit, .. } => {
                    let owner = Owner::Viz(job_id);
                    if let Some(run) = self.run_of(owner) {
                        let ask = run.engine.branch(exit);
                        self.follow(now, spec, owner, ask, score, events);
                    }
                }
            }
        }
    }

    /// The change holds from the next run on; the server has checked the value against what the step takes.
    fn write_parameter(&mut self, port: PortId, step: i32, key: &str, value: f64) {
        if self.engine.set_parameter(step, key, value).is_err() {
            return;
        }
        let places = self.engine.project().index_steps();
        for (step, places) in places {
            self.server.set_places(port, step, places as i32);
        }
    }
}

/// The arm's own joints: a message always carries six.
fn of_arm(spec: &CellSpec, joints: &JointPositions) -> JointPositions {
    let count = spec.arm.joint_count().min(joints.len());
    let mut own = JointPositions::zeros(spec.arm.joint_count());
    own[..count].copy_from_slice(&joints[..count]);
    own
}

fn note(events: &mut Vec<EventKind>, text: String) {
    events.push(EventKind::Message { text });
}

fn text_of(value: &VariableValue) -> String {
    match value {
        VariableValue::Number(number) => number.to_string(),
        VariableValue::Numbers(numbers) => format!("{numbers:?}"),
        VariableValue::Text(text) => format!("{text:?}"),
        VariableValue::Texts(texts) => format!("{texts:?}"),
    }
}

/// Where the flange is in the base by what the robot has told: as such, or by its joints.
fn reported_flange(spec: &CellSpec, pose: &RobotPose) -> Option<Pose> {
    match pose {
        RobotPose::Current {
            base_from_flange: Some(base_from_flange),
            ..
        } => Some(*base_from_flange),
        RobotPose::Current {
            joints: Some(joints),
            ..
        } => Some(spec.arm.base_from_flange(&of_arm(spec, joints))),
        _ => None,
    }
}

/// Where a path starts: where the robot says it is, or the planner's home.
fn start_of(spec: &CellSpec, pose: &RobotPose) -> JointPositions {
    match pose {
        RobotPose::PathStart(joints)
        | RobotPose::Current {
            joints: Some(joints),
            ..
        } => of_arm(spec, joints),
        _ => JointPositions::zeros(spec.arm.joint_count()),
    }
}
