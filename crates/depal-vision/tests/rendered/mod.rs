//! Layers of cartons taken by the simulated camera, with its truth: depth, intensity and all noise.
//! Z of the world points up; the camera looks straight down.
#![allow(dead_code, unused_imports)]

use std::f64::consts::{FRAC_PI_2, PI};

use depal_camera::{CameraSpec, Material, RenderShape, render, sense};
use depal_frames::{BoxSize, DepthFrame, Pose, Rotation, Shape, Vector};
use depal_time::RandomStreams;
use depal_vision::DetectedBox;

pub use cameras::{camera, small_stereo};

mod cameras;

/// A top face: middle, yaw about the world's Z, sides.
#[derive(Debug, Clone, Copy)]
pub struct Carton {
    pub x: f64,
    pub y: f64,
    pub top: f64,
    pub yaw: f64,
    /// Turns about the own X and Y through the middle of the top, radians, before the yaw.
    pub tilt: [f64; 2],
    pub size: [f64; 3],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    Regular,
    Brick,
    Pinwheel,
    Mixed,
    /// 4 x 5.
    Regular20,
    /// Rows of four lying and six standing cartons in turn.
    Brick20,
    /// Four pinwheels of four, and a column of five.
    Pinwheel21,
    /// Five rows of four, every other one shifted by half a carton.
    RunningBond20,
    /// 8 x 6 small cartons.
    Small48,
}

impl Layout {
    /// Rectangles (x, y, extent in x, extent in y), millimetres.
    fn rectangles(self) -> Vec<[f64; 4]> {
        let row = |y: f64, x: f64, n: usize, a: f64, b: f64| {
            (0..n).map(move |i| [x + a * i as f64, y, a, b])
        };
        match self {
            Self::Regular => (0..4)
                .flat_map(|j| row(200.0 * f64::from(j), 0.0, 4, 300.0, 200.0))
                .collect(),
            Self::Brick => row(0.0, 0.0, 3, 400.0, 300.0)
                .chain(row(300.0, 0.0, 4, 300.0, 400.0))
                .collect(),
            Self::Pinwheel => vec![
                [0.0, 0.0, 400.0, 300.0],
                [400.0, 0.0, 300.0, 400.0],
                [300.0, 400.0, 400.0, 300.0],
                [0.0, 300.0, 300.0, 400.0],
            ],
            Self::Mixed => vec![
                [0.0, 0.0, 400.0, 300.0],
                [400.0, 0.0, 400.0, 300.0],
                [800.0, 0.0, 300.0, 200.0],
                [0.0, 300.0, 300.0, 200.0],
                [300.0, 300.0, 300.0, 200.0],
                [600.0, 300.0, 200.0, 300.0],
            ],
            Self::Regular20 => (0..5)
                .flat_map(|j| row(200.0 * f64::from(j), 0.0, 4, 300.0, 200.0))
                .collect(),
            Self::Brick20 => row(0.0, 0.0, 4, 300.0, 200.0)
                .chain(row(200.0, 0.0, 6, 200.0, 300.0))
                .chain(row(500.0, 0.0, 4, 300.0, 200.0))
                .chain(row(700.0, 0.0, 6, 200.0, 300.0))
                .collect(),
            Self::Pinwheel21 => {
                let wheel = |x: f64, y: f64| {
                    [
                        [x, y, 300.0, 200.0],
                        [x + 300.0, y, 200.0, 300.0],
                        [x + 200.0, y + 300.0, 300.0, 200.0],
                        [x, y + 200.0, 200.0, 300.0],
                    ]
                };
                [[0.0, 0.0], [500.0, 0.0], [0.0, 500.0], [500.0, 500.0]]
                    .into_iter()
                    .flat_map(|[x, y]| wheel(x, y))
                    .chain((0..5).map(|n| [1000.0, 200.0 * f64::from(n), 300.0, 200.0]))
                    .collect()
            }
            Self::Small48 => (0..6)
                .flat_map(|j| row(150.0 * f64::from(j), 0.0, 8, 200.0, 150.0))
                .collect(),
            Self::RunningBond20 => (0..5)
                .flat_map(|j| {
                    let shift = if j % 2 == 0 { 0.0 } else { 150.0 };
                    row(200.0 * f64::from(j), shift, 4, 300.0, 200.0)
                })
                .collect(),
        }
    }

    pub fn sizes(self) -> Vec<BoxSize> {
        let mm = |l, w| BoxSize::from_mm([l, w, 200.0]);
        match self {
            Self::Regular
            | Self::Regular20
            | Self::Brick20
            | Self::Pinwheel21
            | Self::RunningBond20 => {
                vec![mm(300.0, 200.0)]
            }
            Self::Brick | Self::Pinwheel => vec![mm(400.0, 300.0)],
            Self::Small48 => vec![mm(200.0, 150.0)],
            Self::Mixed => vec![mm(400.0, 300.0), mm(300.0, 200.0)],
        }
    }
}

