//! What a vision project says of a picture: the label of each carton that it found, or the code that says why there
//! is none.

use depal_frames::{BoxSize, DepthFrame};
use depal_interface::Status;
use depal_vision::{DetectedBox, Detection, RejectReason, VisionSettings, detect_any_size};

use crate::event::EventKind;
use crate::spec::VisionProject;

/// Cartons of another size than the known ones have sides that differ from theirs by less than this factor.
/// At twice the length it could as well be a slip sheet, or two cartons that stand together.
const SAME_KIND: f64 = 1.8;

/// The labels of what was found, one for each report.
///
/// # Errors
/// 1003: no depth point in the region. 1049: nothing of the known sizes, but whole cartons of another one.
/// 1048: flat tops that could not be told apart into cartons. 1002: nothing. 1010, 1017: see [`labels`].
/// What a person needs to know beside the code goes into the events.
pub(crate) fn outcome(
    project: &VisionProject,
    settings: &VisionSettings,
    frame: &DepthFrame,
    detection: &Detection,
    events: &mut Vec<EventKind>,
) -> Result<Vec<i32>, Status> {
    if detection.points_in_region == 0 {
        return Err(Status::NoPointsInRegion);
    }
    let said = if detection.boxes.is_empty() {
        Err(nothing_found(settings, frame, detection))
    } else {
        labels(&project.labels, &detection.boxes)
    };
    said.map_err(|(status, why)| {
        if !why.is_empty() {
            let (id, code) = (project.id, status.code());
            events.push(EventKind::Message {
                text: format!("vision project {id} says {code}: {why}"),
            });
        }
        status
    })
}

/// Why no carton of a known size was found, in the interface's words and for a person.
fn nothing_found(
    settings: &VisionSettings,
    frame: &DepthFrame,
    detection: &Detection,
) -> (Status, String) {
    let words = |sizes: &[BoxSize]| {
        let mut words: Vec<String> = sizes
            .iter()
            .map(|size| format!("{:.0} x {:.0} mm", size.length * 1e3, size.width * 1e3))
            .collect();
        words.dedup();
        words.join(", ")
    };
    let others: Vec<BoxSize> = detect_any_size(frame, settings)
        .boxes
        .iter()
        .map(|found| found.size)
        .filter(|size| is_another(size, settings))
        .collect();
    if !others.is_empty() {
        let why = format!(
            "it looks for cartons of {}, and sees {}",
            words(&settings.sizes),
            words(&others)
        );
        return (Status::BoxSizeCheckFailed, why);
    }
    let unclear = detection
        .rejected
        .iter()
        .filter(|surface| surface.reason == RejectReason::Ambiguous)
        .count();
    if unclear > 0 {
        let why = format!(
            "{unclear} flat {} may be cartons of {}, but in more than one arrangement",
            if unclear == 1 { "top" } else { "tops" },
            words(&settings.sizes)
        );
        return (Status::BoxMaskError, why);
    }
    (Status::NoVisionResult, String::new())
}

/// True of a measured size that is no known one, but might be that of a carton among them.
fn is_another(measured: &BoxSize, settings: &VisionSettings) -> bool {
    let sides = |size: &BoxSize| [size.length, size.width];
    let pairs = |known: &BoxSize| {
        let (a, b) = (sides(measured), sides(known));
        [[a[0], b[0]], [a[1], b[1]]]
    };
    let is_known = settings.sizes.iter().any(|known| {
        let tolerance = settings.size_tolerance;
        pairs(known).iter().all(|[a, b]| (a - b).abs() <= tolerance)
    });
    let is_kind = settings.sizes.iter().any(|known| {
        let factor = |[a, b]: &[f64; 2]| f64::max(a / b, b / a);
        pairs(known).iter().all(|pair| factor(pair) < SAME_KIND)
    });
    !is_known && is_kind
}

/// The label of each found carton: that of its size, or the size's place in the list where the project names none.
///
/// # Errors
/// 1010 where a found carton's size has no label, 1017 where its label is no whole number, each with what is wrong.
fn labels(labels: &[String], found: &[DetectedBox]) -> Result<Vec<i32>, (Status, String)> {
    let label = |found: &DetectedBox| {
        if labels.is_empty() {
            return Ok(found.label as i32);
        }
        let [length, width, height] = found.size.to_mm();
        let Some(text) = labels.get(found.label as usize) else {
            let why = format!(
                "{} labels are set up, and none is left for the size of {length:.0} x {width:.0} x {height:.0} mm",
                labels.len()
            );
            return Err((Status::PosesNotLabels, why));
        };
        text.trim().parse().map_err(|_| {
            let why = format!(
                "the label {text:?} is no whole number, and the interface sends only those"
            );
            (Status::LabelNotInteger, why)
        })
    };
    found.iter().map(label).collect()
}

#[cfg(test)]
mod tests;
