//! A planned path as the registers hold it.

use depal_frames::JointPositions;
use depal_wire::s7::{DataBlock, Field};

use crate::{Fetch, PlcSettings};

/// One waypoint.
#[derive(Debug, Clone)]
pub(crate) struct Waypoint {
    pub(crate) joints: JointPositions,
    pub(crate) is_linear: bool,
    pub(crate) percent: f64,
}

/// A path to the pick and on to the place, which is its last waypoint.
#[derive(Debug, Clone, Default)]
pub(crate) struct Path {
    pub(crate) points: Vec<Waypoint>,
    /// Place of the Vision Move, from 0.
    pub(crate) pick: usize,
}

impl Path {
    /// Copies the path out of the block; or says why it cannot be driven.
    pub(crate) fn of_block(block: &DataBlock, settings: &PlcSettings) -> Result<Self, String> {
        let count = usize::try_from(block.int(Field::PoseCount, 0)).unwrap_or(0);
        let index = usize::try_from(block.int(Field::VisionMoveIndex, 0)).unwrap_or(0);
        if index < 2 || index >= count || count > Field::TargetPose.spec().shape[0] {
            return Err(format!(
                "unusable path: {count} waypoints, Vision Move at {index}"
            ));
        }
        let pick = index - 1;
        let point = |row: usize| {
            let joints: Vec<f64> = (0..6)
                .map(|joint| f64::from(block.real(Field::TargetPose, 6 * row + joint)))
                .collect();
            let joints = JointPositions::from_degrees(&joints);
            match settings.fetch {
                Fetch::PlanData => Waypoint {
                    joints,
                    is_linear: block.int(Field::MoveType, row) == 2,
                    percent: f64::from(block.int(Field::Speed, row)).clamp(1.0, 100.0),
                },
                Fetch::Path => Waypoint {
                    joints,
                    is_linear: row == pick || row == pick + 1 || row + 1 == count,
                    percent: settings.path_percent,
                },
            }
        };
        Ok(Self {
            points: (0..count).map(point).collect(),
            pick,
        })
    }

    /// Whether the arm has to stand at a waypoint.
    pub(crate) fn is_stop(&self, place: usize) -> bool {
        place == self.pick || place + 1 == self.points.len()
    }

    /// Whether a waypoint is next to one where the arm stands.
    pub(crate) fn is_near_stop(&self, place: usize) -> bool {
        self.is_stop(place + 1) || (place > 0 && self.is_stop(place - 1))
    }
}
