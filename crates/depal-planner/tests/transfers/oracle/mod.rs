//! The promise of a plan, worked out once more: where the way leads, what it touches, how long it takes.

// Tests and benches each use a part of it.
#![allow(dead_code)]

use depal_arm::JointLimit;
use depal_frames::{JointPositions, PlacedShape, Pose};
use depal_planner::{TransferPlan, TransferScene};

use cuboid::{Cuboid, gap};

mod cuboid;

type Joints = Vec<f64>;

/// A stretch of the way: from `a` to `b` straight, or the parabola that leaves `a` and reaches `b` towards `p`.
pub struct Stretch {
    a: Joints,
    p: Option<Joints>,
    b: Joints,
    /// Parameter range in which the speed is continuous from stretch to stretch, rad.
    length: f64,
    /// The arm stands still at its end.
    stops: bool,
}

fn norm(a: &[f64], b: &[f64]) -> f64 {
    let square = |(x, y): (&f64, &f64)| (x - y) * (x - y);
    a.iter().zip(b).map(square).sum::<f64>().sqrt()
}

fn towards(from: &[f64], to: &[f64], way: f64) -> Joints {
    let share = way / norm(from, to);
    from.iter()
        .zip(to)
        .map(|(f, t)| f + (t - f) * share)
        .collect()
}

impl Stretch {
    fn at(&self, u: f64) -> Joints {
        let mix = |i: usize| match &self.p {
            None => (1.0 - u) * self.a[i] + u * self.b[i],
            Some(p) => {
                (1.0 - u).powi(2) * self.a[i] + 2.0 * u * (1.0 - u) * p[i] + u * u * self.b[i]
            }
        };
        (0..self.a.len()).map(mix).collect()
    }

    /// States with at most `step` rad of length between them, both ends included.
    pub fn samples(&self, step: f64) -> Vec<Joints> {
        let count = (self.length / step).ceil().max(1.0) as usize;
        (0..=count)
            .map(|k| self.at(k as f64 / count as f64))
            .collect()
    }

    /// First and second derivative by the length.
    fn slopes(&self, u: f64) -> (Joints, Joints) {
        let l = self.length;
        let n = self.a.len();
        match &self.p {
            None => (
                (0..n).map(|i| (self.b[i] - self.a[i]) / l).collect(),
                vec![0.0; n],
            ),
            Some(p) => (
                (0..n)
                    .map(|i| 2.0 * ((1.0 - u) * (p[i] - self.a[i]) + u * (self.b[i] - p[i])) / l)
                    .collect(),
                (0..n)
                    .map(|i| 2.0 * (self.a[i] - 2.0 * p[i] + self.b[i]) / (l * l))
                    .collect(),
            ),
        }
    }
}

/// The way as promised. Panics where waypoints and blends do not make one.
pub fn stretches(plan: &TransferPlan) -> Vec<Stretch> {
    let points: Vec<(Joints, f64)> = plan
        .waypoints
        .iter()
        .map(|w| (w.joints.to_vec(), w.blend))
        .collect();
    assert!(points[0].1 == 0.0 && points[points.len() - 1].1 == 0.0);
    let mut way: Vec<Stretch> = Vec::new();
    for i in 1..points.len() {
        let ((from, cut), (to, blend)) = (&points[i - 1], &points[i]);
        let room = norm(from, to);
        assert!(
            *blend >= 0.0 && cut + blend <= room,
            "blends overlap at {i}"
        );
        if room - cut - blend > 1e-9 {
            way.push(Stretch {
                a: towards(from, to, *cut),
                p: None,
                b: towards(to, from, *blend),
                length: room - cut - blend,
                stops: false,
            });
        }
        if *blend == 0.0
            && let Some(last) = way.last_mut()
        {
            last.stops = true;
        }
        if *blend > 0.0 {
            way.push(Stretch {
                a: towards(to, from, *blend),
                p: Some(to.clone()),
                b: towards(to, &points[i + 1].0, *blend),
                length: 2.0 * blend,
                stops: false,
            });
        }
    }
    way
}

pub struct Oracle<'a> {
    scene: &'a TransferScene,
    obstacles: Vec<Cuboid>,
    /// Link and box.
    bodies: Vec<(usize, &'a PlacedShape)>,
    pairs: Vec<(usize, usize)>,
}

impl<'a> Oracle<'a> {
    /// Obstacles are `grown` by so many metres on every side.
    pub fn new(scene: &'a TransferScene, grown: f64) -> Self {
        let here = Pose::identity();
        let links = scene.arm.links();
        let mut bodies: Vec<(usize, &PlacedShape)> =
            scene.attached.iter().map(|(link, s)| (*link, s)).collect();
        for (i, link) in links.iter().enumerate() {
            bodies.extend(link.collision.iter().map(|s| (i, s)));
        }
        let mut pairs = Vec::new();
        for i in 0..bodies.len() {
            for j in i + 1..bodies.len() {
                let (a, b) = (bodies[i].0, bodies[j].0);
                let names = (links[a].name.clone(), links[b].name.clone());
                let swapped = (names.1.clone(), names.0.clone());
                let listed = &scene.allowed_pairs;
                if a != b && !listed.contains(&names) && !listed.contains(&swapped) {
                    pairs.push((i, j));
                }
            }
        }
        Self {
            scene,
            obstacles: scene
                .obstacles
                .iter()
                .map(|s| Cuboid::new(&here, s, grown))
                .collect(),
            bodies,
            pairs,
        }
    }

