//! What programs do to the cabinet, and when.

use depal_time::{SimDuration, SimTime};
use depal_vm::execution::Step;

use crate::fake_system::*;

fn trace(text: &str, mut system: FakeSystem) -> String {
    let mut machine = machine(text);
    let end = run(&mut machine, &mut system);
    let end = match end {
        Step::Failed(error) => {
            let place = &error.call_stack[0];
            format!(
                "failed at {}/{}:{} {}: {}",
                place.module, place.routine, place.line, error.name, error.message
            )
        }
        other => format!("{other:?}"),
    };
    format!(
        "{}\n{:.3} {end}",
        system.trace.join("\n"),
        system.now.as_secs_f64()
    )
}

const MOVES: &str = "MODULE m
  PERS tooldata grip := [TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,100],[1,0,0,0],0,0,0]];
  PERS wobjdata pallet := [FALSE,TRUE,\"\",[[1000,0,0],[1,0,0,0]],[[0,200,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,10,20,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pick := [[100,0,50],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    AccSet 50, 100;
    MoveAbsJ home\\NoEOffs, v1000, z50, grip;
    SetDO do_pump, 1;
    MoveJ Offs(pick,0,0,100), v500, z10, grip \\WObj:=pallet;
    MoveL pick, v100, fine, grip \\WObj:=pallet;
    SetGO go_zone, 5;
    VelSet 50, 200;
    MoveL RelTool(pick,0,0,-10), v1000 \\V:=600, z5 \\Z:=7, grip \\WObj:=pallet;
    WaitRob \\InPos;
    SetDO do_pump, 0;
  ENDPROC
ENDMODULE";

#[test]
fn fly_by_moves_run_ahead_and_fine_waits() {
    insta::assert_snapshot!(trace(MOVES, FakeSystem::default()));
}

#[test]
fn a_refused_move_is_an_error_at_its_own_line() {
    let system = FakeSystem {
        refuse_move: Some(2),
        ..FakeSystem::default()
    };
    let trace = trace(MOVES, system);
    assert!(trace.ends_with("failed at m/main:11 ERR_ROBLIMIT: out of reach: the wrist would be 4.2 m away, at most 3.2 m"), "{trace}");
}

#[test]
fn waits_end_by_signal_or_by_time() {
    let text = "MODULE m
  VAR bool late;
  PROC main()
    WaitDI di_part, 1;
    TPWrite \"part\";
    WaitUntil gi_count >= 3 \\MaxTime:=2 \\TimeFlag:=late;
    TPWrite \"late \" \\Bool:=late;
    WaitDI di_part, 0 \\MaxTime:=0.5;
    TPWrite \"never\";
  ERROR
    IF ERRNO = ERR_WAIT_MAXTIME THEN TPWrite \"gave up\"; RETURN; ENDIF
  ENDPROC
ENDMODULE";
    let at = |seconds: f64| SimTime::ZERO + SimDuration::from_secs_f64(seconds);
    let system = FakeSystem {
        changes: vec![
            (at(1.0), "di_part".into(), 1.0),
            (at(1.5), "gi_count".into(), 3.0),
        ],
        ..FakeSystem::default()
    };
    insta::assert_snapshot!(trace(text, system));
    // Without the count the flag tells of the time.
    let system = FakeSystem {
        changes: vec![(at(1.0), "di_part".into(), 1.0)],
        ..FakeSystem::default()
    };
    assert!(trace(text, system).contains("late TRUE"));
}

const CLIENT: &str = "MODULE m
  VAR socketdev s;
  VAR rawbytes out;
  VAR rawbytes back;
  VAR num n;
  VAR num status;
  PROC main()
    SocketCreate s;
    SocketConnect s, \"127.0.0.1\", 50000 \\Time:=5;
    PackRawBytes 101, out, 1 \\IntX:=DINT;
    SocketSend s \\RawData:=out;
    SocketReceive s \\RawData:=back \\ReadNoOfBytes:=4 \\NoRecBytes:=n \\Time:=2;
    UnpackRawBytes back, 1, status \\IntX:=DINT;
    TPWrite \"status \" \\Num:=status;
    SocketClose s;
    IF SocketGetStatus(s) = SOCKET_CLOSED TPWrite \"closed\";
  ERROR
    IF ERRNO = ERR_SOCK_TIMEOUT THEN
      TPWrite \"time-out\";
      RETRY;
    ENDIF
    IF ERRNO = ERR_SOCK_CLOSED THEN
      TPWrite \"peer gone\";
      RETURN;
    ENDIF
  ENDPROC
ENDMODULE";

#[test]
fn a_socket_client_waits_for_its_bytes() {
    let system = FakeSystem {
        peer: Script::new([(SimDuration::from_millis(300), vec![78, 4, 0, 0])]),
        ..FakeSystem::default()
    };
    insta::assert_snapshot!(trace(CLIENT, system));
}

#[test]
fn a_receive_time_out_is_simulated_time_and_can_be_retried() {
    let system = FakeSystem {
        peer: Script::new([(SimDuration::from_millis(3000), vec![78, 4, 0, 0])]),
        ..FakeSystem::default()
    };
    insta::assert_snapshot!(trace(CLIENT, system));
}

#[test]
fn a_closed_peer_and_a_refused_connection_are_errors() {
    let system = FakeSystem {
        peer_closes_at: Some(SimTime::from_nanos(1_000_000_000)),
        ..FakeSystem::default()
    };
    assert!(trace(CLIENT, system).contains("peer gone"));
    let system = FakeSystem {
        connect_after: None,
        ..FakeSystem::default()
    };
    assert!(trace(CLIENT, system).contains("peer gone"));
    let system = FakeSystem {
        connect_after: Some(SimDuration::from_millis(90_000)),
        ..FakeSystem::default()
    };
    let slow = trace(CLIENT, system);
    assert!(slow.contains("ERR_EXCRTYMAX"), "{slow}");
}

#[test]
fn stop_waits_for_the_arm() {
    let text = "MODULE m\nCONST jointtarget home := [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nPROC main()\nMoveAbsJ home, v100, z10, tool0;\nStop;\nTPWrite \"never\";\nENDPROC\nENDMODULE";
    insta::assert_snapshot!(trace(text, FakeSystem::default()));
}

#[test]
fn positions_and_clocks_are_read() {
    let text = "MODULE m
  VAR clock c;
  VAR robtarget p;
  VAR jointtarget j;
  PERS tooldata grip := [TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,100],[1,0,0,0],0,0,0]];
  PROC main()
    ClkReset c; ClkStart c;
    WaitTime 1.5;
    ClkStop c;
    TPWrite \"clock \" \\Num:=ClkRead(c);
    p := CRobT(\\Tool:=grip \\WObj:=wobj0);
    TPWrite \"at \" \\Pos:=p.trans;
    j := CalcJointT(p, grip);
    TPWrite ValToStr(j.robax.rax_3);
    p.trans.x := 99999;
    j := CalcJointT(p, grip);
  ERROR
    IF ERRNO = ERR_ROBLIMIT TPWrite \"out of reach\";
    TRYNEXT;
  ENDPROC
