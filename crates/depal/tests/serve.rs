//! `depal serve` as a robot meets it: the real program, real sockets on the loopback interface.
#![allow(missing_docs, clippy::disallowed_methods)]

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use served::{BINARY, FEW, Served, ask, client, is_closed, packed, reply};

mod served;

/// With one port, in text.
fn ascii() -> Served {
    Served::start(&[&["--listen", "ascii=127.0.0.1:0"], FEW].concat())
}

/// Another client is answered; the best of a few tries, so that a busy computer does not count.
fn check_alive(served: &Served) {
    let best = (0..5)
        .map(|_| {
            let started = Instant::now();
            assert_eq!(ask(&mut served.client(), "901"), "901,1101");
            started.elapsed()
        })
        .min()
        .expect("five tries");
    assert!(best < Duration::from_millis(50), "answered after {best:?}");
}

fn run_to_end(args: &[&str]) -> Output {
    Command::new(BINARY)
        .arg("serve")
        .args(args)
        .output()
        .expect("the program starts")
}

fn temporary(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

const TRIGGER: &str = "101,1,0,0,0,0,0,0,0,0";

#[test]
fn commands_come_in_any_pieces() {
    let served = ascii();
    let mut robot = served.client();
    for byte in b"901\r\n103,7,1\r\n999\r\n" {
        robot.write_all(&[*byte]).expect("sent");
    }
    assert_eq!(reply(&mut robot), "901,1101");
    assert_eq!(reply(&mut robot), "103,1011");
    assert_eq!(reply(&mut robot), "999,3001");
    // A thousand at once are answered in order.
    let many: Vec<String> = (0..1000).map(|n| format!("{}\r", 3000 + n)).collect();
    let many = many.concat();
    robot.write_all(many.as_bytes()).expect("sent");
    for n in 0..1000 {
        assert_eq!(reply(&mut robot), format!("{},3001", 3000 + n));
    }
    // Without a terminator, silence ends the command.
    robot.write_all(b"901").expect("sent");
    assert_eq!(reply(&mut robot), "901,1101");
    check_alive(&served);
}

#[test]
fn vision_results_wait_for_the_next_client_and_are_given_once() {
    let served = ascii();
    assert_eq!(ask(&mut served.client(), TRIGGER), "101,1102");
    let mut robot = served.client();
    let points = ask(&mut robot, "102,1");
    assert!(points.starts_with("102,1100,1,8,"), "{points}");
    assert_eq!(ask(&mut robot, "102,1"), "102,1002");
}

#[test]
fn a_waiting_command_holds_up_only_its_own_connection() {
    let served = ascii();
    let (mut waiting, mut other) = (served.client(), served.client());
    assert_eq!(ask(&mut waiting, TRIGGER), "101,1102");
    waiting.write_all(b"102,1\r901\r").expect("sent");
    let started = Instant::now();
    while started.elapsed() < Duration::from_millis(300) {
        assert_eq!(ask(&mut other, "901"), "901,1101");
    }
    assert!(reply(&mut waiting).starts_with("102,1100,"));
    assert_eq!(reply(&mut waiting), "901,1101");
}

#[test]
fn sessions_of_two_ports_do_not_touch() {
    let ports = ["--listen", "ascii=127.0.0.1:0", "--listen", "hex-le=:0"];
    let served = Served::start(&[&ports[..], FEW].concat());
    let mut text = served.client();
    assert_eq!(ask(&mut text, TRIGGER), "101,1102");
    // 102 on the other port: there, nothing was started.
    let mut packed = client(served.address(1));
    let mut request = [0; 64];
    request[0] = 102;
    request[4] = 1;
    packed.write_all(&request).expect("sent");
    let mut answer = [0; 660];
    packed.read_exact(&mut answer).expect("660 bytes");
    assert_eq!(answer[..8], [102, 0, 0, 0, 0xfc, 3, 0, 0], "1020");
    assert!(ask(&mut text, "102,1").starts_with("102,1100,1,8,"));
}

#[test]
fn a_closed_sending_side_still_gets_its_replies() {
    let served = ascii();
    let mut robot = served.client();
    robot
        .write_all(format!("{TRIGGER}\r102,1\r901").as_bytes())
        .expect("sent");
    robot.shutdown(Shutdown::Write).expect("a socket");
    let mut all = String::new();
    robot
        .read_to_string(&mut all)
        .expect("replies, then the end");
    let replies: Vec<&str> = all.split_terminator('\r').collect();
    assert_eq!(replies.len(), 3, "{all:?}");
    assert_eq!(replies[0], "101,1102");
    assert!(replies[1].starts_with("102,1100,1,8,"), "{all:?}");
    assert_eq!(replies[2], "901,1101");
}

#[test]
fn a_result_goes_past_a_client_that_has_closed() {
    let served = ascii();
    let mut gone = served.client();
    gone.write_all(format!("{TRIGGER}\r102,1\r").as_bytes())
        .expect("sent");
    assert_eq!(reply(&mut gone), "101,1102");
    drop(gone);
    assert!(ask(&mut served.client(), "102,1").starts_with("102,1100,1,8,"));
}

#[test]
fn a_reset_in_the_middle_of_replies_ends_only_that_client() {
    let served = ascii();
    for _ in 0..20 {
        let mut robot = served.client();
        robot
            .write_all("901\r".repeat(500).as_bytes())
            .expect("sent");
        let mut some = [0; 10];
        robot.read_exact(&mut some).expect("the first replies");
        // Closing with replies unread sends a reset.
        drop(robot);
    }
    check_alive(&served);
}

#[test]
fn what_is_no_command_is_cut() {
    let served = ascii();
    let mut endless = served.client();
    let _ = endless.write_all(&vec![b'7'; 100_000]);
    assert!(is_closed(&mut endless), "a line of 100,000 bytes");
    let mut tls = served.client();
    let mut hello = vec![0x16, 0x03, 0x01, 0x02, 0x00, 0x01, 0x00, 0x01, 0xfc];
    hello.resize(517, 0xa5);
    tls.write_all(&hello).expect("sent");
    assert!(is_closed(&mut tls), "a TLS hello");
    check_alive(&served);
}

#[test]
fn a_flood_does_not_delay_a_polite_client() {
    let served = ascii();
    let address = served.address(0);
    let floods: Vec<_> = (0..8)
        .map(|_| {
            std::thread::spawn(move || {
                let mut robot = client(address);
                let mut reader = robot.try_clone().expect("a socket");
                let counting = std::thread::spawn(move || {
                    let mut bytes = vec![0; 9 * 10_000];
                    reader.read_exact(&mut bytes).is_ok()
                });
                robot
                    .write_all("901\r".repeat(10_000).as_bytes())
                    .expect("sent");
                assert!(counting.join().expect("no panic"), "every reply came");
            })
        })
        .collect();
    let mut polite = served.client();
    let mut times = Vec::new();
    for _ in 0..20 {
        let started = Instant::now();
        assert_eq!(ask(&mut polite, "901"), "901,1101");
        times.push(started.elapsed());
    }
    times.sort();
    assert!(times[10] < Duration::from_millis(50), "{times:?}");
    for flood in floods {
        flood.join().expect("no panic");
    }
}

#[test]
fn a_port_holds_80_clients_and_refuses_the_129th() {
    let served = ascii();
    let mut clients: Vec<TcpStream> = (0..128).map(|_| served.client()).collect();
    for robot in &mut clients {
        assert_eq!(ask(robot, "901"), "901,1101");
    }
    assert!(is_closed(&mut served.client()), "the 129th");
    clients.truncate(100);
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(5) {
        let mut robot = served.client();
        let _ = robot.write_all(b"901\r");
        if robot.read(&mut [0; 9]).is_ok_and(|count| count > 0) {
            return;
        }
    }
    panic!("places that became free are not given again");
}

#[test]
fn sigterm_ends_cleanly_and_the_port_is_free_at_once() {
    let mut served = ascii();
    let address = served.address(0).to_string();
    let mut robot = served.client();
    assert_eq!(ask(&mut robot, "901"), "901,1101");
    let (code, time) = served.terminate();
    assert_eq!(code, Some(0));
    assert!(time < Duration::from_secs(2), "{time:?}");
    assert!(is_closed(&mut robot));
    let listen = format!("ascii={address}");
    let again = Served::start(&[&["--listen", &listen], FEW].concat());
    assert_eq!(ask(&mut again.client(), "901"), "901,1101");
}

#[test]
fn signals_end_it_cleanly_while_commands_wait() {
    for signal in ["-INT", "-TERM"] {
        let mut served = ascii();
        let mut waiting = served.client();
        assert_eq!(ask(&mut waiting, TRIGGER), "101,1102");
        waiting.write_all(b"102,1\r").expect("sent");
        let mut busy = served.client();
        busy.write_all("901\r".repeat(2_000).as_bytes())
            .expect("sent");
        assert_eq!(reply(&mut busy), "901,1101");
        let (code, time) = served.signal(signal);
        assert_eq!(code, Some(0), "{signal}");
        assert!(time < Duration::from_secs(2), "{signal}: {time:?}");
        // What came was whole replies.
        let mut rest = Vec::new();
        let _ = busy.read_to_end(&mut rest);
        assert_eq!(rest.len() % "901,1101\r".len(), 0, "{signal}");
        assert!(is_closed(&mut waiting));
    }
}

#[test]
fn settings_of_the_interface_can_be_set() {
    let with = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        Served::start(&[&["--listen", "ascii=127.0.0.1:0"], FEW, &set].concat())
    };
    let points = |served: &Served| {
        let mut robot = served.client();
        assert_eq!(ask(&mut robot, TRIGGER), "101,1102");
        let reply = ask(&mut robot, "102,1");
        let fields: Vec<f64> = reply
            .split(',')
            .map(|f| f.parse().expect("a number"))
            .collect();
        fields
    };
    let abb = points(&with(&[]));
    assert_eq!(abb[..4], [102.0, 1100.0, 1.0, 8.0]);
    let few = points(&with(&["interface.pose_cap=3"]));
    assert_eq!(few[..4], [102.0, 1100.0, 0.0, 3.0]);
    assert_eq!(few.len(), 5 + 3 * 8);
    // The same pose in the other brand's order: three angles the other way round.
    let fanuc = points(&with(&["interface.brand=fanuc"]));
    let angles = |points: &[f64]| [points[8], points[9], points[10]];
    let [z, y, x] = angles(&abb);
    assert_eq!(angles(&fanuc), [x, y, z]);
    assert_ne!(x, z, "else the order would not show");
    let hurried = with(&["interface.timeout_s=0.1"]);
    let mut robot = hurried.client();
    assert_eq!(ask(&mut robot, TRIGGER), "101,1102");
    assert_eq!(ask(&mut robot, "102,1"), "102,1019");
    assert_eq!(ask(&mut robot, "601"), "601,0");
}

