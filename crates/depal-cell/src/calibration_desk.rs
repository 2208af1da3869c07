//! Where the pictures of command 701 are asked for, taken and made into a camera pose.

use std::collections::VecDeque;

use depal_camera::RenderShape;
use depal_frames::Pose;
use depal_time::SimTime;
use depal_vision::calibration::{Calibration, Mounting};

use crate::calibration::CalibrationRun;
use crate::event::{EventKind, LoggedPose, round};
use crate::spec::CellSpec;

/// A picture that is asked for.
struct Shot {
    due: SimTime,
    /// Which pose of the dialogue, from 1.
    number: usize,
    /// Where the robot says that it stands.
    reported: Pose,
}

/// The calibration of one session.
#[derive(Default)]
pub(crate) struct CalibrationDesk {
    run: Option<CalibrationRun>,
    shots: VecDeque<Shot>,
}

impl CalibrationDesk {
    /// The robot stands at pose `number` and waits for the answer: the picture is taken at once.
    pub(crate) fn ask(&mut self, now: SimTime, number: usize, reported: Pose) {
        self.shots.push_back(Shot {
            due: now,
            number,
            reported,
        });
    }

    /// When the next picture is due.
    pub(crate) fn next_due(&self) -> Option<SimTime> {
        self.shots.front().map(|shot| shot.due)
    }

    /// Whether a picture is due.
    pub(crate) fn is_due(&self, now: SimTime) -> bool {
        self.next_due().is_some_and(|due| due <= now)
    }

    /// Takes the pictures that are due. `standing` is where the flange stands (in the base); without it the
    /// robot is where it says it is. The new `base_from_camera` after the last pose, if there is one.
    pub(crate) fn advance(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        shapes: &[RenderShape],
        standing: Option<Pose>,
        events: &mut Vec<EventKind>,
    ) -> Option<Pose> {
        let mut found = None;
        while self.is_due(now) {
            let Some(shot) = self.shots.pop_front() else {
                break;
            };
            let say = |text: String| EventKind::Message { text };
            let Some(calibration) = &spec.calibration else {
                events.push(say(format!(
                    "calibration pose {}: no board is set up",
                    shot.number
                )));
                continue;
            };
            if shot.number == 1 || self.run.is_none() {
                self.run = CalibrationRun::new(calibration).ok();
            }
            let Some(run) = &mut self.run else {
                continue;
            };
            let standing = standing.unwrap_or(shot.reported);
            let told = match run.capture(spec, shapes.to_vec(), &standing, &shot.reported) {
                Ok(report) => format!(
                    "all discs found, {:.3} mm from a flat board",
                    report.view.rms * 1e3
                ),
                Err(problem) => problem.to_string(),
            };
            events.push(say(format!("calibration pose {}: {told}", shot.number)));
            if shot.number >= spec.interface.calibration.len() {
                match run.finish() {
                    Ok(result) => {
                        events.push(say(summary(&result, spec)));
                        if let Some(base_from_camera) = base_from_camera(&result) {
                            events.push(logged(&result, run.pictures(), &base_from_camera, spec));
                            found = Some(base_from_camera);
                        }
                    }
                    Err(problem) => events.push(say(format!("no calibration: {problem}"))),
                }
                self.run = None;
            }
        }
        found
    }
}

fn logged(result: &Calibration, taken: u32, base_from_camera: &Pose, spec: &CellSpec) -> EventKind {
    let truth = spec.world_from_base.inverse() * spec.world_from_camera;
    let distance = base_from_camera.translation.vector - truth.translation.vector;
    let angle = base_from_camera.rotation.angle_to(&truth.rotation);
    EventKind::Calibrated {
        base_from_camera: LoggedPose::from(base_from_camera),
        residual_rms_mm: round(result.rms * 1e3, 1e6),
        residual_max_mm: round(result.max * 1e3, 1e6),
        used: result.poses.iter().filter(|pose| pose.used).count(),
        taken: taken as usize,
        error_mm: round(distance.norm() * 1e3, 1e6),
        error_deg: round(angle.to_degrees(), 1e6),
    }
}

/// The pose that detections go through; a camera on the flange has none of its own.
fn base_from_camera(result: &Calibration) -> Option<Pose> {
    (result.mounting == Mounting::EyeToHand).then_some(result.camera)
}

fn summary(result: &Calibration, spec: &CellSpec) -> String {
    let at = result.camera.translation.vector * 1e3;
    let before = spec.base_from_camera;
    let moved = (result.camera.translation.vector - before.translation.vector).norm() * 1e3;
    let turned = result
        .camera
        .rotation
        .angle_to(&before.rotation)
        .to_degrees();
    format!(
        "calibrated: camera at ({:.2}, {:.2}, {:.2}) mm in the base, {moved:.2} mm and {turned:.3} degrees \
         from before, residual {:.3} mm, {} of {} poses used",
        at.x,
        at.y,
        at.z,
        result.rms * 1e3,
        result.poses.iter().filter(|pose| pose.used).count(),
        result.poses.len()
    )
}
