//! Pallets whose carton sizes the estimation is not told, and the judgement of what it measures.
//! Z of the world points up, nominal tops are at 0; the camera stands 2 m above.
#![allow(dead_code)]

use std::f64::consts::{FRAC_PI_2, PI};

use depal_camera::{Material, RenderShape, SensorSpec};
use depal_frames::{DepthFrame, Point, Vector};
use depal_time::{RandomStream, RandomStreams};
use depal_vision::{DetectedBox, Detection, VisionSettings, detect_any_size};

use crate::{
    generator::{self, Noise, at},
    rendered::{Carton, HEIGHT, Layout, block, camera, picture, places},
};

/// Who takes the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sensor {
    /// The simulated camera with its intensity image; cartons stand level, up to 0.5 mm higher or lower.
    Camera,
    /// The second model without intensity; cartons lean by some tenths of a degree, up to 1 mm higher or lower.
    Second,
}

/// What stands there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// One layer.
    Layer(Layout),
    /// One to six cartons of one size in rows and columns, nothing else.
    Cluster,
    /// The same twice, of one size, 80 mm apart: one cluster is a single carton in half the pictures.
    TwoClusters,
    /// 4 x 5 of one size; each gap another one, between 0 and 8 mm.
    RandomGaps,
    /// Rows of 400 x 300, 300 x 200 and 400 x 200, each gap as given.
    MixedRows,
    /// The same with random gaps.
    MixedRandomGaps,
    /// A full layer and some of a second one straight above.
    TwoHeights,
    /// A full layer and one to three more cartons anyhow on it.
    Upper,
    /// One of the outer row leans.
    OneTilted,
    /// Pairs pushed together, their ends not flush.
    Staggered,
    /// A sheet over a layer, or over a part of it.
    Sheet,
    /// A bare pallet.
    Boards,
    /// Nothing.
    Floor,
}

pub const CASES: [Case; 19] = [
    Case::Layer(Layout::Regular20),
    Case::Layer(Layout::RunningBond20),
    Case::Layer(Layout::Brick20),
    Case::Layer(Layout::Brick),
    Case::Layer(Layout::Pinwheel21),
    Case::Layer(Layout::Pinwheel),
    Case::Layer(Layout::Mixed),
    Case::Layer(Layout::Small48),
    Case::Cluster,
    Case::TwoClusters,
    Case::RandomGaps,
    Case::MixedRows,
    Case::MixedRandomGaps,
    Case::TwoHeights,
    Case::Upper,
    Case::OneTilted,
    Case::Staggered,
    Case::Sheet,
    Case::Boards,
];

impl Case {
    /// True when the case draws or lacks its gaps.
    pub fn has_own_gaps(self) -> bool {
        matches!(
            self,
            Self::RandomGaps | Self::MixedRandomGaps | Self::Sheet | Self::Boards | Self::Floor
        )
    }
}

/// One pallet.
pub struct Scene {
    pub cartons: Vec<Carton>,
    pub others: Vec<RenderShape>,
}

/// Gaps as pushed cartons have them, metres.
const GAPS: [f64; 8] = [0.0, 0.0, 0.0005, 0.001, 0.002, 0.003, 0.005, 0.008];
/// By so much a thin sheet may lie over a carton unseen, metres.
const SHEET_RIM: f64 = 0.010;
/// Long and short sides, metres.
const SIZES: [[f64; 2]; 6] = [
    [0.3, 0.2],
    [0.4, 0.3],
    [0.2, 0.15],
    [0.25, 0.25],
    [0.38, 0.285],
    [0.33, 0.18],
];

fn pick<T: Copy>(r: &mut RandomStream, from: &[T]) -> T {
    from[(r.uniform(0.0, from.len() as f64) as usize).min(from.len() - 1)]
}

/// Puts cartons down; each as uneven as the sensor's world is.
struct Ground<'a> {
    r: &'a mut RandomStream,
    unlevel: bool,
    cartons: Vec<Carton>,
}

