//! Layers with gaps of a millimetre, which hardly show, with a disturbance in each: other sizes, tape, a tilted carton,
//! a carton on top, a second height. No box may be reported that is none, and most of the free ones must be.

use depal_frames::{DepthFrame, Point, Pose, Vector};
use depal_vision::{Detection, RegionOfInterest, VisionSettings, detect};
use generator::{Noise, at, cartons, frame};
use rendered::{Carton, HEIGHT, Layout};

mod generator;
mod rendered;

const GAP: f64 = 0.001;

#[derive(Default)]
struct Tally {
    /// Cartons that lie free, and how many of those were found.
    free: usize,
    found: usize,
    /// Boxes that are no uncovered carton.
    wrong: Vec<String>,
}

impl Tally {
    fn add(&mut self, free: &[Carton], covered: &[Carton], detection: &Detection, seed: u64) {
        let near = |c: &Carton, p: &Point, size: [f64; 2]| {
            Vector::new(c.x - p.x, c.y - p.y, c.top - p.z).norm() < 0.005
                && (c.size[0] - size[0]).abs() < 0.001
                && (c.size[1] - size[1]).abs() < 0.001
        };
        let mut open = free.to_vec();
        for b in &detection.boxes {
            let at = at() * Point::from(b.camera_from_box.translation.vector);
            let size = [b.size.length, b.size.width];
            if let Some(n) = open.iter().position(|c| near(c, &at, size)) {
                open.swap_remove(n);
            } else if !covered.iter().any(|c| near(c, &at, size)) {
                self.wrong.push(format!(
                    "seed {seed}: {:.0} x {:.0} at {:.0} {:.0} {:.0} mm",
                    size[0] * 1e3,
                    size[1] * 1e3,
                    at.x * 1e3,
                    at.y * 1e3,
                    at.z * 1e3
                ));
            }
        }
        self.free += free.len();
        self.found += free.len() - open.len();
    }

    fn demand(&self, share: f64) {
        let Self { free, found, wrong } = self;
        assert!(wrong.is_empty(), "{found} of {free}, wrong: {wrong:?}");
        assert!(
            *found as f64 >= share * *free as f64,
            "{found} of {free} found"
        );
    }
}

/// Detects in the picture of some cartons, after `change` of it.
fn seen(
    layout: Layout,
    standing: &[Carton],
    seed: u64,
    change: impl FnOnce(&mut DepthFrame),
) -> Detection {
    let mut frame = frame(standing, Noise::White, false, seed);
    change(&mut frame);
    let mut settings = VisionSettings::new(layout.sizes()).suited_to(&frame);
    // Cartons stand on the pallet: what is seen of that beside them is none.
    settings.region = Some(RegionOfInterest {
        camera_from_region: at().inverse() * Pose::translation(0.0, 0.0, 0.15),
        half_extents: Vector::new(1.0, 1.0, 0.25),
    });
    detect(&frame, &settings)
}

#[test]
fn mixed_sizes_are_told_apart_by_their_heights() {
    let mut tally = Tally::default();
    for seed in 900..904 {
        let cartons = cartons(Layout::Mixed, GAP, seed);
        let detection = seen(Layout::Mixed, &cartons, seed, |_| {});
        tally.add(&cartons, &[], &detection, seed);
    }
    tally.demand(0.95);
}

#[test]
fn what_lies_beside_a_tilted_carton_is_found() {
    let mut tally = Tally::default();
    for seed in 910..914 {
        let mut cartons = cartons(Layout::Regular, GAP, seed);
        let n = seed as usize * 7 % cartons.len();
        // It stands on one of its long sides, the other is raised.
        let angle = (2.0 + 1.5 * (seed % 4) as f64).to_radians();
        cartons[n].tilt[0] = angle;
        cartons[n].top += cartons[n].size[1] / 2.0 * angle.sin();
        let detection = seen(Layout::Regular, &cartons, seed, |_| {});
        let tilted = cartons.remove(n);
        tally.add(&cartons, &[tilted], &detection, seed);
    }
    tally.demand(0.95);
}

#[test]
fn what_lies_around_a_carton_on_top_is_found() {
    let mut tally = Tally::default();
    for seed in 920..924 {
        let below = cartons(Layout::Regular, GAP, seed);
        let n = seed as usize * 3 % below.len();
        let upper = Carton {
            x: below[n].x * 0.7,
            y: below[n].y * 0.7,
            top: below[n].top + HEIGHT,
            yaw: 0.3 * (seed % 7) as f64,
            tilt: [0.0; 2],
            size: below[n].size,
        };
        let mut standing = below.clone();
        standing.push(upper);
        let detection = seen(Layout::Regular, &standing, seed, |_| {});
        // Its shadow and the slanted view hide what is nearer than that.
        let reach = 0.5 * upper.size[0].hypot(upper.size[1]) + 0.07;
        let (hidden, mut free): (Vec<Carton>, Vec<Carton>) = below.iter().partition(|c| {
            let dx = ((c.x - upper.x).abs() - c.size[0] / 2.0).max(0.0);
            let dy = ((c.y - upper.y).abs() - c.size[1] / 2.0).max(0.0);
            dx.hypot(dy) < reach
        });
        free.push(upper);
        tally.add(&free, &hidden, &detection, seed);
    }
    tally.demand(0.9);
}

#[test]
fn tape_across_every_carton_moves_none_of_them() {
    let mut tally = Tally::default();
    for seed in 930..934 {
        let layout = if seed % 2 == 0 {
            Layout::Regular
        } else {
            Layout::Brick
        };
        let cartons = cartons(layout, GAP, seed);
        let across = usize::from(seed % 4 < 2);
        let detection = seen(layout, &cartons, seed, |frame| {
            let k = frame.intrinsics;
            for (i, z) in frame.depth.iter_mut().enumerate() {
                let (u, v) = ((i % k.width) as f64, (i / k.width) as f64);
                let p = at() * Point::from(k.ray(u, v) * f64::from(*z));
                let taped = cartons.iter().any(|c| {
                    let top = Point::new(c.x, c.y, c.top);
                    let q = c.rotation().inverse() * (p - top);
                    q.z.abs() < 0.01
                        && q[across].abs() < 0.024
                        && q[1 - across].abs() < c.size[1 - across] / 2.0
                });
                if taped {
                    *z = 0.0;
                }
            }
        });
        tally.add(&cartons, &[], &detection, seed);
    }
    tally.demand(0.95);
}
