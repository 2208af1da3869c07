use depal_time::{SimDuration, SimTime};

use super::{ENCODINGS, decode_ascii};
use crate::*;

pub(super) fn frames_of(encoding: Encoding, pieces: &[(u64, &[u8])]) -> Vec<Frame> {
    let mut framer = Framer::new(encoding, 64);
    let mut frames = Vec::new();
    let mut now = SimTime::ZERO;
    for (pause_ms, bytes) in pieces {
        now += SimDuration::from_millis(*pause_ms);
        frames.extend(std::iter::from_fn(|| framer.poll_frame(now)));
        framer.push(now, bytes);
        frames.extend(std::iter::from_fn(|| framer.poll_frame(now)));
    }
    while let Some(due) = framer.poll_timeout() {
        frames.extend(std::iter::from_fn(|| framer.poll_frame(due)));
    }
    frames
}

#[test]
fn lines_end_with_any_terminator_or_silence() {
    let line = |text: &str| Frame::Request(text.as_bytes().to_vec());
    let stream = b"901\r102,1\r\n\r\n103,1,2\n202";
    let expected = vec![line("901"), line("102,1"), line("103,1,2"), line("202")];
    assert_eq!(frames_of(Encoding::Ascii, &[(0, stream)]), expected);
    assert_eq!(
        frames_of(Encoding::Ascii, &[(0, b"90"), (49, b"1"), (51, b"202\r")]),
        vec![line("901"), line("202")]
    );
    assert_eq!(
        frames_of(Encoding::Ascii, &[(0, &[b'1'; 5000])]),
        vec![Frame::TooLong(5000)]
    );
}

#[test]
fn hex_length_is_latched_by_the_first_burst() {
    let lengths = |pieces: &[(u64, &[u8])]| -> Vec<usize> {
        frames_of(Encoding::HexLittleEndian, pieces)
            .iter()
            .map(|frame| match frame {
                Frame::Request(bytes) => bytes.len(),
                Frame::Dropped(count) | Frame::TooLong(count) => *count + 10_000,
            })
            .collect()
    };
    let bytes = [1u8; 2000];
    for length in [56, 64, 65] {
        assert_eq!(
            lengths(&[
                (0, &bytes[..length]),
                (30, &bytes[..length]),
                (1, &bytes[..length])
            ]),
            [length; 3]
        );
    }
    let mut kuka = vec![0u8; 660];
    kuka[0] = 101;
    assert_eq!(lengths(&[(0, &kuka), (5, &kuka)]), [660, 660]);
    // Eleven requests at once are not one of KUKA.
    assert_eq!(lengths(&[(0, &bytes[..704])]), [64; 11]);
    assert_eq!(lengths(&[(0, &bytes[..63]), (30, &bytes[..64])]), [63, 64]);
    assert_eq!(lengths(&[(0, &bytes[..8])]), [10_008]);
    assert_eq!(
        lengths(&[(0, &bytes[..64]), (21, &bytes[..65])]),
        [64, 64, 10_001]
    );
}

#[test]
fn each_single_cut_gives_the_same_requests() {
    for encoding in ENCODINGS {
        let stream: Vec<u8> = ["103,1,2", "101,1,0,2,1,2,3,4,5,6", "901"]
            .iter()
            .flat_map(|text| {
                decode_ascii(text)
                    .unwrap()
                    .encode(encoding, &Profile::v1_8())
            })
            .collect();
        let whole = frames_of(encoding, &[(0, &stream)]);
        assert_eq!(whole.len(), 3);
        for cut in 0..=stream.len() {
            let (head, tail) = stream.split_at(cut);
            assert_eq!(
                frames_of(encoding, &[(0, head), (19, tail)]),
                whole,
                "cut at {cut}"
            );
        }
    }
}

/// A robot that sends the last bytes of each record late, when it has its reply.
#[test]
fn padding_that_comes_late_belongs_to_its_request() {
    let requests = ["901", "103,1,2", "210,1", "601", "101,1,0,0"];
    for encoding in &ENCODINGS[1..] {
        for (length, cut) in [
            (64, 56),
            (64, 57),
            (64, 61),
            (64, 63),
            (660, 56),
            (660, 300),
        ] {
            let records: Vec<Vec<u8>> = requests
                .iter()
                .map(|text| {
                    let mut bytes = decode_ascii(text)
                        .unwrap()
                        .encode(*encoding, &Profile::v1_8());
                    bytes.resize(length, 0);
                    bytes
                })
                .collect();
            let mut pieces: Vec<(u64, &[u8])> = Vec::new();
            for record in &records {
                pieces.push((0, &record[..cut]));
                pieces.push((30, &record[cut..]));
            }
            let decoded: Vec<String> = frames_of(*encoding, &pieces)
                .iter()
                .filter_map(|frame| match frame {
                    Frame::Request(bytes) => {
                        Some(Request::decode(*encoding, bytes).unwrap().text())
                    }
                    _ => None,
                })
                .collect();
            let expected = requests.map(|text| decode_ascii(text).unwrap().text());
            assert_eq!(decoded, expected, "{encoding:?} {length} {cut}");
        }
    }
}

/// Zeros instead of the angles that are still to come would be another pose.
#[test]
fn no_request_ends_in_the_midst_of_a_pose() {
    let text = "101,1,0,1,1,2,3,4,5,6,500,10,900,180,-1,175";
    for encoding in &ENCODINGS[1..] {
        let request = decode_ascii(text).unwrap();
        let bytes = request.encode(*encoding, &Profile::v1_8());
        let state = decode_ascii("901").unwrap();
        let state = state.encode(*encoding, &Profile::v1_8());
        for cut in 56..64 {
            let (head, tail) = bytes.split_at(cut);
            let whole = Frame::Request(bytes.clone());
            // As the first request, and behind one that looked like 56 bytes.
            assert_eq!(
                frames_of(*encoding, &[(0, head), (90, tail)]),
                std::slice::from_ref(&whole)
            );
            let pieces = [(0, &state[..56]), (30, head), (90, tail)];
            let short = Frame::Request(state[..56].to_vec());
            assert_eq!(frames_of(*encoding, &pieces), [short, whole]);
            // Nothing is made up if the rest never comes.
            let frames = frames_of(*encoding, &[(0, head), (101, &state)]);
            let [Frame::Request(first), Frame::Request(second)] = &frames[..] else {
                panic!("{frames:?}");
            };
            let refusal = Request::decode(*encoding, first).unwrap_err();
            assert_eq!(refusal.status, Status::WrongFormat, "{}", refusal.reason);
            assert_eq!(Request::decode(*encoding, second), decode_ascii("901"));
        }
        // What a robot of old sends ends behind the joints, and is complete.
        let request = decode_ascii("101,1,0,1,1,2,3,4,5,6").unwrap();
        let old = request.encode(*encoding, &Profile::v1_8())[..56].to_vec();
        let expected = vec![Frame::Request(old.clone()); 2];
        assert_eq!(frames_of(*encoding, &[(0, &old), (30, &old)]), expected);
    }
}
