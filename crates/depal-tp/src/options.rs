/// Order of the bytes in a cell of the vision interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ByteOrder {
    /// Most significant byte first: controllers up to version 9.
    #[default]
    BigEndian,
    /// Least significant byte first: version 10.
    LittleEndian,
}

/// Digital outputs that are bits of one signal of the cabinet, as a group output is configured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GroupOutput {
    /// The cabinet's signal, `GO[1]` or any other name.
    pub signal: String,
    /// Number of the digital output that is its lowest bit. A gripper whose outputs are counted from 0 has 0 here.
    pub first: u32,
    /// How many outputs.
    pub bits: u32,
}

/// What a controller has before the program runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Values of numeric registers, by number from 1.
    pub registers: Vec<(u32, f64)>,
    /// Byte order of the vision calls.
    pub byte_order: ByteOrder,
    /// Whether axis 3 is shown against the horizontal, as on arms of this make.
    pub is_axis_3_coupled: bool,
    /// Digital outputs that are bits of another signal.
    pub groups: Vec<GroupOutput>,
    /// Tools: number from 1, and x, y, z in mm and W, P, R in degrees of `flange_from_tcp`.
    pub tools: Vec<(u32, [f64; 6])>,
    /// User frames: number from 1, and x, y, z in mm and W, P, R in degrees of `base_from_frame`.
    pub frames: Vec<(u32, [f64; 6])>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            registers: Vec::new(),
            byte_order: ByteOrder::BigEndian,
            is_axis_3_coupled: true,
            groups: Vec::new(),
            tools: Vec::new(),
            frames: Vec::new(),
        }
    }
}

/// Why a preset of a register is not one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PresetError {
    /// Not of the form `number=value`.
    #[error("expected number=value (1=0), found {found:?}")]
    Form {
        /// As given.
        found: String,
    },
    /// No such register.
    #[error("there is no R[{number}]; R[1] to R[{most}] are there")]
    Number {
        /// As given.
        number: u32,
        /// The last register.
        most: u32,
    },
}

/// Reads a preset of a numeric register, `1=0` or `12=-2.5`.
pub fn parse_preset(text: &str) -> Result<(u32, f64), PresetError> {
    let form = || PresetError::Form { found: text.into() };
    let (number, value) = text.split_once('=').ok_or_else(form)?;
    let number: u32 = number.trim().parse().map_err(|_| form())?;
    let value: f64 = value.trim().parse().map_err(|_| form())?;
    if !value.is_finite() {
        return Err(form());
    }
    let most = crate::state::REGISTERS;
    if number == 0 || number > most {
        return Err(PresetError::Number { number, most });
    }
    Ok((number, value))
}
