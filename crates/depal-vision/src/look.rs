//! What a rectangle on a plane shows, here and there inside it.

use crate::{
    class::Class, gate::DepthImage, patch::pixel_pitch, plane::PlaneFrame, resample::int,
    spaced_points::SpacedPoints, widest::with_widest_vectors,
};

/// What a rectangle on a plane shows.
pub struct Look {
    /// (u, v, z) of the pixels in front of the plane.
    near: Vec<(f64, f64, f64)>,
    counts: [usize; 5],
}

impl Look {
    fn samples(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Share 0..1 of the samples that are of a class.
    pub fn share(&self, class: Class) -> f64 {
        self.counts[class as usize] as f64 / self.samples().max(1) as f64
    }

    /// True when points in front of the plane stand inside the rectangle once they are put down on it
    /// along the normal. A taller neighbour in the line of sight stands outside and only hides.
    /// Where depths were averaged over `average_px`, noise stands out in lumps of that size: one is chance.
    pub fn is_covered(
        &self,
        image: &DepthImage,
        frame: &PlaneFrame,
        extents: [f64; 2],
        average_px: usize,
    ) -> bool {
        const MARGIN: f64 = 0.010;
        let lump = ((2 * average_px + 1) as f64 / SPACING).powi(2) as usize;
        let over = self
            .near
            .iter()
            .filter(|&&(u, v, z)| {
                let from_middle = image.intrinsics.deproject(u, v, z) - frame.origin;
                from_middle.dot(&frame.x).abs() < extents[0] / 2.0 - MARGIN
                    && from_middle.dot(&frame.y).abs() < extents[1] / 2.0 - MARGIN
            })
            .count();
        over * 400 > self.samples() && (average_px == 0 || over > lump)
    }
}

/// Distance of the samples, pixels.
const SPACING: f64 = 4.0;

/// Samples the inside of a rectangle, `margin` metres away from its sides; calls `on_surface` with (u, v, z) of the
/// pixels on its plane.
pub fn look(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    tolerance: f64,
    margin: f64,
    mut on_surface: impl FnMut((f64, f64, f64)),
) -> Look {
    let k = &image.intrinsics;
    let spacing = (SPACING * pixel_pitch(frame, k)).max(1e-4);
    let inner = extents.map(|e| e - 2.0 * margin);
    let [nx, ny] = inner.map(|e| (e / spacing).floor().max(1.0) as usize);
    let mut result = Look {
        near: Vec::new(),
        counts: [0; 5],
    };
    let size = (image.width as f32, image.height as f32);
    let tolerance = tolerance as f32;
    let mut samples = Samples::new(nx);
    for j in 0..ny {
        let y = ((j as f64 + 0.5) / ny as f64 - 0.5) * inner[1];
        let first = frame.point((0.5 / nx as f64 - 0.5) * inner[0], y);
        let step = frame.x * (inner[0] / nx as f64);
        let points = SpacedPoints::new(k, first, step);
        // First where, then what: the processor does several of the former at once.
        with_widest_vectors(
            #[inline(always)]
            || samples.place(&points, size),
        );
        let places = samples.columns.iter().zip(&samples.rows);
        for ((&u, &v), &expected) in places.zip(&samples.expected) {
            if u == OUTSIDE {
                result.counts[Class::Outside as usize] += 1;
                continue;
            }
            let z = image.depth[v as usize * image.width + u as usize];
            let here = || (f64::from(u), f64::from(v), f64::from(z));
            let class = if z == 0.0 {
                Class::Hole
            } else if z > expected + tolerance {
                Class::Deep
            } else if z < expected - tolerance {
                result.near.push(here());
                Class::Near
            } else {
                on_surface(here());
                Class::On
            };
            result.counts[class as usize] += 1;
        }
    }
    result
}

/// Stands for the column of a sample beyond the image.
const OUTSIDE: i32 = -1;

/// A row of samples: their pixels and the plane's depth there.
struct Samples {
    columns: Vec<i32>,
    rows: Vec<i32>,
    expected: Vec<f32>,
}

impl Samples {
    fn new(count: usize) -> Self {
        Self {
            columns: vec![0; count],
            rows: vec![0; count],
            expected: vec![0.0; count],
        }
    }

    #[inline(always)]
    fn place(&mut self, points: &SpacedPoints, (width, height): (f32, f32)) {
        let places = self.columns.iter_mut().zip(&mut self.rows);
        for (i, ((column, row), expected)) in places.zip(&mut self.expected).enumerate() {
            let (u, v, z) = points.at(i);
            // Also refuses NaN.
            let inside = (u >= 0.0) & (v >= 0.0) & (u < width) & (v < height);
            let (u, v) = if inside { (u, v) } else { (0.0, 0.0) };
            *column = if inside { int(u) } else { OUTSIDE };
            *row = int(v);
            *expected = z;
        }
    }
}