pub const HEIGHT: f64 = 0.2;

/// A place in a layer: middle, yaw, long and short side, metres and radians.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub x: f64,
    pub y: f64,
    pub yaw: f64,
    pub long: f64,
    pub short: f64,
}

/// The places of a layer with `gap` metres between its cartons, around (0, 0).
pub fn places(layout: Layout, gap: f64) -> Vec<Place> {
    let rectangles = layout.rectangles();
    let [width, depth] = rectangles.iter().fold([0.0f64; 2], |b, r| {
        [b[0].max(r[0] + r[2]), b[1].max(r[1] + r[3])]
    });
    // Gaps that lie before a carton: as many as cartons before it in its row or column.
    let before = |k: usize, rectangle: &[f64; 4]| {
        let mut at = rectangle[k];
        let mut gaps = 0.0;
        while at > 1.0 {
            let Some(r) = rectangles.iter().find(|r| {
                let across = 1 - k;
                (r[k] + r[k + 2] - at).abs() < 1.0
                    && r[across] < rectangle[across] + rectangle[across + 2] - 1.0
                    && rectangle[across] < r[across] + r[across + 2] - 1.0
            }) else {
                gaps += (at / 250.0).round();
                break;
            };
            at = r[k];
            gaps += 1.0;
        }
        gaps
    };
    rectangles
        .iter()
        .map(|rectangle| {
            let [_, _, a, b] = *rectangle;
            Place {
                x: (rectangle[0] + a / 2.0 - width / 2.0) * 1e-3 + gap * before(0, rectangle),
                y: (rectangle[1] + b / 2.0 - depth / 2.0) * 1e-3 + gap * before(1, rectangle),
                yaw: if b > a { FRAC_PI_2 } else { 0.0 },
                long: a.max(b) * 1e-3,
                short: a.min(b) * 1e-3,
            }
        })
        .collect()
}

/// A layer with `gap` metres between its cartons, the middle of its tops at (0, 0, `top`).
/// Each carton is turned and shifted a little where the gap leaves room.
pub fn layer(layout: Layout, gap: f64, top: f64, seed: u64) -> Vec<Carton> {
    let mut r = RandomStreams::new(seed).stream("layer");
    // The whole layer stands as a forklift has left it.
    let turn = r.uniform(-0.01, 0.01);
    let shift = [r.uniform(-0.02, 0.02), r.uniform(-0.02, 0.02)];
    let (s, c) = turn.sin_cos();
    places(layout, gap)
        .iter()
        .map(|place| {
            let free = f64::from(u8::from(gap >= 0.002));
            let jitter = (gap * 0.15).min(0.001) * free;
            let x = place.x + r.uniform(-jitter, jitter);
            let y = place.y + r.uniform(-jitter, jitter);
            let room = (gap / place.long * 0.3).min(0.005) * free;
            Carton {
                x: x * c - y * s + shift[0],
                y: x * s + y * c + shift[1],
                top: top + r.uniform(-0.0005, 0.0005),
                yaw: turn + place.yaw + r.uniform(-room, room),
                tilt: [0.0; 2],
                size: [place.long, place.short, HEIGHT],
            }
        })
        .collect()
}

pub fn block(
    id: u32,
    centre: [f64; 3],
    size: [f64; 3],
    yaw: f64,
    material: Material,
) -> RenderShape {
    RenderShape {
        world_from_shape: Pose::from_parts(
            Vector::from(centre).into(),
            Rotation::new(Vector::z() * yaw),
        ),
        shape: Shape::cuboid(size[0], size[1], size[2]),
        id,
        material,
        edge_radius: 0.0,
    }
}

/// Radius of the cartons' edges, metres: `EDGE_MM` of the environment, so that every test and table can be had
/// with another one; else 0.
pub fn edge_radius() -> f64 {
    let given = std::env::var("EDGE_MM").ok();
    given.and_then(|mm| mm.parse().ok()).unwrap_or(0.0) * 1e-3
}

impl Carton {
    pub fn shape(&self, id: u32) -> RenderShape {
        let rotation = self.rotation();
        let centre =
            Vector::new(self.x, self.y, self.top) - rotation * Vector::z() * (self.size[2] / 2.0);
        RenderShape {
            world_from_shape: Pose::from_parts(centre.into(), rotation),
            shape: Shape::cuboid(self.size[0], self.size[1], self.size[2]),
            id,
            material: Material::KRAFT,
            edge_radius: edge_radius(),
        }
    }

