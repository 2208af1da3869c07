//! Pallets whose carton sizes the estimation is not told, and the judgement of what it measures.
//! Z of the world points up, nominal tops are at 0; the camera stands 2 m above.
#![allow(dead_code)]

use std::f64::consts::PI;

use depal_camera::{Material, RenderShape, SensorSpec};
use depal_frames::DepthFrame;
use depal_time::{RandomStream, RandomStreams};
use depal_vision::{Detection, VisionSettings, detect_any_size};

use crate::{
    generator::{self, Noise, at},
    rendered::{Carton, HEIGHT, Layout, block, camera, picture},
};

mod ground;
pub mod verdict;
use ground::{GAPS, Ground, as_left, cluster, full_layer, pick};
use verdict::{grid, holds};

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
