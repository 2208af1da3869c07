//! The vision calls `MM_...`: they act on numeric and position registers.
//!
//! Names, arguments and their order are those of version 1.8.3; a status register behind the others is accepted,
//! as newer versions have it. What a call with a status register meets (refusal, lost connection) goes there;
//! a call without one stops the program with the error.
//! Codes of this side, as in the other languages: 3099 not connected, 3098 no reply in time, 3097 connection closed,
//! 3096 a reply that does not fit.
//! Joint angles in registers are those the controller shows; on the wire they are those of the arm's description.

mod calibration;
mod fetch;
mod link;
mod store;
mod stored_point;
mod trigger;

use crate::builtins::Entry;

/// A call: its name and the names of its arguments.
pub(crate) struct VisionCall {
    pub name: &'static str,
    pub parameters: &'static [&'static str],
}

macro_rules! calls {
    ($($name:literal ($($parameter:literal),*) $run:path)*) => {
        /// All of them.
        pub(crate) const CALLS: &[VisionCall] = &[
            $(VisionCall { name: $name, parameters: &[$($parameter),*] }),*
        ];
        pub(crate) const ENTRIES: &[Entry] = &[$(($name, $run)),*];
    };
}

calls! {
    "MM_INIT_SKT" ("C_Tag", "Ip_Addr", "Svr_Port", "Time_Out") link::init
    "MM_START_VIS" ("Job", "Pos_Num_Need", "SendPos_Type", "Pr_Num") trigger::start_vision
    "MM_GET_VIS" ("Job", "Reg_Pos_Num", "Reg_Status") fetch::vision_points
    "MM_GET_POS" ("Serial", "Pr_Num", "Reg_Label", "Reg_Speed") store::pose
    "MM_GET_JPS" ("Serial", "Pr_Num", "Reg_Label", "Reg_Speed") store::joints
    "MM_SET_MOD" ("Job", "Model_Num") trigger::switch_recipe
    "MM_GET_VISP" ("Job", "Jps_Pos", "Reg_Pos_Num", "Reg_VPos_Num", "Reg_Status") fetch::vision_path
    "MM_GET_DY_DT" ("Job", "Reg_Pos_Num", "Reg_Status") fetch::custom_data
    "MM_GET_DYPOS" ("Serial", "Pr_Num", "Reg_Label", "Reg_UserData") store::custom_point
    "MM_GET_DL" ("Resource") fetch::outputs
    "MM_SET_DL" () store::outputs
    "MM_START_VIZ" ("SendPos_Type", "Pr_Num") trigger::start_viz
    "MM_SET_BCH" ("Branch_Num", "Export_Num") trigger::set_branch
    "MM_SET_IDX" ("Skill_Num", "Index_Num") trigger::set_index
    "MM_GET_VIZ" ("Jps_Pos", "Reg_Pos_Num", "Reg_VPos_Num", "Reg_Status") fetch::viz_path
    "MM_GET_PLNDT" ("Resource", "Jps_Pos", "Reg_Pos_Num", "Reg_VPos_Num", "Reg_Status") fetch::plan_data
    "MM_GET_PLJOP" ("Serial", "Jps_Pos", "Pr_Num", "Reg_MoveType", "Reg_ToolNum", "Reg_Speed", "Reg_UserData", "Reg_PlanRes") store::plan_point
    "MM_GET_PROP" ("Read_id", "Reg_Status", "Reg_Viz_Prop") fetch::parameter
    "MM_SET_PROP" ("Write_id", "Reg_Status") trigger::write_parameter
    "MM_SET_BS" ("Job", "Length", "Width", "Height") trigger::set_box_size
    "MM_GET_NTFY" ("MM_NotifyMsg") fetch::message
    "MM_CALIB" ("Move_Type", "PosJps", "WaitTime", "AxisNum", "AxisVal", "Reg_CalibPos") calibration::calibrate
    "MM_STOP_VIZ" () trigger::stop_viz
    "MM_GET_STAT" ("MM_Status") fetch::state
}
