use depal_rapid::{SignalDefinition, SignalKind as RapidKind};
use depal_vm::{Machine, SourceFile};

use super::Translated;
use crate::robot::{Robot, SignalKind};

/// RAPID modules as one task with the entry `main`; a signal that the scene does not define is an error.
pub(super) fn load(sources: &[SourceFile], robot: &Robot) -> Translated {
    let signals: Vec<SignalDefinition> = robot
        .signal
        .iter()
        .map(|signal| SignalDefinition {
            name: signal.name.clone(),
            kind: match signal.kind {
                SignalKind::DigitalInput => RapidKind::Di,
                SignalKind::DigitalOutput => RapidKind::Do,
                SignalKind::GroupInput => RapidKind::Gi,
                SignalKind::GroupOutput => RapidKind::Go,
            },
        })
        .collect();
    let loaded = depal_rapid::load(sources, &signals, "main");
    Translated {
        program: loaded.program,
        diagnostics: loaded.diagnostics,
        task: |program| Box::new(Machine::new(program, "T_ROB1")),
    }
}
