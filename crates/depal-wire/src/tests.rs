//! Messages and frames: single cases, and laws over random messages.

mod framing;
mod laws;
mod messages;
mod random;

use crate::*;

const ENCODINGS: [Encoding; 3] = [
    Encoding::Ascii,
    Encoding::HexLittleEndian,
    Encoding::HexBigEndian,
];

fn decode_ascii(text: &str) -> Result<Request, RequestError> {
    Request::decode(Encoding::Ascii, text.as_bytes())
}
