use super::decode_ascii;
use crate::*;

#[track_caller]
fn check_refused(text: &str, command: i32, status: Status) {
    let error = decode_ascii(text).unwrap_err();
    assert_eq!((error.command, error.status), (command, status), "{text}");
}

#[test]
fn status_table_is_ascending_and_invertible() {
    for pair in Status::ALL.windows(2) {
        assert!(pair[0].code() < pair[1].code(), "{pair:?}");
    }
    for status in Status::ALL {
        assert_eq!(Status::from_code(status.code()), Some(*status));
        assert!(!status.meaning().is_empty());
    }
    assert_eq!(Status::from_code(1234), None);
    for status in Status::ALL {
        let seen = status.seen_from_viz();
        assert!((2001..2200).contains(&seen.code()), "{status} -> {seen}");
    }
    assert_eq!(Status::NoPointsInRegion.seen_from_viz().code(), 2038);
    assert_eq!(Status::NoVisionResult.seen_from_viz().code(), 2037);
    assert!(Status::VizFinished.is_success() && !Status::VizTimeout.is_success());
}

#[test]
fn input_variants_are_accepted() {
    let expected = decode_ascii("103,1,2").unwrap();
    for text in [
        "103, 1 ,2",
        "103,1.0,2.",
        "103,1,2,",
        "+103,1e0,2,,,",
        " 103,1,2 \r",
    ] {
        assert_eq!(decode_ascii(text).as_ref(), Ok(&expected), "{text}");
    }
    let without_pose = decode_ascii("101,1,0,0").unwrap();
    assert_eq!(
        decode_ascii("101,1,0,0,0,0,0,-0,0,0").unwrap(),
        without_pose
    );
    assert_eq!(
        decode_ascii("101,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0").unwrap(),
        without_pose
    );
    assert!(matches!(
        decode_ascii("101,1,0,1,1,2,3,4,5,6").unwrap(),
        Request::StartVision(StartVision {
            pose: RobotPosePayload::JointsAndFlange { flange: None, .. },
            ..
        })
    ));
    assert_eq!(
        decode_ascii("999,hello").unwrap(),
        Request::Unknown { code: 999 }
    );
}

#[test]
fn malformed_requests_name_their_status() {
    check_refused("103,1", 103, Status::WrongFormat);
    check_refused("103,1,2,3", 103, Status::WrongFormat);
    check_refused("103,1,x", 103, Status::WrongFormat);
    check_refused("103,1,1.5", 103, Status::WrongFormat);
    check_refused("103,1,4294967296", 103, Status::WrongFormat);
    check_refused("103,1,nan", 103, Status::WrongFormat);
    check_refused("103,1,\u{661}", 103, Status::WrongFormat);
    check_refused("hello", 0, Status::InvalidCommand);
    check_refused("", 0, Status::InvalidCommand);
    check_refused("99999999999999999999", 0, Status::InvalidCommand);
    check_refused("101,1,0,2,1,2,nan,4,5,6", 101, Status::InvalidVisionPose);
    check_refused("101,1,0,2,1,2,1e999,4,5,6", 101, Status::InvalidVisionPose);
    check_refused("101,1,0,2,1,2,3,4,5", 101, Status::WrongFormat);
    check_refused("201,2,1,2,3,4,5,-inf", 201, Status::InvalidVizPose);
    check_refused("501,1,NaN,2,3", 501, Status::InvalidBoxSize);
    check_refused("206,65", 206, Status::WrongFormat);
    let mut frame = vec![0; 64];
    frame[..4].copy_from_slice(&501i32.to_le_bytes());
    frame[8..12].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = Request::decode(Encoding::HexLittleEndian, &frame).unwrap_err();
    assert_eq!(error.status, Status::InvalidBoxSize);
}

#[test]
fn published_bytes() {
    let profile = Profile::v1_8();
    let recipe = decode_ascii("103,1,2").unwrap();
    let mut expected = vec![0, 0, 0, 0x67, 0, 0, 0, 1, 0, 0, 0, 2];
    expected.resize(64, 0);
    assert_eq!(recipe.encode(Encoding::HexBigEndian, &profile), expected);

    let start = decode_ascii("101,1,0,2,549.56,50,647.01,180,-1,180").unwrap();
    let bytes = start.encode(Encoding::HexLittleEndian, &profile);
    assert_eq!(bytes[16..20], [0xd7, 0x63, 0x09, 0x44]);
    assert_eq!(bytes[32..36], [0x00, 0x00, 0x80, 0xbf]);
    assert_eq!(bytes.len(), 64);

    let triggered = Reply::status(101, Status::VisionTriggered);
    let bytes = triggered.encode(Encoding::HexLittleEndian, &profile);
    assert_eq!(bytes[..8], [0x65, 0, 0, 0, 0x4e, 0x04, 0, 0]);
    assert!(bytes.len() == 660 && bytes[8..].iter().all(|b| *b == 0));

    let big_cap = Profile {
        pose_cap: 30,
        ..Profile::v1_8()
    };
    assert_eq!(
        triggered.encode(Encoding::HexLittleEndian, &big_cap).len(),
        980
    );
}

#[test]
fn ascii_reals_are_short_and_never_negative_zero() {
    let list = PointList {
        is_last: true,
        vision_move: 0,
        points: vec![PointRecord {
            values: [95.7806, 400.0, -0.00001, 1.23456, -171.1301, 180.0],
            label: 3,
            cell8: 0,
        }],
    };
    let reply = Reply::Points {
        command: 102,
        status: Status::VisionResult,
        list,
    };
    let bytes = reply.encode(Encoding::Ascii, &Profile::v1_8());
    assert_eq!(
        String::from_utf8(bytes).unwrap(),
        "102,1100,1,1,0,95.7806,400.0,0.0,1.2346,-171.1301,180.0,3,0\r"
    );
}

#[test]
fn replies_of_other_commands_are_told_apart() {
    let request = decode_ascii("901").unwrap();
    let bytes =
        Reply::status(901, Status::VisionReady).encode(Encoding::HexBigEndian, &Profile::v1_8());
    assert!(Reply::decode(Encoding::HexBigEndian, &request, &bytes).is_ok());
    assert!(matches!(
        Reply::decode(Encoding::HexLittleEndian, &request, &bytes),
        Err(ReplyError::OtherCommand { expected: 901, .. })
    ));
}

#[test]
fn the_head_of_a_text_is_its_beginning() {
    let list = PointList {
        is_last: true,
        vision_move: 0,
        points: vec![
            PointRecord {
                values: [1.5, -0.00001, 3.0, 0.25, 1e6, 2.0],
                label: 1,
                cell8: 0,
            };
            20
        ],
    };
    let reply = Reply::Points {
        command: 102,
        status: Status::VisionResult,
        list,
    };
    let whole = reply.text();
    assert!(whole.starts_with("102,1100,1,20,0,1.5,0.0,3.0,0.25,1000000.0,2.0,1,0,1.5,"));
    for most in 0..=whole.len() + 1 {
        let head = reply.text_head(most);
        assert!(whole.starts_with(&head));
        assert!(head.len() >= most.min(whole.len()));
        assert!(head.len() < most + 12, "{} of {most}", head.len());
    }
    assert_eq!(reply.text_head(usize::MAX), whole);
}
