//! Before stage 1: cameras that match patches of a picture smear depth steps over many pixels. The
//! step stands where the depth is half way; there it is put back.

/// Least depth step that counts, metres: less is noise of such a camera, or a carton's edge.
const LEAST_STEP: f32 = 0.030;
/// Half of the widest smear that is looked for, pixels.
const REACH: usize = 12;
/// Shares of a step between which a pixel is on it.
const LEVELS: (f32, f32) = (0.15, 0.85);
/// Fewer steps say nothing.
const LEAST_STEPS: usize = 100;

/// Steps are higher than so many deviations of the noise.
const LEAST_SIGMAS: f32 = 12.0;

/// How many measured pixels lie on the steps along the rows of a frame, as pixels of a whole step; 0 where they are
/// sharp, `None` where there are too few. What is lost beside a step is not counted: sharp cameras lose pixels there as
/// well.
pub fn pixels_on_steps(depth: &[f32], width: usize) -> Option<usize> {
    let mut widths: Vec<usize> = Vec::new();
    if width < 4 * REACH {
        return None;
    }
    for row in depth.chunks_exact(width).step_by(4) {
        let mut u = REACH + 4;
        while u + REACH + 4 < width {
            if let Some((a, b)) = ends(row, u) {
                let between = row[u - REACH..=u + REACH].iter().filter(|&&z| {
                    let share = (z - a) / (b - a);
                    z > 0.0 && share > LEVELS.0 && share < LEVELS.1
                });
                widths.push(between.count());
                u += 2 * REACH;
            }
            u += 4;
        }
    }
    whole_step(widths)
}

/// The level depths on both sides of a place on a line, where they differ by more than a step.
#[inline(always)]
fn ends(line: &[f32], u: usize) -> Option<(f32, f32)> {
    let line = &line[u - REACH - 4..=u + REACH + 4];
    level_ends(line[4], line[0], line[2 * REACH + 4], line[2 * REACH + 8])
}

/// The same of the depths on both sides and of those beside them, farther out.
#[inline(always)]
fn level_ends(a: f32, beside_a: f32, b: f32, beside_b: f32) -> Option<(f32, f32)> {
    let level =
        |at: f32, beside: f32| at > 0.0 && beside > 0.0 && (at - beside).abs() < 0.2 * LEAST_STEP;
    // There are few steps: that comes first.
    ((a - b).abs() > LEAST_STEP && level(a, beside_a) && level(b, beside_b)).then_some((a, b))
}

/// Median of the widths between the levels, as that of a whole step; `None` of too few.
fn whole_step(mut widths: Vec<usize>) -> Option<usize> {
    if widths.len() < LEAST_STEPS {
        return None;
    }
    let middle = widths.len() / 2;
    let inner = *widths.select_nth_unstable(middle).1;
    Some((inner as f32 / (LEVELS.1 - LEVELS.0)).round() as usize)
}

/// Over how many pixels the steps of a frame are smeared, along rows and columns, what is lost on them included; 0
/// where they are sharp. `noise`: deviation at a depth of one metre, metres; it goes with the square of depth.
pub fn smear_of(depth: &[f32], width: usize, noise: f32) -> usize {
    let height = depth.len() / width.max(1);
    let mut widths: Vec<usize> = Vec::new();
    for row in depth.chunks_exact(width.max(1)).step_by(4) {
        widths_along(row, noise, &mut widths);
    }
    // Down all columns at once, as rows lie together in memory; each goes on behind the step that it met.
    let mut next = vec![0usize; width];
    let mut column = [0.0; 2 * REACH + 1];
    let row = |v: usize| &depth[v * width..(v + 1) * width];
    for v in (REACH + 4..height.saturating_sub(REACH + 4)).step_by(4) {
        let (a, beside_a) = (row(v - REACH), row(v - REACH - 4));
        let (b, beside_b) = (row(v + REACH), row(v + REACH + 4));
        for u in (0..width).step_by(4) {
            let Some(ends) = level_ends(a[u], beside_a[u], b[u], beside_b[u]) else {
                continue;
            };
            if next[u] > v || !is_step(ends, noise) {
                continue;
            }
            for (k, z) in column.iter_mut().enumerate() {
                *z = depth[(v - REACH + k) * width + u];
            }
            widths.extend(width_of(&column, ends));
            next[u] = v + 2 * REACH + 4;
        }
    }
    whole_step(widths).unwrap_or(0)
}

/// Over how many pixels each step along a line goes from one of the levels to the other.
fn widths_along(row: &[f32], noise: f32, widths: &mut Vec<usize>) {
    let mut u = REACH + 4;
    while u + REACH + 4 < row.len() {
        if let Some(ends) = ends(row, u).filter(|ends| is_step(*ends, noise)) {
            widths.extend(width_of(&row[u - REACH..=u + REACH], ends));
            u += 2 * REACH;
        }
        u += 4;
    }
}

