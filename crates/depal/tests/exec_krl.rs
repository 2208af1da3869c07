//! `depal exec` with KRL programs as a user runs it, alone and against a served vision system.
#![allow(missing_docs, clippy::disallowed_methods)]

mod robot_program;

use std::io::{Read, Write};
use std::net::TcpListener;

use robot_program::{asset, depal, folder, route, serve, told};

const ALL: [(&str, &str); 2] = [
    (
        "all_commands.src",
        include_str!("robot_program/all_commands.src"),
    ),
    (
        "all_commands.dat",
        include_str!("robot_program/all_commands.dat"),
    ),
];

fn module() -> [String; 3] {
    ["mm_module.src", "mm_module.dat", "XML_Kuka_MMIND.xml"]
        .map(|f| asset(&format!("assets/krl/{f}")))
}

#[test]
fn every_subprogram_succeeds_and_a_lost_connection_needs_no_new_server() {
    let folder = folder("krl_all", &ALL);
    let [source, data, channel] = module();
    let served = serve("hex-le", "kuka", &["--inject", "drop_connection@reply=8"]);
    let route = route(&served);
    let arguments = [
        "exec",
        ALL[0].0,
        ALL[1].0,
        &source,
        &data,
        "--eki",
        &channel,
        "--connect",
        &route,
    ];
    let output = depal(&folder, &arguments);
    let (_, stderr) = told(&output);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("command refused, status 3097"), "{stderr}");
    let output = depal(&folder, &arguments);
    let (stdout, stderr) = told(&output);
    assert_eq!(
        (output.status.code(), stdout.as_str()),
        (Some(0), ""),
        "{stderr}"
    );
    let after = |word: &str| -> Vec<String> {
        let lines = stderr.lines().filter_map(|line| line.split_once(word));
        lines.map(|(_, rest)| rest.to_owned()).collect()
    };
    let codes = ["1101", "1100", "1103", "1100", "2100", "2100", "2100"];
    assert_eq!(after(" s status "), codes, "{stderr}");
    assert_eq!(after(" s points "), ["8", "5", "8", "4", "4", "4"]);
    assert_eq!(after(" s output "), ["3", "5"]);
    assert_eq!(after(" s own data "), ["1 2 3"]);
    assert_eq!(after(" s size "), ["400 300 250"]);
}

#[test]
fn a_server_of_the_other_byte_order_is_told() {
    let folder = folder("krl_order", &ALL);
    let [source, data, channel] = module();
    let served = serve("hex-be", "kuka", &[]);
    let output = depal(
        &folder,
        &[
            "exec",
            ALL[0].0,
            ALL[1].0,
            &source,
            &data,
            "--eki",
            &channel,
            "--connect",
            &route(&served),
        ],
    );
    assert!(told(&output).1.contains("status 3096"), "{output:?}");
}

const CHANNEL: &str = r#"<ETHERNETKRL>
<CONFIGURATION><EXTERNAL><IP>192.168.1.9</IP><PORT>59152</PORT></EXTERNAL>
<INTERNAL><BUFFERING Mode="FIFO" Limit="10"/><ALIVE Set_Flag="11"/></INTERNAL></CONFIGURATION>
<RECEIVE><XML><ELEMENT Tag="Cmd/N" Type="INT"/><ELEMENT Tag="Cmd" Set_Flag="12"/></XML></RECEIVE>
<SEND><XML><ELEMENT Tag="Robot/N"/><ELEMENT Tag="Robot/B"/></XML></SEND>
</ETHERNETKRL>"#;

