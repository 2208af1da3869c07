//! What a project says of pictures of flat tops over a floor.

use std::collections::BTreeMap;

use depal_frames::{BoxSize, DepthFrame, Intrinsics};
use depal_interface::Status;
use depal_vision::{VisionSettings, detect};

use super::outcome;
use crate::event::EventKind;
use crate::spec::VisionProject;

const TOP: f64 = 2.0;
const FLOOR: f64 = 2.5;

/// A camera that looks straight down on tops (middle and sides, metres) without any gap or noise.
fn picture(tops: &[[f64; 4]]) -> DepthFrame {
    let intrinsics = Intrinsics {
        width: 640,
        height: 512,
        fx: 608.0,
        fy: 608.0,
        cx: 319.5,
        cy: 255.5,
    };
    let mut depth = Vec::new();
    for v in 0..512 {
        for u in 0..640 {
            let x = (f64::from(u) - 319.5) / 608.0 * TOP;
            let y = (f64::from(v) - 255.5) / 608.0 * TOP;
            let is_top = tops.iter().any(|[mx, my, length, width]| {
                (x - mx).abs() <= length / 2.0 && (y - my).abs() <= width / 2.0
            });
            depth.push(if is_top { TOP } else { FLOOR } as f32);
        }
    }
    DepthFrame {
        intrinsics,
        depth,
        intensity: Vec::new(),
    }
}

/// What a project of these sizes (mm) and labels says, and the message beside it.
fn said(
    sizes: &[[f64; 3]],
    labels: &[&str],
    frame: &DepthFrame,
) -> (Result<Vec<i32>, Status>, String) {
    let sizes = sizes.iter().map(|size| BoxSize::from_mm(*size)).collect();
    let project = VisionProject {
        id: 3,
        settings: VisionSettings::new(sizes),
        region: None,
        labels: labels.iter().map(|label| (*label).to_owned()).collect(),
        recipes: BTreeMap::new(),
        custom_ports: Vec::new(),
        path: None,
    };
    let detection = detect(frame, &project.settings);
    let mut events = Vec::new();
    let said = outcome(&project, &project.settings, frame, &detection, &mut events);
    let words = events.iter().map(|event| match event {
        EventKind::Message { text } => text.as_str(),
        other => panic!("{other:?}"),
    });
    (said, words.collect())
}

const SIZE: [f64; 3] = [400.0, 300.0, 250.0];
const OTHER: [f64; 3] = [300.0, 200.0, 200.0];

#[test]
fn cartons_of_another_size_fail_the_size_check() {
    let frame = picture(&[[-0.3, 0.0, 0.4, 0.3], [0.3, 0.0, 0.4, 0.3]]);
    let (status, why) = said(&[OTHER], &[], &frame);
    assert_eq!(status, Err(Status::BoxSizeCheckFailed));
    assert!(why.starts_with("vision project 3 says 1049: "), "{why}");
    assert!(why.contains("of 300 x 200 mm, and sees 40"), "{why}");
    assert_eq!(said(&[SIZE], &[], &frame).0, Ok(vec![0, 0]));
}

#[test]
fn what_is_no_carton_fails_no_check() {
    let floor = picture(&[]);
    assert_eq!(said(&[SIZE], &[], &floor).0, Err(Status::NoVisionResult));
    // A sheet that lies there alone, and a board of a pallet.
    let sheet = picture(&[[0.0, 0.0, 0.85, 0.65]]);
    assert_eq!(said(&[SIZE], &[], &sheet).0, Err(Status::NoVisionResult));
    let board = picture(&[[0.0, 0.0, 1.2, 0.1]]);
    assert_eq!(said(&[SIZE], &[], &board).0, Err(Status::NoVisionResult));
    let mut dark = picture(&[[0.0, 0.0, 0.4, 0.3]]);
    dark.depth.fill(0.0);
    let (status, why) = said(&[SIZE], &[], &dark);
    assert_eq!((status, why.as_str()), (Err(Status::NoPointsInRegion), ""));
}

/// Twelve cartons without gaps or heights of their own: three rows of four, or four of three.
#[test]
fn cartons_that_cannot_be_told_apart_fail_the_mask() {
    let square = picture(&[[0.0, 0.0, 1.2, 1.2]]);
    let (status, why) = said(&[SIZE], &[], &square);
    assert_eq!(status, Err(Status::BoxMaskError), "{why}");
    assert!(why.contains("more than one arrangement"), "{why}");
}

#[test]
fn labels_go_by_the_sizes() {
    let frame = picture(&[[-0.3, 0.0, 0.4, 0.3], [0.3, 0.0, 0.3, 0.2]]);
    let both = [SIZE, OTHER];
    let mut found = said(&both, &["70", " 8"], &frame).0.unwrap();
    found.sort_unstable();
    assert_eq!(found, [8, 70]);
    let (status, why) = said(&both, &["70"], &frame);
    assert_eq!(status, Err(Status::PosesNotLabels));
    assert!(why.contains("300 x 200 x 200 mm"), "{why}");
    let (status, why) = said(&both, &["70", "blue"], &frame);
    assert_eq!(status, Err(Status::LabelNotInteger));
    assert!(why.contains("\"blue\""), "{why}");
    // No carton of the nameless size is there: nothing is missing.
    let alone = picture(&[[0.0, 0.0, 0.4, 0.3]]);
    assert_eq!(said(&both, &["70"], &alone).0, Ok(vec![70]));
}
