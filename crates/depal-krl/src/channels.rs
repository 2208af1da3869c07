use std::collections::BTreeMap;
use std::sync::Arc;

use depal_eki::{ChannelConfig, ConfigDiagnostic, ConfigSeverity};
use depal_syntax::{Diagnostic, SourceFile, Span};
use depal_vm::Loaded;

use crate::builtins::{CHANNELS, Links, channels};

/// Gives a loaded program its Ethernet channels: configuration files in XML, each a channel with the file's name,
/// without folder and extension. What is wrong with a file is among the diagnostics, as file `sources` and up:
/// the channel files stand behind the files that were loaded.
#[must_use]
pub fn with_channels(mut loaded: Loaded, sources: usize, files: &[SourceFile]) -> Loaded {
    let mut configs = BTreeMap::new();
    let mut failed = false;
    for (index, file) in files.iter().enumerate() {
        let place = |line| span((sources + index) as u32, file, line);
        let name = channel_name(&file.name);
        let (says, config) = match ChannelConfig::read(&file.text) {
            Ok(read) => (read.warnings, Some(read.config)),
            Err(error) => (error.diagnostics, None),
        };
        failed |= config.is_none();
        let says = says.iter().map(|say| diagnostic(say, place(say.line)));
        loaded.diagnostics.extend(says);
        let Some(config) = config else { continue };
        if configs.insert(name.to_owned(), Arc::new(config)).is_some() {
            failed = true;
            loaded.diagnostics.push(Diagnostic::error(
                "EKI0003",
                place(1),
                format!("there is another file for the channel {name}"),
            ));
        }
    }
    if failed {
        loaded.program = None;
    }
    if let Some(program) = &mut loaded.program {
        let program = Arc::make_mut(program);
        program.globals[CHANNELS] = channels(Links::new(configs));
    }
    loaded
}

/// The last part of a path, without its extension.
fn channel_name(path: &str) -> &str {
    let base = path.rsplit(['/', '\\']).next().unwrap_or(path);
    base.rsplit_once('.').map_or(base, |(stem, _)| stem)
}

/// A line without its blanks.
fn span(index: u32, file: &SourceFile, line: u32) -> Span {
    let before = file
        .text
        .split_inclusive('\n')
        .take(line.saturating_sub(1) as usize);
    let start: usize = before.map(str::len).sum();
    let text = file.line_text(line);
    let indent = text.len() - text.trim_start().len();
    let start = start + indent;
    Span::new(index, start as u32, (start + text.trim().len()) as u32)
}

fn diagnostic(say: &ConfigDiagnostic, span: Span) -> Diagnostic {
    let message = match say.key.as_str() {
        "" => say.message.clone(),
        key => format!("{key}: {}", say.message),
    };
    match say.severity {
        ConfigSeverity::Error => Diagnostic::error("EKI0001", span, message),
        ConfigSeverity::Warning => Diagnostic::warning("EKI0002", span, message),
    }
}
