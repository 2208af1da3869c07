use depal_vm::{Diagnostic, Span};

use super::lexer::{SpannedToken, Token, lex};
use super::tree::*;

/// Reads one file. The tree holds whatever could be read.
pub(crate) fn parse(file: u32, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Vec<Module> {
    let tokens = lex(file, text, diagnostics);
    let mut parser = Parser {
        tokens,
        at: 0,
        diagnostics,
        depth: 0,
        operators: 0,
        inside: 0,
        reported_at: None,
    };
    parser.file()
}

/// Reads one routine heading, as the table of built-ins has them.
pub(crate) fn parse_heading(text: &str) -> Option<Routine> {
    let mut diagnostics = Vec::new();
    let tokens = lex(u32::MAX, text, &mut diagnostics);
    let mut parser = Parser {
        tokens,
        at: 0,
        diagnostics: &mut diagnostics,
        depth: 0,
        operators: 0,
        inside: 0,
        reported_at: None,
    };
    let routine = parser.heading(false);
    diagnostics.is_empty().then_some(routine).flatten()
}

/// Deepest nesting of expressions and blocks, so that no text can exhaust the stack.
const DEPTH_LIMIT: usize = 64;

/// Most operators in one expression.
const OPERATOR_LIMIT: usize = 256;

pub(crate) struct Parser<'a> {
    tokens: Vec<SpannedToken>,
    at: usize,
    pub(crate) diagnostics: &'a mut Vec<Diagnostic>,
    depth: usize,
    /// Operators of the expression being read.
    operators: usize,
    /// Expressions inside each other.
    pub(crate) inside: usize,
    reported_at: Option<usize>,
}

