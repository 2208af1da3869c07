//! The table of commands, and what is common to all requests.

use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::command::c100_run_vision::RunVision;
use crate::command::c101_start_vision::StartVision;
use crate::command::c102_get_vision_points::GetVisionPoints;
use crate::command::c103_switch_recipe::SwitchRecipe;
use crate::command::c104_switch_solution::SwitchSolution;
use crate::command::c105_get_vision_path::GetVisionPath;
use crate::command::c106_get_vision_do_list::GetVisionDoList;
use crate::command::c110_get_custom_data::GetCustomData;
use crate::command::c111_get_vision_plan_data::GetVisionPlanData;
use crate::command::c200_run_viz::RunViz;
use crate::command::c201_start_viz::StartViz;
use crate::command::c202_stop_viz::StopViz;
use crate::command::c203_set_branch::SetBranch;
use crate::command::c204_set_index::SetIndex;
use crate::command::c205_get_viz_path::GetVizPath;
use crate::command::c206_get_do_list::GetDoList;
use crate::command::c207_read_parameter::ReadParameter;
use crate::command::c208_write_parameter::WriteParameter;
use crate::command::c210_get_plan_data::GetPlanData;
use crate::command::c501_set_box_size::SetBoxSize;
use crate::command::c502_set_outer_pose::SetOuterPose;
use crate::command::c503_set_input_pose::SetInputPose;
use crate::command::c504_set_number::SetNumber;
use crate::command::c505_set_numbers::SetNumbers;
use crate::command::c506_set_text::SetText;
use crate::command::c507_set_texts::SetTexts;
use crate::command::c601_get_notify::GetNotify;
use crate::command::c701_calibrate::Calibrate;
use crate::command::c901_get_state::GetState;
use crate::{Encoding, Profile, RequestError, Status};

macro_rules! commands {
    ($($code:literal $name:ident $text:literal)*) => {
        /// What a robot asks for.
        #[derive(Debug, Clone, PartialEq)]
        #[non_exhaustive]
        pub enum Request {
            $(#[doc = concat!("Command ", $code, ": ", $text, ".")] $name($name),)*
            /// A command number that is not in the table; answered with 3001.
            Unknown {
                /// The number as read.
                code: i32,
            },
        }

        impl Request {
            /// The command number.
            pub fn code(&self) -> i32 {
                match self {
                    $(Self::$name(_) => $code,)*
                    Self::Unknown { code } => *code,
                }
            }

            /// What the command does, in a few words; empty for an unknown one.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => $text,)*
                    Self::Unknown { .. } => "",
                }
            }

            /// All command numbers, ascending.
            pub const CODES: &'static [i32] = &[$($code),*];

            /// Whether a command number is in the table.
            pub fn is_known(code: i32) -> bool {
                matches!(code, $($code)|*)
            }

            fn decode_body(code: i32, cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
                Ok(match code {
                    $($code => {
                        let body = $name::decode(cells)?;
                        cells.end()?;
                        Self::$name(body)
                    })*
                    _ => Self::Unknown { code },
                })
            }

            fn write(&self, cells: &mut CellWriter) {
                cells.int(self.code());
                match self {
                    $(Self::$name(body) => body.encode(cells),)*
                    Self::Unknown { .. } => {}
                }
            }
        }
    };
}

commands! {
    100 RunVision         "run vision project"
    101 StartVision       "start vision project"
    102 GetVisionPoints   "get vision points"
    103 SwitchRecipe      "switch recipe"
    104 SwitchSolution    "switch solution"
    105 GetVisionPath     "get vision path"
    106 GetVisionDoList   "get DO list of vision"
    110 GetCustomData     "get custom data"
    111 GetVisionPlanData "get plan data of vision"
    200 RunViz            "run Viz project"
    201 StartViz          "start Viz project"
    202 StopViz           "stop Viz project"
    203 SetBranch         "set branch exit"
    204 SetIndex          "set index"
    205 GetVizPath        "get Viz path"
    206 GetDoList         "get DO list"
    207 ReadParameter     "read step parameter"
    208 WriteParameter    "write step parameter"
    210 GetPlanData       "get plan data"
    501 SetBoxSize        "set box size"
    502 SetOuterPose      "set external pose"
    503 SetInputPose      "set input pose"
    504 SetNumber         "set numeric variable"
    505 SetNumbers        "set numeric list"
    506 SetText           "set text variable"
    507 SetTexts          "set text list"
    601 GetNotify         "get message"
    701 Calibrate         "calibrate"
    901 GetState          "get state"
}

/// Why the fields after the command number are refused.
pub(crate) struct BodyError {
    status: Status,
    reason: String,
}

impl From<FieldError> for BodyError {
    fn from(error: FieldError) -> Self {
        Self {
            status: Status::WrongFormat,
            reason: error.to_string(),
        }
    }
}

impl BodyError {
    /// The wrong number of values for the command's parameters.
    pub(crate) fn wrong_format(reason: String) -> Self {
        Self {
            status: Status::WrongFormat,
            reason,
        }
    }

    /// Like the plain conversion, but a value that is not finite has a code of its own.
    pub(crate) fn with_non_finite(error: FieldError, status: Status) -> Self {
        let reason = error.to_string();
        match error {
            FieldError::NotFinite { .. } => Self { status, reason },
            _ => Self::wrong_format(reason),
        }
    }
}

impl Request {
    /// Reads one frame (see [`crate::Framer`]). Never panics; whatever came, the error says what the
    /// robot has to hear.
    pub fn decode(encoding: Encoding, frame: &[u8]) -> Result<Self, RequestError> {
        let mut cells = CellReader::new(encoding, frame);
        let code = cells.int().map_err(|error| RequestError {
            command: 0,
            status: Status::InvalidCommand,
            reason: error.to_string(),
        })?;
        Self::decode_body(code, &mut cells).map_err(|error| RequestError {
            command: code,
            status: error.status,
            reason: error.reason,
        })
    }

    /// Whether a HEX frame ends in the midst of a pose that its command takes.
    pub(crate) fn is_cut_off(encoding: Encoding, frame: &[u8]) -> bool {
        let mut cells = CellReader::new(encoding, frame);
        let code = cells.int().unwrap_or_default();
        let _ = Self::decode_body(code, &mut cells);
        cells.is_cut_off()
    }

    /// The bytes that a robot sends.
    pub fn encode(&self, encoding: Encoding, profile: &Profile) -> Vec<u8> {
        let mut cells = CellWriter::default();
        self.write(&mut cells);
        cells.request_bytes(encoding, profile)
    }

    /// The request as comma-separated text, for logs.
    pub fn text(&self) -> String {
        let mut cells = CellWriter::default();
        self.write(&mut cells);
        cells.text()
    }
}
