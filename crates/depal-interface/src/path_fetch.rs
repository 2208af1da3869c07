//! A planned path on its way to the robot: parts of 105 and 205, single waypoints of 111 and 210, DO lists.

use depal_frames::EulerConvention;
use depal_wire::{
    DO_LIST_LEN, DoList, PLAN_VALUES, PlanPoint, PointCell8, PointList, PointRecord, Status,
    VisionMoveCells,
};

use crate::job::{CustomPort, Motion, PathPoint, PlannedPath, VisionMoveData};
use crate::settings::PortSettings;
use crate::wire_values::{joint_values, pose_values};

/// A path and how much of it is sent.
#[derive(Debug, Clone)]
pub(crate) struct PathFetch {
    points: Vec<PathPoint>,
    /// Custom values by Vision Move waypoint.
    custom: Vec<Vec<f64>>,
    rounds: Vec<Vec<u16>>,
    sections: usize,
    /// Waypoints already sent.
    sent: usize,
    /// The command that fetches them: two commands are not to be mixed on one path.
    pub(crate) fetched_by: Option<i32>,
}

impl PathFetch {
    /// Nothing sent yet. Custom rows that do not fit the Vision Move waypoints are refused with 1024.
    pub(crate) fn new(path: PlannedPath) -> Result<Self, Status> {
        let vision_moves = path.points.iter().filter(|p| p.vision_move.is_some());
        let custom = joined_rows(path.custom_ports, vision_moves.count())?;
        Ok(Self {
            points: path.points,
            custom,
            rounds: path.rounds,
            sections: path.sections,
            sent: 0,
            fetched_by: None,
        })
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    pub(crate) fn is_untouched(&self) -> bool {
        self.sent == 0
    }

    pub(crate) fn is_drained(&self) -> bool {
        self.sent == self.points.len()
    }

    /// The next part, at most `limit` waypoints.
    pub(crate) fn next_part(
        &mut self,
        limit: usize,
        wants_joints: bool,
        port: &PortSettings,
    ) -> PointList {
        let rest = &self.points[self.sent..];
        let part = &rest[..rest.len().min(limit)];
        self.sent += part.len();
        PointList {
            is_last: part.len() == rest.len(),
            vision_move: rest
                .iter()
                .position(|p| p.vision_move.is_some())
                .map_or(0, |place| place as i32 + 1),
            points: part
                .iter()
                .map(|point| PointRecord {
                    values: waypoint_values(point, wants_joints, port.euler),
                    label: point.label,
                    cell8: match port.profile.point_cell8 {
                        PointCell8::Velocity => whole_percent(point.velocity_percent),
                        PointCell8::ToolId => point.tool,
                    },
                })
                .collect(),
        }
    }

    /// The next waypoint with its motion and plan data; one must be left.
    pub(crate) fn next_plan_point(
        &mut self,
        wants_joints: bool,
        wants_plan: bool,
        euler: EulerConvention,
    ) -> PlanPoint {
        let point = &self.points[self.sent];
        let picked_before = self.points[..self.sent]
            .iter()
            .filter(|p| p.vision_move.is_some())
            .count();
        self.sent += 1;
        PlanPoint {
            is_last: self.sent == self.points.len(),
            values: waypoint_values(point, wants_joints, euler),
            move_type: match point.motion {
                Motion::Joint => 1,
                Motion::Linear => 2,
            },
            tool: point.tool,
            velocity_percent: whole_percent(point.velocity_percent),
            vision_move: point.vision_move.as_ref().map(|data| VisionMoveCells {
                plan: wants_plan.then(|| plan_values(data)),
                custom: self.custom.get(picked_before).cloned().unwrap_or_default(),
            }),
        }
    }

    /// The list of outputs to switch on, if there is any; it may be fetched any number of times.
    ///
    /// One round fills the list from its start. Several rounds get `sections` places each, filled up with -1;
    /// what does not fit a round or the list is left out.
    pub(crate) fn do_list(&self, sections: Option<i32>) -> Option<DoList> {
        if self.rounds.iter().all(Vec::is_empty) {
            return None;
        }
        let mut list = [-1; DO_LIST_LEN];
        let longest = self.rounds.iter().map(Vec::len).max().unwrap_or(1).max(1);
        let asked = sections.and_then(|n| usize::try_from(n).ok());
        let width = match (self.rounds.len(), asked, self.sections) {
            (1, ..) => DO_LIST_LEN,
            (_, Some(asked), _) => asked,
            (_, None, 0) => longest,
            (_, None, own) => own,
        };
        for (places, round) in list.chunks_mut(width.max(1)).zip(&self.rounds) {
            for (place, number) in places.iter_mut().zip(round) {
                *place = i32::from(*number);
            }
        }
        Some(DoList(list))
    }
}

/// The rows of all ports, ports in alphabetical order, joined for each of `count` points;
/// 1024 if a port has another number of rows. Without ports: nothing.
pub(crate) fn joined_rows(
    mut ports: Vec<CustomPort>,
    count: usize,
) -> Result<Vec<Vec<f64>>, Status> {
    if ports.iter().any(|port| port.rows.len() != count) {
        return Err(Status::PosesNotCustomData);
    }
    ports.sort_by(|a, b| a.name.cmp(&b.name));
    Ok((0..count)
        .map(|place| {
            let rows = ports.iter().flat_map(|port| port.rows[place].iter());
            rows.copied().collect()
        })
        .collect())
}

fn waypoint_values(point: &PathPoint, wants_joints: bool, euler: EulerConvention) -> [f64; 6] {
    if wants_joints {
        joint_values(&point.joints)
    } else {
        pose_values(euler, &point.base_from_tcp)
    }
}

/// Velocities are whole percentages; a moving robot never gets 0.
fn whole_percent(percent: f64) -> i32 {
    percent.round().clamp(1.0, 100.0) as i32
}

/// The 21 plan values in their order on the wire; millimetres.
fn plan_values(data: &VisionMoveData) -> [f64; PLAN_VALUES] {
    let mut values = [0.0; PLAN_VALUES];
    for (value, label) in values.iter_mut().zip(data.labels) {
        *value = f64::from(label);
    }
    let offset_mm = data.group_from_tcp_offset * 1e3;
    let size_mm = data.group_size.to_mm();
    values[10..].copy_from_slice(&[
        f64::from(data.picked_total),
        f64::from(data.picked_now),
        f64::from(data.edge_or_corner),
        offset_mm.x,
        offset_mm.y,
        offset_mm.z,
        f64::from(u8::from(data.is_group_square)),
        f64::from(u8::from(data.is_box_square)),
        size_mm[0],
        size_mm[1],
        size_mm[2],
    ]);
    values
}
