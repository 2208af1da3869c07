//! Messages of the vision standard interface: bytes to typed values and back.
//!
//! A robot (the client) sends one [`Request`] and gets one [`Reply`]; nothing is ever pushed.
//! Both directions are public, so that a robot-side test client uses the same code.
//! One command lives in one file below `command/`; [`Request`] is made from a table of them.
//!
//! This crate must never know sockets, clocks, sessions or what a command does: only its bytes.
//! No input makes it panic: what cannot be read is a [`RequestError`] with the status code that
//! the robot has to hear.
//!
//! ```
//! use depal_wire::{Encoding, Profile, Reply, Request, Status};
//! let profile = Profile::v1_8();
//! let request = Request::decode(Encoding::Ascii, b"103,1,2").unwrap();
//! assert_eq!(request.code(), 103);
//! let reply = Reply::status(103, Status::RecipeSwitched);
//! assert_eq!(reply.encode(Encoding::Ascii, &profile), b"103,1107\r");
//! assert_eq!(reply.encode(Encoding::HexLittleEndian, &profile).len(), 660);
//! ```
//!
//! Units on the wire: millimetres and degrees; labels, counters and codes are 32-bit integers.
//! The angles of a pose stay in the brand's own order here: their meaning is the server's business.
//! Numbers in HEX are single precision.
//!
//! Commands 503 to 507 carry text and exist in ASCII only.
//! [`s7`] holds the telegrams and the data block of Siemens controllers, which speak no commands but share memory.

mod cells;
mod command;
mod encoding;
mod error;
mod framer;
mod profile;
mod reply;
mod request;
pub mod s7;
mod status;

pub use command::c100_run_vision::RunVision;
pub use command::c101_start_vision::{RobotPosePayload, StartVision};
pub use command::c102_get_vision_points::GetVisionPoints;
pub use command::c103_switch_recipe::SwitchRecipe;
pub use command::c104_switch_solution::SwitchSolution;
pub use command::c105_get_vision_path::GetVisionPath;
pub use command::c106_get_vision_do_list::GetVisionDoList;
pub use command::c110_get_custom_data::{CustomPoint, GetCustomData};
pub use command::c111_get_vision_plan_data::GetVisionPlanData;
pub use command::c200_run_viz::RunViz;
pub use command::c201_start_viz::{StartViz, VizStartPayload};
pub use command::c202_stop_viz::StopViz;
pub use command::c203_set_branch::SetBranch;
pub use command::c204_set_index::SetIndex;
pub use command::c205_get_viz_path::GetVizPath;
pub use command::c206_get_do_list::{DO_LIST_LEN, DoList, GetDoList};
pub use command::c207_read_parameter::ReadParameter;
pub use command::c208_write_parameter::WriteParameter;
pub use command::c210_get_plan_data::{GetPlanData, PLAN_VALUES, PlanPoint, VisionMoveCells};
pub use command::c501_set_box_size::SetBoxSize;
pub use command::c502_set_outer_pose::SetOuterPose;
pub use command::c503_set_input_pose::SetInputPose;
pub use command::c504_set_number::SetNumber;
pub use command::c505_set_numbers::SetNumbers;
pub use command::c506_set_text::SetText;
pub use command::c507_set_texts::SetTexts;
pub use command::c601_get_notify::GetNotify;
pub use command::c701_calibrate::{Calibrate, CalibrationPoint};
pub use command::c901_get_state::{GetState, StateFields};
pub use command::point_list::{PointList, PointRecord};
pub use encoding::Encoding;
pub use error::{ReplyError, RequestError};
pub use framer::{Frame, Framer, HEX_SILENCE, LINE_SILENCE, MAX_LINE, SCRAP_SILENCE};
pub use profile::{AsciiTerminator, HexPlanCells, HexReplyLength, PointCell8, Profile, StateReply};
pub use reply::Reply;
pub use request::Request;
pub use status::Status;

#[cfg(test)]
mod tests;