#[test]
fn faults_on_demand_come_from_the_command_line_and_are_replayed() {
    let path = temporary("faulty.jsonl");
    let journal = path.to_string_lossy().into_owned();
    let faults = [
        "--inject",
        "status=1019@command=102,n=1;drop_connection@reply=4",
        "--inject",
        "split_replies@command=901",
        "--journal",
        &journal,
    ];
    let mut served = Served::start(&[&["--listen", "ascii=127.0.0.1:0"], FEW, &faults].concat());
    let mut robot = served.client();
    assert_eq!(ask(&mut robot, TRIGGER), "101,1102");
    assert_eq!(ask(&mut robot, "102,1"), "102,1019");
    assert_eq!(ask(&mut robot, "901"), "901,1101");
    robot.write_all(b"901\r").expect("sent");
    assert!(is_closed(&mut robot));
    let mut next = served.client();
    assert!(ask(&mut next, "102,1").starts_with("102,1100,1,8,"));
    drop(next);
    assert_eq!(served.terminate().0, Some(0));
    let same = run_to_end(&["--replay", &journal, "--json"]);
    assert_eq!(same.status.code(), Some(0), "{same:?}");

    let wrong = run_to_end(&["--inject", "statuss=1019@command=102"]);
    assert_eq!(wrong.status.code(), Some(2));
    let told = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(told.contains("did you mean \"status\"?"), "{told}");
}

