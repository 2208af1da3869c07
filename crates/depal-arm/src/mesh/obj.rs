use depal_frames::Point;

use super::numbers;

/// The `v` lines; whatever else a file holds does not move a corner.
pub(super) fn points(text: &str) -> Result<Vec<Point>, String> {
    text.lines()
        .filter_map(|line| line.trim_start().strip_prefix("v "))
        .map(|rest| numbers(rest, 3).map(|n| Point::new(n[0], n[1], n[2])))
        .collect()
}
