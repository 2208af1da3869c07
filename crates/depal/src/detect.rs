//! `depal detect`: carton poses from a depth image of any camera.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use depal_frames::{BoxSize, DepthFrame};
use depal_vision::{DetectedBox, Detection, RejectReason, VisionSettings};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::image_file::{colour_png, read_depth, read_grey, read_intrinsics, write};
use crate::overlay::overlay;

/// Arguments of `depal detect`.
#[derive(Args)]
pub struct DetectArgs {
    /// Depth image, 16-bit grey PNG; 0 = invalid.
    #[arg(value_name = "DEPTH.png")]
    depth: PathBuf,
    /// Pinhole model: {"width","height","fx","fy","cx","cy"} in pixels.
    #[arg(long, value_name = "FILE.json")]
    intrinsics: PathBuf,
    /// A known carton size in mm, as in 400x300x250; may be given many times. Without it, sizes are measured.
    #[arg(long = "box", value_name = "LxWxH", allow_hyphen_values = true)]
    boxes: Vec<String>,
    /// One step of the depth image, mm.
    #[arg(long, value_name = "MM", default_value_t = 0.1)]
    depth_scale_mm: f64,
    /// Intensity image of the same size, 8-bit grey PNG.
    #[arg(long, value_name = "FILE.png")]
    intensity: Option<PathBuf>,
    /// Write a picture of the result to this file.
    #[arg(long, value_name = "FILE.png")]
    overlay: Option<PathBuf>,
    /// Print the result as one JSON document on stdout; its time is the least of three estimations.
    #[arg(long)]
    json: bool,
}

/// Estimations that are timed; the least time counts, as other work on the computer only adds to it.
const TIMED_ESTIMATIONS: usize = 3;
/// After so long no further one is timed, ms.
const LONGEST_TIMING_MS: f64 = 200.0;

/// Reads, estimates, prints.
pub fn detect(args: &DetectArgs) -> Result<(), Failure> {
    if !(1e-4..=100.0).contains(&args.depth_scale_mm) {
        return Err(Failure::Input(format!(
            "--depth-scale-mm: expected 0.0001 to 100, found {}",
            args.depth_scale_mm
        )));
    }
    let sizes = args
        .boxes
        .iter()
        .map(|text| parse_size(text))
        .collect::<Result<Vec<_>, _>>()
        .map_err(Failure::Input)?;
    let intrinsics = read_intrinsics(&args.intrinsics)?;
    let frame = DepthFrame {
        intrinsics,
        depth: read_depth(&args.depth, &intrinsics, args.depth_scale_mm * 1e-3)?,
        intensity: match &args.intensity {
            Some(path) => read_grey(path, &intrinsics)?,
            None => Vec::new(),
        },
    };
    let estimate = || {
        let started = Instant::now();
        let settings = VisionSettings::new(sizes.clone()).suited_to(&frame);
        let detection = if sizes.is_empty() {
            depal_vision::detect_any_size(&frame, &settings)
        } else {
            depal_vision::detect(&frame, &settings)
        };
        (detection, started.elapsed().as_secs_f64() * 1e3)
    };
    // The first estimation fetches memory; the others are what a camera's computer does again and again.
    let (detection, mut time_ms) = estimate();
    let mut spent_ms = time_ms;
    for _ in 1..TIMED_ESTIMATIONS {
        if spent_ms > LONGEST_TIMING_MS {
            break;
        }
        let (_, again_ms) = estimate();
        time_ms = time_ms.min(again_ms);
        spent_ms += again_ms;
    }

    if let Some(path) = &args.overlay {
        write(
            path,
            &colour_png(&intrinsics, &overlay(&frame, &detection.boxes))?,
        )?;
    }
    if args.json {
        let boxes: Vec<Value> = detection.boxes.iter().map(box_json).collect();
        say!(
            "{}",
            json!({"boxes": boxes, "time_ms": round(time_ms, 1e3)})
        );
    } else {
        print_for_people(&frame, &detection, time_ms, !sizes.is_empty());
    }
    Ok(())
}