#[test]
fn exit_codes_name_the_mistake() {
    let taken = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("bound").to_string();
    let output = run_to_end(&["--listen", &format!("ascii={address}")]);
    assert_eq!(output.status.code(), Some(3));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains(&address), "{text}");
    for wrong in [
        "morse=127.0.0.1:0",
        "s7=127.0.0.1:0",
        "ascii",
        "ascii=nowhere",
    ] {
        let output = run_to_end(&["--listen", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
}

#[test]
fn a_journal_is_answered_the_same_again() {
    let path = temporary("journal.jsonl");
    let journal = path.to_string_lossy().into_owned();
    let args = ["--listen", "ascii=127.0.0.1:0", "--journal", &journal];
    let mut served = Served::start(&[&args[..], FEW].concat());
    let mut robot = served.client();
    assert_eq!(ask(&mut robot, TRIGGER), "101,1102");
    assert!(ask(&mut robot, "102,1").starts_with("102,1100,"));
    assert_eq!(ask(&mut robot, "201,0,0,0,0,0,0,0"), "201,2103");
    ask(&mut robot, "205,2");
    robot.write_all(b"901").expect("sent");
    assert_eq!(reply(&mut robot), "901,1101");
    drop(robot);
    assert_eq!(served.terminate().0, Some(0));

    let same = run_to_end(&["--replay", &journal, "--json"]);
    assert_eq!(same.status.code(), Some(0), "{same:?}");
    let verdict: serde_json::Value = serde_json::from_slice(&same.stdout).expect("JSON");
    assert_eq!(verdict["replies"], 5);

    // One digit of one recorded reply changed: the first difference is told.
    let text = std::fs::read_to_string(&path).expect("it is there");
    let changed = text.replacen("101,1102", "101,1103", 1).replacen(
        "3130312c313130320d",
        "3130312c313130330d",
        1,
    );
    assert_ne!(text, changed);
    std::fs::write(&path, changed).expect("writable");
    let other = run_to_end(&["--replay", &journal]);
    assert_eq!(other.status.code(), Some(1));
    let told = String::from_utf8_lossy(&other.stderr).into_owned();
    assert!(told.contains("recorded") && told.contains("1103"), "{told}");
}

#[test]
fn the_encoding_is_found_out_where_that_is_asked_for_and_only_there() {
    let ports = ["--listen", "auto=127.0.0.1:0", "--listen", "hex-be=:0"];
    let set = ["--set", "interface.encoding=auto"];
    let served = Served::start(&[&ports[..], &set[..], FEW].concat());
    let (auto, fixed) = (served.address(0), served.address(1));
    assert_eq!(ask(&mut client(auto), "901"), "901,1101");
    let little = 901i32.to_le_bytes();
    assert_eq!(packed(auto, i32::from_le_bytes, little), [901, 1101]);
    let big = 901i32.to_be_bytes();
    assert_eq!(packed(auto, i32::from_be_bytes, big), [901, 1101]);
    assert_eq!(packed(fixed, i32::from_be_bytes, big), [901, 1101]);
    // With a wrong byte order nothing is understood.
    assert_eq!(packed(fixed, i32::from_be_bytes, little)[1], 3001);
}
