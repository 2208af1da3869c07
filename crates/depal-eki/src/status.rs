use crate::EkiError;

/// What every call on a channel answers: the structure `EKI_STATUS` of the language.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Status {
    /// Values that are left in the memory of the element after the call (`Buff`).
    pub buff: i32,
    /// Values that the call took (`Read`).
    pub read: i32,
    /// What went wrong; its number is `Msg_No`.
    pub error: Option<EkiError>,
    /// Whether there is a connection (`Connected`).
    pub connected: bool,
    /// How many records had arrived, from 1, when the last value that was taken came (`Counter`).
    pub counter: i32,
    /// Simulated time at which it came, ms (`TimeStamp`).
    pub timestamp_ms: i32,
}

impl Status {
    /// A refusal.
    pub fn failed(error: EkiError, connected: bool) -> Self {
        Self {
            error: Some(error),
            connected,
            ..Self::default()
        }
    }

    /// `Msg_No`: 0 if all went well.
    pub fn message_number(&self) -> i32 {
        self.error.as_ref().map_or(0, EkiError::number)
    }
}
