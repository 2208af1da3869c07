/// How cells become bytes; chosen per port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Encoding {
    /// Fields joined by commas, ended by CR.
    Ascii,
    /// Packed 4-byte cells, least significant byte first: ABB, KUKA, newer FANUC.
    HexLittleEndian,
    /// Packed 4-byte cells, most significant byte first: FANUC up to V9.
    HexBigEndian,
}

impl Encoding {
    /// The name used in scenes and on the command line: `ascii`, `hex-le`, `hex-be`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ascii => "ascii",
            Self::HexLittleEndian => "hex-le",
            Self::HexBigEndian => "hex-be",
        }
    }

    /// The encoding of a name; also takes underscores for hyphens.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.replace('_', "-").as_str() {
            "ascii" => Some(Self::Ascii),
            "hex-le" => Some(Self::HexLittleEndian),
            "hex-be" => Some(Self::HexBigEndian),
            _ => None,
        }
    }

    /// Whether this is one of the packed forms.
    pub fn is_hex(self) -> bool {
        self != Self::Ascii
    }
}
