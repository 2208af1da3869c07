//! Addresses and values inside read and write telegrams.

use super::{ReturnCode, S7Error};

/// The area of data blocks.
pub const AREA_DB: u8 = 0x84;

/// Bytes of an address item.
const ADDRESS_LEN: usize = 12;
const ADDRESS_HEAD: [u8; 3] = [0x12, 0x0a, 0x10];

/// A run of variables in a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VarAddress {
    /// Type of one variable: 1 bit, 2 byte, 3 char, 4 word, 5 int, 6 double word, 7 double int, 8 real.
    pub kind: u8,
    /// How many.
    pub count: u16,
    /// Number of the data block; 0 for other areas.
    pub db: u16,
    /// The area, [`AREA_DB`] for data blocks.
    pub area: u8,
    /// First bit: eight times the byte, plus the bit. 24 bits.
    pub first_bit: u32,
}

impl VarAddress {
    /// Bytes of a data block.
    pub fn bytes(db: u16, first_byte: u16, count: u16) -> Self {
        Self {
            kind: 2,
            count,
            db,
            area: AREA_DB,
            first_bit: u32::from(first_byte) * 8,
        }
    }

    /// One bit of a data block.
    pub fn bit(db: u16, byte: u16, bit: u8) -> Self {
        Self {
            kind: 1,
            count: 1,
            db,
            area: AREA_DB,
            first_bit: u32::from(byte) * 8 + u32::from(bit & 7),
        }
    }

    /// Whether single bits are meant.
    pub fn is_bits(&self) -> bool {
        self.kind == 1
    }

    /// Bytes of the whole run; `None` for a type that is unknown. A bit takes one byte.
    pub fn len(&self) -> Option<usize> {
        let one = match self.kind {
            1..=3 => 1,
            4 | 5 => 2,
            6..=8 => 4,
            _ => return None,
        };
        Some(one * usize::from(self.count))
    }

    /// Whether the run has no variable.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The first byte.
    pub fn first_byte(&self) -> usize {
        (self.first_bit / 8) as usize
    }

    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), S7Error> {
        let Some((item, rest)) = bytes.split_at_checked(ADDRESS_LEN) else {
            return Err(S7Error::Length {
                what: "address item",
                expected: ADDRESS_LEN,
                found: bytes.len(),
            });
        };
        for (found, expected) in item.iter().zip(ADDRESS_HEAD) {
            if *found != expected {
                return Err(S7Error::Value {
                    what: "address item",
                    expected,
                    found: *found,
                });
            }
        }
        let address = Self {
            kind: item[3],
            count: u16::from_be_bytes([item[4], item[5]]),
            db: u16::from_be_bytes([item[6], item[7]]),
            area: item[8],
            first_bit: u32::from_be_bytes([0, item[9], item[10], item[11]]),
        };
        Ok((address, rest))
    }

    pub(super) fn emit(&self, out: &mut Vec<u8>) {
        out.extend(ADDRESS_HEAD);
        out.push(self.kind);
        out.extend(self.count.to_be_bytes());
        out.extend(self.db.to_be_bytes());
        out.push(self.area);
        out.extend(&self.first_bit.to_be_bytes()[1..]);
    }
}

/// How the length of a value is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DataTransport {
    /// Single bits, each in a byte.
    Bit,
    /// Bytes and words; the length field counts bits.
    Byte,
    /// Integers; the length field counts bits.
    Int,
    /// Double integers; the length field counts bytes.
    DoubleInt,
    /// Reals; the length field counts bytes.
    Real,
    /// Octets; the length field counts bytes.
    Octet,
}

impl DataTransport {
    fn code(self) -> u8 {
        match self {
            Self::Bit => 3,
            Self::Byte => 4,
            Self::Int => 5,
            Self::DoubleInt => 6,
            Self::Real => 7,
            Self::Octet => 9,
        }
    }

    fn from_code(code: u8) -> Result<Self, S7Error> {
        Ok(match code {
            3 => Self::Bit,
            4 => Self::Byte,
            5 => Self::Int,
            6 => Self::DoubleInt,
            7 => Self::Real,
            9 => Self::Octet,
            found => {
                return Err(S7Error::Value {
                    what: "type of a value",
                    expected: 4,
                    found,
                });
            }
        })
    }

    fn counts_bits(self) -> bool {
        matches!(self, Self::Byte | Self::Int)
    }

    /// What answers a read of `address`.
    pub fn of_address(address: &VarAddress) -> Self {
        match address.kind {
            1 => Self::Bit,
            3 => Self::Octet,
            5 => Self::Int,
            7 => Self::DoubleInt,
            8 => Self::Real,
            _ => Self::Byte,
        }
    }
}

/// The value of one item: at most 8,191 bytes, which no telegram can carry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VarData {
    /// How its length is counted.
    pub transport: DataTransport,
    /// The bytes.
    pub bytes: Vec<u8>,
}

impl VarData {
    /// Plain bytes.
    pub fn bytes(bytes: &[u8]) -> Self {
        Self {
            transport: DataTransport::Byte,
            bytes: bytes.to_vec(),
        }
    }

    /// A single bit.
    pub fn bit(value: bool) -> Self {
        Self {
            transport: DataTransport::Bit,
            bytes: vec![u8::from(value)],
        }
    }
}

/// Reads one item; `is_last` items have no fill byte.
pub(super) fn parse_item(
    bytes: &[u8],
    is_last: bool,
) -> Result<(ReturnCode, Option<VarData>, &[u8]), S7Error> {
    let length = |expected| S7Error::Length {
        what: "value of an item",
        expected,
        found: bytes.len(),
    };
    let [code, transport, high, low, rest @ ..] = bytes else {
        return Err(length(4));
    };
    let code = ReturnCode(*code);
    let claimed = usize::from(u16::from_be_bytes([*high, *low]));
    if claimed == 0 && *transport == 0 {
        return Ok((code, None, rest));
    }
    let transport = DataTransport::from_code(*transport)?;
    let len = if transport.counts_bits() {
        claimed.div_ceil(8)
    } else {
        claimed
    };
    let Some((value, rest)) = rest.split_at_checked(len) else {
        return Err(length(len + 4));
    };
    let rest = match rest {
        [_fill, after @ ..] if len % 2 == 1 && !is_last => after,
        all => all,
    };
    let value = VarData {
        transport,
        bytes: value.to_vec(),
    };
    Ok((code, Some(value), rest))
}

/// Writes one item. Failed ones have no value.
pub(super) fn emit_item(
    code: ReturnCode,
    value: Option<&VarData>,
    is_last: bool,
    out: &mut Vec<u8>,
) {
    let Some(value) = value else {
        out.extend([code.0, 0, 0, 0]);
        return;
    };
    let unit = if value.transport.counts_bits() { 8 } else { 1 };
    let claimed = (value.bytes.len() * unit).min(usize::from(u16::MAX)) as u16;
    out.extend([code.0, value.transport.code()]);
    out.extend(claimed.to_be_bytes());
    out.extend(&value.bytes);
    if value.bytes.len() % 2 == 1 && !is_last {
        out.push(0);
    }
}
