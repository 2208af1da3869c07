//! Cartons put down as warehouses do.

use std::f64::consts::FRAC_PI_2;

use depal_time::RandomStream;

use crate::rendered::{Carton, HEIGHT, Layout, places};

/// Gaps as pushed cartons have them, metres.
pub const GAPS: [f64; 8] = [0.0, 0.0, 0.0005, 0.001, 0.002, 0.003, 0.005, 0.008];
pub fn pick<T: Copy>(r: &mut RandomStream, from: &[T]) -> T {
    from[(r.uniform(0.0, from.len() as f64) as usize).min(from.len() - 1)]
}

/// Puts cartons down; each as uneven as the sensor's world is.
pub struct Ground<'a> {
    pub r: &'a mut RandomStream,
    pub unlevel: bool,
    pub cartons: Vec<Carton>,
}

impl Ground<'_> {
    /// A carton with extents `a` along x and `b` along y around (x, y).
    pub fn put(&mut self, [x, y]: [f64; 2], [a, b]: [f64; 2], top: f64, room: f64) {
        let degree = 1f64.to_radians();
        let free = room.min(0.005);
        let shift = (free * 0.15).min(0.001);
        let (x, y) = (
            x + self.r.uniform(-shift, shift),
            y + self.r.uniform(-shift, shift),
        );
        let turn = (free / a.max(b) * 0.3).min(0.005);
        let yaw = if b > a { FRAC_PI_2 } else { 0.0 } + self.r.uniform(-turn, turn);
        let (tilt, dz) = if self.unlevel {
            let tilt = [
                self.r.normal(1.0) * 0.2 * degree,
                self.r.normal(1.0) * 0.2 * degree,
            ];
            (tilt, self.r.uniform(-0.001, 0.001))
        } else {
            ([0.0; 2], self.r.uniform(-0.0005, 0.0005))
        };
        self.cartons.push(Carton {
            x,
            y,
            top: top + dz,
            yaw,
            tilt,
            size: [a.max(b), a.min(b), HEIGHT],
        });
    }

    /// A row along x from `x` on: extents along x, their common depth; gaps as given.
    pub fn row(&mut self, [mut x, y]: [f64; 2], along: &[f64], depth: f64, gap: Option<f64>) {
        for &a in along {
            self.put([x + a / 2.0, y + depth / 2.0], [a, depth], 0.0, 0.0);
            x += a + gap.unwrap_or_else(|| pick(self.r, &GAPS));
        }
    }
}

/// The whole turned and shifted as a forklift has left it.
pub fn as_left(cartons: &mut [Carton], r: &mut RandomStream) {
    let (s, c) = r.uniform(-0.02, 0.02).sin_cos();
    let shift = [r.uniform(-0.02, 0.02), r.uniform(-0.02, 0.02)];
    for carton in cartons {
        (carton.x, carton.y) = (
            carton.x * c - carton.y * s + shift[0],
            carton.x * s + carton.y * c + shift[1],
        );
        carton.yaw += s.asin();
    }
}

pub fn full_layer(on: &mut Ground, layout: Layout, gap: f64, top: f64) {
    for place in places(layout, gap) {
        let lying = place.yaw == 0.0;
        let sides = if lying {
            [place.long, place.short]
        } else {
            [place.short, place.long]
        };
        let room = if gap >= 0.002 { gap } else { 0.0 };
        on.put([place.x, place.y], sides, top, room);
    }
}

pub fn cluster(on: &mut Ground, middle: [f64; 2], size: [f64; 2], count: [usize; 2], gap: f64) {
    for i in 0..count[0] {
        for j in 0..count[1] {
            let at = |k: usize, n: usize| {
                middle[k] + (n as f64 - (count[k] as f64 - 1.0) / 2.0) * (size[k] + gap)
            };
            on.put([at(0, i), at(1, j)], size, 0.0, 0.0);
        }
    }
}
