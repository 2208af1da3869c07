//! One exposure: rendered, estimated, and compared with the truth.

use depal_camera::{Capture, RenderShape, capture};
use depal_frames::Pose;
use depal_interface::Status;
use depal_time::{RandomStreams, SimTime};
use depal_vision::{Detection, detect};

use crate::event::{EventKind, LoggedDetection, LoggedPose, round};
use crate::observer::{CaptureView, Observer};
use crate::outcome::outcome;
use crate::score::Score;
use crate::spec::{CellSpec, VisionProject};
use crate::truth::{PICKABLE_FRACTION, TrueCarton, match_reports, visible_fraction};

/// What the camera could see at the instant of exposure, and the truth about it.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    /// Every solid in view.
    pub(crate) shapes: Vec<RenderShape>,
    /// Where the flange stands in the base; absent: where the robot says that it is.
    pub(crate) base_from_flange: Option<Pose>,
    /// Cartons that could be asked for.
    pub(crate) cartons: Vec<TrueCarton>,
}

/// A frame after vision: the estimate, and which true carton each report is (`None`: none).
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    /// The vision project that it was taken for.
    pub(crate) project: i32,
    pub(crate) detection: Detection,
    /// The label of each report, or why the project has nothing to say.
    pub(crate) labels: Result<Vec<i32>, Status>,
    /// Where the camera is taken to have been: calibrated, and on the flange that the robot has told.
    pub(crate) base_from_camera: Pose,
    /// Reported top-face poses in the robot base, through that camera pose.
    pub(crate) base_from_boxes: Vec<Pose>,
    /// By truth; goes into the score, never to vision, planner or program.
    pub(crate) cartons: Vec<Option<u32>>,
}

/// Takes and evaluates frame `number`. `reported` is the flange in the base as the robot has told it.
pub(crate) fn take_picture(
    spec: &CellSpec,
    project: &VisionProject,
    reported: Option<&Pose>,
    number: u32,
    now: SimTime,
    seen: &Seen,
    stopwatch: fn() -> f64,
    score: &mut Score,
    events: &mut Vec<EventKind>,
    observers: &mut [&mut dyn Observer],
) -> Picture {
    let noise_seed = RandomStreams::new(spec.seed)
        .stream(&format!("camera/{number}"))
        .next_u64();
    let world_from_camera = spec.world_from_camera(seen.base_from_flange.as_ref().or(reported));
    let Capture { frame, ids, .. } =
        capture(&spec.camera, &world_from_camera, &seen.shapes, noise_seed);
    let base_from_camera = spec.base_from_camera(reported);
    let started = stopwatch();
    let settings = project.settings_from(&base_from_camera).suited_to(&frame);
    let detection = detect(&frame, &settings);
    score.vision_ms.push((stopwatch() - started) * 1e3);
    let labels = outcome(project, &settings, &frame, &detection, events);

    let base_from_boxes: Vec<Pose> = detection
        .boxes
        .iter()
        .map(|found| base_from_camera * found.camera_from_box)
        .collect();
    let world_from_boxes: Vec<Pose> = base_from_boxes
        .iter()
        .map(|base_from_box| spec.world_from_base * base_from_box)
        .collect();

    let camera_from_world = world_from_camera.inverse();
    let visible = |carton: &TrueCarton| {
        visible_fraction(carton, &camera_from_world, &spec.camera.intrinsics, &ids)
    };
    let whole = |carton: &&TrueCarton| visible(carton) >= PICKABLE_FRACTION;
    let wanted: Vec<TrueCarton> = seen.cartons.iter().filter(whole).copied().collect();
    let matches = match_reports(&world_from_boxes, &seen.cartons);
    let found = |carton: &TrueCarton| matches.iter().flatten().any(|m| m.carton == carton.id);
    let missed: Vec<u32> = wanted
        .iter()
        .filter(|carton| !found(carton))
        .map(|carton| carton.id)
        .collect();

    score.frames += 1;
    score.pickable += wanted.len() as u64;
    score.found += (wanted.len() - missed.len()) as u64;
    score.false_picks += matches.iter().filter(|m| m.is_none()).count() as u64;
    for m in matches.iter().flatten() {
        score.pose_errors_mm.push(m.distance * 1e3);
        score.pose_errors_deg.push(m.angle.to_degrees());
    }

    let view = CaptureView {
        time: now,
        number,
        frame: &frame,
        world_from_camera: spec.world_from_base * base_from_camera,
        detections: world_from_boxes
            .iter()
            .zip(&detection.boxes)
            .map(|(pose, found)| {
                (
                    *pose,
                    [found.size.length, found.size.width, found.size.height],
                )
            })
            .collect(),
        truth: wanted
            .iter()
            .map(|carton| (carton.world_from_top(), carton.size))
            .collect(),
        obstacle_points: detection
            .obstacle_points
            .iter()
            .map(|point| spec.world_from_base * base_from_camera * point)
            .collect(),
    };
    for observer in observers.iter_mut() {
        observer.on_capture(&view);
    }
    events.push(EventKind::Vision {
        frame: number,
        detections: detection
            .boxes
            .iter()
            .zip(&world_from_boxes)
            .zip(&matches)
            .map(|((found, world_from_box), m)| LoggedDetection {
                world_from_box: LoggedPose::from(world_from_box),
                size_mm: found.size.to_mm().map(|side| round(side, 1e3)),
                confidence: round(found.confidence, 1e6),
                carton: m.map(|m| m.carton),
                error_mm: m.map(|m| round(m.distance * 1e3, 1e6)),
                error_deg: m.map(|m| round(m.angle.to_degrees(), 1e6)),
            })
            .collect(),
        missed,
        pickable: wanted.len(),
    });
    Picture {
        project: project.id,
        labels,
        cartons: matches.iter().map(|m| m.map(|m| m.carton)).collect(),
        base_from_camera,
        base_from_boxes,
        detection,
    }
}
