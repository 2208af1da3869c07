//! The steps of a scene as workflows: the planning project's, and those of vision projects that plan a path.

use depal_frames::nalgebra::Translation3;
use depal_frames::{JointPositions, Pose, Rotation, Vector};
use depal_workflow::{
    CartonPattern, Grid, Layers, MoveMotion, Next, OffsetFrame, Place, Project, Reference, Step,
    StepKind, Travel,
};

use super::solids::pose_mm_yaw;
use crate::scene::Scene;
use crate::vision::VisionProject;
use crate::viz::{MoveFrame, MoveReference, StepMotion, VizAction};

/// Recognise, pick, place on the conveyor.
pub(super) fn path_steps(project: &VisionProject) -> Project {
    Project::new(vec![
        Step::new(
            1,
            StepKind::VisualRecognition {
                project: i32::from(project.id),
                reuses_result: false,
            },
        ),
        Step::new(
            2,
            StepKind::VisionMove {
                uses_sections: true,
                plans_all: project.plan_all_vision_results,
                max_group: 1,
                velocity_percent: project.velocity_percent,
            },
        ),
        Step::new(
            3,
            StepKind::PalletPattern {
                place: Place::Conveyor,
            },
        ),
    ])
}

/// The planning project.
pub(super) fn workflow(scene: &Scene) -> Project {
    let steps = scene.viz.steps.iter().map(|step| {
        let next = match step.next {
            None => Next::Following,
            Some(0) => Next::End,
            Some(id) => Next::Step(i32::from(id)),
        };
        Step::new(i32::from(step.id), kind(&step.action)).then(next)
    });
    Project {
        steps: steps.collect(),
        global_velocity_percent: scene.viz.velocity_percent,
    }
}

fn travel(motion: StepMotion, velocity_percent: f64) -> Travel {
    match motion {
        StepMotion::Joint => Travel::joint(velocity_percent),
        StepMotion::Linear => Travel {
            motion: MoveMotion::Linear,
            velocity_percent,
        },
    }
}

fn pose_mm_rpy(xyz_mm: [f64; 3], rpy_deg: [f64; 3]) -> Pose {
    let [roll, pitch, yaw] = rpy_deg.map(f64::to_radians);
    Pose::from_parts(
        Translation3::from(Vector::from(xyz_mm) * 1e-3),
        Rotation::from_euler_angles(roll, pitch, yaw),
    )
}

fn kind(action: &VizAction) -> StepKind {
    match action {
        VizAction::VisualRecognition(step) => StepKind::VisualRecognition {
            project: i32::from(step.project),
            reuses_result: step.reuse_vision_result,
        },
        VizAction::VisionMove(step) => StepKind::VisionMove {
            uses_sections: step.sections,
            plans_all: step.plan_all_vision_results,
            max_group: step.group_max,
            velocity_percent: step.velocity_percent,
        },
        VizAction::PalletPattern(_) => StepKind::PalletPattern {
            place: Place::Conveyor,
        },
        VizAction::FixedPointMove(step) => StepKind::FixedPointMove {
            joints: JointPositions::from_degrees(&step.joints_deg),
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::RelativeMove(step) => StepKind::RelativeMove {
            offset: pose_mm_rpy(step.xyz_mm, step.rpy_deg),
            frame: match step.frame {
                MoveFrame::Tool => OffsetFrame::Tool,
                MoveFrame::Base => OffsetFrame::Base,
            },
            reference: match step.relative_to {
                MoveReference::Previous => Reference::Previous,
                MoveReference::Next => Reference::Next,
            },
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::MoveByList(step) => StepKind::MoveByList {
            targets: step
                .joints_deg
                .iter()
                .map(|joints| JointPositions::from_degrees(joints))
                .collect(),
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::MoveByGrid(step) => StepKind::MoveByGrid {
            grid: Grid {
                base_from_first: pose_mm_rpy(step.base_xyz_mm, step.base_rpy_deg),
                counts: step.counts,
                offsets: step.offsets_mm.map(|offset| offset * 1e-3),
            },
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::CustomPalletPattern(step) => StepKind::CartonPattern {
            pattern: CartonPattern::Custom(
                step.places
                    .iter()
                    .map(|place| pose_mm_yaw(place.xyz_mm, place.yaw_deg))
                    .collect(),
            ),
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::PredefinedPalletPattern(step) => StepKind::CartonPattern {
            pattern: CartonPattern::Predefined(Layers {
                base_from_first: pose_mm_yaw(step.base_xyz_mm, step.base_yaw_deg),
                rows: step.rows,
                columns: step.columns,
                layers: step.layers,
                pitch: step.pitch_mm.map(|pitch| pitch * 1e-3),
                is_alternating: step.alternating,
            }),
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::BranchByMsg(step) => StepKind::BranchByMsg {
            exits: step.exits.iter().map(|exit| i32::from(*exit)).collect(),
        },
        VizAction::ExternalMove(step) => StepKind::ExternalMove {
            travel: travel(step.motion, step.velocity_percent),
        },
        VizAction::SetDo(_) => StepKind::SetDo,
        VizAction::Notify(step) => StepKind::Notify {
            message: step.message as i32,
        },
    }
}
