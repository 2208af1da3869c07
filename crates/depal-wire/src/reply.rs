//! What the vision side answers.

use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::c110_get_custom_data::CustomPoint;
use crate::command::c206_get_do_list::DoList;
use crate::command::c210_get_plan_data::{PlanForm, PlanPoint};
use crate::command::c701_calibrate::CalibrationPoint;
use crate::command::c901_get_state::StateFields;
use crate::command::point_list::PointList;
use crate::{Encoding, Profile, ReplyError, Request, Status};

/// One reply: the command it answers, a status code, and data where the command has some.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Reply {
    /// Command and status alone: every failure, and success of the commands without data.
    Status {
        /// The command answered.
        command: i32,
        /// The verdict.
        status: Status,
    },
    /// 102, 105, 205 and what 100 and 200 answer in their form: a part of a list of points.
    Points {
        /// The command answered.
        command: i32,
        /// The success code.
        status: Status,
        /// The part.
        list: PointList,
    },
    /// 110, and 100 in format 2: one point with custom values.
    CustomPoint {
        /// The command answered.
        command: i32,
        /// The point.
        point: Box<CustomPoint>,
    },
    /// 106: the DO list of the gripper for a vision project's path.
    VisionDoList(Box<DoList>),
    /// 111: one waypoint of a vision project's path.
    VisionPlanPoint(Box<PlanPoint>),
    /// 206: the DO list of the gripper.
    DoList(Box<DoList>),
    /// 207: a step parameter.
    Parameter(f64),
    /// 210: one waypoint.
    PlanPoint(Box<PlanPoint>),
    /// 601: a message, 0 for none. It carries no status code.
    Message(i32),
    /// 701: the next point.
    CalibrationPoint(Box<CalibrationPoint>),
    /// 901 from version 2.2.
    State(StateFields),
}

impl Reply {
    /// A reply without data.
    pub fn status(command: i32, status: Status) -> Self {
        Self::Status { command, status }
    }

    /// The command answered.
    pub fn command(&self) -> i32 {
        match self {
            Self::Status { command, .. }
            | Self::Points { command, .. }
            | Self::CustomPoint { command, .. } => *command,
            Self::VisionDoList(_) => 106,
            Self::VisionPlanPoint(_) => 111,
            Self::DoList(_) => 206,
            Self::Parameter(_) => 207,
            Self::PlanPoint(_) => 210,
            Self::Message(_) => 601,
            Self::CalibrationPoint(_) => 701,
            Self::State(_) => 901,
        }
    }

    /// The status code; a message has none.
    pub fn verdict(&self) -> Option<Status> {
        Some(match self {
            Self::Status { status, .. } | Self::Points { status, .. } => *status,
            Self::CustomPoint { .. } => Status::VisionResult,
            Self::VisionDoList(_) => Status::VisionDoListSent,
            Self::VisionPlanPoint(_) => Status::VisionPathSent,
            Self::DoList(_) => Status::VizDoListSent,
            Self::Parameter(_) => Status::StepParameterRead,
            Self::PlanPoint(_) => Status::VizFinished,
            Self::Message(_) => return None,
            Self::CalibrationPoint(_) => Status::CalibrationPointSent,
            Self::State(_) => Status::StateSent,
        })
    }

    fn write(&self, profile: &Profile, cells: &mut CellWriter) {
        cells.int(self.command());
        if let Some(status) = self.verdict() {
            cells.int(status.code());
        }
        match self {
            Self::Status { .. } => {}
            Self::Points { list, .. } => list.encode(cells),
            Self::CustomPoint { point, .. } => point.encode(cells),
            Self::DoList(list) | Self::VisionDoList(list) => list.encode(cells),
            Self::Parameter(value) => cells.real(*value),
            Self::PlanPoint(point) => point.encode(viz_form(profile, true), cells),
            Self::VisionPlanPoint(point) => point.encode(vision_form(profile), cells),
            Self::Message(message) => cells.int(*message),
            Self::CalibrationPoint(point) => point.encode(cells),
            Self::State(fields) => fields.encode(cells),
        }
    }

    /// The bytes that the server sends, in one write.
    pub fn encode(&self, encoding: Encoding, profile: &Profile) -> Vec<u8> {
        let mut cells = CellWriter::default();
        self.write(profile, &mut cells);
        cells.reply_bytes(encoding, profile)
    }

    /// The reply as comma-separated text in the form of version 1.8, for logs.
    pub fn text(&self) -> String {
        let mut cells = CellWriter::default();
        self.write(&Profile::v1_8(), &mut cells);
        cells.text()
    }

