/// What ends an ASCII reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AsciiTerminator {
    /// Nothing, as up to version 1.5.
    None,
    /// Carriage return.
    Cr,
    /// Line feed.
    Lf,
    /// Both.
    CrLf,
}

/// How long a HEX reply is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HexReplyLength {
    /// Padded with zeros to `max(660, 20 + 32 * cap)` bytes; a fixed-length reader (KUKA) needs it.
    Fixed,
    /// Just the cells.
    Exact,
}

/// The eighth cell of a point or waypoint record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointCell8 {
    /// Velocity in percent, up to version 1.8.
    Velocity,
    /// Tool id, from version 2.0.
    ToolId,
}

/// What 901 answers when all is well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateReply {
    /// 1101 alone.
    Ready,
    /// 9100 and three fields, from version 2.2.
    Fields,
}

/// How the whole numbers among the 21 plan values are packed in HEX; no source says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HexPlanCells {
    /// All 21 in single precision, as the PLC data block has them.
    SinglePrecision,
    /// Labels, counts and orientations as integers, the rest in single precision.
    IntegerCounts,
}

/// The output side of one product version: every line is its own switch.
///
/// Input is accepted in all variants whatever the profile says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Profile {
    /// Name in scenes, `v1_8`.
    pub name: &'static str,
    /// End of an ASCII reply.
    pub ascii_terminator: AsciiTerminator,
    /// A comma after the last field of an ASCII reply.
    pub ascii_trailing_comma: bool,
    /// Most decimals of a real in an ASCII reply; published examples show at most four.
    pub ascii_decimals: usize,
    /// Bytes of a HEX request unless a connection shows another length (56, 64 or 660).
    pub hex_request_len: usize,
    /// Length rule of HEX replies.
    pub hex_reply: HexReplyLength,
    /// Most points in one reply, 1 to 30. More than 20 make the fixed HEX reply longer.
    pub pose_cap: usize,
    /// Meaning of a record's eighth cell.
    pub point_cell8: PointCell8,
    /// What 901 answers.
    pub state_reply: StateReply,
    /// The reply to 111 has a velocity cell.
    pub has_vision_plan_velocity: bool,
    /// Packed form of the plan values.
    pub hex_plan_cells: HexPlanCells,
    /// In 210, waypoints that are no Vision Move end with a custom count of 0 instead of the velocity.
    pub pads_plan_points: bool,
}

impl Profile {
    /// Version 1.8, the default.
    pub fn v1_8() -> Self {
        Self {
            name: "v1_8",
            ascii_terminator: AsciiTerminator::Cr,
            ascii_trailing_comma: false,
            ascii_decimals: 4,
            hex_request_len: 64,
            hex_reply: HexReplyLength::Fixed,
            pose_cap: 20,
            point_cell8: PointCell8::Velocity,
            state_reply: StateReply::Ready,
            has_vision_plan_velocity: true,
            hex_plan_cells: HexPlanCells::SinglePrecision,
            pads_plan_points: false,
        }
    }

    /// Version 1.5 and older: short requests, no terminator, a comma after the last field.
    pub fn v1_5() -> Self {
        Self {
            name: "v1_5",
            ascii_terminator: AsciiTerminator::None,
            ascii_trailing_comma: true,
            hex_request_len: 56,
            ..Self::v1_8()
        }
    }

    /// Versions 1.6 and 1.7: the output is that of 1.8.
    pub fn v1_7() -> Self {
        Self {
            name: "v1_7",
            ..Self::v1_8()
        }
    }

    /// Versions 2.0 and 2.1: records end with the tool id.
    pub fn v2_1() -> Self {
        Self {
            name: "v2_1",
            point_cell8: PointCell8::ToolId,
            ..Self::v1_8()
        }
    }

    /// Version 2.2: 901 answers with fields, 111 without velocity.
    pub fn v2_2() -> Self {
        Self {
            name: "v2_2",
            state_reply: StateReply::Fields,
            has_vision_plan_velocity: false,
            ..Self::v2_1()
        }
    }

    /// All profiles, oldest first.
    pub fn all() -> [Self; 5] {
        [
            Self::v1_5(),
            Self::v1_7(),
            Self::v1_8(),
            Self::v2_1(),
            Self::v2_2(),
        ]
    }

    /// The profile of a name as in [`Profile::name`].
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|profile| profile.name == name)
    }

    /// Bytes of a HEX reply whose cells take `cell_bytes`.
    pub fn hex_reply_len(&self, cell_bytes: usize) -> usize {
        match self.hex_reply {
            HexReplyLength::Fixed => cell_bytes.max(660).max(20 + 32 * self.pose_cap),
            HexReplyLength::Exact => cell_bytes,
        }
    }
}

impl Default for Profile {
    fn default() -> Self {
        Self::v1_8()
    }
}
