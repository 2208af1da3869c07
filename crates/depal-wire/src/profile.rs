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
        }
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
