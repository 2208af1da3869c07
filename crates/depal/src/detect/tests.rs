use std::path::Path;

use depal_frames::Intrinsics;

use super::*;
use crate::image_file::depth_png;

#[test]
fn sizes_are_read_strictly() {
    let size = parse_size("300x400x250.5").expect("a size");
    for (side, mm) in size.to_mm().into_iter().zip([400.0, 300.0, 250.5]) {
        assert!((side - mm).abs() < 1e-9);
    }
    for wrong in [
        "",
        "400",
        "400x300",
        "400x300x250x1",
        "ax1x1",
        "400x-300x250",
        "400x300xNaN",
        "1x1x1",
        "400x300xinf",
    ] {
        let message = parse_size(wrong).unwrap_err();
        assert!(message.contains("400x300x250"), "{message}");
    }
}

/// A camera of 60 degrees.
fn camera(width: usize, height: usize) -> Intrinsics {
    Intrinsics {
        width,
        height,
        fx: width.max(height) as f64,
        fy: width.max(height) as f64,
        cx: (width as f64 - 1.0) / 2.0,
        cy: (height as f64 - 1.0) / 2.0,
    }
}

/// What `depal detect` says to these files, with known sizes and without.
fn answer(name: &str, png: &[u8], intrinsics: &Intrinsics) -> Result<(), String> {
    let folder = std::env::temp_dir().join(format!("depal-detect-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let (depth, model) = (folder.join("depth.png"), folder.join("intrinsics.json"));
    std::fs::write(&depth, png).expect("a file");
    let text = serde_json::to_vec(intrinsics).expect("text");
    std::fs::write(&model, text).expect("a file");
    let run = |boxes: Vec<String>| {
        let overlay = folder.join("overlay.png");
        let result = detect(&DetectArgs {
            depth: depth.clone(),
            intrinsics: model.clone(),
            boxes,
            depth_scale_mm: 0.1,
            intensity: None,
            overlay: Some(overlay.clone()),
            json: true,
        });
        match result {
            Ok(()) => {
                assert!(Path::is_file(&overlay), "{name}: no overlay");
                Ok(())
            }
            Err(Failure::Input(message)) => Err(message),
            Err(other) => panic!("{name}: {other:?}"),
        }
    };
    let known = run(vec!["400x300x250".to_owned()]);
    let any = run(Vec::new());
    assert_eq!(known, any);
    std::fs::remove_dir_all(&folder).expect("the folder goes");
    known
}

#[test]
fn frames_without_sense_are_frames_without_boxes() {
    for (name, width, height, z) in [
        ("zero", 320, 240, 0.0),
        ("one-value", 320, 240, 1.5),
        ("nearest-step", 320, 240, 0.0001),
        ("farthest-step", 320, 240, 6.5535),
        ("one-pixel", 1, 1, 1.5),
        ("one-row", 640, 1, 1.5),
        ("one-column", 1, 640, 1.5),
        ("wide", 16_384, 4, 1.5),
    ] {
        let i = camera(width, height);
        let png = depth_png(&i, &vec![z; width * height]).expect("encodes");
        assert_eq!(answer(name, &png, &i), Ok(()), "{name}");
    }
}

#[test]
fn a_wrong_camera_model_is_an_error_or_a_frame() {
    let i = camera(320, 240);
    // A board with a step across its middle.
    let depth: Vec<f32> = (0..320 * 240)
        .map(|n| if n % 320 < 160 { 1.5 } else { 1.8 })
        .collect();
    let png = depth_png(&i, &depth).expect("encodes");
    // Right in form, wrong in value: nothing to be seen in it.
    for (name, fx, cx) in [
        ("wide-lens", 40.0, 159.5),
        ("long-lens", 90_000.0, 159.5),
        ("beside", 320.0, -300.0),
    ] {
        let wrong = Intrinsics { fx, cx, ..i };
        assert_eq!(answer(name, &png, &wrong), Ok(()), "{name}");
    }
    for (name, wrong, word) in [
        ("size", camera(240, 320), "found 320 x 240"),
        ("fx", Intrinsics { fx: 0.3, ..i }, "fx: expected"),
        ("fy", Intrinsics { fy: -320.0, ..i }, "fy: expected"),
        ("cy", Intrinsics { cy: 1e7, ..i }, "cy: expected"),
    ] {
        let message = answer(name, &png, &wrong).expect_err(name);
        assert!(message.contains(word), "{name}: {message}");
    }
}

#[test]
fn a_cut_off_file_is_named() {
    let i = camera(64, 48);
    let png = depth_png(&i, &vec![1.5; 64 * 48]).expect("encodes");
    for length in [0, 1, 20, png.len() / 2] {
        let message = answer(&format!("cut-{length}"), &png[..length], &i).expect_err("cut off");
        assert!(
            message.contains("depth.png") && message.contains("not a whole PNG"),
            "{message}"
        );
    }
}
