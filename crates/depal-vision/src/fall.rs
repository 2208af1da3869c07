//! How a smeared step falls, along a line of the picture.

/// A line with what is lost, up to `widest` in a row, as on a straight line between its ends.
pub fn bridged(line: impl Iterator<Item = f32>, widest: usize) -> Vec<f32> {
    let mut line: Vec<f32> = line.collect();
    let mut last: Option<usize> = None;
    for k in 0..line.len() {
        if line[k].is_nan() {
            continue;
        }
        if let Some(last) = last.filter(|l| (2..=widest + 1).contains(&(k - l))) {
            let (a, b) = (line[last], line[k]);
            for (n, between) in line[last + 1..k].iter_mut().enumerate() {
                *between = a + (b - a) * (n + 1) as f32 / (k - last) as f32;
            }
        }
        last = Some(k);
    }
    line
}

/// How many times deeper it is some smears (`ahead`) beyond an edge than at it, where the wall below is seen over so many
/// smears: means over a smear of a slope that ends as level ground.
pub fn growth(wall: f64, ahead: f64) -> f64 {
    let mean = |seen: f64| {
        if seen < wall {
            0.5 * seen * seen / wall
        } else {
            seen - 0.5 * wall.max(0.0)
        }
    };
    mean(0.5 + ahead) / mean(0.5)
}
