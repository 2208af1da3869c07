//! The interface modules in `assets/rapid`: they compile, and what they send is what the transcripts in
//! `tests/golden/wire` hold; the answers there are what they get.

use depal_frames::{EulerConvention, JointPositions};
use depal_rapid::load;
use depal_syntax::SourceFile;
use depal_time::SimDuration;
use depal_vm::execution::Step;
use depal_vm::{Machine, Value};

use crate::fake_system::*;

const V1_7: &str = include_str!("../../../../../assets/rapid/MM_Module_1_7.mod");
const V1_8: &str = include_str!("../../../../../assets/rapid/MM_Module.mod");
const V2_X: &str = include_str!("../../../../../assets/rapid/MM_Module_2_x.mod");
const AUTO_CALIB: &str = include_str!("../../../../../assets/rapid/MM_Auto_Calib.mod");
const COM_TEST: &str = include_str!("../../../../../assets/rapid/MM_Com_Test.mod");

/// A version: its text, whether its procedures all have a status, whether each opens its own connection.
#[derive(Clone, Copy)]
struct Version {
    name: &'static str,
    text: &'static str,
    status: bool,
    each: bool,
}

const VERSIONS: [Version; 3] = [
    Version {
        name: "1.7",
        text: V1_7,
        status: false,
        each: true,
    },
    Version {
        name: "1.8",
        text: V1_8,
        status: false,
        each: false,
    },
    Version {
        name: "2.x",
        text: V2_X,
        status: true,
        each: false,
    },
];

macro_rules! golden {
    ($name:literal) => {
        include_str!(concat!("../../../../../tests/golden/wire/", $name))
    };
}

mod calibration;
mod commands;
mod paths;
mod trouble;

fn bytes(line: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    for word in line.split_whitespace().filter(|word| *word != "|") {
        match word.strip_prefix('+') {
            Some(zeros) => bytes.resize(bytes.len() + zeros.parse::<usize>().expect("zeros"), 0),
            None => bytes.push(u8::from_str_radix(word, 16).expect("a byte")),
        }
    }
    bytes
}

/// Requests of a transcript with their answers, one by one.
fn exchanges(text: &str) -> Vec<(Vec<u8>, Vec<u8>)> {
    let mut exchanges = Vec::new();
    let mut request = None;
    for line in text.lines() {
        if let Some(sent) = line.strip_prefix("-> hex-le ") {
            request = Some(bytes(sent));
        } else if let Some(answer) = line.strip_prefix("<- hex-le ")
            && let Some(request) = request.take()
        {
            exchanges.push((request, bytes(answer)));
        }
    }
    exchanges
}

/// The same cells: floats within a thousandth and whole turns, all else to the bit.
fn same(sent: &[u8], expected: &[u8], place: &str) {
    assert_eq!(sent.len(), expected.len(), "{place}");
    for (index, (a, b)) in sent.chunks(4).zip(expected.chunks(4)).enumerate() {
        let real = |cell: &[u8]| f32::from_le_bytes(cell.try_into().expect("four bytes"));
        let turned = |turn: f32| (real(a) - real(b) - turn).abs() < 1e-3;
        assert!(
            a == b || turned(0.0) || turned(360.0) || turned(-360.0),
            "{place}: cell {index} is {a:?}, expected {b:?}"
        );
    }
}

/// The arm of the transcripts.
fn arm(system: &mut FakeSystem) {
    let joints = JointPositions::from_degrees(&[0.0, -20.0, 10.0, 0.0, 60.0, 0.0]);
    let pose = [549.56, 50.0, 647.01, 180.0, -1.0, 180.0];
    let flange = EulerConvention::AbbZyx.pose_from_mm_deg(pose);
    system.arm = Some((joints, flange));
}

fn loaded(module: &str, statements: &str) -> Machine {
    let main = format!(
        "MODULE user\nCONST jointtarget jGolden:=[[0,-20,10,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nVAR num n:=-1;\nVAR num v:=-1;\nVAR num st:=-1;\nVAR robtarget p;\nVAR jointtarget j;\nVAR num a;\nVAR num b;\nVAR num c;\nPROC main()\nMM_Init_Socket \"10.0.0.1\",50000,60;\n{statements}\nENDPROC\nENDMODULE\n"
    );
    let sources = [
        SourceFile::new("module.mod", module),
        SourceFile::new("user.mod", main),
    ];
    let loaded = load(&sources, &signals(), "main");
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(&sources))
        .collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
    Machine::new(loaded.program.expect("no errors"), "T_ROB1")
}

