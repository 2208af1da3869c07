//! 210: fetches one waypoint of the Viz project with its motion and plan data.
//!
//! - Wire: `210, format`; 1 joints, 2 tool pose, 3 joints with plan data, 4 tool pose with plan data.
//! - Reply: `210, 2100, last, is_vision_move, 6 values, move, tool, velocity`, and for a Vision Move waypoint
//!   then `[21 plan values if format 3 or 4], n, n custom values`. Ask again while `last` is 0.
//!   move: 1 joint, 2 linear. tool: -1 none.
//! - HEX: plan and custom values are single precision, the rest after the six values are integers.
//! - Codes: 2012 format, 2022 not started or all fetched, 2025 timeout, 2042, and others of the run.
//! - Golden file: `210_get_plan_data.txt`.

use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Numbers in the plan data of a Vision Move.
pub const PLAN_VALUES: usize = 21;

/// Places of the plan values that are whole numbers: ten labels, picked in total and now, edge or corner,
/// and the two orientations. The others are millimetres.
const COUNTED_PLAN_VALUES: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 16, 17];

/// Command 210.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetPlanData {
    /// 1 to 4; others are answered with 2012.
    pub format: i32,
}

impl RequestBody for GetPlanData {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            format: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.format);
    }
}

/// One waypoint in the reply to 210 or 111.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanPoint {
    /// No more waypoints follow.
    pub is_last: bool,
    /// Joints in degrees, or tool pose in mm and degrees, as asked for.
    pub values: [f64; 6],
    /// 1 joint motion, 2 linear motion.
    pub move_type: i32,
    /// Tool id, -1 for none.
    pub tool: i32,
    /// Velocity, percent; 0 where the profile leaves the cell out.
    pub velocity_percent: i32,
    /// Present for a Vision Move waypoint.
    pub vision_move: Option<VisionMoveCells>,
}

/// What only a Vision Move waypoint carries.
#[derive(Debug, Clone, PartialEq)]
pub struct VisionMoveCells {
    /// The plan values, present in formats 3 and 4.
    pub plan: Option<[f64; PLAN_VALUES]>,
    /// Values of the custom ports, in alphabetical order of their names.
    pub custom: Vec<f64>,
}

/// Which cells a waypoint has, by command, format and profile.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlanForm {
    /// The velocity cell.
    pub(crate) has_velocity: bool,
    /// The 21 plan values of a Vision Move.
    pub(crate) has_plan: bool,
    /// A custom count of 0 for waypoints that are no Vision Move.
    pub(crate) pads_others: bool,
}

impl PlanPoint {
    pub(crate) fn encode(&self, form: PlanForm, cells: &mut CellWriter) {
        cells.int(i32::from(self.is_last));
        cells.int(i32::from(self.vision_move.is_some()));
        cells.reals(&self.values);
        cells.int(self.move_type);
        cells.int(self.tool);
        if form.has_velocity {
            cells.int(self.velocity_percent);
        }
        if self.vision_move.is_none() && form.pads_others {
            cells.int(0);
        }
        if let Some(vision_move) = &self.vision_move {
            if let Some(plan) = &vision_move.plan {
                for (index, value) in plan.iter().enumerate() {
                    if COUNTED_PLAN_VALUES.contains(&index) {
                        cells.count(*value);
                    } else {
                        cells.real(*value);
                    }
                }
            }
            cells.int(i32::try_from(vision_move.custom.len()).unwrap_or(i32::MAX));
            cells.reals(&vision_move.custom);
        }
    }

    pub(crate) fn decode(form: PlanForm, cells: &mut CellReader<'_>) -> Result<Self, FieldError> {
        let is_last = cells.int()? != 0;
        let is_vision_move = cells.int()? == 1;
        let values = cells.reals()?;
        let move_type = cells.int()?;
        let tool = cells.int()?;
        let velocity_percent = if form.has_velocity { cells.int()? } else { 0 };
        let vision_move = if is_vision_move {
            let plan = if form.has_plan {
                Some(cells.reals()?)
            } else {
                None
            };
            let count = cells.int()?.clamp(0, 1000);
            let custom = (0..count).map(|_| cells.real()).collect::<Result<_, _>>()?;
            Some(VisionMoveCells { plan, custom })
        } else {
            if form.pads_others {
                cells.int()?;
            }
            None
        };
        Ok(Self {
            is_last,
            values,
            move_type,
            tool,
            velocity_percent,
            vision_move,
        })
    }
}
