//! Cuts the byte stream of one connection into request frames.

use depal_time::{SimDuration, SimTime};

use crate::{Encoding, Request};

/// An unterminated ASCII command is complete after this silence: old clients send no terminator.
pub const LINE_SILENCE: SimDuration = SimDuration::from_millis(50);
/// A HEX request that is shorter than expected is complete after this silence.
pub const HEX_SILENCE: SimDuration = SimDuration::from_millis(20);
/// Bytes that are too few for any HEX request are thrown away after this silence, and one that ends in the midst of
/// a pose is given out as it is: some robots send a request in many small writes, and a busy computer puts pauses
/// between them.
pub const SCRAP_SILENCE: SimDuration = SimDuration::from_millis(100);
/// Longest ASCII command, bytes; a longer one is an attack or another protocol.
pub const MAX_LINE: usize = 4096;

/// Shortest HEX request, bytes: 14 cells, as up to version 1.5.
const SHORTEST_HEX: usize = 56;
/// What all commands fit into: 16 cells.
const FULL_HEX: usize = 64;
/// A KUKA request, always as long as the reply.
const LONGEST_HEX: usize = 660;

/// What came out of the stream.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Frame {
    /// One request, without terminator.
    Request(Vec<u8>),
    /// So many bytes that make no request were thrown away.
    Dropped(usize),
    /// The line exceeds [`MAX_LINE`]; the connection should be cut.
    TooLong(usize),
}

/// Reassembles requests from pieces of any size.
///
/// Call [`push`](Self::push) with what arrived, then [`poll_frame`](Self::poll_frame) until `None`;
/// [`poll_timeout`](Self::poll_timeout) says when to poll again although nothing arrives.
///
/// HEX has no terminator. The length is latched by the first burst of a connection: 56, 64 or 660
/// bytes, or 64 plus a few that are ignored. Until then a request needs [`HEX_SILENCE`] to end.
/// Later requests end with the latched length at once.
///
/// A robot may pause within a request for longer than that. Then the rest is padding, for a request that ends in the
/// midst of a pose is waited for. When it comes it is dropped, as no command begins with zeros, and the length that
/// the request has with it is latched.
#[derive(Debug, Clone)]
pub struct Framer {
    /// Unknown while a detecting framer has not seen enough.
    encoding: Option<Encoding>,
    default_hex_len: usize,
    latched_hex_len: Option<usize>,
    /// Bytes of the last HEX request as far as they came, if more of them may follow.
    may_grow: Option<usize>,
    buffer: Vec<u8>,
    last_byte_at: SimTime,
}

impl Framer {
    /// For a fresh connection. `hex_request_len` is the profile's; it holds until a burst shows another.
    pub fn new(encoding: Encoding, hex_request_len: usize) -> Self {
        Self {
            encoding: Some(encoding),
            default_hex_len: hex_request_len.clamp(SHORTEST_HEX, LONGEST_HEX),
            latched_hex_len: None,
            may_grow: None,
            buffer: Vec::new(),
            last_byte_at: SimTime::ZERO,
        }
    }

    /// For a fresh connection whose encoding is found out from its first bytes: all printable is ASCII,
    /// else the byte order under which the first cell is a known command, least significant byte first if none.
    pub fn detecting(hex_request_len: usize) -> Self {
        Self {
            encoding: None,
            ..Self::new(Encoding::Ascii, hex_request_len)
        }
    }

    /// The encoding of the connection, as soon as it is known.
    pub fn encoding(&self) -> Option<Encoding> {
        self.encoding
    }

    /// Takes what arrived.
    pub fn push(&mut self, now: SimTime, bytes: &[u8]) {
        if !bytes.is_empty() {
            self.buffer.extend_from_slice(bytes);
            self.last_byte_at = now;
        }
    }

    /// Bytes that wait for the rest of their frame.
    pub fn buffered(&self) -> usize {
        self.buffer.len()
    }

    /// The next frame, if one is complete at `now`.
    pub fn poll_frame(&mut self, now: SimTime) -> Option<Frame> {
        if self.encoding.is_none() {
            self.encoding = self.detect(now);
        }
        match self.encoding {
            None => None,
            Some(Encoding::Ascii) => self.poll_line(now),
            Some(_) => self.poll_hex(now),
        }
    }

    /// Two bytes tell text from cells, because no command number fills the first two bytes of a cell with
    /// printable characters; four bytes tell the byte order. Silence decides with what there is.
    fn detect(&self, now: SimTime) -> Option<Encoding> {
        let is_text = |b: &u8| matches!(b, b' '..=b'~' | b'\r' | b'\n' | b'\t');
        let silent = self.is_silent(now);
        match self.buffer.as_slice() {
            [] => None,
            [first, second, ..] if is_text(first) && is_text(second) => Some(Encoding::Ascii),
            [first] if is_text(first) => silent.then_some(Encoding::Ascii),
            [a, b, c, d, ..] => {
                let big = i32::from_be_bytes([*a, *b, *c, *d]);
                let little = i32::from_le_bytes([*a, *b, *c, *d]);
                let is_big = Request::is_known(big) && !Request::is_known(little);
                Some(if is_big {
                    Encoding::HexBigEndian
                } else {
                    Encoding::HexLittleEndian
                })
            }
            _ => silent.then_some(Encoding::HexLittleEndian),
        }
    }