impl Ground<'_> {
    /// A carton with extents `a` along x and `b` along y around (x, y).
    fn put(&mut self, [x, y]: [f64; 2], [a, b]: [f64; 2], top: f64, room: f64) {
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
    fn row(&mut self, [mut x, y]: [f64; 2], along: &[f64], depth: f64, gap: Option<f64>) {
        for &a in along {
            self.put([x + a / 2.0, y + depth / 2.0], [a, depth], 0.0, 0.0);
            x += a + gap.unwrap_or_else(|| pick(self.r, &GAPS));
        }
    }
}

/// The whole turned and shifted as a forklift has left it.
fn as_left(cartons: &mut [Carton], r: &mut RandomStream) {
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

fn full_layer(on: &mut Ground, layout: Layout, gap: f64, top: f64) {
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

fn cluster(on: &mut Ground, middle: [f64; 2], size: [f64; 2], count: [usize; 2], gap: f64) {
    for i in 0..count[0] {
        for j in 0..count[1] {
            let at = |k: usize, n: usize| {
                middle[k] + (n as f64 - (count[k] as f64 - 1.0) / 2.0) * (size[k] + gap)
            };
            on.put([at(0, i), at(1, j)], size, 0.0, 0.0);
        }
    }
}

fn turned_size(r: &mut RandomStream) -> [f64; 2] {
    let size = pick(r, &SIZES);
    if r.uniform(0.0, 1.0) < 0.5 {
        [size[1], size[0]]
    } else {
        size
    }
}

/// Builds one pallet.
pub fn scene(case: Case, gap: f64, seed: u64, sensor: Sensor) -> Scene {
    let mut streams = RandomStreams::new(seed).stream("unsized");
    let r = &mut streams;
    let mut choice = RandomStreams::new(seed).stream("choice");
    let choice = &mut choice;
    let mut on = Ground {
        r,
        unlevel: sensor == Sensor::Second,
        cartons: Vec::new(),
    };
    let mut others = Vec::new();
    let mut base = -HEIGHT - 0.002;
    let counts = [[1, 1], [2, 1], [1, 2], [2, 2], [3, 1], [1, 3], [3, 2]];
    match case {
        Case::Layer(layout) => full_layer(&mut on, layout, gap, 0.0),
        Case::Cluster => {
            let (size, count) = (turned_size(choice), pick(choice, &counts));
            cluster(&mut on, [0.0, 0.0], size, count, gap);
        }
        Case::TwoClusters => {
            let size = turned_size(choice);
            let mut x = -0.5;
            for n in 0..2 {
                let single = n == 1 && choice.uniform(0.0, 1.0) < 0.5;
                let count = if single {
                    [1, 1]
                } else {
                    pick(choice, &counts)
                };
                let wide = count[0] as f64 * (size[0] + gap);
                cluster(&mut on, [x + wide / 2.0, 0.0], size, count, gap);
                x += wide + 0.08;
            }
        }
        Case::RandomGaps => {
            let mut y = -0.5;
            for _ in 0..5 {
                on.row([-0.61, y], &[0.3; 4], 0.2, None);
                y += 0.2 + pick(choice, &GAPS);
            }
        }
        Case::MixedRows | Case::MixedRandomGaps => {
            let fixed = (case == Case::MixedRows).then_some(gap);
            let mut rows: Vec<(Vec<f64>, f64)> = vec![
                (vec![0.4; 3], 0.3),
                (vec![0.3; 4], 0.2),
                (vec![0.4; 3], 0.2),
                (vec![0.4, 0.2, 0.2, 0.2, 0.2], 0.3),
            ];
            let mut y = -0.5;
            while !rows.is_empty() {
                let n = (choice.uniform(0.0, rows.len() as f64) as usize).min(rows.len() - 1);
                let (along, depth) = rows.remove(n);
                on.row([-0.61, y], &along, depth, fixed);
                y += depth + fixed.unwrap_or_else(|| pick(choice, &GAPS));
            }
        }
        Case::TwoHeights => {
            let layout = pick(choice, &[Layout::Regular20, Layout::RunningBond20]);
            full_layer(&mut on, layout, gap, -HEIGHT);
            let below = on.cartons.len();
            full_layer(&mut on, layout, gap, 0.0);
            let mut kept = Vec::new();
            for n in 0..on.cartons.len() {
                if n < below || choice.uniform(0.0, 1.0) < 0.4 {
                    kept.push(on.cartons[n]);
                }
            }
            on.cartons = kept;
            base -= HEIGHT;
        }
        Case::Upper => {
            let layouts = [Layout::Regular20, Layout::RunningBond20, Layout::Brick20];
            full_layer(&mut on, pick(choice, &layouts), gap, -HEIGHT);
            for x in [-0.35, 0.35] {
                if choice.uniform(0.0, 1.0) < 0.8 {
                    let at = [x + choice.uniform(-0.1, 0.1), choice.uniform(-0.3, 0.3)];
                    on.put(at, [0.3, 0.2], 0.0, 0.0);
                    let last = on.cartons.len() - 1;
                    on.cartons[last].yaw = choice.uniform(0.0, PI);
                    on.cartons[last].tilt = [0.0; 2];
                }
            }
            base -= HEIGHT;
        }
        Case::OneTilted => {
            full_layer(&mut on, Layout::Regular20, gap, 0.0);
            let lean = choice.uniform(2.0, 8.0).to_radians();
            let n = (choice.uniform(0.0, 4.0) as usize).min(3);
            let tilted = &mut on.cartons[n];
            tilted.tilt[0] = -lean;
            tilted.y -= 0.02;
            tilted.top += 0.1 * lean.sin();
        }
        Case::Staggered => {
            let size = turned_size(choice);
            for n in 0..3 {
                let off = choice.uniform(-0.02, 0.02);
                let x = (f64::from(n) - 1.0) * 0.36;
                on.put([x, -size[1] / 2.0 - gap / 2.0], size, 0.0, 0.0);
                on.put([x + off, size[1] / 2.0 + gap / 2.0], size, 0.0, 0.0);
            }
            if size[0] > 0.35 {
                on.cartons.truncate(2);
            }
        }
        Case::Sheet => {
            full_layer(&mut on, Layout::Regular20, 0.003, -0.006);
            let thick = choice.uniform(0.002, 0.006);
            let sheet = Carton {
                x: choice.uniform(-0.15, 0.15),
                y: choice.uniform(-0.1, 0.1),
                top: thick - 0.004,
                yaw: choice.uniform(-0.05, 0.05),
                tilt: [0.0; 2],
                size: [choice.uniform(0.3, 1.25), choice.uniform(0.2, 1.05), thick],
            };
            others.push(sheet.shape(2000));
            // What lies under the sheet by more than its rim is no carton to be found.
            let (under, kept): (Vec<_>, Vec<_>) = on.cartons.iter().copied().partition(|c| {
                let points = grid(c, 60, 0.003);
                points.iter().any(|p| holds(&sheet, p, SHEET_RIM))
            });
            others.extend((0..under.len()).map(|n| under[n].shape(3000 + n as u32)));
            base -= 0.006;
            add_ground(&mut others, base);
            return Scene {
                cartons: kept,
                others,
            };
        }
        Case::Boards => {
            let mut y = -0.4;
            for width in [0.145, 0.1, 0.145, 0.1, 0.145] {
                others.push(board(
                    [0.0, y + width / 2.0, -0.011],
                    [1.2, width, 0.022],
                    others.len(),
                ));
                y += width + (0.8 - 0.635) / 4.0;
            }
            for x in [-0.527, 0.0, 0.527] {
                others.push(board([x, 0.0, -0.033], [0.145, 0.8, 0.022], others.len()));
                for y in [-0.35, 0.0, 0.35] {
                    others.push(board([x, y, -0.083], [0.145, 0.1, 0.078], others.len()));
                }
            }
            for y in [-0.35, 0.0, 0.35] {
                others.push(board([0.0, y, -0.133], [1.2, 0.1, 0.022], others.len()));
            }
            others.push(block(
                1001,
                [0.0, 0.0, -0.244],
                [8.0, 8.0, 0.2],
                0.0,
                Material::CONCRETE,
            ));
            return Scene {
                cartons: Vec::new(),
                others,
            };
        }
        Case::Floor => {}
    }
    let mut cartons = on.cartons;
    as_left(&mut cartons, choice);
    if case == Case::Floor {
        base = -1.0;
    }
    add_ground(&mut others, base);
    Scene { cartons, others }
}

fn board(centre: [f64; 3], size: [f64; 3], n: usize) -> RenderShape {
    block(4000 + n as u32, centre, size, 0.0, Material::KRAFT)
}

/// The layers below as one block, and a floor.
fn add_ground(others: &mut Vec<RenderShape>, base: f64) {
    others.push(block(
        1000,
        [0.0, 0.0, base - 0.1],
        [1.2, 1.0, 0.2],
        0.0,
        Material::KRAFT,
    ));
    others.push(block(
        1001,
        [0.0, 0.0, -1.2],
        [8.0, 8.0, 0.2],
        0.0,
        Material::CONCRETE,
    ));
}

/// Its picture.
pub fn frame(scene: &Scene, sensor: Sensor, seed: u64) -> DepthFrame {
    let mut shapes: Vec<RenderShape> = scene
        .cartons
        .iter()
        .enumerate()
        .map(|(n, c)| c.shape(n as u32))
        .collect();
    shapes.extend(scene.others.iter().cloned());
    match sensor {
        Sensor::Camera => picture(&camera(SensorSpec::laser_3m()), &at(), &shapes, seed),
        Sensor::Second => generator::frame_of(&shapes, Noise::White, false, seed),
    }
}

/// Takes the picture and measures.
pub fn measured(scene: &Scene, sensor: Sensor, seed: u64) -> Detection {
    let frame = frame(scene, sensor, seed);
    detect_any_size(&frame, &VisionSettings::new(Vec::new()).suited_to(&frame))
}

/// True for a point (own axes of a carton) under or in another one.
fn holds(other: &Carton, p: &Vector, margin: f64) -> bool {
    let (s, c) = other.yaw.sin_cos();
    let (dx, dy) = (p.x - other.x, p.y - other.y);
    let (x, y) = (dx * c + dy * s, dy * c - dx * s);
    x.abs() < other.size[0] / 2.0 - margin && y.abs() < other.size[1] / 2.0 - margin
}

/// Points of a top, `margin` inside.
fn grid(carton: &Carton, count: i32, margin: f64) -> Vec<Vector> {
    let mut points = Vec::new();
    for i in 0..count {
        for j in 0..count {
            let at = |n: i32, side: f64| {
                ((f64::from(n) + 0.5) / f64::from(count) - 0.5) * (side - 2.0 * margin)
            };
            let p = Vector::new(at(i, carton.size[0]), at(j, carton.size[1]), 0.0);
            points.push(carton.rotation() * p + Vector::new(carton.x, carton.y, carton.top));
        }
    }
    points
}

/// True when another carton stands on it.
pub fn is_covered(cartons: &[Carton], n: usize) -> bool {
    let on_it = |o: &Carton| o.top - o.size[2] > cartons[n].top - 0.02;
    cartons.iter().filter(|o| on_it(o)).any(|o| {
        grid(&cartons[n], 60, 0.003)
            .iter()
            .any(|p| holds(o, p, 0.0))
    })
}

/// Share of a top that higher cartons hide from the camera.
fn hidden(cartons: &[Carton], n: usize) -> f64 {
    let eye = at().translation.vector;
    let points = grid(&cartons[n], 20, 0.0);
    let blocked = |p: &Vector| {
        cartons.iter().enumerate().any(|(k, o)| {
            k != n
                && (1..60).any(|s| {
                    let q = p + (eye - p) * (f64::from(s) * 0.004);
                    q.z < o.top && q.z > o.top - o.size[2] && holds(o, &q, 0.0)
                })
        })
    };
    points.iter().filter(|p| blocked(p)).count() as f64 / points.len() as f64
}

/// What became of one picture.
#[derive(Debug, Default, Clone)]
pub struct Verdict {
    /// Uncovered cartons, wholly in view.
    pub wanted: usize,
    pub found: usize,
    /// Reports of a carton that is there, but something stands on it.
    pub covered: usize,
    /// Reports that hold most of two cartons or more.
    pub spanning: usize,
    /// Other reports that are no carton.
    pub wrong: usize,
    /// Measured less true side of what was found, mm.
    pub off_mm: Vec<f64>,
    pub xy_mm: Vec<f64>,
    pub notes: Vec<String>,
}

impl Verdict {
    pub fn absorb(&mut self, other: Self) {
        self.wanted += other.wanted;
        self.found += other.found;
        self.covered += other.covered;
        self.spanning += other.spanning;
        self.wrong += other.wrong;
        self.off_mm.extend(other.off_mm);
        self.xy_mm.extend(other.xy_mm);
        self.notes.extend(other.notes);
    }

    /// Reports that a robot must not act on.
    pub fn bad(&self) -> usize {
        self.covered + self.spanning + self.wrong
    }
}

/// Compares reports with the truth.
pub fn judge(scene: &Scene, boxes: &[DetectedBox]) -> Verdict {
    let cartons = &scene.cartons;
    let covered: Vec<bool> = (0..cartons.len()).map(|n| is_covered(cartons, n)).collect();
    let wanted: Vec<bool> = (0..cartons.len())
        .map(|n| !covered[n] && hidden(cartons, n) < 0.02)
        .collect();
    let mut verdict = Verdict {
        wanted: wanted.iter().filter(|w| **w).count(),
        ..Verdict::default()
    };
    let mut taken = vec![false; cartons.len()];
    for found in boxes {
        let pose = at() * found.camera_from_box;
        let p = pose.translation.vector;
        let own = (0..cartons.len()).find(|&n| {
            let c = &cartons[n];
            !taken[n]
                && (c.x - p.x).hypot(c.y - p.y) < 0.02
                && (c.top - p.z).abs() < 0.02
                && (c.size[0] - found.size.length).abs() < 0.02
                && (c.size[1] - found.size.width).abs() < 0.02
        });
        let tell = |what: &str| {
            format!(
                "{what} {:.0} x {:.0} at {:.0} {:.0} {:.0}, confidence {:.2}",
                found.size.length * 1e3,
                found.size.width * 1e3,
                p.x * 1e3,
                p.y * 1e3,
                p.z * 1e3,
                found.confidence
            )
        };
        if let Some(n) = own {
            taken[n] = true;
            if covered[n] {
                verdict.covered += 1;
                verdict.notes.push(tell("covered"));
                continue;
            }
            let off = [
                found.size.length - cartons[n].size[0],
                found.size.width - cartons[n].size[1],
            ];
            if wanted[n] {
                verdict.found += 1;
            }
            if off.iter().any(|o| o.abs() > 0.002) {
                verdict.notes.push(tell("size off"));
            }
            verdict.off_mm.extend(off.map(|o| o * 1e3));
            let c = &cartons[n];
            verdict.xy_mm.push((c.x - p.x).hypot(c.y - p.y) * 1e3);
            continue;
        }
        // Whose tops lie under it.
        let spanned = cartons
            .iter()
            .filter(|c| {
                let points = grid(c, 20, 0.0);
                let under = points.iter().filter(|q| {
                    let q = pose.inverse_transform_point(&Point::from(**q));
                    q.x.abs() < found.size.length / 2.0
                        && q.y.abs() < found.size.width / 2.0
                        && q.z.abs() < 0.02
                });
                under.count() * 2 > points.len()
            })
            .count();
        if spanned >= 2 {
            verdict.spanning += 1;
            verdict.notes.push(tell("spanning"));
        } else {
            verdict.wrong += 1;
            verdict.notes.push(tell("wrong"));
        }
    }
    verdict
}
