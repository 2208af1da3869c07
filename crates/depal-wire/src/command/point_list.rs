//! The list of points that 102 and 205 answer with.

use crate::cells::{CellReader, CellWriter, FieldError};

/// One part of a list of points.
#[derive(Debug, Clone, PartialEq)]
pub struct PointList {
    /// No more parts follow.
    pub is_last: bool,
    /// Place of the first Vision Move waypoint, from 1 within this part and beyond; 0 if none follows.
    /// Always 0 for vision points.
    pub vision_move: i32,
    /// The points of this part.
    pub points: Vec<PointRecord>,
}

/// One point or waypoint: eight cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PointRecord {
    /// Joints in degrees, or a tool pose in mm and degrees in the brand's order.
    pub values: [f64; 6],
    /// Label, 0 if none.
    pub label: i32,
    /// Velocity in percent or tool id, as the profile says.
    pub cell8: i32,
}

impl PointList {
    pub(crate) fn encode(&self, cells: &mut CellWriter) {
        cells.int(i32::from(self.is_last));
        cells.int(i32::try_from(self.points.len()).unwrap_or(i32::MAX));
        cells.int(self.vision_move);
        for point in &self.points {
            cells.reals(&point.values);
            cells.int(point.label);
            cells.int(point.cell8);
        }
    }

    pub(crate) fn decode(cells: &mut CellReader<'_>) -> Result<Self, FieldError> {
        let is_last = cells.int()? != 0;
        let count = cells.int()?.clamp(0, 1000);
        let vision_move = cells.int()?;
        let mut points = Vec::new();
        for _ in 0..count {
            points.push(PointRecord {
                values: cells.reals()?,
                label: cells.int()?,
                cell8: cells.int()?,
            });
        }
        Ok(Self {
            is_last,
            vision_move,
            points,
        })
    }
}
