use crate::{SourceFile, Span};

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The program does not run.
    Error,
    /// The program runs; probably not as meant.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// A span with a few words about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is there. May be empty for the primary label.
    pub message: String,
}

/// What is wrong in a program text. Plain data; drawing it with the source is done elsewhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Stable code, `RAPID0012`.
    pub code: &'static str,
    /// One sentence: what is wrong, with the names that matter.
    pub message: String,
    /// The place to mend.
    pub primary: Label,
    /// Other places that explain it: where a block was opened, where a name was declared first.
    pub secondary: Vec<Label>,
    /// How to mend it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at `span`.
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message: message.into(),
            primary: Label {
                span,
                message: String::new(),
            },
            secondary: Vec::new(),
            help: None,
        }
    }

    /// A warning at `span`.
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, span, message)
        }
    }

    /// Words at the primary place.
    #[must_use]
    pub fn label(mut self, message: impl Into<String>) -> Self {
        self.primary.message = message.into();
        self
    }

    /// Another place that explains the error.
    #[must_use]
    pub fn secondary(mut self, span: Span, message: impl Into<String>) -> Self {
        self.secondary.push(Label {
            span,
            message: message.into(),
        });
        self
    }

    /// How to mend it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// `file:line:column: error[CODE]: message`.
    pub fn one_line(&self, files: &[SourceFile]) -> String {
        let place = place(files, self.primary.span);
        format!(
            "{place}: {}[{}]: {}",
            self.severity.name(),
            self.code,
            self.message
        )
    }

    /// The one line, then one indented line for each label with words and for the help.
    pub fn plain(&self, files: &[SourceFile]) -> String {
        let mut out = self.one_line(files);
        for label in std::iter::once(&self.primary).chain(&self.secondary) {
            if !label.message.is_empty() {
                out.push_str("\n    ");
                out.push_str(&place(files, label.span));
                out.push_str(": ");
                out.push_str(&label.message);
            }
        }
        if let Some(help) = &self.help {
            out.push_str("\n    help: ");
            out.push_str(help);
        }
        out
    }
}

/// Messages by file and place, each once.
pub fn in_order(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start, d.severity));
    diagnostics.dedup();
    diagnostics
}

fn place(files: &[SourceFile], span: Span) -> String {
    match files.get(span.file as usize) {
        Some(file) => format!("{}:{}", file.name, file.line_column(span.start)),
        None => "(built in)".to_owned(),
    }
}
