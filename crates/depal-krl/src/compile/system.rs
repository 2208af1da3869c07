//! System variables whose value is the cabinet's: they are asked, not stored.

/// A variable of the system that is read and written by built-ins.
#[derive(Debug)]
pub(crate) struct Live {
    pub(crate) name: &'static str,
    /// Has an index.
    pub(crate) indexed: bool,
    /// Name of its type.
    pub(crate) kind: &'static str,
    /// Built-in that reads it; takes the index.
    pub(crate) read: Option<&'static str>,
    /// Built-in that writes it; takes the index and the value.
    pub(crate) write: Option<&'static str>,
    /// The arm must stand first.
    pub(crate) stops_advance: bool,
}

const fn indexed(
    name: &'static str,
    kind: &'static str,
    read: Option<&'static str>,
    write: Option<&'static str>,
    stops_advance: bool,
) -> Live {
    Live {
        name,
        indexed: true,
        kind,
        read,
        write,
        stops_advance,
    }
}

const fn single(
    name: &'static str,
    kind: &'static str,
    read: &'static str,
    stops_advance: bool,
) -> Live {
    Live {
        name,
        indexed: false,
        kind,
        read: Some(read),
        write: None,
        stops_advance,
    }
}

pub(crate) const LIVE: &[Live] = &[
    indexed("$IN", "BOOL", Some("read in"), None, true),
    indexed("$OUT", "BOOL", Some("read out"), Some("write out"), true),
    indexed("$OUT_C", "BOOL", None, Some("write out on time"), false),
    indexed(
        "$FLAG",
        "BOOL",
        Some("read flag"),
        Some("write flag"),
        false,
    ),
    indexed("$ANIN", "REAL", Some("read anin"), None, true),
    indexed(
        "$ANOUT",
        "REAL",
        Some("read anout"),
        Some("write anout"),
        true,
    ),
    indexed(
        "$TIMER",
        "INT",
        Some("read timer"),
        Some("write timer"),
        false,
    ),
    indexed(
        "$TIMER_STOP",
        "BOOL",
        Some("read timer stop"),
        Some("write timer stop"),
        false,
    ),
    indexed("$TIMER_FLAG", "BOOL", Some("read timer flag"), None, false),
    single("$AXIS_ACT", "E6AXIS", "axes now", true),
    single("$AXIS_ACT_MEAS", "E6AXIS", "axes now", true),
    single("$POS_ACT", "E6POS", "position now", true),
    single("$POS_ACT_MES", "E6POS", "position now", true),
    single("$AXIS_INT", "E6AXIS", "axes now", false),
    single("$POS_INT", "E6POS", "position now", false),
    single("$AXIS_FOR", "E6AXIS", "axes planned", false),
    single("$POS_FOR", "E6POS", "position planned", false),
    single("$ROB_STOPPED", "BOOL", "standing", false),
    single("$ROB_TIMER", "INT", "milliseconds", false),
];

/// System variables that are known and not simulated.
pub(crate) const REFUSED: &[&str] = &[
    "$DATE",
    "$TORQUE_AXIS_ACT",
    "$TORQMON",
    "$SEN_PREA",
    "$SEN_PINT",
    "$SOFT_PLC_BOOL",
    "$CURR_ACT",
    "$MOT_TEMP",
    "$VEL_ACT",
    "$VEL_AXIS_ACT",
    "$MEAS_PULSE",
    "$ERR",
    "$AXIS_BACK",
    "$POS_BACK",
    "$AXIS_RET",
    "$POS_RET",
    "$ASYNC_STATE",
    "$LOOP_MSG",
];
