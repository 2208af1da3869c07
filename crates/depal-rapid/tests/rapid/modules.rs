//! The interface modules in `assets/rapid`: they compile, and what they send is what the transcripts in
//! `tests/golden/wire` hold; the answers there are what they get.

use depal_frames::{EulerConvention, JointPositions};
use depal_rapid::load;
use depal_time::SimDuration;
use depal_vm::execution::Step;
use depal_vm::{Machine, SourceFile, Value};

use crate::fake_system::*;

const V1_7: &str = include_str!("../../../../assets/rapid/MM_Module_1_7.mod");
const V1_8: &str = include_str!("../../../../assets/rapid/MM_Module.mod");
const V2_X: &str = include_str!("../../../../assets/rapid/MM_Module_2_x.mod");
const AUTO_CALIB: &str = include_str!("../../../../assets/rapid/MM_Auto_Calib.mod");
const COM_TEST: &str = include_str!("../../../../assets/rapid/MM_Com_Test.mod");

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
        include_str!(concat!("../../../../tests/golden/wire/", $name))
    };
}

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
    system.replies = wanted
        .iter()
        .map(|(_, answer)| (SimDuration::from_millis(5), answer.clone()))
        .collect();
    let end = run(&mut machine, &mut system);
    let place = format!("{} {statements}", version.name);
    assert_eq!(end, Step::Finished, "{place}: {:?}", system.trace);
    assert_eq!(
        system.sent.len(),
        wanted.len(),
        "{place}: number of requests"
    );
    for (sent, (expected, _)) in system.sent.iter().zip(wanted) {
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

#[test]
fn commands_without_data() {
    let start = golden!("101_start_vision.txt");
    plain(start, 0, "MM_Start_Vis 1,0,0,jGolden", 1102.0);
    plain(start, 1, "MM_Start_Vis 1,0,1,jGolden", 1102.0);
    plain(start, 2, "MM_Start_Vis 1,0,2,jGolden", 1102.0);
    plain(start, 3, "MM_Start_Vis 1,5,3,jGolden", 1102.0);
    plain(
        golden!("103_switch_recipe.txt"),
        0,
        "MM_Switch_Model 1,2",
        1107.0,
    );
    let of = |text: &str, status: u16| {
        let found = exchanges(text)
            .into_iter()
            .position(|(_, answer)| answer[4..6] == status.to_le_bytes());
        found.expect("a success in the transcript")
    };
    let at = |text: &str, status: u16| {
        exchanges(text)
            .into_iter()
            .nth(of(text, status))
            .expect("just found")
            .0
    };
    let cell = |frame: &[u8], index: usize| {
        i32::from_le_bytes(
            frame[4 * index..4 * index + 4]
                .try_into()
                .expect("four bytes"),
        )
    };
    let real = |frame: &[u8], index: usize| {
        f32::from_le_bytes(
            frame[4 * index..4 * index + 4]
                .try_into()
                .expect("four bytes"),
        )
    };
    for (text, status, name, ints) in [
        (golden!("203_set_branch.txt"), 2105, "MM_Set_Branch", 2),
        (golden!("204_set_index.txt"), 2106, "MM_Set_Index", 2),
    ] {
        let frame = at(text, status);
        let arguments: Vec<_> = (1..=ints).map(|i| cell(&frame, i).to_string()).collect();
        plain(
            text,
            of(text, status),
            &format!("{name} {}", arguments.join(",")),
            f64::from(status),
        );
    }
    let boxes = golden!("501_set_box_size.txt");
    let frame = at(boxes, 1108);
    let call = format!(
        "MM_Set_BoxSize {},{},{},{}",
        cell(&frame, 1),
        real(&frame, 2),
        real(&frame, 3),
        real(&frame, 4)
    );
    plain(boxes, of(boxes, 1108), &call, 1108.0);
    let viz = golden!("201_start_viz.txt");
    for (index, (frame, answer)) in exchanges(viz).iter().enumerate() {
        if answer[4..6] == 2103u16.to_le_bytes() {
            plain(
                viz,
                index,
                &format!("MM_Start_Viz {},jGolden", cell(frame, 1)),
                2103.0,
            );
        }
    }
    for version in VERSIONS {
        for (text, status, name) in [
            (golden!("202_stop_viz.txt"), 2104, "MM_Stop_Viz st;"),
            (golden!("901_get_state.txt"), 1101, "MM_Get_Status st;"),
        ] {
            let at = of(text, status);
            let (machine, _) = call_one(version, name, text, at);
            assert_eq!(num(&machine, "st"), f64::from(status));
        }
        let text = golden!("208_write_parameter.txt");
        let index = of(text, 2108);
        let id = cell(&exchanges(text)[index].0, 1);
        let (machine, _) = call_one(version, &format!("MM_Set_Property {id},st;"), text, index);
        assert_eq!(num(&machine, "st"), 2108.0);
        let text = golden!("207_read_parameter.txt");
        let index = of(text, 2109);
        let (request, answer) = &exchanges(text)[index];
        let (machine, _) = call_one(
            version,
            &format!("MM_Get_Property {},st,v;", cell(request, 1)),
            text,
            index,
        );
        assert_eq!(num(&machine, "v"), f64::from(real(answer, 2)));
    }
}

fn call_one(version: Version, statement: &str, text: &str, at: usize) -> (Machine, FakeSystem) {
    call(version, statement, &exchanges(text)[at..=at])
}

/// A waypoint of the Viz transcripts: the second one, 210 in all its formats and 205.
#[test]
fn paths_are_fetched_and_stored() {
    let text = golden!("210_get_plan_data.txt");
    let all = exchanges(text);
    for format in 1..=4u8 {
        let rounds: Vec<_> = all
            .iter()
            .filter(|(request, answer)| {
                request[0] == 210 && request[4] == format && answer[4..6] == 2100u16.to_le_bytes()
            })
            .take(3)
            .cloned()
            .collect();
        assert_eq!(rounds.len(), 3, "format {format}");
        for version in VERSIONS {
            let store = if format % 2 == 1 {
                "MM_Get_PlanJps 2,1,j,a,b,c;"
            } else {
                "MM_Get_PlanPose 2,2,p,a,b,c;"
            };
            let statements = format!("MM_get_plandata 0,{format},n,v,st;\n{store}");
            let (machine, _) = call(version, &statements, &rounds);
            let found = ["n", "v", "st", "a", "b", "c"].map(|name| num(&machine, name));
            assert_eq!(
                found,
                [3.0, 2.0, 2100.0, 2.0, 1.0, 40.0],
                "{} {format}",
                version.name
            );
            let target = if format % 2 == 1 { "j" } else { "p" };
            let Value::Record(fields) = global(&machine, target) else {
                panic!("a record");
            };
            let Value::Record(first) = &fields[0] else {
                panic!("robax or trans");
            };
            let expected = if format % 2 == 1 { 1.5 } else { 600.0 };
            assert_eq!(first[0].as_number(), Some(expected));
            if format > 2 {
                let Value::Array(plan) = global(&machine, "MM_Plan_Results") else {
                    panic!("an array");
                };
                let plan: Vec<_> = plan.iter().filter_map(Value::as_number).collect();
                assert_eq!(plan[..2], [3.0, 3.0]);
                assert_eq!(plan[18..], [600.0, 400.0, 200.0]);
            }
        }
    }
    let text = golden!("dialogue_f_heads.txt");
    let path = exchanges(text)
        .into_iter()
        .find(|(r, a)| r[0] == 205 && a[4..6] == 2100u16.to_le_bytes());
    let path = [path.expect("a path")];
    for version in VERSIONS {
        let statements = "MM_Get_VizData 1,n,v,st;\nMM_Get_Jps 2,j,a,b;";
        let (machine, _) = call(version, statements, &path);
        let found = ["n", "v", "st", "a", "b"].map(|name| num(&machine, name));
        assert_eq!(found, [3.0, 2.0, 2100.0, 3.0, 40.0], "{}", version.name);
    }
}

/// Points in several parts are joined; labels and the place of the Vision Move count over all.
#[test]
fn points_are_fetched_and_stored() {
    for (text, code, status, statement) in [
        (
            golden!("102_get_vision_points.txt"),
            102u8,
            1100u16,
            "MM_Get_VisData 1,n,st;",
        ),
        (
            golden!("105_get_vision_path.txt"),
            105,
            1103,
            "MM_Get_VisPath",
        ),
    ] {
        // From the first part up to the one that says that it is the last.
        let all = exchanges(text);
        let mut parts = Vec::new();
        for (request, answer) in all {
            if request[0] == code && answer[4..6] == status.to_le_bytes() {
                let last = answer[8] == 1;
                parts.push((request, answer));
                if last {
                    break;
                }
            }
        }
        assert!(!parts.is_empty());
        let cell = |frame: &[u8], index: usize| {
            i32::from_le_bytes(frame[4 * index..4 * index + 4].try_into().expect("four"))
        };
        let request = &parts[0].0;
        let (job, kind) = (cell(request, 1), cell(request, 2));
        let statement = if code == 105 {
            format!("{statement} {job},{kind},n,v,st;")
        } else {
            statement.replace(" 1,", &format!(" {job},"))
        };
        let count: i32 = parts.iter().map(|(_, answer)| cell(answer, 3)).sum();
        let (_, last) = parts.last().expect("a part");
        let label_at = 5 + 8 * (cell(last, 3) as usize - 1) + 6;
        let label = cell(last, label_at);
        for version in VERSIONS {
            let store = if code == 105 && kind == 1 {
                "MM_Get_Jps n,j,a,b;"
            } else {
                "MM_Get_Pose n,p,a,b;"
            };
            let (machine, _) = call(version, &format!("{statement}\n{store}"), &parts);
            assert_eq!(num(&machine, "n"), f64::from(count), "{}", version.name);
            assert_eq!(num(&machine, "st"), f64::from(status));
            assert_eq!(num(&machine, "a"), f64::from(label));
        }
    }
}

#[test]
fn the_do_list_switches_on_its_bits() {
    let text = golden!("dialogue_f_heads.txt");
    let list = exchanges(text)
        .into_iter()
        .find(|(request, _)| request[0] == 206);
    let list = [list.expect("a list")];
    for version in VERSIONS {
        // DO 1 and 3 of the list; the group begins with 0.
        let statements = if version.status {
            "MM_Get_DoList 0,0,st;\nMM_Set_DoList 1,1,go_zone;"
        } else {
            "MM_Get_DoList 0;\nMM_Set_DoList 1,go_zone;"
        };
        let (_, system) = call(version, statements, &list);
        assert_eq!(system.signals["go_zone"], 10.0, "{}", version.name);
    }
    // In rounds of one slot: only the second slot's DO 3.
    let mut asked = list.clone();
    asked[0].0[4] = 1;
    let statements = "MM_Get_DoList 0,1,st;\nMM_Set_DoList 2,1,go_zone;";
    let (_, system) = call(VERSIONS[2], statements, &asked);
    assert_eq!(system.signals["go_zone"], 8.0);
}

#[test]
fn messages_and_custom_data() {
    let text = golden!("601_get_notify.txt");
    let found = exchanges(text)
        .into_iter()
        .find(|(request, answer)| request[..2] == 601u16.to_le_bytes() && answer[4] != 0);
    let notify = [found.expect("a message")];
    let message = i32::from_le_bytes(notify[0].1[4..8].try_into().expect("four"));
    for version in VERSIONS {
        let (machine, _) = call(version, &call_of(version, "MM_Get_Notify v"), &notify);
        assert_eq!(num(&machine, "v"), f64::from(message));
    }
    let text = golden!("110_get_custom_data.txt");
    let mut parts = Vec::new();
    for (request, answer) in exchanges(text) {
        if answer[4..6] == 1100u16.to_le_bytes() {
            let last = answer[8] == 1;
            parts.push((request, answer));
            if last {
                break;
            }
        }
    }
    let cell = |frame: &[u8], index: usize| {
        i32::from_le_bytes(frame[4 * index..4 * index + 4].try_into().expect("four"))
    };
    let job = cell(&parts[0].0, 1);
    let (_, last) = parts.last().expect("a part");
    let elements = cell(last, 3) as usize;
    let first = f32::from_le_bytes(last[4 * 11..4 * 12].try_into().expect("four"));
    assert!(elements > 0);
    for version in VERSIONS {
        let statements = format!("MM_Get_DyData {job},n,st;\nMM_Get_DyPose n,p,a;");
        let (machine, _) = call(version, &statements, &parts);
        assert_eq!(num(&machine, "n"), parts.len() as f64);
        let Value::Array(data) = global(&machine, "MM_UserData") else {
            panic!("an array");
        };
        assert_eq!(
            data[0].as_number(),
            Some(f64::from(first)),
            "{}",
            version.name
        );
        assert_eq!(data[elements].as_number(), Some(0.0), "the rest is cleared");
    }
}

/// Both one-shot commands: what they send holds the arm, what they get is stored.
#[test]
fn one_shot_commands() {
    for (text, code) in [
        (golden!("100_run_vision.txt"), 100u8),
        (golden!("200_run_viz.txt"), 200),
    ] {
        let success = if code == 100 { 1100u16 } else { 2100 };
        let found = exchanges(text)
            .into_iter()
            .find(|(request, answer)| request[0] == code && answer[4..6] == success.to_le_bytes());
        let one = [found.expect("a success")];
        let cell = |index: usize| {
            i32::from_le_bytes(one[0].0[4 * index..4 * index + 4].try_into().expect("four"))
        };
        let name = if code == 100 {
            "MM_Lite_Vis"
        } else {
            "MM_Lite_Viz"
        };
        let statements = format!(
            "{name} {},{},{},st,\\Pos_Num:=n,\\VisPos_Num:=v;",
            cell(1),
            cell(2),
            cell(3)
        );
        let count = i32::from_le_bytes(one[0].1[12..16].try_into().expect("four"));
        for version in VERSIONS {
            // The transcript's arm stands elsewhere: only the head is compared.
            let mut machine = loaded(
                version.text,
                &format!(
                    "{}\n{statements}",
                    match (version.each, version.status) {
                        (true, _) => "",
                        (_, true) => "MM_Open_Socket st;",
                        _ => "MM_Open_Socket;",
                    }
                ),
            );
            let mut system = FakeSystem::default();
            arm(&mut system);
            system
                .replies
                .push_back((SimDuration::from_millis(5), one[0].1.clone()));
            assert_eq!(
                run(&mut machine, &mut system),
                Step::Finished,
                "{:?}",
                system.trace
            );
            assert_eq!(system.sent[0][..16], one[0].0[..16], "{}", version.name);
            same(&system.sent[0][16..40], &joints_cells(), version.name);
            assert_eq!(num(&machine, "st"), f64::from(success));
            if cell(3) != 2 || code == 200 {
                assert_eq!(num(&machine, "n"), f64::from(count));
            }
        }
    }
}

fn joints_cells() -> Vec<u8> {
    [0.0f32, -20.0, 10.0, 0.0, 60.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect()
}

/// Answers of another byte order, of another command, in pieces, and none.
#[test]
fn trouble_has_its_codes() {
    let good = exchanges(golden!("901_get_state.txt")).remove(0);
    let one = |reply: Vec<u8>| [(good.0.clone(), reply)];
    for version in VERSIONS {
        let state = |reply: Vec<u8>| {
            let (machine, _) = call(version, "MM_Get_Status st;", &one(reply));
            num(&machine, "st")
        };
        let mut swapped = good.1.clone();
        swapped[4..8].reverse();
        assert_eq!(state(swapped), 3096.0);
        let mut other = good.1.clone();
        other[0] = 101;
        assert_eq!(state(other), 3096.0);
        assert_eq!(state(Vec::new()), 3098.0, "nothing came");
        assert_eq!(state(good.1[..600].to_vec()), 3098.0, "too little came");
        assert_eq!(state(good.1.clone()), 1101.0);
    }
    // Refused: an error in 1.x, a status in 2.x.
    let refused = exchanges(golden!("103_switch_recipe.txt"))
        .into_iter()
        .find(|(_, a)| a[4..6] != 1107u16.to_le_bytes());
    let refused = [refused.expect("a refusal")];
    let cell = |index: usize| {
        i32::from_le_bytes(
            refused[0].0[4 * index..4 * index + 4]
                .try_into()
                .expect("four"),
        )
    };
    let code = i32::from_le_bytes(refused[0].1[4..8].try_into().expect("four"));
    let name = format!("MM_Switch_Model {},{}", cell(1), cell(2));
    let (machine, _) = call(VERSIONS[2], &format!("{name},st;"), &refused);
    assert_eq!(num(&machine, "st"), f64::from(code));
    for version in &VERSIONS[..2] {
        let handled = format!("{name};\nERROR\nIF ERRNO=MM_ERR_STATUS TRYNEXT;");
        let (machine, _) = call(*version, &handled, &refused);
        assert_eq!(num(&machine, "MM_Last_Status"), f64::from(code));
    }
}

/// The calibration: state, flange, joints there; the next pose back; the arm drives to each, and to the last.
#[test]
fn calibration_is_driven_to_its_end() {
    let text = golden!("dialogue_d_calibration.txt");
    let all = exchanges(text);
    let rounds: Vec<_> = {
        let mut rounds = Vec::new();
        for (request, answer) in all {
            if answer[..2] != 701u16.to_le_bytes() {
                continue;
            }
            let done = answer[8] == 1;
            rounds.push((request, answer));
            if done {
                break;
            }
        }
        rounds
    };
    assert!(rounds.len() >= 2);
    for version in VERSIONS {
        let main = "MM_Auto_Calib;";
        let text = format!("{}\n{AUTO_CALIB}", version.text);
        let mut machine = loaded(&text, main);
        let mut system = FakeSystem::default();
        arm(&mut system);
        system.replies = rounds
            .iter()
            .map(|(_, answer)| (SimDuration::from_millis(5), answer.clone()))
            .collect();
        let end = run(&mut machine, &mut system);
        assert_eq!(end, Step::Finished, "{} {:?}", version.name, system.trace);
        assert_eq!(system.sent.len(), rounds.len());
        for (sent, (expected, _)) in system.sent.iter().zip(&rounds) {
            // Command and state; the arm of the fake stands still.
            assert_eq!(sent[..8], expected[..8], "{}", version.name);
            assert_eq!(sent.len(), 64);
        }
        // To the start, then to every pose that was given, the last one included.
        assert_eq!(system.moves.len(), rounds.len() + 1, "{}", version.name);
        let last = system.trace.last().map(String::as_str);
        assert!(
            system
                .trace
                .iter()
                .any(|line| line == "MM: calibration finished"),
            "{last:?}"
        );
    }
}

/// A pose that cannot be reached is told with state 2, and the refusal ends the calibration.
#[test]
fn calibration_tells_what_it_cannot_reach() {
    let mut first = exchanges(golden!("dialogue_d_calibration.txt")).remove(0).1;
    // X of the pose: 90 m.
    first[12..16].copy_from_slice(&90_000f32.to_le_bytes());
    let mut refusal = vec![0; 660];
    refusal[..2].copy_from_slice(&701u16.to_le_bytes());
    refusal[4..6].copy_from_slice(&7004u16.to_le_bytes());
    for version in VERSIONS {
        let statements = "MM_Calib 1,1,0;\nERROR\nIF ERRNO=MM_ERR_STATUS TRYNEXT;";
        let mut machine = loaded(version.text, statements);
        let replies = [first.clone(), refusal.clone()]
            .map(|reply| (SimDuration::from_millis(5), reply))
            .into();
        let mut system = FakeSystem {
            replies,
            ..FakeSystem::default()
        };
        assert_eq!(
            run(&mut machine, &mut system),
            Step::Finished,
            "{:?}",
            system.trace
        );
        assert_eq!(system.sent.len(), 2);
        assert_eq!(system.sent[1][4], 2, "state 2");
        assert!(system.moves.is_empty());
        assert_eq!(num(&machine, "MM_Last_Status"), 7004.0);
    }
}

#[test]
fn the_communication_test_tells_what_is_wrong() {
    let good = exchanges(golden!("901_get_state.txt")).remove(0).1;
    let result = |reply: Option<Vec<u8>>, connects: bool| {
        let main = "MODULE user\nPROC main()\nMM_Com_Test;\nENDPROC\nENDMODULE\n";
        let sources = [
            SourceFile::new("t.mod", COM_TEST),
            SourceFile::new("u.mod", main),
        ];
        let loaded = load(&sources, &[], "main");
        let shown: Vec<_> = loaded
            .diagnostics
            .iter()
            .map(|d| d.plain(&sources))
            .collect();
        assert!(shown.is_empty(), "{}", shown.join("\n"));
        let mut machine = Machine::new(loaded.program.expect("no errors"), "T_ROB1");
        let mut system = FakeSystem::default();
        if !connects {
            system.connect_after = None;
        }
        system.replies = reply
            .into_iter()
            .map(|reply| (SimDuration::from_millis(12), reply))
            .collect();
        assert_eq!(
            run(&mut machine, &mut system),
            Step::Finished,
            "{:?}",
            system.trace
        );
        if connects {
            assert_eq!(system.sent[0].len(), 64);
            assert_eq!(system.sent[0][..4], 901u32.to_le_bytes());
        }
        (num(&machine, "MM_Com_Result"), system.trace)
    };
    let (passed, trace) = result(Some(good.clone()), true);
    assert_eq!(passed, 0.0, "{trace:?}");
    assert!(
        trace
            .iter()
            .any(|line| line == "MM test: passed, status 1101"),
        "{trace:?}"
    );
    assert_eq!(result(None, false).0, 1.0);
    assert_eq!(result(None, true).0, 2.0);
    let mut swapped = good.clone();
    swapped[4..8].reverse();
    assert_eq!(result(Some(swapped), true).0, 4.0);
    let mut busy = good;
    busy[4..6].copy_from_slice(&1007u16.to_le_bytes());
    assert_eq!(result(Some(busy), true).0, 5.0);
}
