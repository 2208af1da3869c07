use depal_syntax::{Diagnostic, Span};

use super::keywords::{FRESH_START, ROUTINE_END};
use super::parser::Parser;
use super::tree::*;

impl Parser<'_> {
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
                    && !self.is_class(FRESH_START)
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

    pub(super) fn routine(&mut self, local: bool) -> Option<Routine> {
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
        let mut clauses: Vec<(String, Span)> = Vec::new();
        while self.is_any_word(&["ERROR", "UNDO", "BACKWARD"]) {
            let (clause, place) = (self.describe().to_uppercase(), self.span());
            if let Some((_, first)) = clauses.iter().find(|(known, _)| *known == clause) {
                let diagnostic = Diagnostic::error(
                    "RAPID0023",
                    place,
                    format!("a routine has one {clause} clause, this is another"),
                )
                .secondary(*first, "the first")
                .help("join them; in ERROR tell the errors apart with IF ERRNO = ..");
                self.report_with(diagnostic);
            }
            clauses.push((clause, place));
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
            if self.is_end() || self.is_class(ROUTINE_END) {
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
