//! Random messages.

use proptest::prelude::*;

use crate::*;

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

pub(super) fn request() -> impl Strategy<Value = Request> {
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
pub(super) fn later_request() -> impl Strategy<Value = Request> {
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
pub(super) fn text_request() -> impl Strategy<Value = Request> {
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

fn point_list() -> impl Strategy<Value = PointList> {
    let record =
        (six(), any::<i32>(), any::<i32>()).prop_map(|(values, label, cell8)| PointRecord {
            values,
            label,
            cell8,
        });
    let points = prop::collection::vec(record, 0..20);
    (any::<bool>(), 0i32..50, points).prop_map(|(is_last, vision_move, points)| PointList {
        is_last,
        vision_move,
        points,
    })
}

pub(super) fn later_reply() -> impl Strategy<Value = (Request, Reply)> {
    let custom = || prop::collection::vec(real(), 0..9);
    let list = point_list();
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

pub(super) fn reply() -> impl Strategy<Value = (Request, Reply)> {
    let list = point_list();
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
