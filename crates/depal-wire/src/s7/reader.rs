//! From a byte stream to packets.

use super::cotp::{TPKT_HEADER, TPKT_VERSION};
use super::{CotpPacket, S7Error};

/// Header and the shortest packet.
const SHORTEST_FRAME: usize = TPKT_HEADER + 3;

/// Cuts a stream into packets, whatever its pieces; telegrams that come in several packets are joined.
///
/// Call [`push`](Self::push) with what arrived, then [`poll`](Self::poll) until `None`.
/// After an error the stream is out of step for good: the connection has to be closed.
/// Memory stays below the limit and what one `push` brings, whatever lengths the frames claim.
#[derive(Debug, Clone)]
pub struct TelegramReader {
    limit: usize,
    buffer: Vec<u8>,
    telegram: Vec<u8>,
}

impl TelegramReader {
    /// `limit` is the longest telegram that is expected, bytes.
    pub fn new(limit: usize) -> Self {
        Self {
            limit,
            buffer: Vec::new(),
            telegram: Vec::new(),
        }
    }

    /// Another limit, from the next packet on.
    pub fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
    }

    /// Takes what arrived.
    pub fn push(&mut self, bytes: &[u8]) {
        self.buffer.extend_from_slice(bytes);
    }

    /// Whether a packet or a telegram has begun and not ended.
    pub fn is_inside(&self) -> bool {
        !self.buffer.is_empty() || !self.telegram.is_empty()
    }

    /// The next packet; data packets are whole telegrams.
    pub fn poll(&mut self) -> Result<Option<CotpPacket>, S7Error> {
        loop {
            let Some(packet) = self.poll_packet()? else {
                return Ok(None);
            };
            let CotpPacket::Data { is_last, payload } = packet else {
                return Ok(Some(packet));
            };
            self.telegram.extend(payload);
            if self.telegram.len() > self.limit {
                return Err(S7Error::Length {
                    what: "telegram in pieces",
                    expected: self.limit,
                    found: self.telegram.len(),
                });
            }
            if is_last {
                return Ok(Some(CotpPacket::data(std::mem::take(&mut self.telegram))));
            }
        }
    }

    fn poll_packet(&mut self) -> Result<Option<CotpPacket>, S7Error> {
        if let Some(version) = self.buffer.first()
            && *version != TPKT_VERSION
        {
            return Err(S7Error::NotIso { found: *version });
        }
        let [_, _, high, low, ..] = *self.buffer.as_slice() else {
            return Ok(None);
        };
        let length = usize::from(u16::from_be_bytes([high, low]));
        let most = self.limit + SHORTEST_FRAME;
        if !(SHORTEST_FRAME..=most).contains(&length) {
            return Err(S7Error::FrameLength {
                found: length,
                least: SHORTEST_FRAME,
                most,
            });
        }
        if self.buffer.len() < length {
            return Ok(None);
        }
        let packet = CotpPacket::parse(&self.buffer[TPKT_HEADER..length])?;
        self.buffer.drain(..length);
        Ok(Some(packet))
    }
}