impl Parser<'_> {
    pub(crate) fn peek(&self) -> &Token {
        &self.tokens[self.at.min(self.tokens.len() - 1)].token
    }

    pub(crate) fn peek_after(&self, ahead: usize) -> &Token {
        &self.tokens[(self.at + ahead).min(self.tokens.len() - 1)].token
    }

    pub(crate) fn span(&self) -> Span {
        self.tokens[self.at.min(self.tokens.len() - 1)].span
    }

    pub(crate) fn last_span(&self) -> Span {
        self.tokens[self.at.saturating_sub(1).min(self.tokens.len() - 1)].span
    }

    pub(crate) fn position(&self) -> usize {
        self.at
    }

    pub(crate) fn advance(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    pub(crate) fn step_back(&mut self) {
        self.at = self.at.saturating_sub(1);
    }

    pub(crate) fn is_end(&self) -> bool {
        matches!(self.peek(), Token::End)
    }

    pub(crate) fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Name(name) if name.eq_ignore_ascii_case(word))
    }

    pub(crate) fn is_any_word(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.is_word(word))
    }

    pub(crate) fn maybe_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.advance();
        }
        found
    }

    pub(crate) fn is_mark(&self, mark: &str) -> bool {
        matches!(self.peek(), Token::Mark(found) if *found == mark)
    }

    pub(crate) fn maybe_mark(&mut self, mark: &str) -> bool {
        let found = self.is_mark(mark);
        if found {
            self.advance();
        }
        found
    }

    pub(crate) fn describe(&self) -> String {
        match self.peek() {
            Token::Name(name) => name.clone(),
            Token::Number { value, .. } => format!("the number {value}"),
            Token::Text(_) => "a string".into(),
            Token::Mark(mark) => format!("`{mark}`"),
            Token::End => "the end of the file".into(),
        }
    }

    /// Reports at the current token, once for each place.
    pub(crate) fn report(&mut self, code: &'static str, message: String) {
        let span = self.span();
        self.report_with(Diagnostic::error(code, span, message));
    }

    pub(crate) fn report_with(&mut self, diagnostic: Diagnostic) {
        if self.reported_at != Some(self.at) {
            self.reported_at = Some(self.at);
            self.diagnostics.push(diagnostic);
        }
    }

    pub(crate) fn expect_mark(&mut self, mark: &str, why: &str) -> bool {
        if self.maybe_mark(mark) {
            return true;
        }
        let found = self.describe();
        // A missing mark belongs behind what was read last, not before the next line.
        let previous = self.last_span();
        let span = Span::new(previous.file, previous.end, previous.end);
        let diagnostic = Diagnostic::error(
            "RAPID0010",
            span,
            format!("expected `{mark}` {why}, found {found}"),
        )
        .label(format!("`{mark}` is missing here"));
        self.report_with(diagnostic);
        false
    }

    pub(crate) fn expect_word(&mut self, word: &str, why: &str) -> bool {
        if self.maybe_word(word) {
            return true;
        }
        let found = self.describe();
        self.report("RAPID0010", format!("expected {word} {why}, found {found}"));
        false
    }

    pub(crate) fn expect_name(&mut self, what: &str) -> Option<Name> {
        if let Token::Name(text) = self.peek()
            && !is_keyword(text)
        {
            let name = Name {
                text: text.clone(),
                span: self.span(),
            };
            self.advance();
            return Some(name);
        }
        let found = self.describe();
        self.report("RAPID0011", format!("expected {what}, found {found}"));
        None
    }

    /// One level deeper; `false`, reported, when too deep.
    pub(crate) fn enter(&mut self) -> bool {
        self.depth += 1;
        if self.depth > DEPTH_LIMIT {
            self.report(
                "RAPID0019",
                format!("more than {DEPTH_LIMIT} levels inside each other"),
            );
            return false;
        }
        true
    }

    /// Starts counting the operators of an outermost expression.
    pub(crate) fn begin_operators(&mut self) {
        self.operators = 0;
    }

    /// Counts an operator; `false`, reported, when one expression has too many for the tree to stay flat.
    pub(crate) fn count_operator(&mut self) -> bool {
        self.operators += 1;
        if self.operators > OPERATOR_LIMIT {
            self.report(
                "RAPID0019",
                format!("more than {OPERATOR_LIMIT} operators in one expression"),
            );
            self.recover();
            return false;
        }
        true
    }

    pub(crate) fn leave(&mut self) {
        self.depth -= 1;
    }

    /// Skips to behind the next `;`, or to a word that can only begin something new.
    pub(crate) fn recover(&mut self) {
        while !self.is_end() {
            if self.maybe_mark(";") {
                return;
            }
            if self.is_any_word(&RECOVERY_WORDS) {
                return;
            }
            self.advance();
        }
    }

    fn file(&mut self) -> Vec<Module> {
        let mut modules = Vec::new();
        while !self.is_end() {
            if self.is_word("MODULE") {
                modules.extend(self.module());
            } else {
                let found = self.describe();
                self.report("RAPID0012", format!("expected MODULE, found {found}"));
                while !self.is_end() && !self.is_word("MODULE") {
                    self.advance();
                }
            }
        }
        modules
    }

    fn module(&mut self) -> Option<Module> {
        let opened = self.span();
        self.advance();
        let name = self.expect_name("the name of the module")?;
        if self.maybe_mark("(") {
            loop {
                let span = self.span();
                let Some(attribute) = self.expect_name("a module attribute") else {
                    break;
                };
                let known = ["sysmodule", "nostepin", "viewonly", "readonly", "noview"];
                if !known.contains(&attribute.key().as_str()) {
                    self.diagnostics.push(Diagnostic::error(
                        "RAPID0013",
                        span,
                        format!("{} is no module attribute", attribute.text),
                    ));
                }
                if !self.maybe_mark(",") {
                    break;
                }
            }
            self.expect_mark(")", "behind the module attributes");
        }
        let mut module = Module {
            name,
            records: Vec::new(),
            aliases: Vec::new(),
            data: Vec::new(),
            routines: Vec::new(),
        };
        while !self.is_word("ENDMODULE") {
            if self.is_end() || self.is_word("MODULE") {
                let found = self.describe();
                let diagnostic = Diagnostic::error(
                    "RAPID0014",
                    self.span(),
                    format!("expected ENDMODULE, found {found}"),
                )
                .secondary(opened, "this MODULE, opened here, has no ENDMODULE");
                self.report_with(diagnostic);
                return Some(module);
            }
            let before = self.at;
            self.declaration(&mut module);
            if self.at == before {
                self.advance();
            }
        }
        self.advance();
        Some(module)
    }

    fn declaration(&mut self, module: &mut Module) {
        let local = self.maybe_word("LOCAL");
        // A task-private instance; with one task there is no difference.
        self.maybe_word("TASK");
        if self.is_any_word(&["VAR", "PERS", "CONST"]) {
            module.data.extend(self.data(local));
        } else if self.is_any_word(&["PROC", "FUNC", "TRAP"]) {
            module.routines.extend(self.routine(local));
        } else if self.maybe_word("RECORD") {
            module.records.extend(self.record(local));
        } else if self.maybe_word("ALIAS") {
            if let Some(known) = self.expect_name("the type that the alias stands for")
                && let Some(name) = self.expect_name("the name of the alias")
            {
                module.aliases.push((known, name));
            }
            self.expect_mark(";", "behind the alias");
        } else {
            let found = self.describe();
            self.report(
                "RAPID0015",
                format!(
                    "expected a declaration (VAR, PERS, CONST, RECORD, PROC, FUNC), found {found}"
                ),
            );
            while !self.is_end()
                && !self.is_any_word(&[
                    "VAR",
                    "PERS",
                    "CONST",
                    "PROC",
                    "FUNC",
                    "TRAP",
                    "RECORD",
                    "ALIAS",
                    "LOCAL",
                    "TASK",
                    "MODULE",
                    "ENDMODULE",
                ])
            {
                self.advance();
            }
        }
    }

    fn record(&mut self, local: bool) -> Option<Record> {
        let opened = self.last_span();
        let name = self.expect_name("the name of the record")?;
        let mut fields = Vec::new();
        while !self.maybe_word("ENDRECORD") {
            let field = self
                .expect_name("the type of a record component, or ENDRECORD")
                .and_then(|kind| Some((kind, self.expect_name("the name of a record component")?)));
            let Some(field) = field else {
                if let Some(last) = self.diagnostics.last_mut() {
                    last.secondary.push(depal_vm::Label {
                        span: opened,
                        message: "in this RECORD".into(),
                    });
                }
                break;
            };
            fields.push(field);
            self.expect_mark(";", "behind the record component");
        }
        Some(Record {
            local,
            name,
            fields,
        })
    }

    pub(crate) fn data(&mut self, local: bool) -> Option<Data> {
        let storage = if self.is_word("VAR") {
            Storage::Var
        } else if self.is_word("PERS") {
            Storage::Pers
        } else {
            Storage::Const
        };
        self.advance();
        let read = self
            .expect_name("a data type")
            .and_then(|kind| Some((kind, self.expect_name("the name of the data")?)));
        let Some((type_name, name)) = read else {
            self.recover();
            return None;
        };
        let mut sizes = Vec::new();
        if self.maybe_mark("{") {
            loop {
                sizes.push(self.expression());
                if !self.maybe_mark(",") {
                    break;
                }
            }
            self.expect_mark("}", "behind the array size");
        }
        let value = self.maybe_mark(":=").then(|| self.expression());
        if !self.expect_mark(";", "behind the declaration") {
            self.recover();
        }
        Some(Data {
            local,
            storage,
            type_name,
            name,
            sizes,
            value,
        })
    }

    pub(crate) fn heading(&mut self, local: bool) -> Option<Routine> {
        let kind = if self.maybe_word("PROC") {
            RoutineKind::Procedure
        } else if self.maybe_word("FUNC") {
            RoutineKind::Function(self.expect_name("the type of the function's result")?)
        } else {
            self.expect_word("TRAP", "or PROC or FUNC");
            RoutineKind::Trap
        };
        let name = self.expect_name("the name of the routine")?;
        let parameters = if kind == RoutineKind::Trap {
            Vec::new()
        } else {
            self.parameters()
        };
        Some(Routine {
            local,
            kind,
            name,
            parameters,
            data: Vec::new(),
            body: Vec::new(),
            handler: None,
            undo: None,
            backward: None,
        })
    }

    fn parameters(&mut self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        if !self.expect_mark("(", "behind the name of the routine") {
            return parameters;
        }
        let mut group = 0;
        let mut alternative = false;
        while !self.maybe_mark(")") {
            if self.is_end() {
                self.report("RAPID0010", "expected `)` behind the parameters".into());
                break;
            }
            self.maybe_mark(",");
            // Alternatives of an optional parameter are optional, too: `\num A | bool B`.
            let optional = self.maybe_mark("\\") || alternative;
            let mode = if self.maybe_word("VAR") {
                Mode::Var
            } else if self.maybe_word("INOUT") {
                Mode::Inout
            } else if self.maybe_word("PERS") {
                Mode::Pers
            } else {
                Mode::Value
            };
            let read = self
                .expect_name("the type of a parameter")
                .and_then(|kind| Some((kind, self.expect_name("the name of a parameter")?)));
            let Some((type_name, name)) = read else {
                while !self.is_end()
                    && !self.is_mark(")")
                    && !self.is_mark(";")
                    && !self.is_any_word(&RECOVERY_WORDS)
                {
                    self.advance();
                }
                self.maybe_mark(")");
                break;
            };
            let mut dimensions = 0;
            if self.maybe_mark("{") {
                loop {
                    self.expect_mark("*", "as the size of an array parameter");
                    dimensions += 1;
                    if !self.maybe_mark(",") {
                        break;
                    }
                }
                self.expect_mark("}", "behind the array parameter");
            }
            parameters.push(Parameter {
                mode,
                optional,
                group,
                type_name,
                name,
                dimensions,
            });
            let alternatives = self.maybe_mark("|");
            alternative = alternatives && optional;
            if !alternatives {
                group += 1;
            }
        }
        parameters
    }

    fn routine(&mut self, local: bool) -> Option<Routine> {
        let opened = self.span();
        let Some(mut routine) = self.heading(local) else {
            self.recover();
            return None;
        };
        let (opening, closing) = match routine.kind {
            RoutineKind::Procedure => ("PROC", "ENDPROC"),
            RoutineKind::Function(_) => ("FUNC", "ENDFUNC"),
            RoutineKind::Trap => ("TRAP", "ENDTRAP"),
        };
        while self.is_any_word(&["VAR", "PERS", "CONST"]) {
            routine.data.extend(self.data(true));
        }
        routine.body = self.routine_statements();
        while self.is_any_word(&["ERROR", "UNDO", "BACKWARD"]) {
            if self.maybe_word("UNDO") {
                routine.undo = Some(self.routine_statements());
                continue;
            }
            if self.maybe_word("BACKWARD") {
                routine.backward = Some(self.routine_statements());
                continue;
            }
            self.advance();
            let numbers = self.maybe_mark("(").then(|| {
                let mut numbers = Vec::new();
                while !self.is_mark(")") && !self.is_end() {
                    numbers.push(self.expression());
                    if !self.maybe_mark(",") {
                        break;
                    }
                }
                self.expect_mark(")", "behind the error numbers");
                numbers
            });
            let body = self.routine_statements();
            routine.handler = Some(Handler { numbers, body });
        }
        if !self.maybe_word(closing) {
            let found = self.describe();
            let message = format!("expected {closing}, found {found}");
            let diagnostic = Diagnostic::error("RAPID0014", self.span(), message).secondary(
                opened,
                format!("this {opening}, opened here, has no {closing}"),
            );
            self.report_with(diagnostic);
            if self.is_any_word(&["ENDPROC", "ENDFUNC", "ENDTRAP"]) {
                self.advance();
            }
        }
        Some(routine)
    }

    /// Statements up to a word that ends a routine or its body; stray closing words are reported.
    fn routine_statements(&mut self) -> Vec<Statement> {
        let mut statements = Vec::new();
        loop {
            statements.extend(self.block());
            if self.is_end() || self.is_any_word(&ROUTINE_ENDS) {
                return statements;
            }
            let word = self.describe();
            self.report(
                "RAPID0016",
                format!("{word} does not close anything that is open here"),
            );
            self.advance();
            if self.is_mark(":") {
                self.advance();
            }
        }
    }
}

