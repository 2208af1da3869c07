//! Replays inputs that are known to be awkward for the decoders. Each is also cut at every byte.
//! `corpus/ascii` and `corpus/hex` hold inputs of the fuzz targets, see `fuzz/Cargo.toml`.

#[path = "../fuzz/checks.rs"]
mod checks;

use depal_time::{SimDuration, SimTime};
use depal_wire::{Encoding, Frame, Framer, Request};
use proptest::prelude::*;

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

/// The inputs of one fuzz target.
#[allow(clippy::disallowed_methods)] // Raw bytes, many of them: a folder, not a table in the code.
fn inputs(target: &str) -> Vec<Vec<u8>> {
    let folder = format!("{}/tests/corpus/{target}", env!("CARGO_MANIFEST_DIR"));
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut paths: Vec<_> = entries.map(|e| e.expect("readable").path()).collect();
    paths.sort();
    let inputs: Vec<Vec<u8>> = paths
        .iter()
        .map(|path| std::fs::read(path).expect("readable"))
        .collect();
    assert!(inputs.len() >= 10, "{} inputs in {target}", inputs.len());
    inputs
}

fn check_both_ways(target: &str, data: &[u8]) {
    if target == "ascii" {
        checks::check(Encoding::Ascii, data);
    } else {
        checks::check(Encoding::HexLittleEndian, data);
        checks::check(Encoding::HexBigEndian, data);
    }
}

#[test]
fn the_corpus_of_the_fuzz_targets() {
    for target in ["ascii", "hex"] {
        for mut data in inputs(target) {
            for cut in 0..=255 {
                data[0] = cut;
                check_both_ways(target, &data);
            }
        }
    }
}

/// Bytes that are more often than not part of a command.
fn likely_byte() -> impl Strategy<Value = u8> {
    prop_oneof![
        4 => prop::sample::select(b"0123456789".to_vec()),
        3 => prop::sample::select(b",\r\n.-+e \0".to_vec()),
        1 => any::<u8>(),
    ]
}

/// Changes to an input: where, and what is put there instead of how many bytes.
fn changes() -> impl Strategy<Value = Vec<(prop::sample::Index, Vec<u8>, usize)>> {
    let piece = prop::collection::vec(likely_byte(), 0..6);
    prop::collection::vec((any::<prop::sample::Index>(), piece, 0..6usize), 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(data in prop::collection::vec(likely_byte(), 0..1500)) {
        check_both_ways("ascii", &data);
        check_both_ways("hex", &data);
    }

    #[test]
    fn any_bytes_at_all(data in prop::collection::vec(any::<u8>(), 0..1500)) {
        check_both_ways("ascii", &data);
        check_both_ways("hex", &data);
    }

    #[test]
    fn changed_inputs(place in any::<prop::sample::Index>(), changes in changes(), is_text in any::<bool>()) {
        let target = if is_text { "ascii" } else { "hex" };
        let mut data = place.get(&inputs(target)).clone();
        for (place, piece, gone) in changes {
            let from = place.index(data.len() + 1);
            let to = (from + gone).min(data.len());
            data.splice(from..to, piece);
        }
        check_both_ways(target, &data);
    }
}