/// `sized`: sizes were given.
fn print_for_people(frame: &DepthFrame, detection: &Detection, time_ms: f64, sized: bool) {
    tell!("{} boxes in {time_ms:.1} ms", detection.boxes.len());
    for found in &detection.boxes {
        let at = found.camera_from_box.translation.vector * 1e3;
        let [l, w, _] = found.size.to_mm();
        tell!(
            "  at ({:8.1} {:8.1} {:8.1}) mm   {l:.0} x {w:.0} mm   confidence {:.2}",
            at.x,
            at.y,
            at.z,
            found.confidence
        );
    }
    match median_depth(frame) {
        None => tell!("no pixel of the depth image is valid"),
        Some(z) if detection.boxes.is_empty() && !LIKELY_DEPTHS.contains(&z) => {
            tell!("the depth is {z:.3} m in the median: is --depth-scale-mm right?");
        }
        Some(_) => {}
    }
    for refused in &detection.rejected {
        if let Some(reason) = refusal(refused.reason, sized) {
            let at = refused.centre_in_camera.coords * 1e3;
            tell!(
                "  refused: {:.2} m2 at ({:.0} {:.0} {:.0}) mm: {reason}",
                refused.area,
                at.x,
                at.y,
                at.z
            );
        }
    }
}

/// Where depth cameras over pallets work, metres.
const LIKELY_DEPTHS: std::ops::Range<f32> = 0.4..6.0;

/// In metres; `None` when no pixel is valid.
fn median_depth(frame: &DepthFrame) -> Option<f32> {
    let mut valid: Vec<f32> = frame.depth.iter().copied().filter(|z| *z > 0.0).collect();
    let middle = valid.len() / 2;
    (!valid.is_empty()).then(|| *valid.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Why a surface was not reported; `None` for what nobody takes for a carton.
fn refusal(reason: RejectReason, sized: bool) -> Option<&'static str> {
    match reason {
        RejectReason::Background => None,
        RejectReason::Tilted => Some("it leans more than a carton on a pallet does"),
        RejectReason::NotFlat => Some("it is not flat"),
        RejectReason::NoKnownSize if sized => {
            Some("no whole carton of a given size fits its outline")
        }
        RejectReason::NoKnownSize => {
            Some("no whole carton can be measured there; --box would say what to look for")
        }
        RejectReason::Covered => Some("something lies over it"),
        RejectReason::Ambiguous if !sized => {
            Some("it may be one carton or several; --box would tell")
        }
        RejectReason::Ambiguous => {
            Some("cartons could lie there in more than one way; an intensity image may tell")
        }
    }
}

fn box_json(found: &DetectedBox) -> Value {
    let at = found.camera_from_box.translation.vector * 1e3;
    let q = found.camera_from_box.rotation;
    let [l, w, h] = found.size.to_mm().map(|side| round(side, 1e3));
    let centre = [at.x, at.y, at.z].map(|x| round(x, 1e6));
    let height = if h > 0.0 { json!(h) } else { Value::Null };
    json!({
        "center_mm": centre,
        "quat_wxyz": [q.w, q.i, q.j, q.k],
        "size_mm": [json!(l), json!(w), height],
        "label": found.label,
        "confidence": round(found.confidence, 1e6),
    })
}

fn round(x: f64, steps: f64) -> f64 {
    (x * steps).round() / steps
}

/// "400x300x250" in mm; the longer of the first two sides becomes the length.
fn parse_size(text: &str) -> Result<BoxSize, String> {
    let wrong = || {
        format!(
            "--box {text}: expected length x width x height in mm, 20 to 3000 each, as in 400x300x250"
        )
    };
    let sides = text
        .split(['x', 'X'])
        .map(|side| side.trim().parse::<f64>())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|_| wrong())?;
    let &[a, b, c] = sides.as_slice() else {
        return Err(wrong());
    };
    if sides.iter().all(|side| (20.0..=3000.0).contains(side)) {
        Ok(BoxSize::from_mm([a.max(b), a.min(b), c]))
    } else {
        Err(wrong())
    }
}

#[cfg(test)]
mod tests;
