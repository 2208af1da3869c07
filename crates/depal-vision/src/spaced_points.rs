//! Where evenly spaced points of a line lie in the image.

use depal_frames::{Intrinsics, Point, Vector};

/// Points at `first + i step` (camera frame): numerators of column and row, and the depth, each with what a step adds.
///
/// In f32, which places them to a thousandth of a pixel.
#[derive(Debug, Clone, Copy)]
pub struct SpacedPoints {
    column: [f32; 2],
    row: [f32; 2],
    depth: [f32; 2],
}

impl SpacedPoints {
    #[inline(always)]
    pub fn new(lens: &Intrinsics, first: Point, step: Vector) -> Self {
        // Half a pixel added, so that cutting off rounds to the nearest.
        let numerator = |x: f64, z: f64, f: f64, c: f64| (x * f + z * (c + 0.5)) as f32;
        Self {
            column: [
                numerator(first.x, first.z, lens.fx, lens.cx),
                numerator(step.x, step.z, lens.fx, lens.cx),
            ],
            row: [
                numerator(first.y, first.z, lens.fy, lens.cy),
                numerator(step.y, step.z, lens.fy, lens.cy),
            ],
            depth: [first.z as f32, step.z as f32],
        }
    }

    /// Depth of a point.
    #[inline(always)]
    pub fn depth_at(&self, i: usize) -> f32 {
        self.depth[0] + self.depth[1] * i as i32 as f32
    }

    /// Column and row, to be cut off, and depth of a point.
    #[inline(always)]
    pub fn at(&self, i: usize) -> (f32, f32, f32) {
        let z = self.depth_at(i);
        let i = i as i32 as f32;
        let inverse = 1.0 / z;
        let u = (self.column[0] + self.column[1] * i) * inverse;
        let v = (self.row[0] + self.row[1] * i) * inverse;
        (u, v, z)
    }
    /// Column and row of the first pixel, where the points `from..from + count` lie on as many pixels of one row of the
    /// image, one on each, by more than rounding; `None` says nothing.
    #[inline(always)]
    pub fn one_on_each(
        &self,
        from: usize,
        count: usize,
        (width, height): (f32, f32),
    ) -> Option<(usize, usize)> {
        /// What six roundings of numbers as large as the image can do, and more.
        const ROUNDING: f32 = 16.0 * f32::EPSILON;
        let [first, last] = [self.at(from), self.at(from + count - 1)];
        let steps = (count - 1) as i32 as f32;
        let nearest = first.2.min(last.2);
        // How far the points can lie from evenly spaced ones between the two: an eighth of the second
        // derivative, of a column or row as numerator over depth, times the square of the length.
        let grows = (self.depth[1] * steps / nearest).abs();
        let (along, across) = (last.0 - first.0, last.1 - first.1);
        let bent = 0.5 * grows * (along.abs() + across.abs());
        let margin = ROUNDING * width.max(height) + bent;
        let (column, row) = (first.0.floor(), first.1.floor());
        // Each point's place within the pixel on which it should lie.
        let [u, v] = [first.0 - column, first.1 - row];
        let [drift, fall] = [along - steps, across];
        let fits = |at: f32| at >= margin && at <= 1.0 - margin;
        // Also refuses NaN.
        let is_so = nearest > 0.0
            && grows < 0.1
            && [u, u + drift, v, v + fall].into_iter().all(fits)
            && column >= 0.0
            && row >= 0.0
            && column + steps < width
            && row < height;
        is_so.then_some((column as usize, row as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of -1..1 that look random.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 20u64;
        move || {
            state = state
                .wrapping_mul(0x5851_F42D_4C95_7F2D)
                .wrapping_add(0x1405_7B7E_F767_814F);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    #[test]
    fn points_said_to_lie_one_on_each_pixel_do() {
        const COUNT: usize = 64;
        let lens = Intrinsics {
            width: 1280,
            height: 1024,
            fx: 1216.0,
            fy: 1200.0,
            cx: 640.3,
            cy: 511.2,
        };
        let size = (lens.width as f32, lens.height as f32);
        let mut next = numbers();
        let (mut said, mut level) = (0, 0);
        for n in 0..4000 {
            let z = 2.0 + 0.8 * next();
            let first = Point::new(z * 0.6 * next(), z * 0.5 * next(), z);
            // From nearly along the rows to far from it, from level to steep.
            let [turn, tilt] = [0.02 * next().powi(3), if n % 2 == 0 { 0.0 } else { next() }];
            let pitch = z / lens.fx * (1.0 + 0.003 * next());
            let step = Vector::new(1.0, turn, tilt) * pitch;
            let points = SpacedPoints::new(&lens, first, step);
            for count in [COUNT, 7, 1] {
                let Some((column, row)) = points.one_on_each(3, count, size) else {
                    continue;
                };
                said += usize::from(count == COUNT);
                level += usize::from(count == COUNT && n % 2 == 0);
                for k in 0..count {
                    let (u, v, _) = points.at(3 + k);
                    assert_eq!(
                        (u as usize, v as usize),
                        (column + k, row),
                        "line {n}, point {k}"
                    );
                    assert!(column + k < lens.width && row < lens.height);
                }
            }
        }
        // It is worth asking: many that lie level are, and of those that do not at least some.
        assert!(level > 600 && said > level, "{said}, {level} of them level");
    }
}
