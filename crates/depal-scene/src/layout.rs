//! Where each carton stands at the start.

use depal_frames::nalgebra::Translation3;
use depal_frames::{BoxSize, Pose, Rotation, Vector};
use depal_time::{RandomStream, RandomStreams};

use crate::rules::Span;
use crate::scene::Scene;
use crate::stack::{PalletAxis, Pattern, long_and_short_mm};

/// One carton at the start. Its frame: X along the long side, Z up, origin in the middle of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartonPlacement {
    /// Outer size, metres.
    pub size: BoxSize,
    /// Mass, kg.
    pub mass_kg: f64,
    /// `world_from_carton`: the middle of the body, metres.
    pub world_from_carton: Pose,
    /// Layer, 0 at the bottom.
    pub layer: u32,
    /// Place in the layer: column along the pallet's X, row along its Y; for one that lies alone its place in the list.
    pub cell: [u32; 2],
    /// Its block's place in the list; none for cartons of a stack and for those that lie alone.
    pub block: Option<u32>,
}

/// Size of a tidy layer without gaps, along the pallet's X and Y, mm.
pub(crate) fn footprint_mm(size_mm: [f64; 3], pattern: &Pattern) -> [f64; 2] {
    let [x, y] = sides_mm(size_mm, pattern);
    [x * f64::from(pattern.columns), y * f64::from(pattern.rows)]
}

/// A carton's extent along the pallet's X and Y, mm, before it is turned.
fn sides_mm(size_mm: [f64; 3], pattern: &Pattern) -> [f64; 2] {
    let [long, short] = long_and_short_mm(size_mm);
    match pattern.long_side {
        PalletAxis::X => [long, short],
        PalletAxis::Y => [short, long],
    }
}

/// The cartons of a scene, from the bottom layer up.
///
/// In every layer the clear distance between the bounding rectangles of neighbours stays within
/// `randomize.gap_mm`: in a column always, between columns unless the turns alone differ by more than
/// the range. Bounding rectangles that do not meet hold cartons that do not meet.
pub fn carton_layout(scene: &Scene, streams: RandomStreams) -> Vec<CartonPlacement> {
    let cartons = &scene.cartons;
    let mut random = Draws {
        gap: streams.stream("cartons.gap"),
        yaw: streams.stream("cartons.yaw"),
        shift: streams.stream("cartons.shift"),
        mass: streams.stream("cartons.mass"),
    };
    let total = cartons.total() as usize;
    let size = BoxSize::from_mm(cartons.size_mm);
    let world_from_pallet = Pose::from_parts(
        Translation3::from(Vector::from(scene.pallet.xyz_mm) * 1e-3),
        Rotation::from_axis_angle(&Vector::z_axis(), scene.pallet.yaw_deg.to_radians()),
    );
    let mut placements = Vec::with_capacity(total);
    let stack = cartons
        .stack()
        .map(|(layers, pattern)| (None, [0.0; 2], cartons.size_mm, layers, pattern));
    let blocks = (0..).zip(&cartons.block);
    let blocks = blocks.map(|(n, b)| (Some(n), b.xy_mm, b.size_mm, b.layers, &b.pattern));
    for (block, [x_mm, y_mm], size_mm, layers, pattern) in stack.into_iter().chain(blocks) {
        let size = BoxSize::from_mm(size_mm);
        let side_turn = match pattern.long_side {
            PalletAxis::X => 0.0,
            PalletAxis::Y => std::f64::consts::FRAC_PI_2,
        };
        for layer in 0..layers {
            let height_mm = scene.pallet.size_mm[2] + size_mm[2] * (f64::from(layer) + 0.5);
            for cell in lay_layer(scene, size_mm, pattern, &mut random) {
                let mass_kg = random
                    .mass
                    .uniform(cartons.mass_kg.min, cartons.mass_kg.max);
                let pallet_from_carton = Pose::from_parts(
                    Translation3::new(
                        (x_mm + cell.x_mm) * 1e-3,
                        (y_mm + cell.y_mm) * 1e-3,
                        height_mm * 1e-3,
                    ),
                    Rotation::from_axis_angle(&Vector::z_axis(), side_turn + cell.yaw),
                );
                placements.push(CartonPlacement {
                    size,
                    mass_kg,
                    world_from_carton: world_from_pallet * pallet_from_carton,
                    layer,
                    cell: cell.at,
                    block,
                });
            }
        }
    }
    let height_mm = scene.pallet.xyz_mm[2] + scene.pallet.size_mm[2] + 0.5 * cartons.size_mm[2];
    for (position, place) in (0..).zip(&cartons.at) {
        let mass_kg = random
            .mass
            .uniform(cartons.mass_kg.min, cartons.mass_kg.max);
        placements.push(CartonPlacement {
            size,
            mass_kg,
            world_from_carton: Pose::from_parts(
                Translation3::new(
                    place.xy_mm[0] * 1e-3,
                    place.xy_mm[1] * 1e-3,
                    height_mm * 1e-3,
                ),
                Rotation::from_axis_angle(&Vector::z_axis(), place.yaw_deg.to_radians()),
            ),
            layer: 0,
            cell: [position, 0],
            block: None,
        });
    }
    placements.truncate(total);
    placements
}

