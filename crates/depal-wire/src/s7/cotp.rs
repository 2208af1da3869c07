//! COTP packets of class 0 inside TPKT frames.

use super::S7Error;

/// Bytes of a TPKT header.
pub(super) const TPKT_HEADER: usize = 4;
/// The only version of ISO on TCP.
pub(super) const TPKT_VERSION: u8 = 3;

const CONNECT_REQUEST: u8 = 0xe0;
const CONNECT_CONFIRM: u8 = 0xd0;
const DISCONNECT_REQUEST: u8 = 0x80;
const REJECT: u8 = 0x70;
const DATA: u8 = 0xf0;

const TPDU_SIZE: u8 = 0xc0;
const CALLING_TSAP: u8 = 0xc1;
const CALLED_TSAP: u8 = 0xc2;

/// Two bytes that name an end of a connection: the kind of connection, then rack and slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tsap(pub u16);

impl Tsap {
    /// Our own end; controllers do not look at it.
    pub const LOCAL: Self = Self(0x0100);

    /// The processor in `slot` of `rack`, 0 to 31 and 0 to 7, by a programming-device connection.
    pub fn of_place(rack: u8, slot: u8) -> Self {
        Self(0x0100 | u16::from(rack & 0x07) << 5 | u16::from(slot & 0x1f))
    }
}

/// What opens a connection, and what confirms it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CotpConnect {
    /// The other end's number; 0 in a request.
    pub destination: u16,
    /// The sender's number.
    pub source: u16,
    /// Power of two of the largest packet, 7 to 13; 10 is 1,024 bytes.
    pub tpdu_size: Option<u8>,
    /// Who calls.
    pub calling: Option<Tsap>,
    /// Who is called.
    pub called: Option<Tsap>,
}

/// One packet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CotpPacket {
    /// Opens a connection.
    ConnectRequest(CotpConnect),
    /// Accepts it.
    ConnectConfirm(CotpConnect),
    /// Refuses or ends it.
    DisconnectRequest {
        /// Why: 0 none given, 1 busy, 2 unknown address, 3 address missing.
        reason: u8,
    },
    /// A packet was not understood.
    Reject {
        /// Why.
        cause: u8,
    },
    /// A piece of a telegram.
    Data {
        /// Nothing of the telegram follows.
        is_last: bool,
        /// The piece.
        payload: Vec<u8>,
    },
}

impl CotpPacket {
    /// A telegram in one packet.
    pub fn data(payload: Vec<u8>) -> Self {
        Self::Data {
            is_last: true,
            payload,
        }
    }

    /// Reads what a frame holds after its header.
    pub fn parse(bytes: &[u8]) -> Result<Self, S7Error> {
        let length = |what, expected| S7Error::Length {
            what,
            expected,
            found: bytes.len(),
        };
        let [header_len, kind, ..] = *bytes else {
            return Err(length("COTP header", 2));
        };
        let header_end = usize::from(header_len) + 1;
        let header = bytes
            .get(2..header_end)
            .ok_or_else(|| length("COTP header", header_end.max(2)))?;
        let rest = &bytes[header_end..];
        // The low half of connecting packets is a credit, which class 0 does not use.
        match kind & 0xf0 {
            CONNECT_REQUEST => Ok(Self::ConnectRequest(CotpConnect::parse(header, rest)?)),
            CONNECT_CONFIRM => Ok(Self::ConnectConfirm(CotpConnect::parse(header, rest)?)),
            DISCONNECT_REQUEST => match *header {
                [_, _, _, _, reason, ..] => Ok(Self::DisconnectRequest { reason }),
                _ => Err(length("COTP disconnect", 7)),
            },
            REJECT => match *header {
                [_, _, cause, ..] => Ok(Self::Reject { cause }),
                _ => Err(length("COTP reject", 5)),
            },
            DATA => match *header {
                [number] => Ok(Self::Data {
                    is_last: number & 0x80 != 0,
                    payload: rest.to_vec(),
                }),
                _ => Err(length("COTP data header", 3)),
            },
            _ => Err(S7Error::PacketKind { kind }),
        }
    }

    /// The packet in its frame.
    ///
    /// A payload that exceeds the length field (65,528 bytes) is cut there; telegrams are far shorter.
    pub fn emit(&self) -> Vec<u8> {
        let mut packet = Vec::new();
        match self {
            Self::ConnectRequest(connect) => connect.emit(CONNECT_REQUEST, &mut packet),
            Self::ConnectConfirm(connect) => connect.emit(CONNECT_CONFIRM, &mut packet),
            Self::DisconnectRequest { reason } => {
                packet.extend([6, DISCONNECT_REQUEST, 0, 0, 0, 0, *reason]);
            }
            Self::Reject { cause } => packet.extend([4, REJECT, 0, 0, *cause]),
            Self::Data { is_last, payload } => {
                packet.extend([2, DATA, u8::from(*is_last) << 7]);
                packet.extend(payload);
            }
        }
        packet.truncate(usize::from(u16::MAX) - TPKT_HEADER);
        let length = (packet.len() + TPKT_HEADER) as u16;
        let mut frame = vec![TPKT_VERSION, 0];
        frame.extend(length.to_be_bytes());
        frame.extend(packet);
        frame
    }
}

impl CotpConnect {
    fn parse(header: &[u8], rest: &[u8]) -> Result<Self, S7Error> {
        let [d0, d1, s0, s1, _class, parameters @ ..] = header else {
            return Err(S7Error::Length {
                what: "COTP connect",
                expected: 7,
                found: header.len() + 2,
            });
        };
        if !rest.is_empty() {
            return Err(S7Error::Length {
                what: "data in a COTP connect",
                expected: 0,
                found: rest.len(),
            });
        }
        let mut connect = Self {
            destination: u16::from_be_bytes([*d0, *d1]),
            source: u16::from_be_bytes([*s0, *s1]),
            tpdu_size: None,
            calling: None,
            called: None,
        };
        let mut left = parameters;
        while let [code, len, tail @ ..] = left {
            let len = usize::from(*len);
            let value = tail.get(..len).ok_or(S7Error::Length {
                what: "COTP parameter",
                expected: len,
                found: tail.len(),
            })?;
            match (*code, value) {
                (TPDU_SIZE, [size]) => connect.tpdu_size = Some(*size),
                (CALLING_TSAP, [a, b]) => {
                    connect.calling = Some(Tsap(u16::from_be_bytes([*a, *b])));
                }
                (CALLED_TSAP, [a, b]) => connect.called = Some(Tsap(u16::from_be_bytes([*a, *b]))),
                // Other parameters, and names of other lengths, change nothing for us.
                _ => {}
            }
            left = &tail[len..];
        }
        Ok(connect)
    }

    fn emit(&self, kind: u8, packet: &mut Vec<u8>) {
        packet.extend([0, kind]);
        packet.extend(self.destination.to_be_bytes());
        packet.extend(self.source.to_be_bytes());
        packet.push(0);
        if let Some(size) = self.tpdu_size {
            packet.extend([TPDU_SIZE, 1, size]);
        }
        for (code, tsap) in [(CALLING_TSAP, self.calling), (CALLED_TSAP, self.called)] {
            if let Some(Tsap(tsap)) = tsap {
                packet.extend([code, 2]);
                packet.extend(tsap.to_be_bytes());
            }
        }
        packet[0] = (packet.len() - 1) as u8;
    }
}
