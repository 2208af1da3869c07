//! The words of a move instruction, as one number on its way from the compiler to the built-in.

/// The way of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum PathShape {
    #[default]
    Joint,
    Line,
    Arc,
}

/// What the words of a move instruction say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct MoveForm {
    pub(crate) shape: PathShape,
    pub(crate) relative: bool,
    pub(crate) in_tool: bool,
    /// The point is an E6AXIS.
    pub(crate) axes: bool,
    pub(crate) spline: bool,
    pub(crate) c_ptp: bool,
    pub(crate) c_dis: bool,
    pub(crate) c_vel: bool,
    pub(crate) c_ori: bool,
}

impl MoveForm {
    fn bits(self) -> [bool; 8] {
        [
            self.relative,
            self.in_tool,
            self.axes,
            self.spline,
            self.c_ptp,
            self.c_dis,
            self.c_vel,
            self.c_ori,
        ]
    }

    pub(crate) fn encode(self) -> i64 {
        let bits = self.bits().into_iter().enumerate();
        let bits: i64 = bits.map(|(i, bit)| i64::from(bit) << i).sum();
        (bits << 2) | self.shape as i64
    }

    pub(super) fn decode(code: i64) -> Self {
        let bit = |i: i64| (code >> (i + 2)) & 1 == 1;
        Self {
            shape: match code & 3 {
                0 => PathShape::Joint,
                1 => PathShape::Line,
                _ => PathShape::Arc,
            },
            relative: bit(0),
            in_tool: bit(1),
            axes: bit(2),
            spline: bit(3),
            c_ptp: bit(4),
            c_dis: bit(5),
            c_vel: bit(6),
            c_ori: bit(7),
        }
    }

    pub(super) fn is_approximated(self) -> bool {
        self.c_ptp || self.c_dis || self.c_vel || self.c_ori
    }
}
