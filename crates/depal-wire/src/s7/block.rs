//! The data block that controller and vision share: every register in one table.

/// Bytes of the block.
pub const BLOCK_BYTES: usize = 9696;
/// Bytes that the controller writes: command and parameters. Vision never writes them.
pub const COMMAND_BYTES: usize = 108;
/// Rows of the arrays that hold points or waypoints.
pub const POINT_ROWS: usize = 40;

/// Who writes a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The controller.
    Plc,
    /// Vision. The controller resets some of these.
    Vision,
}

/// Type of a register's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldKind {
    /// Bit 0 of a byte; the next register begins at an even byte.
    Bool,
    /// 16-bit integer.
    Int,
    /// Single precision.
    Real,
}

impl FieldKind {
    /// Bytes of one element; a BOOL takes its byte and a fill byte.
    pub fn bytes(self) -> usize {
        match self {
            Self::Bool | Self::Int => 2,
            Self::Real => 4,
        }
    }
}

/// One line of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FieldSpec {
    /// The register.
    pub field: Field,
    /// Its name in the documentation of the interface.
    pub name: &'static str,
    /// First byte.
    pub offset: usize,
    /// Type of its elements.
    pub kind: FieldKind,
    /// Rows and columns of its array; a single value is 1 by 1. Rows lie one after another.
    pub shape: [usize; 2],
    /// Who writes it.
    pub side: Side,
}

impl FieldSpec {
    /// Elements in all.
    pub fn len(&self) -> usize {
        self.shape[0] * self.shape[1]
    }

    /// Whether there are none: never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes in all.
    pub fn bytes(&self) -> usize {
        self.len() * self.kind.bytes()
    }

    /// First byte of an element, counted from 0 over all rows.
    pub fn element(&self, place: usize) -> usize {
        self.offset + place * self.kind.bytes()
    }

    /// Bytes of one row.
    pub fn row_bytes(&self) -> usize {
        self.shape[1] * self.kind.bytes()
    }
}

macro_rules! fields {
    ($($offset:literal $kind:ident $rows:literal $columns:literal $side:ident $field:ident $name:literal)*) => {
        /// A register of the block.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Field {
            $(#[doc = concat!($name, ", byte ", $offset, ".")] $field,)*
        }

        impl Field {
            /// All registers in their order in the block.
            pub const TABLE: &'static [FieldSpec] = &[
                $(FieldSpec {
                    field: Self::$field,
                    name: $name,
                    offset: $offset,
                    kind: FieldKind::$kind,
                    shape: [$rows, $columns],
                    side: Side::$side,
                },)*
            ];
        }
    };
}

fields! {
    0    Bool  1  1 Plc    Trigger          "Command Trigger"
    2    Int   1  1 Plc    Command          "Command"
    4    Int   1  1 Plc    PoseType         "Pose Type"
    6    Int   1  1 Plc    PoseNumber       "Pose Number"
    8    Int   1  1 Plc    Project          "Vision Project No."
    10   Int   1  1 Plc    Recipe           "Recipe No."
    12   Real  1  6 Plc    Joints           "Joint Position"
    36   Real  1  6 Plc    Flange           "Flange Pose"
    60   Int   1  1 Plc    BranchStep       "Branch Name"
    62   Int   1  1 Plc    BranchExit       "Branch Exit Port"
    64   Int   1  1 Plc    IndexStep        "Index Name"
    66   Int   1  1 Plc    IndexCounter     "Index Counter"
    68   Real  1  3 Plc    BoxSize          "External Input Box Dimension"
    80   Real  1  6 Plc    OuterPose        "External Input Pose"
    104  Int   1  1 Plc    RobotMoveStatus  "Robot Move Status"
    106  Int   1  1 Plc    Sections         "Depalletize Tool Section Count"
    108  Int   1 43 Vision Reserved         "Reserved"
    194  Bool  1  1 Vision Acknowledge      "Trigger Acknowledge"
    196  Int   1  1 Vision Notify           "Notify"
    198  Bool  1  1 Vision Heartbeat        "Heartbeat"
    200  Int   1  1 Vision Status           "Status Code"
    202  Bool  1  1 Vision PoseSent         "Status of Pose Sent"
    204  Int   1  1 Vision PoseCount        "Number of Pose Sent"
    206  Int   1  1 Vision VisionMoveIndex  "Index of Vision Picking Point"
    208  Real 40  6 Vision TargetPose       "Target Pose"
    1168 Int  40  1 Vision TargetLabel      "Target Label"
    1248 Int  40  1 Vision TargetTool       "Target Tool ID"
    1328 Int   1 64 Vision DigitalOutput    "Digital Output"
    1456 Real 40 10 Vision CustomOutput     "Custom Vision Output"
    3056 Int  40  1 Vision IsVisionMove     "Target IsVisualMove"
    3136 Int  40  1 Vision MoveType         "Target Move Type"
    3216 Int  40  1 Vision Speed            "Speed Percentage"
    3296 Real 40 40 Vision PlanResult       "VisualMove Planning Result"
}

