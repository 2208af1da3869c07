use depal_frames::Point;

use super::numbers;

/// Bytes before the number of triangles.
const HEADER: usize = 80;
/// Bytes of one triangle: normal, three corners, attribute.
const TRIANGLE: usize = 50;

/// Binary when the length says so (some binary files begin with `solid`, too), else text.
pub(super) fn points(bytes: &[u8]) -> Result<Vec<Point>, String> {
    if let Some(count) = bytes.get(HEADER..HEADER + 4) {
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
        let body = &bytes[HEADER + 4..];
        let head = &bytes[..bytes.len().min(512)];
        let is_text = bytes.starts_with(b"solid") && !head.contains(&0);
        if count.checked_mul(TRIANGLE).is_some_and(|l| l <= body.len()) && !is_text {
            return Ok(binary(&body[..count * TRIANGLE]));
        }
        if !is_text {
            return Err(format!(
                "{count} triangles announced, but only {} bytes follow",
                body.len()
            ));
        }
    }
    ascii(bytes)
}

fn binary(triangles: &[u8]) -> Vec<Point> {
    let value = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    triangles
        .chunks_exact(TRIANGLE)
        .flat_map(|t| t[12..48].chunks_exact(12))
        .map(|p| Point::new(value(&p[..4]), value(&p[4..8]), value(&p[8..12])))
        .collect()
}

fn ascii(bytes: &[u8]) -> Result<Vec<Point>, String> {
    let text = String::from_utf8_lossy(bytes);
    if !text.trim_start().starts_with("solid") {
        return Err("neither a binary nor a text STL".to_owned());
    }
    text.lines()
        .filter_map(|line| line.trim().strip_prefix("vertex"))
        .map(|rest| numbers(rest, 3).map(|n| Point::new(n[0], n[1], n[2])))
        .collect()
}
