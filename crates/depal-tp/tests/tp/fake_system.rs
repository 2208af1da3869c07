//! A cabinet that writes down what is asked of it, with a peer that has replies to requests of 64 bytes.

use std::collections::VecDeque;

use crate::vision::Vision;
use depal_syntax::SourceFile;
use depal_time::{SimDuration, SimTime};
use depal_tp::{Options, Tasks, decimal, load, written_registers};
use depal_vm::execution::Step;
pub use depal_vm::testing::run;
use depal_vm::testing::{self, Peer, RecordingCabinet};

pub type FakeSystem = RecordingCabinet<Script>;

/// Length of a request; a program writes it in pieces.
const REQUEST: usize = 64;

#[derive(Default)]
pub struct Script {
    /// Replies to requests: pieces, each so long after the request.
    pub replies: VecDeque<Vec<(SimDuration, Vec<u8>)>>,
    /// A vision system in this process instead of a script.
    pub vision: Option<Box<Vision>>,
    pub outgoing: Vec<u8>,
    pub writes: usize,
    pub inbox: Vec<(SimTime, u8)>,
    pub sent: Vec<Vec<u8>>,
}

impl Script {
    pub fn new(replies: Vec<Vec<(SimDuration, Vec<u8>)>>) -> Self {
        Self {
            replies: replies.into(),
            ..Self::default()
        }
    }
}

impl Peer for Script {
    const SIGNALS: &'static [(&'static str, f64)] = &[
        ("DI[1]", f64::INFINITY),
        ("DI[2]", f64::INFINITY),
        ("DO[1]", f64::INFINITY),
        ("DO[2]", f64::INFINITY),
        ("RI[1]", f64::INFINITY),
        ("RO[1]", f64::INFINITY),
        ("GI[1]", f64::INFINITY),
        ("GO[1]", 65535.0),
        ("AI[1]", f64::INFINITY),
        ("AO[1]", f64::INFINITY),
    ];

    fn take(&mut self, now: SimTime, bytes: &[u8]) -> Option<String> {
        self.writes += 1;
        self.outgoing.extend(bytes);
        if let Some(vision) = &mut self.vision {
            vision.take(now, bytes);
        }
        while self.outgoing.len() >= REQUEST {
            self.sent.push(self.outgoing.drain(..REQUEST).collect());
            for (delay, piece) in self.replies.pop_front().unwrap_or_default() {
                let bytes = piece.into_iter();
                self.inbox.extend(bytes.map(|byte| (now + delay, byte)));
            }
        }
        None
    }

    fn give(&mut self, now: SimTime, limit: usize) -> Vec<u8> {
        if let Some(vision) = &mut self.vision {
            let arrived = vision.pump(now).into_iter();
            self.inbox.extend(arrived.map(|byte| (now, byte)));
        }
        let here = self.inbox.iter().take_while(|(at, _)| *at <= now).count();
        let taken = self.inbox.drain(..here.min(limit));
        taken.map(|(_, byte)| byte).collect()
    }
}

/// A listing of one program, `MAIN`, with numbered lines.
pub fn listing(lines: &[&str], positions: &str) -> String {
    program("MAIN", lines, positions)
}

pub fn program(name: &str, lines: &[&str], positions: &str) -> String {
    use std::fmt::Write;
    let mut text = format!("/PROG  {name}\n/ATTR\n/MN\n");
    for (index, line) in lines.iter().enumerate() {
        writeln!(text, "{:4}:  {line} ;", index + 1).expect("writing to a string works");
    }
    text + "/POS\n" + positions + "/END\n"
}

/// A taught position in user frame 0 with tool 1.
pub fn taught(number: u32, values: [f64; 6]) -> String {
    let [x, y, z, w, p, r] = values;
    format!(
        "P[{number}]{{\n   GP1:\n\tUF : 0, UT : 1,\tCONFIG : 'N U T, 0, 0, 0',\n\tX = {x} mm,\tY = {y} mm,\tZ = {z} mm,\n\tW = {w} deg,\tP = {p} deg,\tR = {r} deg\n}};\n"
    )
}

pub fn machine_with(texts: &[String], options: &Options) -> Tasks {
    let sources: Vec<_> = texts
        .iter()
        .map(|t| SourceFile::new("TEST.LS", t.clone()))
        .collect();
    let loaded = load(&sources, options, "MAIN");
    Tasks::new(testing::program(loaded, &sources), "TP")
}

/// What a run left behind.
pub struct Left {
    pub trace: Vec<String>,
    pub registers: Vec<String>,
    /// Empty if the program came to its end.
    pub end: String,
    pub system: FakeSystem,
}

/// How a program ended, in a line.
pub fn ended(end: &Step) -> String {
    match end {
        Step::Finished => String::new(),
        Step::Stopped(reason) => format!("stopped: {reason}"),
        Step::Failed(error) => {
            let report = error.report(SimTime::ZERO);
            report.lines().next().unwrap_or_default().to_owned()
        }
        other => format!("{other:?}"),
    }
}

pub fn run_all(texts: &[String], options: &Options, mut system: FakeSystem) -> Left {
    let mut machine = machine_with(texts, options);
    let end = run(&mut machine, &mut system);
    let registers = written_registers(machine.memory());
    Left {
        trace: system.trace.clone(),
        registers: registers
            .iter()
            .map(|(n, v)| format!("R[{n}]={}", decimal(*v)))
            .collect(),
        end: ended(&end),
        system,
    }
}

pub fn run_text(text: &str) -> Left {
    run_all(
        &[text.to_owned()],
        &Options::default(),
        FakeSystem::default(),
    )
}

/// Runs lines of `MAIN` with two taught positions.
pub fn lines(lines: &[&str]) -> Left {
    let positions = taught(1, [1000.0, 0.0, 500.0, 180.0, 0.0, 0.0])
        + &taught(2, [1000.0, 500.0, 500.0, 180.0, 0.0, 90.0]);
    run_text(&listing(lines, &positions))
}

/// The registers that lines of `MAIN` wrote; they must come to their end.
pub fn registers(text: &[&str]) -> String {
    let left = lines(text);
    assert_eq!(left.end, "", "{text:?}");
    left.registers.join(" ")
}