    pub fn rotation(&self) -> Rotation {
        Rotation::new(Vector::z() * self.yaw)
            * Rotation::new(Vector::x() * self.tilt[0])
            * Rotation::new(Vector::y() * self.tilt[1])
    }
}

/// Cartons as solids, numbered from 0.
pub fn solids(cartons: &[Carton]) -> Vec<RenderShape> {
    (0..)
        .zip(cartons)
        .map(|(id, carton)| carton.shape(id))
        .collect()
}

/// A floor of concrete, its upper side at `top`.
pub fn floor(top: f64) -> RenderShape {
    let centre = [0.0, 0.0, top - 0.1];
    block(1001, centre, [8.0, 8.0, 0.2], 0.0, Material::CONCRETE)
}

/// Cartons as solids, over the lower layers as one block and a floor.
pub fn stacked(cartons: &[Carton], top: f64) -> Vec<RenderShape> {
    let mut shapes = solids(cartons);
    let below = top - HEIGHT - 0.002;
    shapes.push(block(
        1000,
        [0.0, 0.0, below / 2.0],
        [1.15, 0.75, below],
        0.0,
        Material::KRAFT,
    ));
    shapes.push(floor(0.0));
    shapes
}

/// `height` metres above the floor, X to the right.
pub fn looking_down(height: f64) -> Pose {
    Pose::from_parts(
        Vector::new(0.0, 0.0, height).into(),
        Rotation::new(Vector::x() * PI),
    )
}

pub fn picture(
    spec: &CameraSpec,
    world_from_camera: &Pose,
    shapes: &[RenderShape],
    seed: u64,
) -> DepthFrame {
    sense(spec, &render(spec, world_from_camera, shapes), seed).frame
}

#[derive(Debug, Default, Clone)]
pub struct Score {
    pub wanted: usize,
    pub found: usize,
    pub false_positives: usize,
    pub xy_mm: Vec<f64>,
    pub z_mm: Vec<f64>,
    pub yaw_deg: Vec<f64>,
    pub tilt_deg: Vec<f64>,
    pub time_ms: Vec<f64>,
}

impl Score {
    pub fn add(&mut self, world_from_camera: &Pose, wanted: &[Carton], boxes: &[DetectedBox]) {
        let mut open = wanted.to_vec();
        self.wanted += open.len();
        for found in boxes {
            let pose = world_from_camera * found.camera_from_box;
            let p = pose.translation.vector;
            let near = |c: &Carton| {
                (c.x - p.x).hypot(c.y - p.y) < 0.02
                    && (c.top - p.z).abs() < 0.02
                    && (c.size[0] - found.size.length).abs() < 0.02
                    && (c.size[1] - found.size.width).abs() < 0.02
            };
            let Some(n) = open.iter().position(near) else {
                self.false_positives += 1;
                continue;
            };
            let carton = open.remove(n);
            let x = pose.rotation * Vector::x();
            let mut yaw = x.y.atan2(x.x) - carton.yaw;
            yaw -= (yaw / PI).round() * PI;
            let normal = pose.rotation * Vector::z();
            self.found += 1;
            self.xy_mm
                .push((carton.x - p.x).hypot(carton.y - p.y) * 1e3);
            self.z_mm.push((carton.top - p.z).abs() * 1e3);
            self.yaw_deg.push(yaw.abs().to_degrees());
            let upright = carton.rotation() * Vector::z();
            self.tilt_deg.push(normal.angle(&upright).to_degrees());
        }
    }

    pub fn absorb(&mut self, other: Self) {
        self.wanted += other.wanted;
        self.found += other.found;
        self.false_positives += other.false_positives;
        self.xy_mm.extend(other.xy_mm);
        self.z_mm.extend(other.z_mm);
        self.yaw_deg.extend(other.yaw_deg);
        self.tilt_deg.extend(other.tilt_deg);
        self.time_ms.extend(other.time_ms);
    }

    /// Found of wanted, false; median and 95 of 100 of the errors: centre mm, height mm, yaw and tilt degrees.
    pub fn errors(&self) -> String {
        format!(
            "{:>3}/{:<3} | {:>2} | {:.2} / {:.2} | {:.2} | {:.3} / {:.3} | {:.3}",
            self.found,
            self.wanted,
            self.false_positives,
            quantile(&self.xy_mm, 0.5),
            quantile(&self.xy_mm, 0.95),
            quantile(&self.z_mm, 0.95),
            quantile(&self.yaw_deg, 0.5),
            quantile(&self.yaw_deg, 0.95),
            quantile(&self.tilt_deg, 0.95),
        )
    }

    /// The same and the time, ms.
    pub fn line(&self) -> String {
        format!("{} | {:.1}", self.errors(), quantile(&self.time_ms, 0.5))
    }
}

pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}