    /// When silence will complete what waits. Ask again after every push and poll.
    pub fn poll_timeout(&self) -> Option<SimTime> {
        if self.buffer.is_empty() {
            None
        } else {
            Some(self.last_byte_at + self.silence())
        }
    }

    fn silence(&self) -> SimDuration {
        match self.encoding {
            Some(Encoding::Ascii) => LINE_SILENCE,
            Some(_) if self.buffer.len() >= SHORTEST_HEX && !self.is_cut_off() => HEX_SILENCE,
            // Three bytes at most while the encoding is not known.
            _ => SCRAP_SILENCE,
        }
    }

    fn is_silent(&self, now: SimTime) -> bool {
        !self.buffer.is_empty() && now >= self.last_byte_at + self.silence()
    }

    fn poll_line(&mut self, now: SimTime) -> Option<Frame> {
        loop {
            let end = self.buffer.iter().position(|b| matches!(b, b'\r' | b'\n'));
            let length = end.unwrap_or(self.buffer.len());
            if length > MAX_LINE {
                self.buffer.clear();
                return Some(Frame::TooLong(length));
            }
            if end.is_none() && !self.is_silent(now) {
                return None;
            }
            let mut line: Vec<u8> = self.buffer.drain(..length).collect();
            if end.is_some() {
                self.buffer.remove(0);
            }
            line.retain(|b| *b != 0);
            if !line.iter().all(u8::is_ascii_whitespace) {
                return Some(Frame::Request(line));
            }
            // Empty lines, also the second half of CR LF, are not requests.
        }
    }

    fn poll_hex(&mut self, now: SimTime) -> Option<Frame> {
        if self.buffer.is_empty() {
            return None;
        }
        let padding = self.late_padding();
        if padding > 0 {
            return Some(self.drop_padding(padding));
        }
        let silent = self.is_silent(now);
        let is_first = self.latched_hex_len.is_none();
        if is_first {
            let burst_is_over = silent && self.buffer.len() >= SHORTEST_HEX;
            if !burst_is_over && self.buffer.len() < LONGEST_HEX {
                return self.drop_scrap(silent);
            }
            self.latched_hex_len = Some(self.length_of_first_burst());
        }
        let mut length = self.latched_hex_len.unwrap_or(self.default_hex_len);
        if length < FULL_HEX && self.is_cut_off() {
            length = FULL_HEX;
        }
        if self.buffer.len() >= length || (silent && self.buffer.len() >= SHORTEST_HEX) {
            let take = length.min(self.buffer.len());
            let is_whole = take == length && take >= FULL_HEX && !is_first;
            self.may_grow = (!is_whole).then_some(take);
            return Some(Frame::Request(self.buffer.drain(..take).collect()));
        }
        self.drop_scrap(silent)
    }

    /// Whether the next request would end in the midst of a pose, were it as long as latched, or over now.
    fn is_cut_off(&self) -> bool {
        let latched = self.latched_hex_len.unwrap_or(LONGEST_HEX);
        let head = &self.buffer[..self.buffer.len().min(latched)];
        head.len() < FULL_HEX
            && self
                .encoding
                .is_some_and(|encoding| Request::is_cut_off(encoding, head))
    }

    /// Bytes at the front that still belong to the request before: zeros, except those with which the number of
    /// a command begins.
    fn late_padding(&self) -> usize {
        let Some(length) = self.may_grow else {
            return 0;
        };
        let zeros = self.buffer.iter().take_while(|b| **b == 0).count();
        let is_big = self.encoding == Some(Encoding::HexBigEndian);
        let own = match self.buffer.get(zeros) {
            _ if !is_big => 0,
            Some(1..=3) => 2,
            _ => 3,
        };
        let most = LONGEST_HEX.saturating_sub(length);
        zeros.saturating_sub(own).min(most)
    }

    /// What comes late is a part of its request, and shows how long that is.
    fn drop_padding(&mut self, count: usize) -> Frame {
        self.buffer.drain(..count);
        if let Some(length) = &mut self.may_grow {
            *length += count;
            if matches!(*length, FULL_HEX | LONGEST_HEX) {
                self.latched_hex_len = Some(*length);
            }
        }
        Frame::Dropped(count)
    }

    /// Too few bytes for a request, and nothing follows.
    fn drop_scrap(&mut self, silent: bool) -> Option<Frame> {
        if !silent || self.buffer.len() >= SHORTEST_HEX {
            return None;
        }
        let dropped = self.buffer.len();
        if self.buffer.iter().all(|b| *b == 0) {
            return Some(self.drop_padding(dropped));
        }
        self.buffer.clear();
        Some(Frame::Dropped(dropped))
    }

    fn length_of_first_burst(&self) -> usize {
        let length = self.buffer.len();
        let padded_to_longest = length >= LONGEST_HEX
            && self.buffer[self.default_hex_len.min(LONGEST_HEX)..LONGEST_HEX]
                .iter()
                .all(|b| *b == 0);
        if padded_to_longest {
            LONGEST_HEX
        } else if self.is_cut_off() {
            FULL_HEX
        } else if length == SHORTEST_HEX
            || (length > self.default_hex_len && length < 2 * SHORTEST_HEX)
        {
            length
        } else {
            // The expected length, a little less of it, or several requests in one go.
            self.default_hex_len
        }
    }
}
