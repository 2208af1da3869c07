use proptest::prelude::*;

use depal_time::{SimDuration, SimTime};

use crate::*;

const ENCODINGS: [Encoding; 3] = [
    Encoding::Ascii,
    Encoding::HexLittleEndian,
    Encoding::HexBigEndian,
];

fn decode_ascii(text: &str) -> Result<Request, RequestError> {
    Request::decode(Encoding::Ascii, text.as_bytes())
}

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

fn frames_of(encoding: Encoding, pieces: &[(u64, &[u8])]) -> Vec<Frame> {
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

/// A value that single precision and six decimals both keep.
fn real() -> impl Strategy<Value = f64> {
    (-16_000i32..16_000).prop_map(|n| f64::from(n) / 16.0)
}

fn six() -> impl Strategy<Value = [f64; 6]> {
    prop::array::uniform6(real())
}

fn flange() -> impl Strategy<Value = Option<[f64; 6]>> {
    prop::option::of(six()).prop_map(|f| f.filter(|v| v.iter().any(|x| *x != 0.0)))
}

fn request() -> impl Strategy<Value = Request> {
    let pose = prop_oneof![
        Just(RobotPosePayload::NotSent),
        (six(), flange()).prop_map(|(joints_deg, flange)| RobotPosePayload::JointsAndFlange {
            joints_deg,
            flange
        }),
        six().prop_map(RobotPosePayload::Flange),
        six().prop_map(RobotPosePayload::StartJoints),
        (4i32..99).prop_map(RobotPosePayload::UnknownType),
    ];
    let start = prop_oneof![
        Just(VizStartPayload::NotSent),
        (six(), flange()).prop_map(|(joints_deg, flange)| VizStartPayload::JointsAndFlange {
            joints_deg,
            flange
        }),
        six().prop_map(VizStartPayload::StartJoints),
        (3i32..99).prop_map(VizStartPayload::UnknownType),
    ];
    prop_oneof![
        (any::<i32>(), any::<i32>(), pose)
            .prop_map(|(job, count, pose)| Request::StartVision(StartVision { job, count, pose })),
        any::<i32>().prop_map(|job| Request::GetVisionPoints(GetVisionPoints { job })),
        (any::<i32>(), any::<i32>())
            .prop_map(|(job, recipe)| Request::SwitchRecipe(SwitchRecipe { job, recipe })),
        start.prop_map(|start| Request::StartViz(StartViz { start })),
        Just(Request::StopViz(StopViz)),
        (any::<i32>(), any::<i32>())
            .prop_map(|(step, port)| Request::SetBranch(SetBranch { step, port })),
        any::<i32>().prop_map(|pose_type| Request::GetVizPath(GetVizPath { pose_type })),
        prop::option::of(1i32..=64).prop_map(|sections| Request::GetDoList(GetDoList { sections })),
        any::<i32>().prop_map(|format| Request::GetPlanData(GetPlanData { format })),
        (any::<i32>(), prop::array::uniform3(real()))
            .prop_map(|(job, size_mm)| Request::SetBoxSize(SetBoxSize { job, size_mm })),
        Just(Request::GetState(GetState)),
    ]
}

/// The commands that came after the first ones.
fn later_request() -> impl Strategy<Value = Request> {
    let int = any::<i32>;
    prop_oneof![
        (int(), int(), int(), six(), six()).prop_map(
            |(job, recipe, format, joints_deg, flange)| {
                Request::RunVision(RunVision {
                    job,
                    recipe,
                    format,
                    joints_deg,
                    flange,
                })
            }
        ),
        int().prop_map(|solution| Request::SwitchSolution(SwitchSolution { solution })),
        (int(), int())
            .prop_map(|(job, pose_type)| Request::GetVisionPath(GetVisionPath { job, pose_type })),
        (int(), prop::option::of(1i32..=64)).prop_map(|(job, sections)| {
            Request::GetVisionDoList(GetVisionDoList { job, sections })
        }),
        int().prop_map(|job| Request::GetCustomData(GetCustomData { job })),
        (int(), int()).prop_map(|(job, pose_type)| {
            Request::GetVisionPlanData(GetVisionPlanData { job, pose_type })
        }),
        (int(), int(), int(), six(), six()).prop_map(
            |(step, port, pose_type, joints_deg, flange)| {
                Request::RunViz(RunViz {
                    step,
                    port,
                    pose_type,
                    joints_deg,
                    flange,
                })
            }
        ),
        (int(), int()).prop_map(|(step, index)| Request::SetIndex(SetIndex { step, index })),
        int().prop_map(|id| Request::ReadParameter(ReadParameter { id })),
        int().prop_map(|id| Request::WriteParameter(WriteParameter { id })),
        six().prop_map(|pose| Request::SetOuterPose(SetOuterPose { pose })),
        Just(Request::GetNotify(GetNotify)),
        (int(), six(), six()).prop_map(|(state, flange, joints_deg)| {
            Request::Calibrate(Calibrate {
                state,
                flange,
                joints_deg: Some(joints_deg),
            })
        }),
    ]
}

/// Commands that exist as text only.
fn text_request() -> impl Strategy<Value = Request> {
    let word = || "[A-Za-z][A-Za-z0-9 _.]{0,8}[a-z]";
    prop_oneof![
        (any::<i32>(), word(), six())
            .prop_map(|(job, step, pose)| Request::SetInputPose(SetInputPose { job, step, pose })),
        (word(), real()).prop_map(|(name, value)| Request::SetNumber(SetNumber { name, value })),
        (word(), prop::collection::vec(real(), 1..6))
            .prop_map(|(name, values)| Request::SetNumbers(SetNumbers { name, values })),
        (word(), word()).prop_map(|(name, value)| Request::SetText(SetText { name, value })),
        (word(), prop::collection::vec(word(), 1..6))
            .prop_map(|(name, values)| Request::SetTexts(SetTexts { name, values })),
    ]
}

fn later_reply() -> impl Strategy<Value = (Request, Reply)> {
    let custom = || prop::collection::vec(real(), 0..9);
    let record =
        (six(), any::<i32>(), any::<i32>()).prop_map(|(values, label, cell8)| PointRecord {
            values,
            label,
            cell8,
        });
    let list = (
        any::<bool>(),
        0i32..50,
        prop::collection::vec(record, 0..20),
    )
        .prop_map(|(is_last, vision_move, points)| PointList {
            is_last,
            vision_move,
            points,
        });
    let run = |format| {
        Request::RunVision(RunVision {
            job: 1,
            recipe: 0,
            format,
            joints_deg: [0.0; 6],
            flange: [0.0; 6],
        })
    };
    let point = (any::<bool>(), six(), any::<i32>(), custom()).prop_map(
        |(is_last, values, label, custom)| {
            Box::new(CustomPoint {
                is_last,
                values,
                label,
                custom,
            })
        },
    );
    let plan = prop::collection::vec((0u8..50).prop_map(f64::from), PLAN_VALUES);
    let waypoint = (
        any::<bool>(),
        six(),
        1i32..101,
        prop::option::of((plan, custom())),
    )
        .prop_map(|(is_last, values, velocity_percent, cells)| PlanPoint {
            is_last,
            values,
            move_type: 2,
            tool: 1,
            velocity_percent,
            vision_move: cells.map(|(plan, custom)| VisionMoveCells {
                plan: plan.try_into().ok(),
                custom,
            }),
        });
    prop_oneof![
        (list, 1i32..5).prop_map(move |(list, format)| match format {
            1 => (
                run(1),
                Reply::Points {
                    command: 100,
                    status: Status::VisionResult,
                    list
                }
            ),
            2 => (
                Request::GetVisionPath(GetVisionPath {
                    job: 1,
                    pose_type: 1
                }),
                Reply::Points {
                    command: 105,
                    status: Status::VisionPathSent,
                    list
                }
            ),
            format => (
                run(format),
                Reply::Points {
                    command: 100,
                    status: Status::VisionPathSent,
                    list
                }
            ),
        }),
        (point, any::<bool>()).prop_map(move |(point, one_shot)| if one_shot {
            (
                run(2),
                Reply::CustomPoint {
                    command: 100,
                    point,
                },
            )
        } else {
            (
                Request::GetCustomData(GetCustomData { job: 1 }),
                Reply::CustomPoint {
                    command: 110,
                    point,
                },
            )
        }),
        waypoint.prop_map(|point| (
            Request::GetVisionPlanData(GetVisionPlanData {
                job: 1,
                pose_type: 1
            }),
            Reply::VisionPlanPoint(Box::new(point))
        )),
        real().prop_map(|value| (
            Request::ReadParameter(ReadParameter { id: 1 }),
            Reply::Parameter(value)
        )),
        any::<i32>().prop_map(|value| (Request::GetNotify(GetNotify), Reply::Message(value))),
        (any::<bool>(), six(), six()).prop_map(|(is_done, flange, joints_deg)| (
            Request::Calibrate(Calibrate {
                state: 0,
                flange,
                joints_deg: Some(joints_deg)
            }),
            Reply::CalibrationPoint(Box::new(CalibrationPoint {
                is_done,
                flange,
                joints_deg
            }))
        )),
        (any::<bool>(), any::<bool>(), any::<bool>()).prop_map(
            |(has_vision, has_viz, has_camera)| (
                Request::GetState(GetState),
                Reply::State(StateFields {
                    has_vision,
                    has_viz,
                    has_camera
                })
            )
        ),
    ]
}

fn reply() -> impl Strategy<Value = (Request, Reply)> {
    let record =
        (six(), any::<i32>(), any::<i32>()).prop_map(|(values, label, cell8)| PointRecord {
            values,
            label,
            cell8,
        });
    let list = (
        any::<bool>(),
        0i32..50,
        prop::collection::vec(record, 0..20),
    )
        .prop_map(|(is_last, vision_move, points)| PointList {
            is_last,
            vision_move,
            points,
        });
    let whole = (0u8..50).prop_map(f64::from);
    let plan = (prop::collection::vec(whole, PLAN_VALUES)).prop_map(|v| {
        let mut plan = [0.0; PLAN_VALUES];
        plan.copy_from_slice(&v);
        plan
    });
    let cells = (plan, prop::collection::vec(real(), 0..9));
    let point = (
        1i32..=4,
        any::<bool>(),
        six(),
        1i32..3,
        -1i32..9,
        1i32..101,
        prop::option::of(cells),
    )
        .prop_map(
            |(format, is_last, values, move_type, tool, velocity_percent, cells)| {
                let vision_move = cells.map(|(plan, custom)| VisionMoveCells {
                    plan: (format >= 3).then_some(plan),
                    custom,
                });
                let point = PlanPoint {
                    is_last,
                    values,
                    move_type,
                    tool,
                    velocity_percent,
                    vision_move,
                };
                (
                    Request::GetPlanData(GetPlanData { format }),
                    Reply::PlanPoint(Box::new(point)),
                )
            },
        );
    prop_oneof![
        list.prop_map(|list| (
            Request::GetVizPath(GetVizPath { pose_type: 1 }),
            Reply::Points {
                command: 205,
                status: Status::VizFinished,
                list
            }
        )),
        prop::collection::vec(-1i32..1000, DO_LIST_LEN).prop_map(|v| {
            let mut list = [-1; DO_LIST_LEN];
            list.copy_from_slice(&v);
            (
                Request::GetDoList(GetDoList { sections: None }),
                Reply::DoList(Box::new(DoList(list))),
            )
        }),
        point,
        // 9100 never stands alone: it comes with the three states, as `Reply::State`.
        prop::sample::select(Status::ALL.to_vec())
            .prop_filter("9100 has fields", |status| *status != Status::StateSent)
            .prop_map(|status| (Request::GetState(GetState), Reply::status(901, status))),
    ]
}

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
