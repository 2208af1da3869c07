//! A running `depal serve`.
#![allow(dead_code, unused_imports)]

use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

pub use client::{ask, client, is_closed, packed, reply};

mod client;

pub const BINARY: &str = env!("CARGO_BIN_EXE_depal");

/// A scene that is quick to set up.
pub const FEW: &[&str] = &[
    "--set",
    "cartons.count=8",
    "--set",
    "cartons.layers=1",
    "--set",
    "accept.delivered_min=0",
];

/// A running server; killed when it goes out of scope.
pub struct Served {
    child: Child,
    /// Kind and place of every port, in order.
    ports: Vec<(String, SocketAddr)>,
    told: Arc<Mutex<String>>,
}

impl Served {
    /// Starts it and waits until it listens.
    pub fn start(args: &[&str]) -> Self {
        let mut child = Command::new(BINARY)
            .args(["serve", "--json"])
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let told: Arc<Mutex<String>> = Arc::default();
        let (all, stderr) = (Arc::clone(&told), child.stderr.take().expect("piped"));
        thread::spawn(move || {
            for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                *all.lock().expect("alive") += &(line + "\n");
            }
        });
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped"))
            .read_line(&mut line)
            .expect("a ready line");
        let ready: serde_json::Value = serde_json::from_str(&line).expect("one line of JSON");
        let port = |port: &serde_json::Value| {
            let text = |key: &str| port[key].as_str().expect("text").to_owned();
            (text("kind"), text("addr").parse().expect("an address"))
        };
        let listening = ready["listening"].as_array().expect("a list");
        Self {
            child,
            ports: listening.iter().map(port).collect(),
            told,
        }
    }

    /// Kind and place of a port.
    pub fn port(&self, place: usize) -> (String, SocketAddr) {
        self.ports[place].clone()
    }

    /// Where a port listens.
    pub fn address(&self, place: usize) -> SocketAddr {
        self.ports[place].1
    }

    /// A robot at the first port.
    pub fn client(&self) -> TcpStream {
        client(self.address(0))
    }

    /// Waits until stderr has this text.
    pub fn wait_told(&self, text: &str) {
        let started = Instant::now();
        while !self.told.lock().expect("alive").contains(text) {
            let told = self.told.lock().expect("alive").clone();
            assert!(
                started.elapsed() < Duration::from_secs(15),
                "not told: {text}; told: {told}"
            );
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Exit code, and the time it took to end.
    pub fn terminate(&mut self) -> (Option<i32>, Duration) {
        self.signal("-TERM")
    }

    /// As [`terminate`](Self::terminate), by any signal.
    pub fn signal(&mut self, signal: &str) -> (Option<i32>, Duration) {
        let started = Instant::now();
        let pid = self.child.id().to_string();
        let killed = Command::new("kill").args([signal, &pid]).status();
        assert!(killed.expect("kill is there").success());
        let status = self.child.wait().expect("it ends");
        (status.code(), started.elapsed())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
