use depal_time::SimTime;
use proptest::prelude::*;

use super::ENCODINGS;
use super::framing::frames_of;
use super::random::*;
use crate::*;

proptest! {
    #[test]
    fn any_bytes_decode_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..700)) {
        for encoding in ENCODINGS {
            let _ = Request::decode(encoding, &bytes);
            let _ = frames_of(encoding, &[(0, &bytes), (3, &bytes)]);
            for code in Request::CODES {
                let fields = ",1".repeat(15);
                let request = (0..=15).find_map(|n| {
                    let text = format!("{code}{}", &fields[..2 * n]);
                    Request::decode(Encoding::Ascii, text.as_bytes()).ok()
                });
                let request = request.expect("some number of fields fits");
                let _ = Reply::decode(encoding, &request, &bytes);
            }
        }
    }

    #[test]
    fn requests_survive_encoding(request in prop_oneof![request(), later_request()]) {
        for encoding in ENCODINGS {
            let bytes = request.encode(encoding, &Profile::v1_8());
            let decoded = Request::decode(encoding, &bytes);
            prop_assert_eq!(decoded.as_ref(), Ok(&request), "{:?}", encoding);
        }
    }

    #[test]
    fn text_requests_survive_ascii(request in text_request()) {
        let bytes = request.encode(Encoding::Ascii, &Profile::v1_8());
        prop_assert_eq!(Request::decode(Encoding::Ascii, &bytes), Ok(request.clone()));
        let packed = request.encode(Encoding::HexBigEndian, &Profile::v1_8());
        let refused = Request::decode(Encoding::HexBigEndian, &packed).unwrap_err();
        prop_assert_eq!((refused.command, refused.status), (request.code(), Status::WrongFormat));
    }

    #[test]
    fn replies_survive_encoding((request, reply) in prop_oneof![reply(), later_reply()]) {
        for profile in Profile::all() {
            // The oldest terminator is a comma, which ends the last field like any other.
            let mut sent = reply.clone();
            if let Reply::VisionPlanPoint(point) = &mut sent
                && !profile.has_vision_plan_velocity
            {
                point.velocity_percent = 0;
            }
            for encoding in ENCODINGS {
                let bytes = sent.encode(encoding, &profile);
                let decoded = Reply::decode_as(encoding, &profile, &request, &bytes);
                prop_assert_eq!(decoded.as_ref(), Ok(&sent), "{:?} {}", encoding, profile.name);
            }
        }
    }

    /// A connection's encoding is found out from its first bytes, however they are split.
    #[test]
    fn detection_does_not_depend_on_splits(
        request in prop_oneof![request(), later_request()],
        cut in 1usize..64,
    ) {
        for encoding in ENCODINGS {
            let bytes = request.encode(encoding, &Profile::v1_8());
            let (head, tail) = bytes.split_at(cut.min(bytes.len()));
            let mut framer = Framer::detecting(64);
            framer.push(SimTime::ZERO, head);
            let early = framer.poll_frame(SimTime::ZERO);
            framer.push(SimTime::ZERO, tail);
            let late = SimTime::ZERO + LINE_SILENCE;
            let frame = early.or_else(|| framer.poll_frame(late));
            prop_assert_eq!(framer.encoding(), Some(encoding));
            let Some(Frame::Request(frame)) = frame else {
                panic!("{frame:?}");
            };
            prop_assert_eq!(Request::decode(encoding, &frame), Ok(request.clone()));
        }
    }

    #[test]
    fn any_split_gives_the_same_requests(
        requests in prop::collection::vec(prop_oneof![request(), later_request()], 1..6),
        cuts in prop::collection::vec(1usize..80, 0..40),
    ) {
        for encoding in ENCODINGS {
            let stream: Vec<u8> = requests
                .iter()
                .flat_map(|r| r.encode(encoding, &Profile::v1_8()))
                .collect();
            let whole = frames_of(encoding, &[(0, &stream)]);
            let mut rest = &stream[..];
            let mut pieces = Vec::new();
            for cut in &cuts {
                let (piece, after) = rest.split_at((*cut).min(rest.len()));
                pieces.push((1, piece));
                rest = after;
            }
            pieces.push((1, rest));
            prop_assert_eq!(&frames_of(encoding, &pieces), &whole);
            let decoded: Vec<_> = whole
                .iter()
                .map(|frame| match frame {
                    Frame::Request(bytes) => Request::decode(encoding, bytes).unwrap(),
                    other => panic!("{other:?}"),
                })
                .collect();
            prop_assert_eq!(&decoded, &requests);
        }
    }
}
