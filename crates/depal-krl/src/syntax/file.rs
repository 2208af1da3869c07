use super::parser::Parser;
use super::tree::*;

impl Parser<'_> {
    pub(super) fn file(&mut self, kind: FileKind) -> File {
        let mut file = File {
            kind,
            name: None,
            public: false,
            data: Vec::new(),
            routines: Vec::new(),
        };
        loop {
            self.skip_empty();
            if self.is_end() {
                return file;
            }
            let before = self.position();
            if self.is_word("defdat") {
                self.data_list(&mut file);
            } else if self.begins_routine() && !self.is_any_word(&["end", "endfct", "enddat"]) {
                if let Some(routine) = self.routine() {
                    file.routines.push(routine);
                }
            } else if self.is_any_word(&["end", "endfct", "enddat"]) {
                let word = self.describe();
                self.report("KRL0014", format!("{word} without its beginning"));
                self.skip_line();
            } else {
                // Declarations may stand before the first DEF.
                let statement = self.nested(Self::statement);
                file.data.extend(statement);
            }
            if self.position() == before {
                self.advance();
            }
        }
    }

    fn data_list(&mut self, file: &mut File) {
        let opening = self.span();
        self.advance();
        file.name = self.expect_name("the name of the data list");
        file.public = self.maybe_word("public");
        self.expect_line_end();
        file.data.extend(self.block(&["enddat"]));
        self.expect_block_end("ENDDAT", "DEFDAT", opening);
        self.expect_line_end();
    }

    fn routine(&mut self) -> Option<Routine> {
        let opening = self.span();
        let global = self.maybe_word("global");
        let function = self.is_word("deffct");
        self.advance();
        let mut result = None;
        if function {
            let type_name = self.expect_name("the type of the result");
            let brackets = self.brackets() > 0;
            result = type_name.map(|name| (name, brackets));
        }
        let name = self.expect_name("the name of the routine");
        let mut parameters = Vec::new();
        if let Some(opening) = self.opening("(") {
            while !self.is_mark(")") && !self.is_line_end() {
                let Some(name) = self.expect_name("a parameter") else {
                    break;
                };
                let dimensions = self.brackets();
                let mode = self.mode();
                parameters.push(Parameter {
                    name,
                    dimensions,
                    mode,
                });
                if !self.maybe_mark(",") {
                    break;
                }
            }
            self.expect_closing(")", opening, "behind the parameters");
        }
        self.expect_line_end();
        let (stops, word): (&'static [&'static str], _) = if function {
            (&["endfct"], "ENDFCT")
        } else {
            (&["end"], "END")
        };
        let body = self.block(stops);
        let what = if function { "DEFFCT" } else { "DEF" };
        self.expect_block_end(word, what, opening);
        if self.is_any_word(&["end", "endfct"]) {
            self.skip_line();
        }
        self.expect_line_end();
        if function && result.is_none() {
            return None;
        }
        Some(Routine {
            global,
            result,
            name: name?,
            parameters,
            body,
        })
    }
}