    fn boxes(&self, joints: &[f64]) -> Vec<Cuboid> {
        let frames = self
            .scene
            .arm
            .base_from_links(&JointPositions::from_slice(joints));
        let place = |&(link, shape): &(usize, &PlacedShape)| Cuboid::new(&frames[link], shape, 0.0);
        self.bodies.iter().map(place).collect()
    }

    /// What touches at one state.
    pub fn touch(&self, joints: &[f64]) -> Option<String> {
        let boxes = self.boxes(joints);
        let name = |i: usize| &self.scene.arm.links()[self.bodies[i].0].name;
        for (i, body) in boxes.iter().enumerate() {
            if self.scene.arm.joints_below(self.bodies[i].0) == 0 {
                continue;
            }
            if let Some(k) = self.obstacles.iter().position(|o| body.meets(o)) {
                return Some(format!("{} meets obstacle {k}", name(i)));
            }
        }
        let pair = self.pairs.iter().find(|&&(i, j)| boxes[i].meets(&boxes[j]));
        pair.map(|&(i, j)| format!("{} meets {}", name(i), name(j)))
    }

    /// Least distance at one state of moving bodies to obstacles and of checked pairs, m; 0 where something meets.
    pub fn clearance(&self, joints: &[f64]) -> f64 {
        let boxes = self.boxes(joints);
        let moves = |i: usize| self.scene.arm.joints_below(self.bodies[i].0) > 0;
        let around = boxes.iter().enumerate().filter(|(i, _)| moves(*i));
        let mut least = f64::INFINITY;
        let mut look = |a: &Cuboid, b: &Cuboid| {
            let apart = (a.centre - b.centre).norm() - a.half.norm() - b.half.norm();
            if apart < least {
                least = if a.meets(b) {
                    0.0
                } else {
                    least.min(gap(a, b))
                };
            }
        };
        for (_, body) in around {
            self.obstacles.iter().for_each(|o| look(body, o));
        }
        for &(i, j) in &self.pairs {
            look(&boxes[i], &boxes[j]);
        }
        least
    }

    /// The first touch on the straight joint moves through these points, every 0.01 rad.
    pub fn touch_on_polyline(&self, points: &[JointPositions]) -> Option<String> {
        points.windows(2).find_map(|w| {
            let count = (norm(&w[0], &w[1]) / 0.01).ceil().max(1.0) as usize;
            (0..=count).find_map(|k| self.touch(&w[0].lerp(&w[1], k as f64 / count as f64)))
        })
    }

    /// Every 0.002 rad of the promised way: nothing touches.
    pub fn check(&self, plan: &TransferPlan) -> Result<(), String> {
        for stretch in stretches(plan) {
            for at in stretch.samples(0.002) {
                if let Some(touch) = self.touch(&at) {
                    return Err(format!("{touch} at {at:?}"));
                }
            }
        }
        Ok(())
    }
}

/// Fastest time from rest to rest over the promised way: the phase plane on a fine grid, backward and then forward,
/// with every ceiling found by bisection. Speeds and accelerations of every joint hold at the middle of each cell.
pub fn fastest(plan: &TransferPlan, limits: &[JointLimit]) -> f64 {
    let mut total = 0.0;
    let mut part: Vec<Stretch> = Vec::new();
    for stretch in stretches(plan) {
        let stops = stretch.stops;
        part.push(stretch);
        if stops {
            total += one_go(&part, limits);
            part.clear();
        }
    }
    assert!(part.is_empty(), "a way ends with a stop");
    total
}

fn one_go(part: &[Stretch], limits: &[JointLimit]) -> f64 {
    /// Length and slopes at the middle.
    struct Cell(f64, Joints, Joints);
    let mut cells = Vec::new();
    for stretch in part {
        let count = (stretch.length / 0.001).ceil().max(40.0) as usize;
        for k in 0..count {
            let (d, dd) = stretch.slopes((k as f64 + 0.5) / count as f64);
            cells.push(Cell(stretch.length / count as f64, d, dd));
        }
    }
    let range = |Cell(_, d, dd): &Cell, x: f64| {
        let (mut low, mut high, mut possible) = (f64::NEG_INFINITY, f64::INFINITY, true);
        for ((d, dd), limit) in d.iter().zip(dd).zip(limits) {
            let a = limit.max_acceleration;
            if d.abs() < 1e-9 {
                possible &= (dd * x).abs() <= a;
                continue;
            }
            let (p, q) = ((-a - dd * x) / d, (a - dd * x) / d);
            low = low.max(p.min(q));
            high = high.min(p.max(q));
        }
        (low, high, possible && low <= high)
    };
    let mut ceiling = vec![0.0; cells.len() + 1];
    for k in (0..cells.len()).rev() {
        let top = |(d, limit): (&f64, &JointLimit)| (limit.max_speed / d.abs().max(1e-12)).powi(2);
        let mut bad = cells[k].1.iter().zip(limits).map(top).fold(1e6, f64::min);
        let fits = |x: f64| {
            let (low, _, possible) = range(&cells[k], x);
            possible && x + 2.0 * cells[k].0 * low <= ceiling[k + 1]
        };
        if fits(bad) {
            ceiling[k] = bad;
            continue;
        }
        let mut good = 0.0;
        for _ in 0..45 {
            let x = 0.5 * (good + bad);
            if fits(x) {
                good = x;
            } else {
                bad = x;
            }
        }
        ceiling[k] = good;
    }
    let (mut x, mut time) = (0.0_f64, 0.0);
    for (k, cell) in cells.iter().enumerate() {
        let (_, high, _) = range(cell, x);
        let next = (x + 2.0 * cell.0 * high).clamp(0.0, ceiling[k + 1]);
        time += 2.0 * cell.0 / (x.sqrt() + next.sqrt()).max(1e-9);
        x = next;
    }
    time
}