    /// The beginning of [`text`](Self::text): whole fields, until there are at least `most` bytes.
    pub fn text_head(&self, most: usize) -> String {
        let mut cells = CellWriter::default();
        self.write(&Profile::v1_8(), &mut cells);
        cells.text_head(most)
    }

    /// Reads the reply of a server of version 1.8 to `request`, as a robot does.
    /// The request is needed because the form of some replies depends on what was asked for.
    pub fn decode(encoding: Encoding, request: &Request, frame: &[u8]) -> Result<Self, ReplyError> {
        Self::decode_as(encoding, &Profile::v1_8(), request, frame)
    }

    /// As [`decode`](Self::decode), of a server of any profile.
    /// Plan values with [`crate::HexPlanCells::IntegerCounts`] are not read back.
    pub fn decode_as(
        encoding: Encoding,
        profile: &Profile,
        request: &Request,
        frame: &[u8],
    ) -> Result<Self, ReplyError> {
        let expected = request.code();
        let malformed = |error: FieldError| ReplyError::Malformed {
            command: expected,
            reason: error.to_string(),
        };
        let mut cells = CellReader::new(encoding, frame);
        let found = cells.int().map_err(malformed)?;
        if found != expected {
            return Err(ReplyError::OtherCommand { expected, found });
        }
        let code = cells.int().map_err(malformed)?;
        if matches!(request, Request::GetNotify(_)) {
            cells.end().map_err(malformed)?;
            return Ok(Self::Message(code));
        }
        let status = Status::from_code(code).ok_or(ReplyError::UnknownStatus {
            command: expected,
            code,
        })?;
        let reply = Self::decode_data(profile, request, status, &mut cells).map_err(malformed)?;
        cells.end().map_err(malformed)?;
        Ok(reply)
    }

    fn decode_data(
        profile: &Profile,
        request: &Request,
        status: Status,
        cells: &mut CellReader<'_>,
    ) -> Result<Self, FieldError> {
        let command = request.code();
        let one_shot = match request {
            Request::RunVision(run) => run.format,
            _ => 0,
        };
        Ok(match (request, status) {
            (Request::GetCustomData(_), Status::VisionResult) => Self::CustomPoint {
                command,
                point: Box::new(CustomPoint::decode(cells)?),
            },
            (Request::RunVision(_), Status::VisionResult) if one_shot == 2 => Self::CustomPoint {
                command,
                point: Box::new(CustomPoint::decode(cells)?),
            },
            (Request::GetVisionPoints(_) | Request::RunVision(_), Status::VisionResult)
            | (Request::GetVisionPath(_) | Request::RunVision(_), Status::VisionPathSent)
            | (Request::GetVizPath(_) | Request::RunViz(_), Status::VizFinished) => Self::Points {
                command,
                status,
                list: PointList::decode(cells)?,
            },
            (Request::GetVisionDoList(_), Status::VisionDoListSent) => {
                Self::VisionDoList(Box::new(DoList::decode(cells)?))
            }
            (Request::GetVisionPlanData(_), Status::VisionPathSent) => {
                let point = PlanPoint::decode(vision_form(profile), cells)?;
                Self::VisionPlanPoint(Box::new(point))
            }
            (Request::GetDoList(_), Status::VizDoListSent) => {
                Self::DoList(Box::new(DoList::decode(cells)?))
            }
            (Request::ReadParameter(_), Status::StepParameterRead) => {
                Self::Parameter(cells.real()?)
            }
            (Request::GetPlanData(get), Status::VizFinished) => {
                let form = viz_form(profile, matches!(get.format, 3 | 4));
                Self::PlanPoint(Box::new(PlanPoint::decode(form, cells)?))
            }
            (Request::Calibrate(_), Status::CalibrationPointSent) => {
                Self::CalibrationPoint(Box::new(CalibrationPoint::decode(cells)?))
            }
            (Request::GetState(_), Status::StateSent) => Self::State(StateFields::decode(cells)?),
            _ => Self::status(command, status),
        })
    }
}

/// Cells of a waypoint in 210. What a waypoint carries is written; what to read follows from the format.
fn viz_form(profile: &Profile, has_plan: bool) -> PlanForm {
    PlanForm {
        has_velocity: true,
        has_plan,
        pads_others: profile.pads_plan_points,
    }
}

/// Cells of a waypoint in 111.
fn vision_form(profile: &Profile) -> PlanForm {
    PlanForm {
        has_velocity: profile.has_vision_plan_velocity,
        has_plan: true,
        pads_others: false,
    }
}