/// Calls a procedure against exchanges of a transcript; the machine afterwards.
#[track_caller]
fn call(
    version: Version,
    statements: &str,
    wanted: &[(Vec<u8>, Vec<u8>)],
) -> (Machine, FakeSystem) {
    let open = match (version.each, version.status) {
        (true, _) => "",
        (_, true) => "MM_Open_Socket st;",
        _ => "MM_Open_Socket;",
    };
    let mut machine = loaded(version.text, &format!("{open}\n{statements}"));
    let mut system = FakeSystem::default();
    arm(&mut system);
    system.peer.replies = wanted
        .iter()
        .map(|(_, answer)| (SimDuration::from_millis(5), answer.clone()))
        .collect();
    let end = run(&mut machine, &mut system);
    let place = format!("{} {statements}", version.name);
    assert_eq!(end, Step::Finished, "{place}: {:?}", system.trace);
    assert_eq!(
        system.peer.sent.len(),
        wanted.len(),
        "{place}: number of requests"
    );
    for (sent, (expected, _)) in system.peer.sent.iter().zip(wanted) {
        same(sent, expected, &place);
    }
    (machine, system)
}

fn num(machine: &Machine, name: &str) -> f64 {
    global(machine, name).as_number().expect("a number")
}

/// The call as 1.x writes it, and with the status of 2.x behind.
fn call_of(version: Version, call: &str) -> String {
    if version.status {
        format!("{call},st;")
    } else {
        format!("{call};")
    }
}

/// A command without data in its answer: the frame, and the success.
#[track_caller]
fn plain(transcript: &str, at: usize, statement: &str, success: f64) {
    let wanted = &exchanges(transcript)[at..=at];
    for version in VERSIONS {
        let (machine, _) = call(version, &call_of(version, statement), wanted);
        assert_eq!(num(&machine, "MM_Last_Status"), success, "{}", version.name);
        if version.status {
            assert_eq!(num(&machine, "st"), success);
        }
    }
}

#[test]
fn the_versions_share_their_internals() {
    const MARK: &str = "-- internals --";
    let internals = |text: &'static str| text.split_once(MARK).expect("the mark").1;
    assert_eq!(internals(V1_7), internals(V1_8));
    assert_eq!(internals(V2_X), internals(V1_8));
    assert!(internals(V1_8).lines().count() > 300);
}

/// All 29 procedures of the interface are in each version.
#[test]
fn every_procedure_is_there() {
    const PROCEDURES: [&str; 29] = [
        "MM_Init_Socket",
        "MM_Open_Socket",
        "MM_Close_Socket",
        "MM_Start_Vis",
        "MM_Get_VisData",
        "MM_Get_Pose",
        "MM_Get_Jps",
        "MM_Switch_Model",
        "MM_Get_VisPath",
        "MM_Lite_Vis",
        "MM_Get_DyData",
        "MM_Get_DyPose",
        "MM_Get_DoList",
        "MM_Set_DoList",
        "MM_Start_Viz",
        "MM_Set_Branch",
        "MM_Set_Index",
        "MM_Get_VizData",
        "MM_Lite_Viz",
        "MM_get_plandata",
        "MM_Get_PlanPose",
        "MM_Get_PlanJps",
        "MM_Get_Property",
        "MM_Set_Property",
        "MM_Set_BoxSize",
        "MM_Get_Notify",
        "MM_Calib",
        "MM_Stop_Viz",
        "MM_Get_Status",
    ];
    for version in VERSIONS {
        for name in PROCEDURES {
            let heading = format!("\n  PROC {name}(");
            assert!(
                version.text.contains(&heading),
                "{} has no {name}",
                version.name
            );
        }
        assert_eq!(
            version.text.matches("\n  PROC ").count(),
            PROCEDURES.len(),
            "{}",
            version.name
        );
        loaded(version.text, "");
    }
}

fn call_one(version: Version, statement: &str, text: &str, at: usize) -> (Machine, FakeSystem) {
    call(version, statement, &exchanges(text)[at..=at])
}
