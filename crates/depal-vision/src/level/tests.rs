//! A flat top on a rim, far above a floor, as a camera sees it that averages along its rows.

use depal_frames::{DepthFrame, Intrinsics, Vector};

use super::*;
use crate::{VisionSettings, gate::gate};

const WIDTH: usize = 400;
const HEIGHT: usize = 120;
const SMEAR: usize = 15;
/// Half of the top, metres, and its depth.
const HALF: f64 = 0.2;
const TOP: f64 = 1.5;
const CELL: f64 = TOP / 600.0;

/// `rim`: pixels of a surface 120 mm below on both sides of the top; then the floor a metre below.
fn level(rim: f64) -> Level {
    let intrinsics = Intrinsics {
        width: WIDTH,
        height: HEIGHT,
        fx: 600.0,
        fy: 600.0,
        cx: (WIDTH as f64 - 1.0) / 2.0,
        cy: (HEIGHT as f64 - 1.0) / 2.0,
    };
    let exact = |u: usize| {
        let beyond = (u as f64 - intrinsics.cx).abs() - HALF / CELL;
        if beyond < 0.0 {
            TOP
        } else if beyond < rim {
            TOP + 0.12
        } else {
            TOP + 1.0
        }
    };
    let smeared = |u: usize| {
        let (first, last) = (u.saturating_sub(SMEAR / 2), (u + SMEAR / 2).min(WIDTH - 1));
        let inverse: f64 = (first..=last).map(|u| 1.0 / exact(u)).sum();
        ((last - first + 1) as f64 / inverse) as f32
    };
    let row: Vec<f32> = (0..WIDTH).map(smeared).collect();
    let frame = DepthFrame {
        intrinsics,
        depth: row.repeat(HEIGHT),
        intensity: Vec::new(),
    };
    let mut cleaned = Vec::new();
    let image = gate(&frame, &mut cleaned, &VisionSettings::new(Vec::new())).expect("it is whole");
    let plane = Plane {
        coefficient: Vector::new(0.0, 0.0, 1.0 / TOP),
    };
    Level::new(
        &image,
        &Cut {
            frame: PlaneFrame::new(plane, &Vector::z()),
            range: [[-0.35, 0.35], [-0.1, 0.1]],
            cell: CELL,
            tolerance: 0.018,
            height: 0.12,
            smear: SMEAR,
            valley: SMEAR + 4,
        },
    )
}

#[test]
fn an_edge_is_where_it_is_whatever_comes_beyond_it() {
    for rim in [8.0, 10.0, 12.0, 15.0, 20.0, 40.0] {
        let level = level(rim);
        for sign in [-1.0, 1.0] {
            let is_on = |n: &i32| level.at([sign * (f64::from(*n) + 0.5) * CELL, 0.0]) == Cell::On;
            let cells = (0..140).take_while(is_on).count();
            let off = cells as f64 - HALF / CELL;
            assert!(off.abs() <= 3.0, "rim of {rim}: off by {off} cells");
        }
    }
}

#[test]
fn a_rectangle_that_is_all_surface_is_all_surface_wherever_it_lies() {
    let level = level(10.0);
    for side in [0.020, 0.0231, 0.0284, 0.0303] {
        for n in 0..50 {
            let low = [
                -0.05 + 0.00037 * f64::from(n),
                -0.03 + 0.00053 * f64::from(n),
            ];
            let high = low.map(|v| v + side);
            let [on, deep] = level.shares(low, high);
            assert!(
                (on - 1.0).abs() < 1e-9 && deep == 0.0,
                "{low:?} {side}: {on}"
            );
            assert!((level.flat_share(low, high) - 1.0).abs() < 1e-9);
        }
    }
    // What lies beyond the level is no surface.
    let [on, _] = level.shares([-0.02, 0.08], [0.02, 0.12]);
    assert!((on - 0.5).abs() < 0.05, "{on}");
}