ENDMODULE";
    insta::assert_snapshot!(trace(text, FakeSystem::default()));
}

/// A client with the traits of a real one: packed head, several packets, retries, a list of targets.
const LARGE: &str = "MODULE vision_client
  LOCAL CONST num MOST := 10;
  LOCAL CONST string ADDRESS := \"192.168.0.10\";
  LOCAL VAR socketdev link;
  LOCAL VAR num status;
  LOCAL VAR num labels{MOST};
  LOCAL VAR robtarget targets{MOST};
  LOCAL VAR num reopened;

  PROC send_request(num code \\num job \\switch WithPose)
    VAR rawbytes out;
    VAR jointtarget j;
    PackRawBytes code, out, 1 \\IntX:=DINT;
    IF Present(job) PackRawBytes job, out, RawBytesLen(out)+1 \\IntX:=DINT;
    IF Present(WithPose) THEN
      j := CJointT();
      PackRawBytes j.robax.rax_1, out, RawBytesLen(out)+1 \\Float4;
    ENDIF
    SocketSend link \\RawData:=out;
  ENDPROC

  FUNC num read_list(INOUT robtarget list{*}, \\INOUT num marks{*})
    VAR rawbytes head;
    VAR rawbytes body;
    VAR num count;
    VAR num at := 1;
    SocketReceive link \\RawData:=head \\ReadNoOfBytes:=8 \\Time:=1;
    UnpackRawBytes head, 1, status \\IntX:=DINT;
    UnpackRawBytes head, 5, count \\IntX:=DINT;
    IF count > Dim(list, 1) RAISE 42;
    FOR i FROM 1 TO count DO
      SocketReceive link \\RawData:=body \\ReadNoOfBytes:=8 \\Time:=1;
      UnpackRawBytes body, at, list{i}.trans.z \\Float4;
      list{i}.rot := OrientZYX(0, 0, 180);
      IF Present(marks) UnpackRawBytes body, at + 4, marks{i} \\IntX:=DINT;
    ENDFOR
    RETURN count;
  ERROR
    IF ERRNO = ERR_SOCK_TIMEOUT AND reopened < 2 THEN
      Incr reopened;
      RETRY;
    ENDIF
    RAISE;
  ENDFUNC

  PROC main()
    VAR num n;
    SocketCreate link;
    SocketConnect link, ADDRESS, 50000;
    send_request 105 \\job:=1, \\WithPose;
    n := read_list(targets, \\marks:=labels);
    TPWrite \"status \" \\Num:=status;
    FOR i FROM 1 TO n DO
      TEST labels{i}
      CASE 7:
        TPWrite \"box at \" \\Num:=targets{i}.trans.z;
        MoveL Offs(targets{i}, 0, 0, 100), v500, z20, tool0;
        MoveL targets{i}, v100, fine, tool0;
      DEFAULT:
        TPWrite \"unknown label \" \\Num:=labels{i};
      ENDTEST
    ENDFOR
    SocketClose link;
  ERROR
    IF ERRNO = 42 THEN
      TPWrite \"too many\";
      SocketClose link;
      RETURN;
    ENDIF
  ENDPROC
