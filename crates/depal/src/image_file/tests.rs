use super::*;

fn intrinsics(width: usize, height: usize) -> Intrinsics {
    Intrinsics {
        width,
        height,
        fx: 100.0,
        fy: 100.0,
        cx: 0.0,
        cy: 0.0,
    }
}

fn some_depth(i: &Intrinsics) -> Vec<u8> {
    let depth: Vec<f32> = (0..i.width * i.height).map(|n| n as f32 * 1e-3).collect();
    depth_png(i, &depth).expect("encodes")
}

#[test]
fn depth_comes_back_to_the_step() {
    let i = intrinsics(40, 30);
    let depth = decode_depth(&some_depth(&i), &i, 1e-4).expect("decodes");
    assert_eq!(depth.len(), 1200);
    assert!((depth[1199] - 1.199).abs() < 5e-5 && depth[0] == 0.0);
    // Steps of 1 mm read ten times as far.
    let coarse = decode_depth(&some_depth(&i), &i, 1e-3).expect("decodes");
    assert!((coarse[100] - 1.0).abs() < 1e-6);
    // Deeper than 16 bits can say is invalid, not wrapped.
    let far = depth_png(&i, &vec![7.0; 1200]).expect("encodes");
    assert_eq!(
        decode_depth(&far, &i, 1e-4).expect("decodes"),
        vec![0.0; 1200]
    );
}

#[test]
fn every_truncation_is_an_error() {
    let i = intrinsics(40, 30);
    let whole = some_depth(&i);
    for length in 0..whole.len() {
        assert!(
            decode_depth(&whole[..length], &i, 1e-4).is_err(),
            "{length}"
        );
    }
}

#[test]
fn any_broken_byte_is_an_error_or_a_frame_but_no_panic() {
    let i = intrinsics(16, 8);
    let whole = some_depth(&i);
    for at in 0..whole.len() {
        for flip in [1, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] ^= flip;
            let _ = decode_depth(&bytes, &i, 1e-4);
        }
    }
}

#[test]
fn wrong_kind_and_size_are_named() {
    let i = intrinsics(40, 30);
    let grey = grey_png(&i, &[7; 1200]).expect("encodes");
    let message = decode_depth(&grey, &i, 1e-4).unwrap_err();
    assert!(message.contains("16 bit grey, found 8 bit"), "{message}");
    let colour = colour_png(&i, &[[1, 2, 3]; 1200]).expect("encodes");
    assert!(
        decode_depth(&colour, &i, 1e-4)
            .unwrap_err()
            .contains("found 8 bit colour")
    );
    let message = decode_depth(&some_depth(&i), &intrinsics(41, 30), 1e-4).unwrap_err();
    assert!(message.contains("41 x 30"), "{message}");
    assert!(message.contains("found 40 x 30"), "{message}");
}

#[test]
fn senseless_intrinsics_are_named() {
    let text = |width: &str, fx: &str, cx: &str| {
        format!(r#"{{"width":{width},"height":10,"fx":{fx},"fy":90.0,"cx":{cx},"cy":5}}"#)
    };
    let parse = |text: String| parse_intrinsics(text.as_bytes());
    assert!(parse(text("20", "90", "9.5")).is_ok());
    assert_eq!(parse(text("20.0", "90", "9.5")).expect("whole").width, 20);
    for (wrong, name) in [
        (text("0", "90", "9.5"), "width"),
        (text("20000", "90", "9.5"), "width"),
        (text("-3", "90", "9.5"), "-3"),
        (text("20.5", "90", "9.5"), "20.5"),
        (text("20", "0", "9.5"), "fx"),
        (text("20", "-90", "9.5"), "fx"),
        (text("20", "90", "1e9"), "cx"),
        (text("20", "\"a\"", "9.5"), "invalid type"),
        ("{}".to_owned(), "missing field"),
        ("no json".to_owned(), "expected"),
    ] {
        let message = parse(wrong).unwrap_err();
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn a_huge_header_is_refused_before_memory_is_asked_for() {
    // 60,000 x 60,000 pixels of 16 bits would be 7 GB.
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 60_000, 60_000);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    let mut writer = encoder.write_header().expect("a header");
    writer
        .write_chunk(png::chunk::IDAT, &[0])
        .expect("the start of an image");
    drop(writer);
    let message = decode_depth(&file, &intrinsics(1280, 1024), 1e-4).unwrap_err();
    assert!(message.contains("1280 x 1024"), "{message}");
    assert!(message.contains("60000 x 60000"), "{message}");
}

#[test]
fn the_smallest_and_the_widest_image_are_read() {
    for (width, height) in [(1, 1), (16_384, 1), (16_384, 4)] {
        let i = intrinsics(width, height);
        let depth = depth_png(&i, &vec![1.5; width * height]).expect("encodes");
        let depth = decode_depth(&depth, &i, 1e-4).expect("decodes");
        assert_eq!(depth.len(), width * height);
    }
}
