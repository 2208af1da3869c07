//! Corner points of mesh files: STL (text and binary), Wavefront OBJ and COLLADA.

mod collada;
mod obj;
mod stl;

use depal_frames::Point;

/// Most corners that are taken from one file.
const MOST_POINTS: usize = 5_000_000;

/// All corner points of a mesh in metres of the file's own unit (COLLADA: in metres, Z up).
pub(crate) fn points(name: &str, bytes: &[u8]) -> Result<Vec<Point>, String> {
    let ending = name.rsplit('.').next().unwrap_or("").to_lowercase();
    let points = match ending.as_str() {
        "stl" => stl::points(bytes)?,
        "obj" => obj::points(&text(bytes)?)?,
        "dae" => collada::points(&text(bytes)?)?,
        other => {
            return Err(format!(
                "files of kind '{other}' are not read; expected stl, obj or dae"
            ));
        }
    };
    if points.is_empty() {
        return Err("no corner points in it".to_owned());
    }
    if points.len() > MOST_POINTS {
        return Err(format!(
            "{} corner points, at most {MOST_POINTS}",
            points.len()
        ));
    }
    match points.iter().find(|p| p.iter().any(|v| !v.is_finite())) {
        Some(point) => Err(format!(
            "a corner at {:?} is not finite",
            point.coords.as_slice()
        )),
        None => Ok(points),
    }
}

fn text(bytes: &[u8]) -> Result<String, String> {
    String::from_utf8(bytes.to_vec()).map_err(|e| format!("not UTF-8 text: {e}"))
}

/// Numbers between blanks; how many there must be at least.
fn numbers(line: &str, least: usize) -> Result<Vec<f64>, String> {
    let read = |word: &str| {
        word.parse::<f64>()
            .map_err(|_| format!("'{word}' is not a number"))
    };
    let numbers: Vec<f64> = line
        .split_ascii_whitespace()
        .map(read)
        .collect::<Result<_, _>>()?;
    if numbers.len() < least {
        return Err(format!(
            "{} numbers, expected {least}: '{line}'",
            numbers.len()
        ));
    }
    Ok(numbers)
}
