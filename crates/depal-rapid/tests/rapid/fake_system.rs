//! A cabinet that writes down what is asked of it, with a peer that has a reply to each send.

use std::collections::VecDeque;

use depal_rapid::{SignalDefinition, SignalKind, load};
use depal_syntax::SourceFile;
use depal_time::{SimDuration, SimTime};
use depal_vm::execution::Step;
pub use depal_vm::testing::run;
use depal_vm::testing::{Peer, RecordingCabinet, program};
use depal_vm::{Machine, Value};

pub type FakeSystem = RecordingCabinet<Script>;

#[derive(Clone, Default)]
pub struct Script {
    /// Bytes that the peer sends, each so long after it was sent something.
    pub replies: VecDeque<(SimDuration, Vec<u8>)>,
    pub inbox: Vec<(SimTime, u8)>,
    pub sent: Vec<Vec<u8>>,
}

impl Script {
    pub fn new(replies: impl IntoIterator<Item = (SimDuration, Vec<u8>)>) -> Self {
        Self {
            replies: replies.into_iter().collect(),
            ..Self::default()
        }
    }
}

impl Peer for Script {
    const SIGNALS: &'static [(&'static str, f64)] = &[
        ("di_part", f64::INFINITY),
        ("do_pump", f64::INFINITY),
        ("go_zone", 15.0),
        ("gi_count", f64::INFINITY),
        ("ao_flow", f64::INFINITY),
    ];

    fn take(&mut self, now: SimTime, bytes: &[u8]) -> Option<String> {
        self.sent.push(bytes.to_vec());
        if let Some((delay, reply)) = self.replies.pop_front() {
            let bytes = reply.into_iter();
            self.inbox.extend(bytes.map(|byte| (now + delay, byte)));
        }
        Some(format!("send {bytes:?}"))
    }

    fn give(&mut self, now: SimTime, limit: usize) -> Vec<u8> {
        let here = self.inbox.iter().take_while(|(at, _)| *at <= now).count();
        let taken = self.inbox.drain(..here.min(limit));
        taken.map(|(_, byte)| byte).collect()
    }
}

pub fn signals() -> Vec<SignalDefinition> {
    [
        ("di_part", SignalKind::Di),
        ("do_pump", SignalKind::Do),
        ("go_zone", SignalKind::Go),
        ("gi_count", SignalKind::Gi),
        ("ao_flow", SignalKind::Ao),
    ]
    .map(|(name, kind)| SignalDefinition {
        name: name.into(),
        kind,
    })
    .to_vec()
}

pub fn machine(text: &str) -> Machine {
    let sources = [SourceFile::new("test.mod", text)];
    let loaded = load(&sources, &signals(), "main");
    Machine::new(program(loaded, &sources), "T_ROB1")
}

/// Runs a body of `main` with module data and gives back what the program wrote and how it ended.
pub fn run_text(text: &str) -> Vec<String> {
    let mut system = FakeSystem::default();
    let mut machine = machine(text);
    let end = run(&mut machine, &mut system);
    if end != Step::Finished {
        system.trace.push(format!("{end:?}"));
    }
    system.trace
}

/// The operator lines of statements in `main`.
pub fn output(data: &str, statements: &str) -> Vec<String> {
    let text = format!("MODULE m\n{data}\nPROC main()\n{statements}\nENDPROC\nENDMODULE\n");
    run_text(&text)
}

pub fn global(machine: &Machine, name: &str) -> Value {
    machine.global(name).expect("declared").clone()
}
