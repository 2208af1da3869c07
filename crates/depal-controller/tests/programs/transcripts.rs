//! The same program on the vision server, recorded, and on the record of that.

use depal_controller::{
    Controller, ControllerSpec, ControllerState, Exchange, Network, RecordingNetwork,
    ReplayNetwork, SignalKind, SignalSpec, Transcript,
};
use depal_frames::JointPositions;
use depal_vm::{Machine, SourceFile};

use crate::harness::{Told, arm, drive_on};
use crate::vision_peer::VisionPeer;

const MODULE: &str = include_str!("../../../../assets/rapid/MM_Module.mod");

fn run(statements: &str, network: &mut dyn Network) -> Told {
    let main = format!(
        "MODULE m\nVAR num n;\nVAR num st;\nVAR num v;\nVAR socketdev s;\nVAR string text;\nPROC main()\n{statements}\nENDPROC\nENDMODULE\n"
    );
    let sources = [
        SourceFile::new("MM_Module.mod", MODULE),
        SourceFile::new("m.mod", main),
    ];
    let loaded = depal_rapid::load(&sources, &[], "main");
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .filter(|d| d.severity == depal_vm::Severity::Error)
        .map(|d| d.plain(&sources))
        .collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
    let home = JointPositions::from_degrees(&[90.0, -20.0, 20.0, 0.0, 90.0, 0.0]);
    let mut spec = ControllerSpec::new("rob1", arm(), home);
    spec.signals = vec![SignalSpec::new(
        "goVacuum",
        SignalKind::GroupOutput { bits: 16 },
    )];
    let mut controller = Controller::new(spec).expect("a cabinet");
    let program = loaded.program.expect("no errors");
    controller.set_task(Box::new(Machine::new(program, "T_ROB1").single_cycle()));
    drive_on(controller, &[], network, 120.0)
}

const DIALOGUE: &str = "MM_Init_Socket \"10.0.0.9\",50000,20;\nMM_Open_Socket;\nMM_Get_Status st;\nTPWrite \"state \"\\Num:=st;\nMM_Start_Vis 1,0,0,[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nMM_Get_VisData 1,n,st;\nTPWrite \"points \"\\Num:=n;\nMM_Close_Socket;";

#[test]
fn a_recorded_dialogue_plays_again() {
    let mut recording = RecordingNetwork::new(VisionPeer::new(5));
    recording.inner_mut().piece = 250;
    let first = run(DIALOGUE, &mut recording);
    assert_eq!(first.state, ControllerState::Finished);
    assert_eq!(first.lines, ["state 1101", "points 3"]);
    let transcript = recording.transcript().clone();
    assert_eq!(
        Transcript::parse(&transcript.to_text()),
        Ok(transcript.clone())
    );
    let mut replay = ReplayNetwork::new(&transcript);
    let second = run(DIALOGUE, &mut replay);
    assert_eq!(replay.difference(), None);
    assert_eq!(second.lines, first.lines);
    assert_eq!(second.events, first.events, "at the same times, too");
}

/// Another request than then ends the replay with its place.
#[test]
fn another_request_is_a_difference() {
    let mut recording = RecordingNetwork::new(VisionPeer::new(5));
    run(DIALOGUE, &mut recording);
    let mut replay = ReplayNetwork::new(recording.transcript());
    let told = run(
        &DIALOGUE.replace("MM_Start_Vis 1,0", "MM_Start_Vis 2,0"),
        &mut replay,
    );
    assert!(matches!(told.state, ControllerState::Failed(_)));
    let difference = replay.difference().expect("a difference");
    assert!(
        difference.ends_with("connection 1: sends 02, then 01"),
        "{difference}"
    );
}

/// Time-outs are simulated time, whatever the network: 2 s without a byte, then a late answer is read.
#[test]
fn time_outs_and_pieces_are_in_simulated_time() {
    let text = "0.0 1 connected 10.0.0.9:7\n0.1 1 sent 70696e67\n3.0 1 received 706f\n3.5 1 received 6e67\n4.0 1 peer-closed\n";
    let transcript = Transcript::parse(text).expect("a transcript");
    let mut replay = ReplayNetwork::new(&transcript);
    let statements = "SocketCreate s;\nSocketConnect s,\"10.0.0.9\",7;\nSocketSend s\\Str:=\"ping\";\nSocketReceive s\\Str:=text\\ReadNoOfBytes:=4\\Time:=2;\nTPWrite text;\nSocketReceive s\\Str:=text;\nERROR\nIF ERRNO=ERR_SOCK_TIMEOUT THEN\nTPWrite \"late\";\nRETRY;\nELSEIF ERRNO=ERR_SOCK_CLOSED THEN\nTPWrite \"closed\";\nENDIF";
    let told = run(statements, &mut replay);
    assert_eq!(told.lines, ["late", "pong", "closed"], "{:?}", told.state);
}

#[test]
fn a_transcript_with_a_mistake_names_its_line() {
    for (text, message) in [
        ("0 1 connected here\n", "line 1: \"here\" is no HOST:PORT"),
        (
            "# x\n\n0 1 sent 0g\n",
            "line 3: \"0g\" is no byte in hexadecimal",
        ),
        (
            "0 1 sent 012\n",
            "line 1: \"012\" are no bytes in hexadecimal",
        ),
        ("x 1 closed\n", "line 1: \"x\" is no time in seconds"),
        ("0 1\n", "line 1: the word is missing"),
    ] {
        let error = Transcript::parse(text).expect_err("a mistake");
        assert_eq!(error.to_string(), message);
    }
    let good = Transcript::parse("0.5 2 refused 10.0.0.9:80\n").expect("a transcript");
    assert_eq!(
        good.lines[0].exchange,
        Exchange::Refused("10.0.0.9".to_owned(), 80)
    );
}