impl Field {
    /// Its line in the table.
    pub fn spec(self) -> &'static FieldSpec {
        &Self::TABLE[self as usize]
    }

    /// First byte.
    pub fn offset(self) -> usize {
        self.spec().offset
    }

    /// The register that a byte of the block belongs to.
    pub fn at(byte: usize) -> Option<Self> {
        let line = Self::TABLE.iter().rev().find(|line| line.offset <= byte)?;
        (byte < BLOCK_BYTES).then_some(line.field)
    }
}

/// The whole block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataBlock {
    bytes: Box<[u8; BLOCK_BYTES]>,
}

impl Default for DataBlock {
    fn default() -> Self {
        Self {
            bytes: Box::new([0; BLOCK_BYTES]),
        }
    }
}

/// Elements are counted from 0 over all rows. One past the end, or one of another type, is our own bug.
impl DataBlock {
    /// All zeros.
    pub fn new() -> Self {
        Self::default()
    }

    /// Everything.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes[..]
    }

    /// `len` bytes from `first` on; `None` if the block is shorter.
    pub fn bytes(&self, first: usize, len: usize) -> Option<&[u8]> {
        self.bytes.get(first..first.checked_add(len)?)
    }

    /// Replaces bytes; `false`, and nothing is changed, if the block is shorter.
    pub fn write(&mut self, first: usize, bytes: &[u8]) -> bool {
        let place = first
            .checked_add(bytes.len())
            .and_then(|end| self.bytes.get_mut(first..end));
        place.is_some_and(|place| {
            place.copy_from_slice(bytes);
            true
        })
    }

    /// A BOOL.
    pub fn bool(&self, field: Field) -> bool {
        self.bytes[element(field, FieldKind::Bool, 0)] & 1 != 0
    }

    /// An INT.
    pub fn int(&self, field: Field, place: usize) -> i16 {
        let first = element(field, FieldKind::Int, place);
        i16::from_be_bytes([self.bytes[first], self.bytes[first + 1]])
    }

    /// A REAL.
    pub fn real(&self, field: Field, place: usize) -> f32 {
        let first = element(field, FieldKind::Real, place);
        let mut bytes = [0; 4];
        bytes.copy_from_slice(&self.bytes[first..first + 4]);
        f32::from_be_bytes(bytes)
    }

    /// The first `N` REALs of a register.
    pub fn reals<const N: usize>(&self, field: Field) -> [f32; N] {
        std::array::from_fn(|place| self.real(field, place))
    }

    /// Sets a BOOL; the other bits of its byte become 0.
    pub fn set_bool(&mut self, field: Field, value: bool) {
        self.bytes[element(field, FieldKind::Bool, 0)] = u8::from(value);
    }

    /// Sets an INT.
    pub fn set_int(&mut self, field: Field, place: usize, value: i16) {
        let first = element(field, FieldKind::Int, place);
        self.bytes[first..first + 2].copy_from_slice(&value.to_be_bytes());
    }

    /// Sets a REAL.
    pub fn set_real(&mut self, field: Field, place: usize, value: f32) {
        let first = element(field, FieldKind::Real, place);
        self.bytes[first..first + 4].copy_from_slice(&value.to_be_bytes());
    }
}

fn element(field: Field, kind: FieldKind, place: usize) -> usize {
    let spec = field.spec();
    assert!(
        spec.kind == kind && place < spec.len(),
        "{} holds {} elements of type {:?}, asked for number {place} of type {kind:?}",
        spec.name,
        spec.len(),
        spec.kind
    );
    spec.element(place)
}
