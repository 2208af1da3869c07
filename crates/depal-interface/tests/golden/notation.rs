//! What the words of a transcript mean.

use std::fmt::Write as _;

use depal_frames::{BoxSize, EulerConvention, JointPositions, Pose, Vector};
use depal_interface::*;

/// Bytes of a `->` or `<-` line, if it is meant for this encoding.
pub fn bytes_of(line: &str, encoding: Encoding) -> Option<Vec<u8>> {
    let (kind, body) = line.split_once(' ').expect("kind and bytes");
    let body = body.trim();
    if (kind == "ascii") == encoding.is_hex() {
        return None;
    }
    if kind == "ascii" {
        return Some(body.replace("\\r", "\r").into_bytes());
    }
    let mut bytes = Vec::new();
    for word in body.split_whitespace().filter(|word| *word != "|") {
        match word.strip_prefix('+') {
            Some(zeros) => bytes.resize(bytes.len() + zeros.parse::<usize>().expect("zeros"), 0),
            None => bytes.push(u8::from_str_radix(word, 16).expect("a byte")),
        }
    }
    if encoding == Encoding::HexBigEndian {
        bytes.chunks_exact_mut(4).for_each(<[u8]>::reverse);
    }
    Some(bytes)
}

/// Text as it is, cells in hexadecimal, so that a failure can be read.
pub fn readable(bytes: Vec<u8>) -> String {
    let is_text = bytes.iter().all(|b| matches!(b, b' '..=b'~' | b'\r'));
    if is_text && !bytes.is_empty() {
        return String::from_utf8_lossy(&bytes).into_owned();
    }
    let mut text = format!("{} bytes:", bytes.len());
    for cell in bytes.chunks(4) {
        text.push(' ');
        for byte in cell {
            write!(text, "{byte:02x}").expect("writing to a string");
        }
    }
    text
}

pub fn numbers(text: &str) -> Vec<f64> {
    text.split(',')
        .map(|n| n.parse().expect("a number"))
        .collect()
}

pub fn six(text: &str) -> [f64; 6] {
    numbers(text).try_into().expect("six numbers")
}

pub fn status(text: &str) -> Status {
    Status::from_code(text.parse().expect("a code")).expect("a known code")
}

pub fn project(text: &str) -> VisionProject {
    let fields: Vec<&str> = text.split(':').collect();
    VisionProject {
        id: fields[0].parse().expect("project number"),
        output: match fields[1] {
            "poses" => OutputPort::Poses,
            "path" => OutputPort::Path,
            "custom" => OutputPort::Custom,
            other => panic!("output {other}"),
        },
        recipes: fields.get(2).map_or(Vec::new(), |list| {
            list.split('+')
                .map(|r| r.parse().expect("recipe"))
                .collect()
        }),
        ..VisionProject::default()
    }
}

/// The 21 numbers of the standard, in their order on the wire.
pub fn vision_move(values: &[f64]) -> VisionMoveData {
    let mut labels = [0; 10];
    for (label, value) in labels.iter_mut().zip(values) {
        *label = *value as i32;
    }
    VisionMoveData {
        labels,
        picked_total: values[10] as i32,
        picked_now: values[11] as i32,
        edge_or_corner: values[12] as i32,
        group_from_tcp_offset: Vector::new(values[13], values[14], values[15]) * 1e-3,
        is_group_square: values[16] != 0.0,
        is_box_square: values[17] != 0.0,
        group_size: BoxSize::from_mm([values[18], values[19], values[20]]),
    }
}

pub fn vision_point(text: &str) -> VisionPoint {
    let v = numbers(text);
    VisionPoint {
        base_from_object: Pose::new(
            Vector::new(v[0], v[1], v[2]) * 1e-3,
            Vector::z() * v[3].to_radians(),
        ),
        label: v[4] as i32,
    }
}

pub fn custom_port(text: &str) -> CustomPort {
    let (name, rows) = text.split_once('=').expect("PORT=ROWS");
    CustomPort {
        name: name.to_owned(),
        rows: rows.split('|').map(numbers).collect(),
    }
}

/// Pose n of the calibrations in the transcripts.
pub fn calibration_pose(n: f64) -> CalibrationPose {
    CalibrationPose {
        base_from_flange: EulerConvention::AbbZyx.pose_from_mm_deg([
            600.0 + 10.0 * n,
            0.0,
            800.0,
            0.0,
            0.0,
            180.0,
        ]),
        joints: JointPositions::from_degrees(&[10.0 * n, 0.0, 10.0, 0.0, 30.0, 0.0]),
    }
}