/// Words at which a statement list of any kind ends.
pub(crate) const BLOCK_ENDS: [&str; 26] = [
    "ENDIF",
    "ELSE",
    "ELSEIF",
    "ENDFOR",
    "ENDWHILE",
    "ENDTEST",
    "CASE",
    "DEFAULT",
    "ENDPROC",
    "ENDFUNC",
    "ENDTRAP",
    "ERROR",
    "UNDO",
    "BACKWARD",
    "ENDMODULE",
    "ENDRECORD",
    "PROC",
    "FUNC",
    "TRAP",
    "MODULE",
    "RECORD",
    "LOCAL",
    "VAR",
    "PERS",
    "CONST",
    "THEN",
];

const ROUTINE_ENDS: [&str; 14] = [
    "ENDPROC",
    "ENDFUNC",
    "ENDTRAP",
    "ERROR",
    "UNDO",
    "BACKWARD",
    "ENDMODULE",
    "PROC",
    "FUNC",
    "TRAP",
    "MODULE",
    "RECORD",
    "LOCAL",
    "ENDRECORD",
];

const RECOVERY_WORDS: [&str; 32] = [
    "ENDIF",
    "ELSE",
    "ELSEIF",
    "ENDFOR",
    "ENDWHILE",
    "ENDTEST",
    "CASE",
    "DEFAULT",
    "ENDPROC",
    "ENDFUNC",
    "ENDTRAP",
    "ERROR",
    "UNDO",
    "ENDMODULE",
    "PROC",
    "FUNC",
    "TRAP",
    "MODULE",
    "RECORD",
    "LOCAL",
    "VAR",
    "PERS",
    "CONST",
    "IF",
    "FOR",
    "WHILE",
    "TEST",
    "RETURN",
    "RAISE",
    "RETRY",
    "TRYNEXT",
    "GOTO",
];

