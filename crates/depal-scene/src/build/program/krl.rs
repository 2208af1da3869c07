use depal_vm::{Machine, SourceFile};

use super::Translated;
use crate::language::Language;

/// KRL files with the Ethernet channels among them, which are moved behind the others.
pub(super) fn load(sources: &mut [SourceFile], entry: &str) -> Translated {
    debug_assert!(
        sources
            .iter()
            .all(|source| Language::of(&source.name) == Some(Language::Krl))
    );
    let is_channel = |source: &SourceFile| source.name.to_ascii_lowercase().ends_with(".xml");
    sources.sort_by_key(is_channel);
    let texts = sources.partition_point(|source| !is_channel(source));
    let (programs, channels) = sources.split_at(texts);
    // Every input and output of the numbered arrays is there.
    let loaded = depal_krl::load_with_any_signals(programs, entry);
    let loaded = depal_krl::with_channels(loaded, programs.len(), channels);
    Translated {
        program: loaded.program,
        diagnostics: loaded.diagnostics,
        task: |program| Box::new(Machine::new(program, "ROBOT")),
    }
}
