//! The board in one picture.

use depal_frames::{DepthFrame, Point, Pose, Vector};

use super::blobs::{Spot, spots};
use super::board::CircleBoard;
use super::closed_form::best_pose;
use super::discs::{board_plane, board_samples, disc};
use super::grid::{assign, groups};
use super::problem::CaptureProblem;
use crate::plane::PlaneFrame;

/// Least share of the board with valid depth.
const LEAST_DEPTH: f64 = 0.4;
/// Disc centres farther from the board's grid than this (root mean square) belong to another board
/// or a bent one, metres.
const MOST_DISTORTION: f64 = 0.001;

/// A board that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardView {
    /// Disc centres in the camera frame, metres, in the order of [`CircleBoard::nodes`].
    pub centres: Vec<Point>,
    /// The board's pose by this picture alone. Far less certain than what many pictures give.
    pub camera_from_board: Pose,
    /// Root mean square distance of the centres from the rigid board, metres.
    pub rms: f64,
    /// Mean diameter of a disc in the image, pixels.
    pub disc_px: f64,
    /// Angle between the board's Z and the direction to the camera, radians.
    pub incidence: f64,
}

/// Finds the board in a picture. Pure: the same frame gives the same bits.
///
/// # Errors
/// See [`CaptureProblem`]; a picture that does not show the whole board once is refused.
pub fn find_board(frame: &DepthFrame, board: &CircleBoard) -> Result<BoardView, CaptureProblem> {
    let expected = frame.intrinsics.width * frame.intrinsics.height;
    if frame.depth.len() != expected || frame.intensity.len() != expected || expected == 0 {
        return Err(CaptureProblem::BadFrame {
            expected,
            depth: frame.depth.len(),
            intensity: frame.intensity.len(),
        });
    }
    let spots = spots(frame, board);
    let mut found = Vec::new();
    let mut refused = None;
    for group in groups(&spots, board.pitch) {
        let members: Vec<&Spot> = group.iter().map(|&k| &spots[k]).collect();
        match view(frame, board, &members) {
            Ok(view) => found.push(view),
            // The largest group tells most about what is wrong.
            Err(problem) => refused = refused.or(Some(problem)),
        }
    }
    match found.len() {
        0 => Err(refused.unwrap_or(CaptureProblem::NoBoard { spots: spots.len() })),
        1 => Ok(found.remove(0)),
        found => Err(CaptureProblem::SeveralBoards { found }),
    }
}

fn view(
    frame: &DepthFrame,
    board: &CircleBoard,
    spots: &[&Spot],
) -> Result<BoardView, CaptureProblem> {
    let (samples, share) = board_samples(frame, spots, board.pitch);
    let no_depth = || CaptureProblem::NoDepth {
        expected_percent: LEAST_DEPTH * 100.0,
        found_percent: share * 100.0,
    };
    if share < LEAST_DEPTH {
        return Err(no_depth());
    }
    let plane = board_plane(frame, &samples).ok_or_else(no_depth)?;
    let count = spots.len() as f64;
    let middle = spots.iter().fold(Vector::zeros(), |s, spot| {
        s + frame.intrinsics.ray(spot.u, spot.v) / count
    });
    let axes = PlaneFrame::new(plane, &middle);
    let discs: Vec<_> = spots
        .iter()
        .filter_map(|spot| disc(frame, spot, &axes))
        .collect();
    let order = assign(board, &discs)?;
    let centres: Vec<Point> = order
        .iter()
        .map(|&k| axes.point(discs[k].x, discs[k].y))
        .collect();
    let (camera_from_board, rms) = best_pose(&board.centres(), &centres);
    if rms > MOST_DISTORTION {
        return Err(CaptureProblem::Distorted {
            expected_mm: MOST_DISTORTION * 1e3,
            found_mm: rms * 1e3,
        });
    }
    let at = camera_from_board.translation.vector;
    let facing = camera_from_board.rotation * Vector::z();
    let radius = discs.iter().map(|d| d.radius).sum::<f64>() / discs.len() as f64;
    Ok(BoardView {
        centres,
        camera_from_board,
        rms,
        disc_px: 2.0 * radius * frame.intrinsics.fx / at.z,
        incidence: facing.angle(&-at),
    })
}
