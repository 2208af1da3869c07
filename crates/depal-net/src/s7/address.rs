use std::net::SocketAddr;
use std::time::Duration;

/// A data block in a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlcAddress {
    /// Where the controller is; its port is 102 as a rule.
    pub address: SocketAddr,
    /// Number of the data block. Default 1.
    pub db: u16,
    /// Rack of the processor, 0 to 7. Default 0.
    pub rack: u8,
    /// Its slot, 0 to 31. Default 1; the series 300 wants 2, the 1200 and 1500 take 0 as well.
    pub slot: u8,
    /// How often Command Trigger is looked at. Default 20 ms.
    pub poll: Duration,
}

impl PlcAddress {
    /// With the defaults.
    pub fn new(address: SocketAddr) -> Self {
        Self {
            address,
            db: 1,
            rack: 0,
            slot: 1,
            poll: Duration::from_millis(20),
        }
    }
}
