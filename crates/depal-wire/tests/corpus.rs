//! Replays inputs that are known to be awkward for the decoders. Each is also cut at every byte.

use depal_time::{SimDuration, SimTime};
use depal_wire::{Encoding, Frame, Framer, Request};

/// Pieces of a stream with the silence before each, milliseconds.
type Pieces = Vec<(u64, Vec<u8>)>;

/// The verdicts on all frames of a stream.
fn verdicts(encoding: Encoding, pieces: &Pieces) -> String {
    let mut framer = Framer::new(encoding, 64);
    let mut now = SimTime::ZERO;
    let mut found = Vec::new();
    let mut drain = |framer: &mut Framer, now: SimTime| {
        while let Some(frame) = framer.poll_frame(now) {
            found.push(match frame {
                Frame::Request(bytes) => match Request::decode(encoding, &bytes) {
                    Ok(request) => request.code().to_string(),
                    Err(error) => format!("{}:{}", error.command, error.status.code()),
                },
                Frame::Dropped(_) => "drop".to_owned(),
                Frame::TooLong(_) => "long".to_owned(),
            });
        }
    };
    for (silence, bytes) in pieces {
        now += SimDuration::from_millis(*silence);
        drain(&mut framer, now);
        framer.push(now, bytes);
        drain(&mut framer, now);
    }
    while let Some(due) = framer.poll_timeout() {
        drain(&mut framer, due);
    }
    found.join(" ")
}

fn check(encoding: Encoding, text: &str, read: impl Fn(&str) -> Pieces) {
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (input, expected) = line.split_once(" => ").expect("input and verdicts");
        let pieces = read(input);
        assert_eq!(verdicts(encoding, &pieces), expected, "{input}");
        let [(0, whole)] = pieces.as_slice() else {
            continue;
        };
        for cut in 0..=whole.len() {
            let (head, tail) = whole.split_at(cut);
            let halves = vec![(0, head.to_vec()), (1, tail.to_vec())];
            assert_eq!(
                verdicts(encoding, &halves),
                expected,
                "{input} cut at {cut}"
            );
        }
    }
}

#[test]
fn awkward_lines() {
    check(Encoding::Ascii, include_str!("corpus/ascii.txt"), |input| {
        let mut bytes = Vec::new();
        let mut rest = input;
        while let Some(first) = rest.chars().next() {
            let (byte, length) = match rest.get(..2) {
                Some("\\r") => (b'\r', 2),
                Some("\\n") => (b'\n', 2),
                Some("\\t") => (b'\t', 2),
                Some("\\x") => (u8::from_str_radix(&rest[2..4], 16).expect("a byte"), 4),
                _ => (u8::try_from(first).expect("ASCII"), 1),
            };
            bytes.push(byte);
            rest = &rest[length..];
        }
        vec![(0, bytes)]
    });
}

#[test]
fn awkward_frames() {
    check(
        Encoding::HexLittleEndian,
        include_str!("corpus/hex.txt"),
        |input| {
            let mut pieces: Pieces = vec![(0, Vec::new())];
            for word in input.split_whitespace() {
                let bytes = &mut pieces.last_mut().expect("one piece").1;
                if let Some(zeros) = word.strip_prefix('+') {
                    let zeros: usize = zeros.parse().expect("zeros");
                    bytes.resize(bytes.len() + zeros, 0);
                } else if let Some(silence) = word.strip_prefix('@') {
                    pieces.push((silence.parse().expect("milliseconds"), Vec::new()));
                } else {
                    bytes.push(u8::from_str_radix(word, 16).expect("a byte"));
                }
            }
            pieces
        },
    );
}
