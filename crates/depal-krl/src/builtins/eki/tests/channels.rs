//! The calls of the language on channels of their own.

use depal_vm::system::SocketId;

use super::cabinet::Cabinet;
use super::*;

const XML: &str = r#"<ETHERNETKRL><CONFIGURATION><EXTERNAL><IP>10.0.0.2</IP><PORT>5000</PORT></EXTERNAL>
<INTERNAL><ALIVE Set_Flag="1" Set_Out="5"/></INTERNAL></CONFIGURATION>
<RECEIVE><XML><ELEMENT Tag="Plc/Speed" Type="REAL"/><ELEMENT Tag="Plc/Count" Type="INT"/><ELEMENT Tag="Plc/Go" Type="BOOL"/>
<ELEMENT Tag="Plc/Name" Type="STRING"/><ELEMENT Tag="Plc/Pos" Type="FRAME"/><ELEMENT Tag="Plc" Set_Flag="2"/></XML></RECEIVE>
<SEND><XML><ELEMENT Tag="Robot/Speed"/><ELEMENT Tag="Robot/Count"/><ELEMENT Tag="Robot/Go"/><ELEMENT Tag="Robot/Name"/>
<ELEMENT Tag="Robot/Pos"/></XML></SEND></ETHERNETKRL>"#;

const LINES: &str = r#"<ETHERNETKRL><CONFIGURATION><EXTERNAL><TYPE>Client</TYPE></EXTERNAL>
<INTERNAL><IP>0.0.0.0</IP><PORT>54600</PORT><ALIVE Set_Flag="11"/></INTERNAL></CONFIGURATION>
<RECEIVE><RAW><ELEMENT Tag="Line" Type="STREAM" EOS="13,10" Set_Flag="12"/></RAW></RECEIVE>
<SEND><RAW><ELEMENT Tag="Out" Type="STREAM" EOS="10"/></RAW></SEND></ETHERNETKRL>"#;

const DATA: &str = "
DECL EKI_STATUS RET
DECL INT NO[12]
DECL REAL SPEED,SPEEDS[3]
DECL INT COUNT,COUNTS[3]
DECL BOOL GO,ALIVE
DECL CHAR NAME[8]
DECL FRAME POS";

fn program(body: &str) -> Machine {
    let source = format!("DEF main( )\n{body}\nEND\n");
    let data = format!("DEFDAT MAIN PUBLIC\n{DATA}\nENDDAT\n");
    let files = [("main.src", source.as_str()), ("main.dat", data.as_str())];
    task(&files, &[("Plc.xml", XML), ("Lines.xml", LINES)])
}

fn text(machine: &Machine, name: &str) -> String {
    let Some(Value::Array(codes)) = machine.global(name) else {
        panic!("{name} is no text");
    };
    let codes = codes.iter().map_while(Value::as_number);
    codes.map(|code| char::from(code as u8)).collect()
}

