//! Diagnostics of robot programs as people read them: with the source lines.

use std::io::IsTerminal;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use depal_vm::{Diagnostic, Severity, SourceFile, Span};

/// Tells what was found in programs that were given by hand, and where the interface's procedures are if they are missed.
pub fn tell_all(diagnostics: &[Diagnostic], files: &[SourceFile]) {
    for diagnostic in diagnostics {
        tell!("{}\n", draw(diagnostic, files));
    }
    let misses = |code: &str| {
        diagnostics
            .iter()
            .any(|found| found.code == code && found.message.contains(" named MM_"))
    };
    if misses("RAPID0101") {
        tell!(
            "help: the MM_ procedures stand in MM_Module.mod: give it too; `depal init DIR` writes it, scenes have it built in"
        );
    }
    if misses("KRL0102") {
        tell!(
            "help: the MM_ routines stand in assets/krl/mm_module.src and .dat: give them too; scenes have them built in"
        );
    }
}

/// Draws a diagnostic with its source; in colour when stderr is a terminal.
pub fn draw(diagnostic: &Diagnostic, files: &[SourceFile]) -> String {
    let renderer = if std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    draw_with(&renderer, diagnostic, files)
}

fn draw_with(renderer: &Renderer, diagnostic: &Diagnostic, files: &[SourceFile]) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level
        .primary_title(diagnostic.message.as_str())
        .id(diagnostic.code);
    let primary = diagnostic.primary.span;
    let Some(file) = files.get(primary.file as usize) else {
        return diagnostic.plain(files);
    };
    let mut snippet = Snippet::source(file.text.as_str())
        .path(file.name.as_str())
        .annotation(
            AnnotationKind::Primary
                .span(range(primary, file))
                .label(diagnostic.primary.message.as_str()),
        );
    for label in &diagnostic.secondary {
        if label.span.file == primary.file {
            snippet = snippet.annotation(
                AnnotationKind::Context
                    .span(range(label.span, file))
                    .label(label.message.as_str()),
            );
        }
    }
    let mut group = title.element(snippet);
    for label in &diagnostic.secondary {
        if let Some(other) = files.get(label.span.file as usize)
            && label.span.file != primary.file
        {
            group = group.element(
                Snippet::source(other.text.as_str())
                    .path(other.name.as_str())
                    .annotation(
                        AnnotationKind::Context
                            .span(range(label.span, other))
                            .label(label.message.as_str()),
                    ),
            );
        }
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    renderer.render(&[group])
}

/// Byte range of a span, within the text.
fn range(span: Span, file: &SourceFile) -> std::ops::Range<usize> {
    let end = (span.end as usize).min(file.text.len());
    (span.start as usize).min(end)..end
}
