//! From captures to a calibration.

use depal_frames::{Point, Pose, Rotation, Vector};
use nalgebra::Unit;

use super::board::{CircleBoard, Mounting};
use super::closed_form::{best_pose, best_rotation, complete, motions, rotation_from_motions};
use super::joint::{Problem, Unknowns};
use super::observability::{Motion, check_information, motion};
use super::problem::CalibrationProblem;

/// Fewer captures never give both transforms.
pub(crate) const LEAST_POSES: usize = 3;
/// A calibration that explains its own captures worse is no calibration, metres.
const MOST_RESIDUAL: f64 = 0.005;
/// A capture is dropped when its residual is this many times the median of all ...
const OUTLIER_FACTOR: f64 = 4.0;
/// ... and more than this, metres.
const OUTLIER_FLOOR: f64 = 0.001;
/// Turns about a single axis that are tried as beginnings when rotations alone do not tell.
const TURNS: usize = 24;

/// One picture of the board and where the robot was.
#[derive(Debug, Clone, PartialEq)]
pub struct Capture {
    /// As the robot reports it.
    pub base_from_flange: Pose,
    /// Disc centres in the camera frame, row by row of the board, metres.
    pub centres_in_camera: Vec<Point>,
}

/// A point that the robot has touched with a known tool tip and the camera has seen.
/// It stands for what motions about a single axis cannot tell.
#[derive(Debug, Clone, PartialEq)]
pub struct TouchedPoint {
    /// Where the tool tip touched it, metres.
    pub point_in_base: Point,
    /// Where the camera saw it, metres.
    pub point_in_camera: Point,
    /// Where the flange was when the camera saw it; without effect for a fixed camera.
    pub base_from_flange: Pose,
}

/// How well one capture fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseResidual {
    /// Root mean square distance of its disc centres, metres.
    pub rms: f64,
    /// Largest distance, metres.
    pub max: f64,
    /// It was used; captures that contradict the others are dropped, a third of them at most.
    pub used: bool,
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Which frames the two poses belong to.
    pub mounting: Mounting,
    /// `base_from_camera` (camera fixed) or `flange_from_camera` (camera on the flange).
    pub camera: Pose,
    /// `flange_from_board` (camera fixed) or `base_from_board` (camera on the flange).
    pub board: Pose,
    /// Root mean square distance of all used disc centres, metres.
    pub rms: f64,
    /// Largest distance of a used disc centre, metres.
    pub max: f64,
    /// By capture, in their order.
    pub poses: Vec<PoseResidual>,
}

/// Estimates camera and board pose together. Pure and sequential: the same captures give the same bits.
///
/// # Errors
/// See [`CalibrationProblem`]: too few captures, motions that leave something open, no agreement.
pub fn calibrate(
    board: &CircleBoard,
    mounting: Mounting,
    captures: &[Capture],
    touched: &[TouchedPoint],
) -> Result<Calibration, CalibrationProblem> {
    board.validate()?;
    let in_board = board.centres();
    if let Some(odd) = captures
        .iter()
        .find(|c| c.centres_in_camera.len() != in_board.len())
    {
        return Err(CalibrationProblem::Centres {
            expected: in_board.len(),
            found: odd.centres_in_camera.len(),
        });
    }
    let touched: Vec<(Point, Point)> = touched
        .iter()
        .map(|t| {
            let in_hub = match mounting {
                Mounting::EyeToHand => t.point_in_base,
                Mounting::EyeInHand => t.base_from_flange.inverse_transform_point(&t.point_in_base),
            };
            (t.point_in_camera, in_hub)
        })
        .collect();
    let mut used: Vec<usize> = (0..captures.len()).collect();
    let least = LEAST_POSES.max((2 * captures.len()).div_ceil(3));
    loop {
        let chosen: Vec<&Capture> = used.iter().map(|&i| &captures[i]).collect();
        let unknowns = estimate(&chosen, mounting, &in_board, &touched)?;
        let residuals: Vec<PoseResidual> = captures
            .iter()
            .map(|c| residual(c, mounting, &in_board, &unknowns))
            .collect();
        let mut sizes: Vec<f64> = used.iter().map(|&i| residuals[i].rms).collect();
        sizes.sort_by(f64::total_cmp);
        let limit = (OUTLIER_FACTOR * sizes[sizes.len() / 2]).max(OUTLIER_FLOOR);
        let worst = (0..used.len())
            .max_by(|&a, &b| residuals[used[a]].rms.total_cmp(&residuals[used[b]].rms))
            .expect("three captures or more");
        if used.len() > least && residuals[used[worst]].rms > limit {
            used.remove(worst);
            continue;
        }
        return finished(mounting, &unknowns, residuals, &used);
    }
}

fn finished(
    mounting: Mounting,
    unknowns: &Unknowns,
    mut poses: Vec<PoseResidual>,
    used: &[usize],
) -> Result<Calibration, CalibrationProblem> {
    for (i, pose) in poses.iter_mut().enumerate() {
        pose.used = used.contains(&i);
    }
    let kept = || poses.iter().filter(|p| p.used);
    let rms = (kept().map(|p| p.rms * p.rms).sum::<f64>() / used.len() as f64).sqrt();
    if rms > MOST_RESIDUAL || rms.is_nan() {
        return Err(CalibrationProblem::Residual {
            expected_mm: MOST_RESIDUAL * 1e3,
            found_mm: rms * 1e3,
        });
    }
    let max = kept().fold(0.0, |m: f64, p| m.max(p.max));
    Ok(Calibration {
        mounting,
        camera: unknowns.camera_from_hub.inverse(),
        board: unknowns.carrier_from_board,
        rms,
        max,
        poses,
    })
}

