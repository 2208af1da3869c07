//! 110: fetches one vision point with the values of the project's custom ports.
//!
//! - Wire: `110, job`.
//! - Reply: `110, 1100, last, n, pose, label, n custom values`; ask again while `last` is 0.
//! - Codes: 1002 nothing found or all fetched, 1011 job, 1016 no custom port or fetched by 102, 1019 timeout,
//!   1020 not started, 1024 rows and points differ in number.
//! - Golden file: `110_get_custom_data.txt`.

use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 110.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetCustomData {
    /// Number of the vision project.
    pub job: i32,
}

impl RequestBody for GetCustomData {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self { job: cells.int()? })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
    }
}

/// One vision point with custom values: the reply to 110, and to 100 in format 2.
#[derive(Debug, Clone, PartialEq)]
pub struct CustomPoint {
    /// No more points follow.
    pub is_last: bool,
    /// Tool pose, mm and degrees in the brand's order.
    pub values: [f64; 6],
    /// Label, 0 if none.
    pub label: i32,
    /// Values of the custom ports, in alphabetical order of their names.
    pub custom: Vec<f64>,
}

impl CustomPoint {
    pub(crate) fn encode(&self, cells: &mut CellWriter) {
        cells.int(i32::from(self.is_last));
        cells.int(i32::try_from(self.custom.len()).unwrap_or(i32::MAX));
        cells.reals(&self.values);
        cells.int(self.label);
        cells.reals(&self.custom);
    }

    pub(crate) fn decode(cells: &mut CellReader<'_>) -> Result<Self, FieldError> {
        let is_last = cells.int()? != 0;
        let count = cells.int()?.clamp(0, 1000);
        let values = cells.reals()?;
        let label = cells.int()?;
        let custom = (0..count).map(|_| cells.real()).collect::<Result<_, _>>()?;
        Ok(Self {
            is_last,
            values,
            label,
            custom,
        })
    }
}
