/// What happened to a carton at the cups.
#[derive(Debug, Clone, PartialEq)]
pub enum GripEvent {
    /// A vacuum switch closed while cups of its section were sealed on the carton.
    Started {
        /// Carton number as given in the contacts.
        carton: u32,
        /// Indices of the sections with sealed cups on it, ascending.
        sections: Vec<usize>,
    },
    /// The valves were closed and the vacuum is gone: the intended end.
    Released {
        /// Carton number.
        carton: u32,
    },
    /// The carton came off, or was never held, with a valve open.
    Lost {
        /// Carton number.
        carton: u32,
        /// Why.
        reason: LossReason,
        /// Pull of all cups on the carton when the first cup came off, N.
        load_n: f64,
        /// What the sealed cups could hold at that time, N.
        limit_n: f64,
    },
}

impl GripEvent {
    /// Number of the carton.
    pub fn carton(&self) -> u32 {
        match self {
            Self::Started { carton, .. }
            | Self::Released { carton }
            | Self::Lost { carton, .. } => *carton,
        }
    }
}

/// Why a carton was lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LossReason {
    /// Cups touched it with an open valve but the vacuum switch never closed.
    NoSeal,
    /// Most cups lost their seal by an uncovered lip, by tilt, or for want of vacuum.
    SealLost,
    /// Most cups were pulled off: the load was higher than the vacuum can hold.
    Dropped,
}

impl LossReason {
    /// The reason as one word for reports: `no_seal`, `seal_lost`, `dropped`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::NoSeal => "no_seal",
            Self::SealLost => "seal_lost",
            Self::Dropped => "dropped",
        }
    }
}