fn residual(
    capture: &Capture,
    mounting: Mounting,
    in_board: &[Point],
    unknowns: &Unknowns,
) -> PoseResidual {
    let camera_from_board = unknowns.camera_from_hub
        * mounting.hub_from_carrier(&capture.base_from_flange)
        * unknowns.carrier_from_board;
    let (mut squares, mut max) = (0.0, 0.0_f64);
    for (b, c) in in_board.iter().zip(&capture.centres_in_camera) {
        let distance = (camera_from_board * b - c).norm();
        squares += distance * distance;
        max = max.max(distance);
    }
    PoseResidual {
        rms: (squares / in_board.len() as f64).sqrt(),
        max,
        used: true,
    }
}

fn estimate(
    captures: &[&Capture],
    mounting: Mounting,
    in_board: &[Point],
    touched: &[(Point, Point)],
) -> Result<Unknowns, CalibrationProblem> {
    if captures.len() < LEAST_POSES {
        return Err(CalibrationProblem::TooFewPoses {
            expected: LEAST_POSES,
            found: captures.len(),
        });
    }
    let flanges: Vec<Pose> = captures.iter().map(|c| c.base_from_flange).collect();
    let motion = motion(&flanges);
    if touched.is_empty()
        && let Some(refusal) = motion.refusal()
    {
        return Err(refusal);
    }
    let hub_from_carrier: Vec<Pose> = flanges
        .iter()
        .map(|f| mounting.hub_from_carrier(f))
        .collect();
    let camera_from_board: Vec<Pose> = captures
        .iter()
        .map(|c| best_pose(in_board, &c.centres_in_camera).0)
        .collect();
    let in_camera: Vec<&[Point]> = captures
        .iter()
        .map(|c| c.centres_in_camera.as_slice())
        .collect();
    let problem = Problem {
        hub_from_carrier: &hub_from_carrier,
        in_camera: &in_camera,
        in_board,
        touched,
    };
    let flange_in_hub: Vec<Point> = flanges
        .iter()
        .map(|f| match mounting {
            Mounting::EyeToHand => Point::from(f.translation.vector),
            Mounting::EyeInHand => Point::origin(),
        })
        .collect();
    let solved = beginnings(motion, &hub_from_carrier, &camera_from_board)
        .into_iter()
        .filter_map(|rotation| complete(rotation, &hub_from_carrier, &camera_from_board, touched))
        .map(|(camera_from_hub, carrier_from_board)| {
            let start = Unknowns {
                camera_from_hub,
                carrier_from_board,
            };
            problem.solve(start, &flange_in_hub)
        })
        .filter(|(_, cost)| cost.is_finite())
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((unknowns, _)) = solved else {
        return Err(CalibrationProblem::Residual {
            expected_mm: MOST_RESIDUAL * 1e3,
            found_mm: f64::NAN,
        });
    };
    check_information(&problem.information(&unknowns))?;
    Ok(unknowns)
}

/// First values of the rotation `camera_from_hub`.
fn beginnings(
    motion: Motion,
    hub_from_carrier: &[Pose],
    camera_from_board: &[Pose],
) -> Vec<Rotation> {
    match motion {
        Motion::Full => vec![rotation_from_motions(hub_from_carrier, camera_from_board)],
        Motion::OneAxis(_) => {
            // The axis is known in both frames; the turn about it is not.
            let seen: Vec<_> = motions(hub_from_carrier, camera_from_board).collect();
            let longest = |pick: fn(&(Vector, Vector)) -> Vector| {
                let long = seen
                    .iter()
                    .max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()))
                    .map_or_else(Vector::zeros, |pair| pair.0);
                seen.iter().fold(Vector::zeros(), |sum, pair| {
                    sum + pick(pair) * pair.0.dot(&long).signum()
                })
            };
            let in_hub = Unit::new_normalize(longest(|pair| pair.0));
            let in_camera = Unit::new_normalize(longest(|pair| pair.1));
            let align = Rotation::rotation_between_axis(&in_hub, &in_camera)
                .unwrap_or_else(|| half_turn(&in_hub));
            (0..TURNS)
                .map(|k| {
                    let turn = std::f64::consts::TAU * k as f64 / TURNS as f64;
                    Rotation::from_axis_angle(&in_camera, turn) * align
                })
                .collect()
        }
        Motion::None(_) => {
            // Without turns the board's positions move as the carrier does.
            let mean = |poses: &[Pose]| {
                let sum = poses
                    .iter()
                    .fold(Vector::zeros(), |s, p| s + p.translation.vector);
                sum / poses.len() as f64
            };
            let (hub, camera) = (mean(hub_from_carrier), mean(camera_from_board));
            vec![best_rotation(
                hub_from_carrier
                    .iter()
                    .zip(camera_from_board)
                    .map(|(m, c)| (m.translation.vector - hub, c.translation.vector - camera)),
            )]
        }
    }
}

/// A half turn that reverses an axis.
fn half_turn(axis: &Unit<Vector>) -> Rotation {
    let other = if axis.x.abs() < 0.7 {
        Vector::x()
    } else {
        Vector::y()
    };
    let square = Unit::new_normalize(axis.cross(&other));
    Rotation::from_axis_angle(&square, std::f64::consts::PI)
}
