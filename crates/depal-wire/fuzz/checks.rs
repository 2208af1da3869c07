//! What has to hold for any bytes. Fuzz targets, the replay of the corpus and property tests share it.

use depal_time::SimTime;
use depal_wire::{Encoding, Frame, Framer, Profile, Reply, Request};

/// Requests of other lengths are refused by the framer long before.
const LONGEST_FRAME: usize = 4096;

/// The first byte says how the rest is cut: into pieces of that many bytes and one more.
pub fn check(encoding: Encoding, data: &[u8]) {
    let Some((cut, stream)) = data.split_first() else {
        return;
    };
    let piece = usize::from(*cut) + 1;
    check_framer(|| Framer::new(encoding, 64), stream, piece);
    check_framer(|| Framer::detecting(64), stream, piece);
    for frame in frames(Framer::new(encoding, 64), stream, stream.len().max(1)) {
        if let Frame::Request(bytes) = frame {
            assert!(bytes.len() <= LONGEST_FRAME);
            check_request(encoding, &bytes, stream);
        }
    }
    check_request(encoding, stream, stream);
}

/// Any split of the stream gives the same frames.
fn check_framer(new: impl Fn() -> Framer, stream: &[u8], piece: usize) {
    let whole = frames(new(), stream, stream.len().max(1));
    let split = frames(new(), stream, piece);
    assert_eq!(split, whole, "in pieces of {piece}");
}

/// All frames, up to the line that cuts the connection.
fn frames(mut framer: Framer, stream: &[u8], piece: usize) -> Vec<Frame> {
    let mut found = Vec::new();
    let mut drain = |framer: &mut Framer, now: SimTime| {
        while let Some(frame) = framer.poll_frame(now) {
            if let Frame::TooLong(_) = frame {
                // How much of it has been seen by then does depend on the pieces.
                found.push(Frame::TooLong(0));
                return true;
            }
            found.push(frame);
        }
        false
    };
    for bytes in stream.chunks(piece) {
        framer.push(SimTime::ZERO, bytes);
        if drain(&mut framer, SimTime::ZERO) {
            return found;
        }
    }
    // Silence ends what is left; each time something has to come of it.
    let mut left = usize::MAX;
    while let Some(due) = framer.poll_timeout() {
        assert!(framer.buffered() < left, "silence brings nothing");
        left = framer.buffered();
        if drain(&mut framer, due) {
            return found;
        }
    }
    found
}

/// What can be read is written and read again as the same; what cannot has a status; replies are read without panic.
fn check_request(encoding: Encoding, frame: &[u8], reply: &[u8]) {
    let profile = Profile::v1_8();
    match Request::decode(encoding, frame) {
        Ok(request) => {
            let written = request.encode(encoding, &profile);
            if !matches!(request, Request::Unknown { .. }) {
                let end = written.len() - usize::from(encoding == Encoding::Ascii);
                let again =
                    Request::decode(encoding, &written[..end]).expect("our own bytes are readable");
                assert_eq!(again.encode(encoding, &profile), written);
            }
            let _ = Reply::decode(encoding, &request, reply);
        }
        Err(error) => assert!(!error.status.is_success(), "{error:?}"),
    }
}
