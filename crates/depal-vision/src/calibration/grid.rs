//! Which disc of the board is which.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::blobs::Spot;
use super::board::CircleBoard;
use super::discs::Disc;
use super::problem::CaptureProblem;

/// Farthest a disc may lie from its node, as a share of the pitch.
const NODE_TOLERANCE: f64 = 0.15;

/// Farthest the mean distance of neighbours may lie from the pitch, as a share of it: a camera's
/// scale error is far below, the next usual board far above.
const PITCH_TOLERANCE: f64 = 0.03;

/// Groups of spots linked by distances of about one pitch in space, the largest first.
pub fn groups(spots: &[Spot], pitch: f64) -> Vec<Vec<usize>> {
    let mut group_of: Vec<Option<usize>> = vec![None; spots.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for start in 0..spots.len() {
        if group_of[start].is_some() {
            continue;
        }
        let number = groups.len();
        group_of[start] = Some(number);
        let mut group = vec![start];
        let mut at = 0;
        while at < group.len() {
            let here = spots[group[at]].point;
            for (k, spot) in spots.iter().enumerate() {
                let distance = (spot.point - here).norm() / pitch;
                if group_of[k].is_none() && (0.8..1.2).contains(&distance) {
                    group_of[k] = Some(number);
                    group.push(k);
                }
            }
            at += 1;
        }
        groups.push(group);
    }
    groups.retain(|group| group.len() >= 4);
    for group in &mut groups {
        group.sort_unstable();
    }
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups
}

/// A disc at a node of an endless grid.
struct Node {
    column: i64,
    row: i64,
    disc: usize,
}

/// For each disc of the board, row by row, its index in `discs`.
pub fn assign(board: &CircleBoard, discs: &[Disc]) -> Result<Vec<usize>, CaptureProblem> {
    let Some((nodes, distance)) = nodes(discs, board.pitch) else {
        return Err(CaptureProblem::NoBoard { spots: discs.len() });
    };
    if (distance / board.pitch - 1.0).abs() > PITCH_TOLERANCE {
        return Err(CaptureProblem::WrongBoard {
            what: format!(
                "expected discs {:.1} mm apart, found {:.1} mm",
                board.pitch * 1e3,
                distance * 1e3
            ),
        });
    }
    let range = |pick: fn(&Node) -> i64| {
        let values = || nodes.iter().map(pick);
        let least = values().min().expect("some nodes");
        (
            least,
            (values().max().expect("some nodes") - least + 1) as usize,
        )
    };
    let (first_column, columns) = range(|n| n.column);
    let (first_row, rows) = range(|n| n.row);
    let (long, short) = (columns.max(rows), columns.min(rows));
    let (own_long, own_short) = (board.columns.max(board.rows), board.columns.min(board.rows));
    if long > own_long || short > own_short {
        return Err(CaptureProblem::WrongBoard {
            what: format!(
                "expected a grid of {own_long} x {own_short} discs, found {long} x {short}"
            ),
        });
    }
    if nodes.len() < board.discs() {
        return Err(CaptureProblem::Partial {
            expected: board.discs(),
            found: nodes.len(),
        });
    }
    let mut at = vec![usize::MAX; columns * rows];
    for node in &nodes {
        let (column, row) = (node.column - first_column, node.row - first_row);
        at[row as usize * columns + column as usize] = node.disc;
    }
    // Large and ordinary discs lie apart by half of the ordinary diameter; the middle parts them.
    let between = board.disc_diameter * (1.0 + CircleBoard::MARK_FACTOR) / 4.0;
    let mut fitting = Vec::new();
    let mut best = usize::MAX;
    for quarter in 0..4 {
        let (turned_columns, turned_rows) = if quarter % 2 == 0 {
            (columns, rows)
        } else {
            (rows, columns)
        };
        if (turned_columns, turned_rows) != (board.columns, board.rows) {
            continue;
        }
        // Quarter turns from board to seen numbers.
        let place = |c: usize, r: usize| match quarter {
            0 => (c, r),
            1 => (columns - 1 - r, c),
            2 => (columns - 1 - c, rows - 1 - r),
            _ => (r, rows - 1 - c),
        };
        let order: Vec<usize> = board
            .nodes()
            .map(|(c, r)| {
                let (column, row) = place(c, r);
                at[row * columns + column]
            })
            .collect();
        let wrong = board
            .nodes()
            .zip(&order)
            .filter(|((c, r), disc)| board.is_mark(*c, *r) != (discs[**disc].radius > between))
            .count();
        best = best.min(wrong);
        if wrong == 0 {
            fitting.push(order);
        }
    }
    match fitting.len() {
        1 => Ok(fitting.remove(0)),
        _ => Err(CaptureProblem::WrongBoard {
            what: format!(
                "expected three large discs at the board's places, found {best} discs of another size"
            ),
        }),
    }
}

/// Grid numbers of all discs that lie on one grid, and the mean distance of neighbours.
fn nodes(discs: &[Disc], pitch: f64) -> Option<(Vec<Node>, f64)> {
    // Direction modulo a quarter turn from all neighbours.
    let (mut sin, mut cos) = (0.0, 0.0);
    let (mut distance, mut count) = (0.0, 0.0);
    for (i, a) in discs.iter().enumerate() {
        for b in &discs[i + 1..] {
            let (dx, dy) = (b.x - a.x, b.y - a.y);
            if (0.85..1.15).contains(&(dx.hypot(dy) / pitch)) {
                let (s, c) = (4.0 * dy.atan2(dx)).sin_cos();
                sin += s;
                cos += c;
                distance += dx.hypot(dy);
                count += 1.0;
            }
        }
    }
    if sin.hypot(cos) < 1.0 {
        return None;
    }
    let (s, c) = (sin.atan2(cos) / TAU * FRAC_PI_2).sin_cos();
    let turned: Vec<(f64, f64)> = discs
        .iter()
        .map(|d| ((d.x * c + d.y * s) / pitch, (d.y * c - d.x * s) / pitch))
        .collect();
    // Phase of the grid along both axes.
    let phase = |pick: fn(&(f64, f64)) -> f64| {
        let (s, c) = turned.iter().fold((0.0, 0.0), |sum, p| {
            let (s, c) = (TAU * pick(p)).sin_cos();
            (sum.0 + s, sum.1 + c)
        });
        s.atan2(c) / TAU
    };
    let (x0, y0) = (phase(|p| p.0), phase(|p| p.1));
    let mut nodes: Vec<Node> = Vec::new();
    for (disc, (x, y)) in turned.iter().enumerate() {
        let (x, y) = (x - x0, y - y0);
        let (column, row) = (x.round(), y.round());
        if (x - column).hypot(y - row) > NODE_TOLERANCE {
            continue;
        }
        let (column, row) = (column as i64, row as i64);
        if !nodes.iter().any(|n| n.column == column && n.row == row) {
            nodes.push(Node { column, row, disc });
        }
    }
    (!nodes.is_empty()).then_some((nodes, distance / count))
}
