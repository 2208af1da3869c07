//! What the motions leave open, and its name.

use depal_frames::{Pose, Vector};
use nalgebra::{Matrix3, SymmetricEigen};

use super::joint::Normal;
use super::problem::CalibrationProblem;

/// Root mean square turn between poses below which nothing was turned.
const LEAST_TURN_DEG: f64 = 5.0;
/// The same about the second-best axis: less, and position along the first axis is a guess.
/// With 3 degrees an error of 0.1 mm in the measured motions becomes 2 mm along the axis.
const LEAST_SECOND_TURN_DEG: f64 = 3.0;
/// A step of 1 in the open direction must move the discs by at least this (root mean square).
/// The sine of the least second turn would be 0.05; half of it tells real holes from thin data.
const LEAST_EFFECT: f64 = 0.02;

/// What kind of motion the captures show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Two rotation axes or more.
    Full,
    /// One direction of rotation axes (unit vector in the base).
    OneAxis(CommonAxis),
    /// No rotation.
    None(f64),
}

/// The common axis and the turn about others, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonAxis {
    pub axis_in_base: Vector,
    pub other_deg: f64,
}

/// Looks at the rotation vectors between all pairs of flange poses.
pub fn motion(base_from_flange: &[Pose]) -> Motion {
    let mut scatter = Matrix3::zeros();
    let mut count = 0.0;
    for (i, a) in base_from_flange.iter().enumerate() {
        for b in &base_from_flange[i + 1..] {
            let turn = (b.rotation * a.rotation.inverse()).scaled_axis();
            scatter += turn * turn.transpose();
            count += 1.0;
        }
    }
    let eigen = SymmetricEigen::new(scatter / f64::max(count, 1.0));
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let degrees = |k: usize| eigen.eigenvalues[order[k]].max(0.0).sqrt().to_degrees();
    if degrees(0) < LEAST_TURN_DEG {
        return Motion::None(degrees(0));
    }
    if degrees(1) < LEAST_SECOND_TURN_DEG {
        let axis = eigen.eigenvectors.column(order[0]).into_owned();
        // Of the two directions the one whose largest part is positive.
        let sign = axis[axis.iamax()].signum();
        return Motion::OneAxis(CommonAxis {
            axis_in_base: axis * sign,
            other_deg: degrees(1),
        });
    }
    Motion::Full
}

impl Motion {
    /// The refusal when no touched point helps out.
    pub fn refusal(&self) -> Option<CalibrationProblem> {
        match self {
            Self::Full => None,
            Self::OneAxis(found) => Some(CalibrationProblem::ParallelAxes {
                axis_in_base: found.axis_in_base,
                expected_deg: LEAST_SECOND_TURN_DEG,
                found_deg: found.other_deg,
            }),
            Self::None(found_deg) => Some(CalibrationProblem::NoRotation {
                expected_deg: LEAST_TURN_DEG,
                found_deg: *found_deg,
            }),
        }
    }
}

/// Refuses what the normal matrix (per disc centre, in metres at the lever) shows as open.
pub fn check_information(information: &Normal) -> Result<(), CalibrationProblem> {
    let eigen = SymmetricEigen::new(*information);
    let weakest = eigen.eigenvalues.imin();
    let effect = eigen.eigenvalues[weakest].max(0.0).sqrt();
    if effect >= LEAST_EFFECT {
        return Ok(());
    }
    let direction = eigen.eigenvectors.column(weakest);
    let shares = [0, 3, 6, 9].map(|at| direction.rows(at, 3).norm());
    let names = [
        "turn of the camera",
        "translation of the camera",
        "turn of the board in its holder",
        "translation of the board in its holder",
    ];
    let strongest = (0..4)
        .max_by(|a, b| shares[*a].total_cmp(&shares[*b]))
        .expect("four shares");
    Err(CalibrationProblem::Unobservable {
        what: names[strongest],
        unit: "1 mm at the discs' distance",
        found: effect,
    })
}
