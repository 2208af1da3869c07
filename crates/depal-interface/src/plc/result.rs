//! From an answer to what is written into the block.

use depal_wire::s7::{DataBlock, Field, POINT_ROWS};
use depal_wire::{CustomPoint, DoList, PLAN_VALUES, PlanPoint, PointList, Status};

/// Custom values that a row of the block holds; further ones are left out.
const CUSTOM_COLUMNS: usize = 10;

/// Everything that answers one command.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    /// What Status becomes; absent for a message.
    pub(super) status: Option<Status>,
    pub(super) data: Data,
}

/// What fills other registers than Status.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Data {
    None,
    /// Vision points, or waypoints with tools.
    Points {
        list: PointList,
        has_tools: bool,
    },
    Custom(Vec<CustomPoint>),
    Plan {
        points: Vec<PlanPoint>,
        /// The plan values were asked for.
        has_plan: bool,
    },
    DoList(Box<DoList>),
    Message(i32),
}

impl Outcome {
    pub(super) fn of_status(status: Status) -> Self {
        Self {
            status: Some(status),
            data: Data::None,
        }
    }

    /// Whether Status of Pose Sent rises.
    pub(super) fn is_new_data(&self) -> bool {
        matches!(
            self.data,
            Data::Points { .. } | Data::Custom(_) | Data::Plan { .. }
        )
    }
}

/// What we have written, so that rows of an earlier and longer answer are cleared.
#[derive(Debug, Clone)]
pub(super) struct Image {
    block: DataBlock,
    /// Rows that may hold something, by register.
    rows: Vec<(Field, usize)>,
}

impl Image {
    /// Of a block of unknown content.
    pub(super) fn new() -> Self {
        Self {
            block: DataBlock::new(),
            rows: Vec::new(),
        }
    }

    /// The writes that come before Status, in order; or the status of data that do not fit the registers.
    pub(super) fn payload(&mut self, data: &Data) -> Result<Vec<(usize, Vec<u8>)>, Status> {
        let mut writes = Vec::new();
        match data {
            Data::None => {}
            Data::Points { list, has_tools } => {
                let points = &list.points;
                let labels = labels(points.iter().map(|point| point.label))?;
                let count = points.len().min(POINT_ROWS);
                writes.push(self.rows(Field::TargetPose, count, |row| reals(&points[row].values)));
                writes.push(self.rows(Field::TargetLabel, count, |row| int(labels[row])));
                if *has_tools {
                    let tool = |row: usize| int(saturated(points[row].cell8));
                    writes.push(self.rows(Field::TargetTool, count, tool));
                }
                writes.push(counts(count, list.vision_move));
            }
            Data::Custom(points) => {
                let labels = labels(points.iter().map(|point| point.label))?;
                let count = points.len().min(POINT_ROWS);
                writes.push(self.rows(Field::TargetPose, count, |row| reals(&points[row].values)));
                writes.push(self.rows(Field::TargetLabel, count, |row| int(labels[row])));
                let custom = |row: usize| custom(&points[row].custom);
                writes.push(self.rows(Field::CustomOutput, count, custom));
                writes.push(counts(count, 0));
            }
            Data::Plan { points, has_plan } => {
                let plan = |row: usize| {
                    let vision_move = points[row].vision_move.as_ref();
                    vision_move.and_then(|cells| cells.plan)
                };
                // Single waypoints carry no label of their own: it is the first of the picked ones.
                let label = |row: usize| plan(row).map_or(0, |plan| plan[0] as i32);
                let labels = labels((0..points.len()).map(label))?;
                let count = points.len().min(POINT_ROWS);
                let mut put = |field, row: &dyn Fn(usize) -> Vec<u8>| {
                    writes.push(self.rows(field, count, row));
                };
                put(Field::TargetPose, &|row| reals(&points[row].values));
                put(Field::TargetLabel, &|row| int(labels[row]));
                put(Field::TargetTool, &|row| int(saturated(points[row].tool)));
                put(Field::CustomOutput, &|row| {
                    let vision_move = points[row].vision_move.as_ref();
                    custom(vision_move.map_or(&[], |cells| cells.custom.as_slice()))
                });
                put(Field::IsVisionMove, &|row| {
                    int(i16::from(points[row].vision_move.is_some()))
                });
                put(Field::MoveType, &|row| {
                    int(saturated(points[row].move_type))
                });
                put(Field::Speed, &|row| {
                    int(saturated(points[row].velocity_percent))
                });
                put(Field::PlanResult, &|row| {
                    let values = if *has_plan { plan(row) } else { None };
                    reals(&values.unwrap_or([0.0; PLAN_VALUES]))
                });
                let vision_move = points.iter().position(|point| point.vision_move.is_some());
                writes.push(counts(count, vision_move.map_or(0, |row| row as i32 + 1)));
            }
            Data::DoList(list) => {
                let numbers = list.0.iter().flat_map(|number| int(saturated(*number)));
                writes.push((Field::DigitalOutput.offset(), numbers.collect()));
            }
            Data::Message(message) => {
                writes.push((Field::Notify.offset(), int(saturated(*message))));
            }
        }
        Ok(writes)
    }

    /// One write for all rows of a register that change: `count` new ones, then zeros over older ones.
    fn rows(
        &mut self,
        field: Field,
        count: usize,
        row: impl Fn(usize) -> Vec<u8>,
    ) -> (usize, Vec<u8>) {
        let spec = field.spec();
        let before = self.rows.iter().find(|(known, _)| *known == field);
        let before = before.map_or(spec.shape[0], |(_, rows)| *rows);
        let len = spec.row_bytes();
        for place in 0..count.max(before) {
            let mut bytes = if place < count {
                row(place)
            } else {
                Vec::new()
            };
            bytes.resize(len, 0);
            self.block.write(spec.offset + place * len, &bytes);
        }
        self.rows.retain(|(known, _)| *known != field);
        self.rows.push((field, count));
        let bytes = self.block.bytes(spec.offset, count.max(before) * len);
        (spec.offset, bytes.unwrap_or_default().to_vec())
    }
}

/// Labels have to fit an INT.
fn labels(labels: impl Iterator<Item = i32>) -> Result<Vec<i16>, Status> {
    let fit = |label| i16::try_from(label).map_err(|_| Status::LabelNotInteger);
    labels.map(fit).collect()
}

/// Number of Pose Sent and Index of Vision Picking Point, which lie side by side.
fn counts(count: usize, vision_move: i32) -> (usize, Vec<u8>) {
    let mut bytes = int(count as i16);
    bytes.extend(int(saturated(vision_move)));
    (Field::PoseCount.offset(), bytes)
}

fn custom(values: &[f64]) -> Vec<u8> {
    reals(&values[..values.len().min(CUSTOM_COLUMNS)])
}

fn reals(values: &[f64]) -> Vec<u8> {
    let bytes = values.iter().map(|value| (*value as f32).to_be_bytes());
    bytes.flatten().collect()
}

fn int(value: i16) -> Vec<u8> {
    value.to_be_bytes().to_vec()
}

fn saturated(value: i32) -> i16 {
    value.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16
}
