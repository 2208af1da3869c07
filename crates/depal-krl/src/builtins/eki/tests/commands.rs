//! Every command of the page once, against the vision server's brain.

use depal_interface::{Encoding, Job, Profile, RobotPose};
use depal_vm::system::{MoveKind, MoveTarget};

use super::cabinet::Cabinet;
use super::*;

const DATA: &str = "
DECL E6AXIS HOME={A1 -90.0,A2 -110.0,A3 110.0,A4 0.0,A5 90.0,A6 0.0,E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}
DECL E6POS P1,P2,P3
DECL E6AXIS J1,J2
DECL FRAME F1
DECL INT ST[20]
DECL INT LAST[6]
DECL INT N[6]
DECL INT VIS[6]
DECL INT LABEL[4]
DECL INT EIGHTH[4]
DECL INT MOVE,TOOL,SPEED,MESSAGE
DECL REAL PROP
DECL REAL OWN[50]";

#[test]
fn all_commands_of_1_7_succeed() {
    let mut machine = with_module(
        r#"
  BAS(#INITMOV,0)
  MM_Init_Socket("XML_Kuka_MMIND",873,871,60)
  MM_Get_Status(ST[1])
  MM_Switch_Model(1,2)
  MM_Set_BoxSize(1,400.0,300.0,250.0)
  MM_Start_Vis(1,0,1,HOME)
  MM_Get_VisData(1,LAST[1],N[1],ST[2])
  MM_Get_Pose(2,P1,LABEL[1],EIGHTH[1])
  MM_Get_VisData(1,LAST[2],N[2],ST[3])
  MM_Start_Vis(2,0,3,HOME)
  MM_Get_VisPath(2,1,LAST[3],N[3],VIS[3],ST[4])
  MM_Get_Jps(3,J1,LABEL[2],EIGHTH[2])
  MM_Start_Vis(3,0,2,HOME)
  MM_Get_Dy_Data(3,N[4],ST[5])
  MM_Get_DyPose(2,P2,LABEL[3])
  MM_Set_Pos(P1)
  MM_Start_Viz(2,HOME)
  MM_Set_Index(5,3)
  MM_Set_Branch(7,1)
  MM_Get_VizData(2,LAST[5],N[5],VIS[5],ST[6])
  MM_Start_Viz(1,HOME)
  MM_Set_Branch(7,2)
  MM_Get_PlanData(3,N[6],VIS[6],ST[7])
  MM_Get_PlanJps(2,3,J2,MOVE,TOOL,SPEED)
  MM_Get_PlanPose(1,4,P3,MOVE,TOOL,SPEED)
  MM_Get_DoList( )
  MM_Set_DoList( )
  MM_Calib(2,2,0.1,0.0)"#,
        DATA,
    );
    let mut cabinet = Cabinet::with_vision(Encoding::HexLittleEndian, Profile::v1_8());
    finished(&mut machine, &mut cabinet);
    assert_eq!(
        cabinet.answered,
        [
            1101, 1107, 1108, 1102, 1100, 1100, 1102, 1103, 1102, 1100, 1100, 2107, 2103, 2106,
            2105, 2100, 2103, 2105, 2100, 2100, 2100, 2102, 7101, 7101, 7101, 7101
        ]
    );
    assert_eq!(
        ints(&machine, "ST", 7),
        [1101, 1100, 1100, 1103, 1100, 2100, 2100]
    );
    // 22 points come as 20 and 2; the program asks for the second part itself.
    assert_eq!(ints(&machine, "LAST", 3), [0, 1, 1]);
    assert_eq!(ints(&machine, "N", 6), [20, 2, 3, 2, 3, 3]);
    assert_eq!(six(&machine, "P1"), [200.0, 100.0, 450.0, 30.0, 0.0, 180.0]);
    assert_eq!(ints(&machine, "LABEL", 3), [3, 4, 3]);
    assert_eq!(six(&machine, "J1"), [3.0, -90.0, 90.0, 0.0, 45.0, -5.0]);
    assert_eq!(ints(&machine, "EIGHTH", 2), [0, 80]);
    assert_eq!(six(&machine, "P2"), [700.0, 100.0, 450.0, 30.0, 0.0, 180.0]);
    assert_eq!(six(&machine, "J2"), [2.0, -90.0, 90.0, 0.0, 45.0, -5.0]);
    assert_eq!((int(&machine, "MOVE"), int(&machine, "TOOL")), (1, 1));
    assert_eq!(int(&machine, "SPEED"), 80);
    let Some(Value::Array(vis)) = machine.global("VIS") else {
        panic!("VIS is an array");
    };
    assert_eq!([&vis[2], &vis[4], &vis[5]], [&Value::Int(2); 3]);
    assert_eq!(
        reals(&machine, "MM_Plan_Results", 21),
        [
            9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 1.0, 2.0, 10.0, 0.0, 0.0, 0.0,
            1.0, 400.0, 300.0, 250.0
        ]
    );
    // The list of DOs, padded; only these outputs are on.
    assert_eq!(ints(&machine, "Do_Port", 5), [1, 3, -1, -1, 6]);
    let on: Vec<_> = cabinet.signals.iter().filter(|(_, v)| **v != 0.0).collect();
    assert_eq!(on.len(), 3);
    assert!(
        ["$OUT[1]", "$OUT[3]", "$OUT[6]"]
            .iter()
            .all(|n| cabinet.signals[*n] == 1.0)
    );
    // The server heard where the robot is.
    let Some(Job::RunVision {
        pose,
        recipe,
        box_size,
        ..
    }) = cabinet.jobs.first()
    else {
        panic!("the first job is that of vision");
    };
    let RobotPose::Current {
        joints: Some(joints),
        base_from_flange: Some(flange),
    } = pose
    else {
        panic!("joints and flange were sent");
    };
    assert!((joints.iter().next().expect("joints") - 10f64.to_radians()).abs() < 1e-6);
    assert!((flange.translation.vector - depal_frames::Vector::new(1.0, 0.2, 1.5)).norm() < 1e-6);
    assert_eq!(*recipe, Some(2));
    assert!(box_size.is_some());
    // The calibration drove through its poses, and back.
    assert_eq!(cabinet.moves.len(), 4);
    assert!(
        cabinet
            .moves
            .iter()
            .all(|m| m.kind == MoveKind::Joint && matches!(m.target, MoveTarget::Joints(_)))
    );
    // 660 bytes each time.
    assert_eq!(cabinet.sent.len(), 660 * cabinet.answered.len());
}

#[test]
fn all_commands_of_2_x_succeed() {
    let source = r#"DEF main( )
  BAS(#INITMOV,0)
  MM_Init_Socket("XML_Kuka_MMIND",873,871,60)
  MM_Get_Status(ST[1])
  MM_Switch_Model(1,2,ST[2])
  MM_Set_BoxSize(1,400.0,300.0,250.0,ST[3])
  MM_Start_Vis(1,0,1,HOME,ST[4])
  MM_Get_Notify(MESSAGE,ST[5])
  MM_Get_VisData(1,N[1],ST[6])
  MM_Get_Wobj(22,F1,LABEL[1],EIGHTH[1])
  MM_Start_Vis(2,0,3,HOME,ST[7])
  MM_Get_VisPath(2,2,N[2],VIS[2],ST[8])
  MM_Get_Pose(1,P1,LABEL[2],EIGHTH[2])
  MM_Start_Vis(3,0,2,HOME,ST[9])
  MM_Get_Dy_Data(3,N[3],ST[10])
  MM_Get_DyPose(1,P2,LABEL[3],OWN[])
  MM_Get_Property(1,ST[11],PROP)
  MM_Set_Property(2,ST[12])
  MM_Start_Viz(2,HOME,ST[13])
  MM_Set_Index(5,3,ST[14])
  MM_Set_Branch(7,1,ST[15])
  MM_Get_PlanData(0,3,N[4],VIS[4],ST[16])
  MM_Get_DoList(0,4,ST[17])
  MM_Set_DoList(2)
  MM_Stop_Viz(ST[18])
END
"#;
    let data = format!("DEFDAT MAIN PUBLIC\n{DATA}\nENDDAT\n");
    let files = [
        ("main.src", source),
        ("main.dat", data.as_str()),
        ("mm_module_2_x.src", MODULE_2_X),
        ("mm_module_2_x.dat", MODULE_2_X_DATA),
    ];
    let mut machine = task(&files, &[("XML_Kuka_MMIND.xml", CHANNEL)]);
    let mut cabinet = Cabinet::with_vision(Encoding::HexLittleEndian, Profile::v2_2());
    finished(&mut machine, &mut cabinet);
    assert_eq!(
        ints(&machine, "ST", 18),
        [
            9100, 1107, 1108, 1102, 0, 1100, 1102, 1103, 1102, 1100, 2109, 2108, 2103, 2106, 2105,
            2100, 2102, 2104
        ]
    );
    assert_eq!(int(&machine, "MESSAGE"), 77);
    assert_eq!(ints(&machine, "N", 4), [22, 3, 2, 3]);
    assert_eq!(
        six(&machine, "F1"),
        [2200.0, 100.0, 450.0, 30.0, 0.0, 180.0]
    );
    assert_eq!(reals(&machine, "OWN", 2), [1.5, 2.5]);
    // The second round only.
    assert_eq!(cabinet.signals["$OUT[6]"], 1.0);
    assert_eq!(cabinet.signals["$OUT[1]"], 0.0);
}
