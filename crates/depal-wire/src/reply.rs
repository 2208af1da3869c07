//! What the vision side answers.

use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::c206_get_do_list::DoList;
use crate::command::c210_get_plan_data::PlanPoint;
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
    /// 102 and 205: a part of a list of points.
    Points {
        /// The command answered.
        command: i32,
        /// The success code.
        status: Status,
        /// The part.
        list: PointList,
    },
    /// 206: the DO list of the gripper.
    DoList(Box<DoList>),
    /// 210: one waypoint.
    PlanPoint(Box<PlanPoint>),
}

impl Reply {
    /// A reply without data.
    pub fn status(command: i32, status: Status) -> Self {
        Self::Status { command, status }
    }

    /// The command answered.
    pub fn command(&self) -> i32 {
        match self {
            Self::Status { command, .. } | Self::Points { command, .. } => *command,
            Self::DoList(_) => 206,
            Self::PlanPoint(_) => 210,
        }
    }

    /// The status code.
    pub fn verdict(&self) -> Status {
        match self {
            Self::Status { status, .. } | Self::Points { status, .. } => *status,
            Self::DoList(_) => Status::VizDoListSent,
            Self::PlanPoint(_) => Status::VizFinished,
        }
    }

    fn write(&self, cells: &mut CellWriter) {
        cells.int(self.command());
        cells.int(self.verdict().code());
        match self {
            Self::Status { .. } => {}
            Self::Points { list, .. } => list.encode(cells),
            Self::DoList(list) => list.encode(cells),
            Self::PlanPoint(point) => point.encode(cells),
        }
    }

    /// The bytes that the server sends, in one write.
    pub fn encode(&self, encoding: Encoding, profile: &Profile) -> Vec<u8> {
        let mut cells = CellWriter::default();
        self.write(&mut cells);
        cells.reply_bytes(encoding, profile)
    }

    /// The reply as comma-separated text, for logs.
    pub fn text(&self) -> String {
        let mut cells = CellWriter::default();
        self.write(&mut cells);
        cells.text()
    }

    /// Reads the reply to `request`, as a robot does.
    /// The request is needed because the form of some replies depends on what was asked for.
    pub fn decode(encoding: Encoding, request: &Request, frame: &[u8]) -> Result<Self, ReplyError> {
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
        let status = Status::from_code(code).ok_or(ReplyError::UnknownStatus {
            command: expected,
            code,
        })?;
        let reply = match (request, status) {
            (Request::GetVisionPoints(_), Status::VisionResult)
            | (Request::GetVizPath(_), Status::VizFinished) => Self::Points {
                command: expected,
                status,
                list: PointList::decode(&mut cells).map_err(malformed)?,
            },
            (Request::GetDoList(_), Status::VizDoListSent) => {
                Self::DoList(Box::new(DoList::decode(&mut cells).map_err(malformed)?))
            }
            (Request::GetPlanData(get), Status::VizFinished) => {
                let point = PlanPoint::decode(get.format, &mut cells).map_err(malformed)?;
                Self::PlanPoint(Box::new(point))
            }
            _ => Self::status(expected, status),
        };
        cells.end().map_err(malformed)?;
        Ok(reply)
    }
}
