use depal_syntax::Diagnostic;

use super::keywords::{DECLARATION, MODULE_ATTRIBUTES};
use super::parser::Parser;
use super::tree::*;

impl Parser<'_> {
    pub(super) fn file(&mut self) -> Vec<Module> {
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
        let mut attributes = Vec::new();
        if self.maybe_mark("(") {
            self.attributes(&mut attributes);
        }
        let mut module = Module {
            name,
            attributes,
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
            let before = self.position();
            self.declaration(&mut module);
            if self.position() == before {
                self.advance();
            }
        }
        self.advance();
        Some(module)
    }

    fn attributes(&mut self, attributes: &mut Vec<Name>) {
        loop {
            let span = self.span();
            let Some(attribute) = self.expect_name("a module attribute") else {
                break;
            };
            let known = |known: &str| known.eq_ignore_ascii_case(&attribute.text);
            if !MODULE_ATTRIBUTES.iter().any(|a| known(a)) {
                self.diagnostics.push(
                    Diagnostic::error(
                        "RAPID0013",
                        span,
                        format!("{} is no module attribute", attribute.text),
                    )
                    .help(format!(
                        "the attributes are {}",
                        MODULE_ATTRIBUTES.join(", ")
                    )),
                );
            }
            attributes.push(attribute);
            if !self.maybe_mark(",") {
                break;
            }
        }
        self.expect_mark(")", "behind the module attributes");
    }

    fn declaration(&mut self, module: &mut Module) {
        let local = self.maybe_word("LOCAL");
        // A task-private instance; with one task there is no difference.
        let of_task = self.maybe_word("TASK");
        if self.is_any_word(&["VAR", "PERS", "CONST"]) {
            let data = self.data(local);
            module
                .data
                .extend(data.map(|data| Data { of_task, ..data }));
        } else if self.is_any_word(&["PROC", "FUNC", "TRAP"]) {
            module.routines.extend(self.routine(local));
        } else if self.maybe_word("RECORD") {
            module.records.extend(self.record(local));
        } else if self.maybe_word("ALIAS") {
            if let Some(known) = self.expect_name("the type that the alias stands for")
                && let Some(name) = self.expect_name("the name of the alias")
            {
                module.aliases.push(Alias { local, known, name });
            }
            self.expect_mark(";", "behind the alias");
        } else if self.placeholder() {
            self.maybe_mark(";");
        } else {
            let found = self.describe();
            self.report(
                "RAPID0015",
                format!(
                    "expected a declaration (VAR, PERS, CONST, RECORD, PROC, FUNC), found {found}"
                ),
            );
            while !self.is_end() && !self.is_class(DECLARATION) {
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
                    last.secondary.push(depal_syntax::Label {
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
        let opened = self.span();
        if self.maybe_mark("{") {
            loop {
                sizes.push(self.expression());
                if !self.maybe_mark(",") {
                    break;
                }
            }
            self.expect_closing("}", opened, "behind the array size");
        }
        let value = self.maybe_mark(":=").then(|| self.expression());
        if !self.expect_mark(";", "behind the declaration") {
            self.recover();
        }
        Some(Data {
            local,
            of_task: false,
            storage,
            type_name,
            name,
            sizes,
            value,
        })
    }
}
