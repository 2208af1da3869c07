//! Which language a file is written in, and what is wrong with the files of one.

use std::path::Path;
use std::sync::Arc;

use depal_controller::EioConfiguration;
use depal_scene::Language;
use depal_vm::{Diagnostic, Program, SourceFile};

use crate::exec_tasks::definition;
use crate::task_folder::extension;

/// The language of a file by its name, else by its beginning: that of a TP listing, a RAPID module or a KRL file.
pub fn language_of(path: &Path) -> Option<Language> {
    let by_name = Language::of(&path.to_string_lossy());
    by_name.or_else(|| of_content(&depal_krl::decode(&std::fs::read(path).ok()?)))
}

fn of_content(text: &str) -> Option<Language> {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let first = first.to_ascii_uppercase();
    let begins = |words: &[&str]| words.iter().any(|word| first.starts_with(word));
    if begins(&["/PROG"]) {
        Some(Language::Tp)
    } else if begins(&["%%%", "MODULE "]) {
        Some(Language::Rapid)
    } else if begins(&["&ACCESS", "&REL", "&COMMENT", "DEF ", "DEFDAT ", "DEFFCT "]) {
        Some(Language::Krl)
    } else {
        None
    }
}

/// The text of a file.
pub fn decode(language: Language, bytes: &[u8]) -> String {
    match language {
        Language::Rapid => depal_rapid::decode(bytes),
        Language::Krl => depal_krl::decode(bytes),
        Language::Tp => depal_tp::decode(bytes),
    }
}

/// What is wrong with the files of a task, or with each for itself if only their syntax is asked for; and the
/// program, if it is good. In RAPID a signal that a given I/O configuration does not define is an error; in KRL the
/// channels stand behind the programs.
pub fn check(
    language: Language,
    sources: &[SourceFile],
    signals: Option<&EioConfiguration>,
    syntax_only: bool,
) -> (Option<Arc<Program>>, Vec<Diagnostic>) {
    match (language, signals) {
        (Language::Rapid, _) if syntax_only => (None, depal_rapid::check_syntax(sources)),
        (Language::Rapid, Some(io)) => {
            let known: Vec<_> = io.signals.iter().map(definition).collect();
            let loaded = depal_rapid::check_with_signals(sources, &known);
            (loaded.program, loaded.diagnostics)
        }
        (Language::Rapid, None) => {
            let loaded = depal_rapid::check(sources);
            (loaded.program, loaded.diagnostics)
        }
        (Language::Krl, _) => {
            let programs = sources.partition_point(|source| !is_channel(Path::new(&source.name)));
            let (programs, channels) = sources.split_at(programs);
            let loaded = if syntax_only {
                depal_krl::Loaded {
                    program: None,
                    diagnostics: depal_krl::check_syntax(programs),
                }
            } else {
                depal_krl::check(programs)
            };
            let loaded = depal_krl::with_channels(loaded, programs.len(), channels);
            (loaded.program, loaded.diagnostics)
        }
        (Language::Tp, _) if syntax_only => (None, depal_tp::check_syntax(sources)),
        (Language::Tp, _) => {
            let loaded = depal_tp::check(sources);
            (loaded.program, loaded.diagnostics)
        }
    }
}

/// Whether a file is the configuration of an Ethernet channel of KRL.
pub fn is_channel(path: &Path) -> bool {
    extension(path) == "xml"
}
