/// Millimetres at a border; convert, do not compute.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Mm(pub f64);

/// Degrees at a border; convert, do not compute.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Deg(pub f64);

impl Mm {
    /// As metres.
    pub fn to_metres(self) -> f64 {
        self.0 * 1e-3
    }

    /// From metres.
    pub fn from_metres(metres: f64) -> Self {
        Self(metres * 1e3)
    }
}

impl Deg {
    /// As radians.
    pub fn to_radians(self) -> f64 {
        self.0.to_radians()
    }

    /// From radians.
    pub fn from_radians(radians: f64) -> Self {
        Self(radians.to_degrees())
    }
}
