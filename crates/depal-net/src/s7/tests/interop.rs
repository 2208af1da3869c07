//! Against other people's implementations, both ways round.
//!
//! `DEPAL_INTEROP=1` installs python-snap7 from the package index into a folder below the target folder;
//! without it, and where a package cannot be installed, that part is skipped with a line that says so.

use std::io::{BufRead as _, BufReader};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use depal_wire::s7::Field;
use rust7::client::S7Client as Rust7;

use super::vision::Vision;
use crate::s7::PlcAddress;

const HANDSHAKES: usize = 100;

/// Two tests want the same version: the second waits until the first has installed it.
static INSTALLING: Mutex<()> = Mutex::new(());

/// Where the package is installed, unless it cannot be.
fn installed(version: &str) -> Option<PathBuf> {
    if std::env::var_os("DEPAL_INTEROP").is_none() {
        println!("skipped: python-snap7 {version}, as DEPAL_INTEROP is not set");
        return None;
    }
    let _one_at_a_time = INSTALLING.lock().unwrap_or_else(PoisonError::into_inner);
    // The test program lies in target/<profile>/deps.
    let program = std::env::current_exe().expect("a program");
    let target = program.ancestors().nth(3).expect("a target folder");
    let folder = target.join("tmp").join(format!("python-snap7-{version}"));
    let python = folder.join("bin").join("python");
    let works = |python: &Path| {
        let found = Command::new(python)
            .args([
                "-c",
                "import importlib.metadata as m; print(m.version('python-snap7'))",
            ])
            .output();
        found.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).trim() == version)
    };
    if !works(&python) {
        let package = format!("python-snap7=={version}");
        let install = [
            Command::new("python3")
                .args(["-m", "venv"])
                .arg(&folder)
                .output(),
            Command::new(&python)
                .args(["-m", "pip", "install", "--quiet", &package])
                .output(),
        ];
        if !works(&python) {
            let said = install.iter().map(|step| match step {
                Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
                Err(error) => error.to_string(),
            });
            let said: Vec<String> = said.collect();
            println!(
                "skipped: {package} cannot be installed: {}",
                said.join("; ")
            );
            return None;
        }
    }
    Some(python)
}

/// Runs the script; what it says at its end.
fn peer(python: &Path, mode: &str, port: u16, start: impl FnOnce()) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/interop/snap7_peer.py");
    let mut child = Command::new(python)
        .arg(script)
        .args([mode, &port.to_string(), &HANDSHAKES.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python starts");
    let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
    let ready = lines.next().and_then(Result::ok).unwrap_or_default();
    if ready == "ready" {
        start();
    }
    let last = lines.map_while(Result::ok).last().unwrap_or_default();
    let output = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{mode}: {ready} {last} {said}");
    println!("{mode}: {last}");
    assert!(last.contains("handshakes"), "{mode}: {last}");
}

fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("bound").port()
}

/// Our client on their server, while their program writes, too.
fn their_plc(version: &str) {
    let Some(python) = installed(version) else {
        return;
    };
    let port = free_port();
    let mut vision = None;
    peer(&python, "plc", port, || {
        let address = ([127, 0, 0, 1], port).into();
        vision = Some(Vision::at(PlcAddress {
            poll: Duration::from_millis(5),
            ..PlcAddress::new(address)
        }));
    });
    let vision = vision.expect("it was ready");
    assert_eq!(vision.run_count(), HANDSHAKES.div_ceil(3));
    let told = vision.told.lock().expect("alive").clone();
    assert!(told[0].contains("telegrams of 480 bytes"), "{told:?}");
}

/// Their client on our block.
fn their_client(version: &str) {
    let Some(python) = installed(version) else {
        return;
    };
    let (vision, address) = Vision::offering();
    peer(&python, "client", address.port(), || {});
    assert_eq!(vision.run_count(), HANDSHAKES.div_ceil(3));
}

#[test]
fn python_snap7_2_is_the_plc() {
    their_plc("2.1.0");
}

#[test]
fn python_snap7_3_is_the_plc() {
    their_plc("3.3.0");
}

#[test]
fn python_snap7_2_is_a_client() {
    their_client("2.1.0");
}

#[test]
fn python_snap7_3_is_a_client() {
    their_client("3.3.0");
}

/// A client in Rust that is not ours.
#[test]
fn rust7_is_a_client() {
    let (vision, address) = Vision::offering();
    let mut client = Rust7::new();
    client.set_connection_port(address.port()).expect("a port");
    client.set_timeout(3000, 3000, 3000).expect("time-outs");
    client
        .connect_rack_slot("127.0.0.1", 3, 7)
        .expect("any rack and slot");
    assert_eq!(client.pdu_length, 480);
    let int = |client: &mut Rust7, field: Field| {
        let mut bytes = [0; 2];
        let first = field.offset() as u16;
        client
            .read_db(1, first, &mut bytes)
            .expect("inside the block");
        i16::from_be_bytes(bytes)
    };
    let call = |client: &mut Rust7, command: i16, project: i16| {
        let command = command.to_be_bytes();
        client.write_db(1, 2, &command).expect("written");
        client
            .write_db(1, 8, &project.to_be_bytes())
            .expect("written");
        client.write_bit(0x84, 1, 0, 0, true).expect("written");
        // In the same program: Acknowledge is there with the answer to the write.
        assert!(client.read_bit(0x84, 1, 194, 0).expect("read"));
        client.write_bit(0x84, 1, 0, 0, false).expect("written");
        assert!(!client.read_bit(0x84, 1, 194, 0).expect("read"));
        for _ in 0..2000 {
            let status = int(client, Field::Status);
            if status != 0 {
                return status;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        panic!("no Status within 2 s");
    };
    for _ in 0..HANDSHAKES / 2 {
        assert_eq!(call(&mut client, 101, 1), 1102);
        assert_eq!(call(&mut client, 102, 1), 1100);
    }
    assert_eq!(vision.run_count(), HANDSHAKES / 2);
    let mut block = vec![0; 9696];
    client.read_db(1, 0, &mut block).expect("the whole block");
    assert_eq!(&block[208 + 24..][..4], &200.0_f32.to_be_bytes());
    assert_eq!(&block[204..206], &[0, 3]);
    // What does not exist.
    assert!(client.read_db(1, 9695, &mut [0; 2]).is_err());
    assert!(client.read_db(2, 0, &mut [0; 2]).is_err());
    // The rest of the block is theirs to write.
    let pattern: Vec<u8> = (0..6400_u32).map(|n| n as u8).collect();
    client.write_db(1, 3296, &pattern).expect("written");
    let mut back = vec![0; 6400];
    client.read_db(1, 3296, &mut back).expect("read");
    assert_eq!(back, pattern);
}