#[test]
fn documents_come_and_go() {
    let mut machine = program(
        r#"
  RET=EKI_Init("Plc")
  RET=EKI_Open("Plc")
  ALIVE=$FLAG[1]
  RET=EKI_SetReal("Plc","Robot/Speed",1.5)
  RET=EKI_SetInt("Plc","Robot/Count",-3)
  RET=EKI_SetBool("Plc","Robot/Go",TRUE)
  RET=EKI_SetString("Plc","Robot/Name","a<b")
  RET=EKI_SetFrame("Plc","Robot/Pos",{X 1.0,Y 2.0,Z 3.0,A 4.0,B 5.0,C 6.0})
  RET=EKI_Send("Plc","Robot")
  WAIT FOR $FLAG[2]
  $FLAG[2]=FALSE
  RET=EKI_CheckBuffer("Plc","Plc/Speed")
  NO[1]=RET.Buff
  RET=EKI_GetReal("Plc","Plc/Speed",SPEED)
  NO[2]=RET.Read
  NO[3]=RET.Buff
  RET=EKI_GetRealArray("Plc","Plc/Speed",SPEEDS[])
  NO[4]=RET.Read
  RET=EKI_GetInt("Plc","Plc/Count",COUNT)
  RET=EKI_GetBool("Plc","Plc/Go",GO)
  RET=EKI_GetString("Plc","Plc/Name",NAME[])
  RET=EKI_GetFrame("Plc","Plc/Pos",POS)
  NO[5]=RET.Msg_No
  RET=EKI_GetInt("Plc","Plc/Count",COUNT)
  NO[6]=RET.Msg_No
  RET=EKI_Close("Plc")
  RET=EKI_Clear("Plc")
  NO[7]=RET.Msg_No
  RET=EKI_Send("Plc","Robot")
  NO[8]=RET.Msg_No"#,
    );
    let mut cabinet = Cabinet::new();
    let document = b"<Plc><Speed>2.5</Speed><Speed>3</Speed><Speed>4</Speed><Count>7</Count><Go>TRUE</Go><Name>box</Name>\
<Pos X='1' Y='2' Z='3' A='4' B='5' C='6'/></Plc>";
    cabinet
        .inbox
        .entry(SocketId(1))
        .or_default()
        .extend(document);
    finished(&mut machine, &mut cabinet);
    let sent = String::from_utf8(cabinet.sent.clone()).expect("text");
    assert_eq!(
        sent,
        "<Robot><Speed>1.500000</Speed><Count>-3</Count><Go>1</Go><Name>a&lt;b</Name>\
         <Pos X=\"1.000000\" Y=\"2.000000\" Z=\"3.000000\" A=\"4.000000\" B=\"5.000000\" C=\"6.000000\"/></Robot>"
    );
    assert_eq!(machine.global("ALIVE"), Some(&Value::Bool(true)));
    assert_eq!(machine.global("SPEED"), Some(&Value::Num(2.5)));
    assert_eq!(reals(&machine, "SPEEDS", 2), [3.0, 4.0]);
    assert_eq!(int(&machine, "COUNT"), 7);
    assert_eq!(machine.global("GO"), Some(&Value::Bool(true)));
    assert_eq!(text(&machine, "NAME"), "box");
    assert_eq!(six(&machine, "POS"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(ints(&machine, "NO", 8), [3, 1, 2, 2, 0, 15, 0, 9]);
    // The output of ALIVE fell when the channel was closed.
    assert_eq!(cabinet.signals["$OUT[5]"], 0.0);
}

/// Three documents in one piece: the flag rises for each that is still to be read, and for no other.
#[test]
fn the_flag_rises_for_each_document() {
    let three =
        b"<Plc><Count>1</Count></Plc><Plc><Count>2</Count></Plc><Plc><Count>3</Count></Plc>";
    let run = |body: &str| {
        let source = format!(
            "RET=EKI_Init(\"Plc\")\nRET=EKI_Open(\"Plc\")\nCOUNT=0\nCOUNTS[1]=0\nCOUNTS[2]=0\nCOUNTS[3]=0\n{body}"
        );
        let mut machine = program(&source);
        let mut cabinet = Cabinet::new();
        let inbox = cabinet.inbox.entry(SocketId(1)).or_default();
        inbox.extend(three);
        finished(&mut machine, &mut cabinet);
        ints(&machine, "COUNTS", 3)
    };
    let reset = "$FLAG[2]=FALSE";
    let read = |n: u32| format!("RET=EKI_GetInt(\"Plc\",\"Plc/Count\",COUNTS[{n}])");
    for first in [true, false] {
        let rounds = (1..=3).map(|n| {
            let (a, b) = if first {
                (reset.to_owned(), read(n))
            } else {
                (read(n), reset.to_owned())
            };
            format!("WAIT FOR $FLAG[2]\n{a}\n{b}")
        });
        let body = rounds.collect::<Vec<_>>().join("\n");
        assert_eq!(run(&body), [1, 2, 3], "reset first: {first}");
    }
    // An interrupt sees each edge, too; the first rise was before it.
    let interrupt = format!(
        "INTERRUPT DECL 4 WHEN $FLAG[2]==TRUE DO take( )\nINTERRUPT ON 4\n{reset}\nWAIT SEC 0.5\nEND\nDEF take( )\n{reset}\nCOUNT=COUNT+1\nRET=EKI_GetInt(\"Plc\",\"Plc/Count\",COUNTS[COUNT])"
    );
    assert_eq!(run(&interrupt), [1, 2, 0]);
    // All read at once: nothing is left to tell of.
    let at_once = format!(
        "WAIT FOR $FLAG[2]\nRET=EKI_GetIntArray(\"Plc\",\"Plc/Count\",COUNTS[])\n{reset}\nWAIT SEC 0.5\nIF $FLAG[2] THEN\nCOUNTS[1]=99\nENDIF"
    );
    assert_eq!(run(&at_once), [1, 2, 3]);
}

#[test]
fn the_robot_can_be_the_server() {
    let mut machine = program(
        r#"
  RET=EKI_Init("Lines")
  RET=EKI_Open("Lines")
  NO[1]=RET.Msg_No
  WAIT FOR $FLAG[11]
  WAIT FOR $FLAG[12]
  RET=EKI_GetString("Lines","Line",NAME[])
  NO[2]=RET.Counter
  RET=EKI_Send("Lines","hello")
  WAIT FOR NOT $FLAG[11]
  RET=EKI_GetString("Lines","Line",NAME[])
  NO[3]=RET.Msg_No"#,
    );
    let mut cabinet = Cabinet::new();
    let mut lost = false;
    for _ in 0..10_000 {
        match machine.step(&mut cabinet) {
            Step::Ran => cabinet.advance(SimDuration::from_micros(20)),
            Step::Blocked => cabinet.advance(TICK),
            end => {
                assert_eq!(end, Step::Finished, "{:?}", cabinet.log);
                break;
            }
        }
        if cabinet.listens == Some(54600) && !lost && cabinet.now.as_secs_f64() > 0.5 {
            cabinet.caller = true;
            // The listener is socket 1, the connection socket 2.
            let line = cabinet.inbox.entry(SocketId(2)).or_default();
            line.extend(b"one\r\n");
            lost = true;
        }
        if !cabinet.sent.is_empty() {
            cabinet.is_closed = true;
        }
    }
    assert_eq!(cabinet.sent, b"hello\n");
    assert_eq!(text(&machine, "NAME"), "one");
    assert_eq!(ints(&machine, "NO", 3), [0, 1, 512]);
}

#[test]
fn flags_of_a_channel_order_interrupts() {
    let source = r#"DEF main( )
  GLOBAL INTERRUPT DECL 5 WHEN $FLAG[2]==TRUE DO Arrived( )
  INTERRUPT ON 5
  RET=EKI_Init("Plc")
  RET=EKI_Open("Plc")
  WAIT SEC 1.0
END
DEF Arrived( )
  COUNT=COUNT+1
  $FLAG[2]=FALSE
END
"#;
    let data = format!(
        "DEFDAT MAIN PUBLIC\n{}\nENDDAT\n",
        DATA.replace("COUNT,", "COUNT=0\nDECL INT ")
    );
    let files = [("main.src", source), ("main.dat", data.as_str())];
    let mut machine = task(&files, &[("Plc.xml", XML)]);
    let mut cabinet = Cabinet::new();
    cabinet
        .inbox
        .entry(SocketId(1))
        .or_default()
        .extend(b"<Plc><Count>1</Count></Plc>");
    finished(&mut machine, &mut cabinet);
    assert_eq!(int(&machine, "COUNT"), 1);
}

#[test]
fn calls_that_cannot_be_served_say_why() {
    let mut machine = program(
        r#"
  RET=EKI_Open("Plc")
  NO[1]=RET.Msg_No
  RET=EKI_Init("Nothing")
  NO[2]=RET.Msg_No
  RET=EKI_Init("Plc")
  NO[3]=RET.Msg_No
  RET=EKI_Init("Plc")
  NO[4]=RET.Msg_No
  RET=EKI_Send("Plc","Robot")
  NO[5]=RET.Msg_No
  RET=EKI_Open("Plc")
  NO[6]=RET.Msg_No
  RET=EKI_Open("Plc")
  NO[7]=RET.Msg_No
  RET=EKI_GetInt("Plc","Plc/Wrong",COUNT)
  NO[8]=RET.Msg_No
  EKI_CHECK(RET,#NOTIFY)
  EKI_CHECK(RET,#QUIT)"#,
    );
    let mut cabinet = Cabinet::new();
    let end = run(&mut machine, &mut cabinet);
    let Step::Failed(error) = end else {
        panic!("expected a run-time error, found {end:?}");
    };
    assert!(error.message.contains("EKI00014"), "{}", error.message);
    assert_eq!(ints(&machine, "NO", 8), [9, 3, 0, 23, 10, 0, 24, 14]);
    assert!(
        cabinet
            .log
            .iter()
            .any(|l| l == "EKI00003 Nothing: no configuration file Nothing.xml; known: Lines, Plc"),
        "{:?}",
        cabinet.log
    );
}

#[test]
fn a_clone_of_a_task_has_its_own_channels() {
    let mut machine = program(
        "  RET=EKI_Init(\"Plc\")\n  WAIT SEC 0.1\n  RET=EKI_Init(\"Plc\")\n  NO[1]=RET.Msg_No",
    );
    let mut cabinet = Cabinet::new();
    let mut copy = machine.clone();
    finished(&mut machine, &mut cabinet);
    finished(&mut copy, &mut cabinet);
    assert_eq!(ints(&machine, "NO", 1), [23]);
    assert_eq!(ints(&copy, "NO", 1), [23]);
}

#[test]
fn what_is_wrong_with_a_channel_file_has_its_place() {
    let files = [depal_syntax::SourceFile::new(
        "main.src",
        "DEF main( )\nEND\n",
    )];
    let channel = depal_syntax::SourceFile::new(
        "folder/Plc.xml",
        XML.replace("<PORT>5000</PORT>", "\n  <PORT>0</PORT>\n"),
    );
    let loaded = crate::with_channels(
        crate::load(&files, &[], "main"),
        1,
        std::slice::from_ref(&channel),
    );
    assert!(loaded.has_errors());
    let all = [files[0].clone(), channel];
    let says: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.one_line(&all))
        .collect();
    assert_eq!(
        says,
        [
            "folder/Plc.xml:1:1: error[EKI0001]: CONFIGURATION/EXTERNAL/PORT: missing: the port of the server to connect to",
            "folder/Plc.xml:2:3: error[EKI0001]: CONFIGURATION/EXTERNAL/PORT: expected a whole number from 1 to 65534, found \"0\"",
        ]
    );
}

#[test]
fn the_program_of_the_scene_loads() {
    let source = include_str!("../../../../../../scenes/kuka.src");
    let data = include_str!("../../../../../../scenes/kuka.dat");
    let names = ["kuka.src", "kuka.dat", "mm_module.src", "mm_module.dat"];
    let files: Vec<_> = names
        .into_iter()
        .zip([source, data, MODULE, MODULE_DATA])
        .map(|(name, text)| depal_syntax::SourceFile::new(name, text))
        .collect();
    let mut signals: Vec<_> = (1..=16).map(|n| format!("$OUT[{n}]")).collect();
    signals.push("$IN[1]".into());
    let channel = depal_syntax::SourceFile::new("XML_Kuka_MMIND.xml", CHANNEL);
    let loaded = crate::with_channels(
        crate::load(&files, &signals, "kuka"),
        files.len(),
        &[channel],
    );
    let says: Vec<_> = loaded.diagnostics.iter().map(|d| d.plain(&files)).collect();
    assert_eq!(says, Vec::<String>::new());
    assert!(loaded.program.is_some());
}
