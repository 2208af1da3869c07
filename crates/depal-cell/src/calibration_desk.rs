//! Where the pictures of command 701 are asked for, taken and made into a camera pose.

use std::collections::VecDeque;

use depal_camera::RenderShape;
use depal_frames::Pose;
use depal_time::SimTime;
use depal_vision::calibration::Calibration;

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
    /// robot is where it says it is. After the last pose, if all went well, where the camera is on what carries
    /// it: in the base, or on the flange.
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
                        events.push(logged(&result, run.pictures(), spec));
                        found = Some(result.camera);
                    }
                    Err(problem) => events.push(say(format!("no calibration: {problem}"))),
                }
                self.run = None;
            }
        }
        found
    }
}

fn logged(result: &Calibration, taken: u32, spec: &CellSpec) -> EventKind {
    let truth = spec.true_carrier_from_camera();
    let distance = result.camera.translation.vector - truth.translation.vector;
    let angle = result.camera.rotation.angle_to(&truth.rotation);
    let is_on_flange = spec.is_eye_in_hand();
    let camera = LoggedPose::from(&result.camera);
    EventKind::Calibrated {
        base_from_camera: (!is_on_flange).then_some(camera),
        flange_from_camera: is_on_flange.then_some(camera),
        residual_rms_mm: round(result.rms * 1e3, 1e6),
        residual_max_mm: round(result.max * 1e3, 1e6),
        used: result.poses.iter().filter(|pose| pose.used).count(),
        taken: taken as usize,
        error_mm: round(distance.norm() * 1e3, 1e6),
        error_deg: round(angle.to_degrees(), 1e6),
    }
}

fn summary(result: &Calibration, spec: &CellSpec) -> String {
    let at = result.camera.translation.vector * 1e3;
    let before = spec.carrier_from_camera;
    let carrier = if spec.is_eye_in_hand() {
        "on the flange"
    } else {
        "in the base"
    };
    let moved = (result.camera.translation.vector - before.translation.vector).norm() * 1e3;
    let turned = result
        .camera
        .rotation
        .angle_to(&before.rotation)
        .to_degrees();
    format!(
        "calibrated: camera at ({:.2}, {:.2}, {:.2}) mm {carrier}, {moved:.2} mm and {turned:.3} degrees \
         from before, residual {:.3} mm, {} of {} poses used",
        at.x,
        at.y,
        at.z,
        result.rms * 1e3,
        result.poses.iter().filter(|pose| pose.used).count(),
        result.poses.len()
    )
}
