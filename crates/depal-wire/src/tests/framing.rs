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