/// True when two levels differ by more than noise of the given deviation at one metre.
fn is_step((a, b): (f32, f32), noise: f32) -> bool {
    let z = a.max(b);
    (a - b).abs() > LEAST_SIGMAS * noise * z * z
}

/// Over how many pixels a line goes from one level to the other; `None` where most of them are lost.
fn width_of(line: &[f32], (a, b): (f32, f32)) -> Option<usize> {
    // What is lost beside the step must not make it narrower.
    let share = |z: f32| (z - a) / (b - a);
    let past = |level: f32| line.iter().position(|&z| z > 0.0 && share(z) > level);
    let half = past(0.5).unwrap_or(0);
    let before = line[..half]
        .iter()
        .rposition(|&z| z > 0.0 && share(z) < LEVELS.0)?;
    let after = half
        + line[half..]
            .iter()
            .position(|&z| z > 0.0 && share(z) > LEVELS.1)?;
    let inner = &line[before + 1..after];
    let lost = inner.iter().filter(|z| **z <= 0.0).count();
    (2 * lost <= inner.len()).then_some(inner.len())
}

/// The depths with every smeared step put back to where it is half way; `smear` pixels wide, `noise`
/// metres of unevenness stay. Up and down the slope from each pixel lies the level on either side of its own
/// step, whatever other steps there are. Half way is meant in 1/z, which is what matching of patches averages.
pub fn sharpened(depth: &[f32], width: usize, smear: usize, noise: f32) -> Vec<f32> {
    let height = depth.len() / width.max(1);
    let mut out = depth.to_vec();
    if width <= 2 * SLOPE || height <= 2 * SLOPE {
        return out;
    }
    let walk = Walk {
        depth,
        width,
        height,
        farthest: (smear + smear / 2 + 4) as f32,
        // What noise does to the difference of two pixels; more is a slope.
        flat: 1.5 * noise,
    };
    for v in SLOPE..height - SLOPE {
        for u in SLOPE..width - SLOPE {
            let i = v * width + u;
            let z = depth[i];
            if z == 0.0 {
                continue;
            }
            // Where one of the two is lost, in a shadow beside a step, the other one tells the slope.
            let across = |a: usize, b: usize| {
                let (a, b) = (depth[a], depth[b]);
                match (a > 0.0, b > 0.0) {
                    (true, true) => b - a,
                    (true, false) => 2.0 * (z - a),
                    (false, true) => 2.0 * (b - z),
                    (false, false) => 0.0,
                }
            };
            let gx = across(i - SLOPE, i + SLOPE);
            let gy = across(i - SLOPE * width, i + SLOPE * width);
            let slope = gx.hypot(gy);
            if slope < 2.0 * noise {
                continue;
            }
            let (du, dv) = (gx / slope, gy / slope);
            let Some((near, far)) = walk
                .level(u, v, -du, -dv)
                .and_then(|near| Some((near, walk.level(u, v, du, dv)?)))
                .filter(|(near, far)| far - near > LEAST_STEP)
            else {
                continue;
            };
            let half_way = 2.0 * near * far / (near + far);
            let side = if z < half_way { near } else { far };
            if (z - side).abs() > noise {
                out[i] = side;
            }
        }
    }
    out
}

/// Over so many pixels to both sides the slope is taken.
const SLOPE: usize = 2;

/// Looks for the level at the foot or the top of a slope.
struct Walk<'a> {
    depth: &'a [f32],
    width: usize,
    height: usize,
    /// Pixels.
    farthest: f32,
    /// Metres.
    flat: f32,
}

impl Walk<'_> {
    fn at(&self, u: f32, v: f32) -> Option<f32> {
        let (u, v) = (u + 0.5, v + 0.5);
        let inside = u >= 0.0 && v >= 0.0 && u < self.width as f32 && v < self.height as f32;
        let z = if inside {
            self.depth[v as usize * self.width + u as usize]
        } else {
            0.0
        };
        (z > 0.0).then_some(z)
    }

    /// Mean of the first four pixels in a row, in direction (du, dv), that lie level.
    fn level(&self, u: usize, v: usize, du: f32, dv: f32) -> Option<f32> {
        let at = |t: f32| self.at(u as f32 + du * t, v as f32 + dv * t);
        // Each pixel is looked up once: on a ramp, where no level is, every walk goes all the way.
        let mut line = [None, at(0.0), at(1.0), at(2.0)];
        let mut t = 0.0;
        while t <= self.farthest {
            line = [line[1], line[2], line[3], at(t + 3.0)];
            if let [Some(a), Some(b), Some(c), Some(d)] = line
                && (d - a).abs() < self.flat
                && (c - a).abs() < self.flat
            {
                return Some(0.25 * (a + b + c + d));
            }
            t += 1.0;
        }
        None
    }
}