struct Draws {
    gap: RandomStream,
    yaw: RandomStream,
    shift: RandomStream,
    mass: RandomStream,
}

/// One carton of a layer, in the pallet frame.
struct Cell {
    at: [u32; 2],
    yaw: f64,
    /// Half extents of the bounding rectangle, mm.
    half_mm: [f64; 2],
    x_mm: f64,
    y_mm: f64,
}

/// How far a carton may shift to either side before a gap leaves its range, mm.
#[derive(Clone, Copy)]
struct Slack {
    down: f64,
    up: f64,
}

fn lay_layer(scene: &Scene, size_mm: [f64; 3], pattern: &Pattern, random: &mut Draws) -> Vec<Cell> {
    let gap = scene.randomize.gap_mm;
    let most_shift = scene.randomize.shift_mm;
    let yaw_limit = scene.randomize.yaw_deg.to_radians();
    let [half_x, half_y] = sides_mm(size_mm, pattern).map(|side| side / 2.0);
    let (columns, rows) = (pattern.columns as usize, pattern.rows as usize);

    let mut cells: Vec<Cell> = (0..columns * rows)
        .map(|position| {
            let yaw = random.yaw.uniform(-yaw_limit, yaw_limit);
            let (sin, cos) = (yaw.sin().abs(), yaw.cos().abs());
            Cell {
                at: [(position / rows) as u32, (position % rows) as u32],
                yaw,
                half_mm: [half_x * cos + half_y * sin, half_x * sin + half_y * cos],
                x_mm: 0.0,
                y_mm: 0.0,
            }
        })
        .collect();

    // Along X: straight strips as wide as their widest carton.
    let strips: Vec<(f64, f64)> = cells
        .chunks(rows)
        .map(|column| {
            let widest = column
                .iter()
                .map(|cell| cell.half_mm[0])
                .fold(0.0, f64::max);
            let narrowest = column
                .iter()
                .map(|cell| cell.half_mm[0])
                .fold(f64::INFINITY, f64::min);
            (widest, widest - narrowest)
        })
        .collect();
    let spare: Vec<f64> = strips
        .windows(2)
        .map(|pair| pair[0].1 + pair[1].1)
        .collect();
    let widths: Vec<f64> = strips.iter().map(|strip| strip.0).collect();
    let (middles_x, slack_x) = line_up(&widths, &spare, gap, random);
    for (cell, index) in cells.iter_mut().zip(0..) {
        let column = index / rows;
        cell.x_mm = middles_x[column] + shift(slack_x[column], most_shift, random);
    }

    // Along Y: every column by itself.
    for column in cells.chunks_mut(rows) {
        let halves: Vec<f64> = column.iter().map(|cell| cell.half_mm[1]).collect();
        let (middles_y, slack_y) = line_up(&halves, &vec![0.0; rows - 1], gap, random);
        for (position, cell) in column.iter_mut().enumerate() {
            cell.y_mm = middles_y[position] + shift(slack_y[position], most_shift, random);
        }
    }
    cells
}

/// Middles of things of the given half widths in a line about zero, and how far each may shift.
/// `spare[i]` is how much wider the gap after `i` already is for the narrowest neighbours.
fn line_up(halves: &[f64], spare: &[f64], gap: Span, random: &mut Draws) -> (Vec<f64>, Vec<Slack>) {
    let free = Slack {
        down: f64::INFINITY,
        up: f64::INFINITY,
    };
    // The line begins at zero.
    let mut middles = vec![halves[0]];
    let mut slack = vec![free; halves.len()];
    for (position, spare) in spare.iter().enumerate() {
        let largest = (gap.max - spare).max(gap.min);
        let drawn = random.gap.uniform(gap.min, largest);
        let end = middles[position] + halves[position];
        middles.push(end + drawn + halves[position + 1]);
        // Each neighbour may use half of what is left in either direction.
        let closer = (drawn - gap.min) / 2.0;
        let farther = ((largest - drawn) / 2.0).max(0.0);
        slack[position].up = slack[position].up.min(closer);
        slack[position].down = slack[position].down.min(farther);
        slack[position + 1].down = slack[position + 1].down.min(closer);
        slack[position + 1].up = slack[position + 1].up.min(farther);
    }
    let last = halves.len() - 1;
    let middle = f64::midpoint(middles[last], halves[last]);
    for at in &mut middles {
        *at -= middle;
    }
    (middles, slack)
}

fn shift(slack: Slack, most: f64, random: &mut Draws) -> f64 {
    random
        .shift
        .uniform(-most, most)
        .clamp(-slack.down.min(most), slack.up.min(most))
}