/// Reserved words, which cannot be names.
pub(crate) fn is_keyword(word: &str) -> bool {
    const KEYWORDS: [&str; 59] = [
        "ALIAS",
        "AND",
        "BACKWARD",
        "CASE",
        "CONNECT",
        "CONST",
        "DEFAULT",
        "DIV",
        "DO",
        "ELSE",
        "ELSEIF",
        "ENDFOR",
        "ENDFUNC",
        "ENDIF",
        "ENDMODULE",
        "ENDPROC",
        "ENDRECORD",
        "ENDTEST",
        "ENDTRAP",
        "ENDWHILE",
        "ERROR",
        "EXIT",
        "FALSE",
        "FOR",
        "FROM",
        "FUNC",
        "GOTO",
        "IF",
        "INOUT",
        "LOCAL",
        "MOD",
        "MODULE",
        "NOSTEPIN",
        "NOT",
        "NOVIEW",
        "OR",
        "PERS",
        "PROC",
        "RAISE",
        "READONLY",
        "RECORD",
        "RETRY",
        "RETURN",
        "STEP",
        "SYSMODULE",
        "TEST",
        "THEN",
        "TO",
        "TRAP",
        "TRUE",
        "TRYNEXT",
        "UNDO",
        "VAR",
        "VIEWONLY",
        "WHILE",
        "WITH",
        "XOR",
        "TASK",
        "ENDUNDO",
    ];
    // Module attributes are read as names by the module heading.
    const ATTRIBUTES: [&str; 5] = ["NOSTEPIN", "NOVIEW", "READONLY", "SYSMODULE", "VIEWONLY"];
    let upper = word.to_ascii_uppercase();
    KEYWORDS.contains(&upper.as_str()) && !ATTRIBUTES.contains(&upper.as_str())
}