ENDMODULE";

fn list_reply(count: i32, items: &[(f32, i32)]) -> Vec<u8> {
    let mut bytes = 1103i32.to_le_bytes().to_vec();
    bytes.extend(count.to_le_bytes());
    for (z, label) in items {
        bytes.extend(z.to_le_bytes());
        bytes.extend(label.to_le_bytes());
    }
    bytes
}

#[test]
fn a_vision_client_reads_its_list_and_moves() {
    let reply = list_reply(2, &[(250.0, 7), (500.0, 9)]);
    let system = FakeSystem {
        peer: Script::new([(SimDuration::from_millis(1500), reply)]),
        ..FakeSystem::default()
    };
    insta::assert_snapshot!(trace(LARGE, system));
    let system = FakeSystem {
        peer: Script::new([(SimDuration::from_millis(10), list_reply(11, &[]))]),
        ..FakeSystem::default()
    };
    assert!(trace(LARGE, system).contains("too many"));
    let silent = trace(LARGE, FakeSystem::default());
    assert!(
        silent.contains("failed at") && silent.contains("ERR_SOCK_TIMEOUT: 0 of 8 bytes"),
        "{silent}"
    );
}

/// The mass of the tool in use goes with each move, `GripLoad` comes on top of it.
#[test]
fn the_load_of_the_tool_and_the_grip_load_reach_the_cabinet() {
    let text = MOVES.replace(
        "SetGO go_zone, 5;",
        "GripLoad [7,[0,10,120],[1,0,0,0],0,0,0];
    MoveAbsJ home\\NoEOffs, v1000, z50, tool0;
    GripLoad load0;",
    );
    let mut system = FakeSystem::default();
    assert_eq!(run(&mut machine(&text), &mut system), Step::Finished);
    assert_eq!(
        system.loads,
        [
            "tool 20 at 0.000 0.000 0.100",
            "carried 7 at 0.000 0.010 0.120",
            "tool 0.0010000000474974513 at 0.000 0.000 0.000",
            "carried 0.0010000000474974513 at 0.000 0.000 0.000",
            "tool 20 at 0.000 0.000 0.100",
        ]
    );
}

/// `\TLoad` stands for tool and payload together, for one move; `load0` there says nothing.
#[test]
fn a_total_load_counts_for_its_move_alone() {
    let text = MOVES.replace(
        "SetGO go_zone, 5;",
        "GripLoad [7,[0,10,120],[1,0,0,0],0,0,0];
    MoveL pick, v100, fine, grip \\TLoad:=[30,[0,0,150],[1,0,0,0],0,0,0];
    MoveJ pick, v100, fine, grip \\TLoad:=load0;
    MoveAbsJ home\\NoEOffs, v100, fine, grip \\TLoad:=[31,[0,0,150],[1,0,0,0],0,0,0];
    MoveJ pick, v100, fine, grip \\TLoad:=[32,[0,0,150],[1,0,0,0],0,0,0];
    MoveJDO pick, v100, fine, grip, do_pump, 0 \\TLoad:=[33,[0,0,150],[1,0,0,0],0,0,0];
    MoveLDO pick, v100, fine, grip, do_pump, 0 \\TLoad:=[34,[0,0,150],[1,0,0,0],0,0,0];",
    );
    let mut system = FakeSystem::default();
    assert_eq!(run(&mut machine(&text), &mut system), Step::Finished);
    let (told, nothing) = (
        "carried 7 at 0.000 0.010 0.120",
        "carried 0 at 0.000 0.000 0.000",
    );
    let own = "tool 20 at 0.000 0.000 0.100";
    let mut expected = vec![own.to_owned(), told.to_owned()];
    for mass in [30, 31, 32, 33, 34] {
        expected.push(format!("tool {mass} at 0.000 0.000 0.150"));
        expected.extend([nothing, told].map(str::to_owned));
        if mass == 30 {
            expected.push(own.to_owned());
        }
    }
    expected.push(own.to_owned());
    assert_eq!(system.loads, expected);
}
