//! Where the robot is, as the commands that start a project say it.

use crate::cells::{CellReader, FieldError};

/// "No pose" comes as six zeros, as twelve, or not at all; the values are not used.
pub(super) fn skip_zero_pose(cells: &mut CellReader<'_>) -> Result<(), FieldError> {
    match cells.remaining() {
        None | Some(0) => Ok(()),
        Some(12) => cells.reals::<12>().map(|_| ()),
        Some(_) => cells.reals::<6>().map(|_| ()),
    }
}

/// Joints, degrees, and the flange pose; absent when not sent or all zeros.
pub(super) fn joints_and_flange(
    cells: &mut CellReader<'_>,
) -> Result<([f64; 6], Option<[f64; 6]>), FieldError> {
    let joints_deg = cells.reals()?;
    if cells.remaining() == Some(0) {
        return Ok((joints_deg, None));
    }
    let flange: [f64; 6] = cells.reals()?;
    let is_sent = flange.iter().any(|v| *v != 0.0);
    Ok((joints_deg, is_sent.then_some(flange)))
}

/// What follows a type of pose that is not known.
pub(super) fn skip_rest(cells: &mut CellReader<'_>) -> Result<(), FieldError> {
    while cells.remaining().is_some_and(|left| left > 0) {
        cells.real()?;
    }
    Ok(())
}
