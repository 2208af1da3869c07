use depal_vm::{Builtin, BuiltinFn};

use super::{
    analog, data_by_name, dialogs, event_log, files, geometry, information, interrupts, io, maths,
    messages, motion, operator, path, positions, rawbytes, search, settings, socket, strings,
    tasks, timing, triggers,
};
use crate::syntax::parser::parse_heading;
use crate::syntax::tree::Routine;

use crate::compile::Callee;

/// A heading in RAPID and the code behind it.
pub(super) type Entry = (&'static str, BuiltinFn);

/// Instructions that the lowering knows itself.
pub(super) const LOWERED: [(&str, Callee); 2] = [
    (
        "PROC WaitUntil(\\switch InPos | switch ZeroSpeed, bool Cond \\num MaxTime \\INOUT bool TimeFlag \\num PollRate)",
        Callee::WaitUntil,
    ),
    ("PROC ResetRetryCount()", Callee::ResetRetryCount),
];

/// Names of the controller that are known and refused; [`refused`](super::refused) has more of them, by theme.
pub(super) const REFUSED: &[&str] = &[
    "MoveLSync",
    "MoveJSync",
    "MoveCSync",
    "MoveExtJ",
    "SearchExtJ",
    "StepBwdPath",
    "IODisable",
    "IOEnable",
    "IPathPos",
    "SocketSendTo",
    "SocketReceiveFrom",
    "SocketPeek",
    "WriteAnyBin",
    "WriteCfgData",
    "PDispOff",
    "ActUnit",
    "DeactUnit",
    "WZBoxDef",
    "WZDOSet",
    "ReadAnyBin",
    "Load",
    "UnLoad",
    "StartLoad",
    "WaitLoad",
    "SoftAct",
    "SoftDeact",
    "EOffsSet",
    "EOffsOn",
    "EOffsOff",
    "PDispSet",
    "PDispOn",
];

/// Names of all instructions and functions that run here.
pub fn built_in_names() -> Vec<&'static str> {
    let mut names: Vec<_> = entries()
        .iter()
        .map(|(heading, _)| name_of(heading))
        .collect();
    names.extend(LOWERED.iter().map(|(heading, _)| name_of(heading)));
    names.push("Present");
    names.sort_unstable();
    names
}

pub(super) fn entries() -> Vec<Entry> {
    let themes: [&[Entry]; 23] = [
        &analog::ENTRIES,
        &data_by_name::ENTRIES,
        &event_log::ENTRIES,
        &dialogs::ENTRIES,
        &files::ENTRIES,
        &information::ENTRIES,
        &interrupts::ENTRIES,
        &operator::ENTRIES,
        &motion::ENTRIES,
        &path::ENTRIES,
        &positions::ENTRIES,
        &search::ENTRIES,
        &settings::ENTRIES,
        &triggers::ENTRIES,
        &geometry::ENTRIES,
        &io::ENTRIES,
        &tasks::ENTRIES,
        &timing::ENTRIES,
        &messages::ENTRIES,
        &socket::ENTRIES,
        &rawbytes::ENTRIES,
        &strings::ENTRIES,
        &maths::ENTRIES,
    ];
    themes.concat()
}

/// The name in a heading.
pub(super) fn name_of(heading: &'static str) -> &'static str {
    let before = heading.split('(').next().unwrap_or_default();
    before.rsplit(' ').next().unwrap_or_default()
}

/// All built-ins, with their headings read.
pub(crate) struct Table {
    headings: Vec<(Routine, Callee)>,
    builtins: Vec<Builtin>,
    operators: Vec<(&'static str, u32)>,
}

impl Table {
    pub(crate) fn new() -> Self {
        let mut table = Self {
            headings: Vec::new(),
            builtins: Vec::new(),
            operators: Vec::new(),
        };
        for (heading, run) in entries() {
            let routine = parse_heading(heading)
                .unwrap_or_else(|| unreachable!("the heading of a built-in reads: {heading}"));
            let index = table.builtins.len() as u32;
            table.builtins.push(Builtin {
                name: name_of(heading),
                run,
            });
            table.headings.push((routine, Callee::Builtin(index)));
        }
        for (heading, callee) in LOWERED {
            let routine = parse_heading(heading)
                .unwrap_or_else(|| unreachable!("the heading of a built-in reads: {heading}"));
            table.headings.push((routine, callee));
        }
        for (name, run) in geometry::OPERATORS.iter().chain(&timing::OPERATORS) {
            table.operators.push((name, table.builtins.len() as u32));
            table.builtins.push(Builtin { name, run: *run });
        }
        table
    }

    pub(crate) fn headings(&self) -> impl Iterator<Item = (&Routine, Callee)> {
        self.headings
            .iter()
            .map(|(routine, callee)| (routine, *callee))
    }

    pub(crate) fn builtins(&self) -> Vec<Builtin> {
        self.builtins.clone()
    }

    /// A built-in without a heading: `pos + pos`.
    pub(crate) fn operator(&self, name: &str) -> Option<u32> {
        self.operators
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, index)| *index)
    }
}