/// Documents that come together, and one in two pieces, over a real socket.
#[test]
fn documents_are_read_in_their_order() {
    let source = "DEF x( )
DECL EKI_STATUS ret
DECL INT n,i
ret=EKI_Init(\"ch\")
ret=EKI_Open(\"ch\")
WAIT FOR $FLAG[11]
ret=EKI_SetInt(\"ch\",\"Robot/N\",41)
ret=EKI_SetBool(\"ch\",\"Robot/B\",TRUE)
ret=EKI_Send(\"ch\",\"Robot\")
FOR i=1 TO 3
 WAIT FOR $FLAG[12]
 $FLAG[12]=FALSE
 ret=EKI_GetInt(\"ch\",\"Cmd/N\",n)
 MsgNotify(\"got %1\",\"x\",n)
ENDFOR
END
";
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let port = listener.local_addr().expect("bound").port();
    let peer = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a robot");
        let mut sent = [0; 100];
        let count = stream.read(&mut sent).expect("a document");
        let documents = b"<Cmd><N>1</N></Cmd><Cmd><N>2</N></Cmd><Cmd><N>";
        stream.write_all(documents).expect("sent");
        std::thread::sleep(std::time::Duration::from_millis(100));
        stream.write_all(b"3</N></Cmd>").expect("sent");
        let _ = stream.read(&mut [0; 8]);
        String::from_utf8(sent[..count].to_vec()).expect("text")
    });
    let folder = folder("krl_documents", &[("x.src", source), ("ch.xml", CHANNEL)]);
    let route = format!("192.168.1.9:59152=127.0.0.1:{port}");
    let output = depal(
        &folder,
        &[
            "exec",
            "x.src",
            "--eki",
            "ch.xml",
            "--connect",
            &route,
            "--max-sim-s",
            "20",
        ],
    );
    assert_eq!(
        peer.join().expect("served"),
        "<Robot><N>41</N><B>1</B></Robot>"
    );
    let (_, stderr) = told(&output);
    let got: Vec<_> = stderr
        .lines()
        .filter_map(|line| line.split_once("got "))
        .map(|(_, n)| n)
        .collect();
    assert_eq!(got, ["1", "2", "3"], "{stderr}");
}

/// A .sub file runs beside the robot and works on the same data, flags and outputs.
#[test]
fn a_submit_program_runs_beside_the_robot() {
    let main = "DEF main( )\nWAIT FOR level > 4\nMsgNotify(\"level %1\",\"main\",level)\nWAIT FOR $FLAG[7]\nMsgNotify(\"out %1\",\"main\",$OUT[3])\nEND\n";
    let data = "DEFDAT main PUBLIC\nDECL GLOBAL INT level=0\nENDDAT\n";
    let watch = "DEF watch( )\nLOOP\nlevel=level+1\nWAIT SEC 0.1\nIF level==7 THEN\n$OUT[3]=TRUE\n$FLAG[7]=TRUE\nENDIF\nENDLOOP\nEND\n";
    let files = [("main.src", main), ("main.dat", data), ("watch.sub", watch)];
    let folder = folder("krl_submit", &files);
    let arguments = ["exec", "main.src", "main.dat"];
    let output = depal(&folder, &[&arguments[..], &["watch.sub"]].concat());
    let (_, stderr) = told(&output);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(
        stderr.contains("level 5") && stderr.contains("out TRUE"),
        "{stderr}"
    );
    // Without it nobody raises the level.
    let alone = depal(&folder, &[&arguments[..], &["--json"]].concat());
    assert!(told(&alone).0.contains("\"end\":\"idle\""), "{alone:?}");
}

#[test]
fn errors_have_their_line_and_bad_input_starts_nothing() {
    let body =
        |line: &str| format!("DEF e( )\nDECL INT i,k,a[3]\nDECL REAL r,u\ni=9\nr=1\n{line}\nEND\n");
    for (line, word) in [
        ("i=1/(i-i)", "division by zero"),
        ("a[i]=1", "outside 1..3"),
        ("i=k", "no value"),
        ("r=u", "no value"),
    ] {
        let folder = folder("krl_errors", &[("e.src", &body(line))]);
        let output = depal(&folder, &["exec", "e.src", "--no-kinematics"]);
        let (_, stderr) = told(&output);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(
            stderr.starts_with("e/e:6: ") && stderr.contains(word),
            "{stderr}"
        );
    }
    let files = [
        ("u.src", &*body("i=nowhere")),
        ("i.src", &body("IF i==1 THEN")),
        ("h.src", &body("HALT")),
    ];
    let folder = folder("krl_bad", &files);
    let code = |arguments: &[&str]| depal(&folder, arguments).status.code();
    assert_eq!(code(&["exec", "u.src"]), Some(2));
    assert_eq!(code(&["exec", "i.src", "--entry", "e"]), Some(2));
    assert_eq!(code(&["exec", "h.src", "--entry", "e"]), Some(0));
    assert_eq!(code(&["exec", "h.src", "--entry", "nowhere"]), Some(2));
    assert_eq!(
        code(&["exec", "h.src", "--entry", "e", "--eki", "gone.xml"]),
        Some(2)
    );
    assert_eq!(code(&["exec", "gone.src"]), Some(2));
}
