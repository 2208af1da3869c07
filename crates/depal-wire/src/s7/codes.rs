/// What a controller says to one item of a read or a write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ReturnCode(pub u8);

impl ReturnCode {
    /// Done.
    pub const OK: Self = Self(0xff);
    /// The block is protected, or optimised access keeps others out.
    pub const ACCESS_DENIED: Self = Self(0x03);
    /// The block is shorter.
    pub const BAD_ADDRESS: Self = Self(0x05);
    /// A type of data that is not offered.
    pub const BAD_TYPE: Self = Self(0x06);
    /// Type or length of the data do not fit the address.
    pub const INCONSISTENT: Self = Self(0x07);
    /// There is no such block.
    pub const NO_OBJECT: Self = Self(0x0a);

    /// Whether the item was read or written.
    pub fn is_ok(self) -> bool {
        self == Self::OK
    }

    /// In words.
    pub fn meaning(self) -> &'static str {
        match self.0 {
            0xff => "done",
            0x01 => "hardware error",
            0x03 => "access denied",
            0x05 => "address out of range",
            0x06 => "data type not supported",
            0x07 => "data type inconsistent",
            0x0a => "object does not exist",
            _ => "unknown code",
        }
    }
}

impl std::fmt::Display for ReturnCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "code {:#04x}, {}", self.0, self.meaning())
    }
}
