use depal_syntax::{Span, Token};

use super::keywords::is_keyword;
use super::parser::Parser;
use super::tree::*;

impl Parser<'_> {
    /// Whether the statement declares something: a word for it, or a type before a name.
    pub(super) fn begins_declaration(&self) -> bool {
        if self.is_any_word(&["decl", "struc", "enum", "signal", "ext", "extfct", "const"]) {
            return true;
        }
        if self.is_word("global") {
            return !matches!(self.peek_after(1), Token::Name(n) if n.eq_ignore_ascii_case("interrupt"));
        }
        match (self.peek(), self.peek_after(1)) {
            (Token::Name(first), Token::Name(second)) => !is_keyword(first) && !is_keyword(second),
            _ => false,
        }
    }

    pub(super) fn declaration(&mut self) -> Option<Declaration> {
        let mut global = self.maybe_word("global");
        let declared = self.maybe_word("decl");
        global |= self.maybe_word("global");
        if !declared || self.is_any_word(&["struc", "enum", "signal"]) {
            if self.maybe_word("struc") {
                return self.struc(global);
            }
            if self.maybe_word("enum") {
                return self.enumeration(global);
            }
            if self.maybe_word("signal") {
                return self.signal(global);
            }
            if self.is_any_word(&["ext", "extfct"]) {
                return self.external();
            }
        }
        let constant = self.maybe_word("const");
        let type_name = self.expect_name("a type")?;
        let mut items = Vec::new();
        loop {
            items.push(self.data_item()?);
            if !self.maybe_mark(",") {
                break;
            }
        }
        Some(Declaration::Data {
            global,
            constant,
            type_name,
            items,
        })
    }

    fn data_item(&mut self) -> Option<DataItem> {
        let name = self.expect_name("the name of a variable")?;
        let sizes = match self.opening("[") {
            Some(opening) => self.indexes(opening),
            None => Vec::new(),
        };
        let value = if self.maybe_mark("=") {
            Some(self.expression())
        } else {
            None
        };
        Some(DataItem { name, sizes, value })
    }

    /// What stands in brackets that are open: `1`, `1,2`, nothing, `1,`.
    pub(super) fn indexes(&mut self, opening: Span) -> Vec<Option<Expression>> {
        let mut indexes = Vec::new();
        loop {
            if self.is_mark(",") || self.is_mark("]") {
                indexes.push(None);
            } else {
                indexes.push(Some(self.expression()));
            }
            if !self.maybe_mark(",") {
                break;
            }
        }
        self.expect_closing("]", opening, "behind the indexes");
        indexes
    }

    /// `STRUC NAME INT A, REAL B,C, CHAR D[10]`: a type holds until the next one.
    fn struc(&mut self, global: bool) -> Option<Declaration> {
        let name = self.expect_name("the name of the structure")?;
        let mut fields = Vec::new();
        let mut type_name: Option<Name> = None;
        loop {
            if let (Token::Name(_), Token::Name(_)) = (self.peek(), self.peek_after(1)) {
                type_name = Some(self.expect_name("the type of a component")?);
            }
            let Some(kind) = type_name.clone() else {
                let found = self.describe();
                self.report(
                    "KRL0011",
                    format!("expected the type of a component, found {found}"),
                );
                return None;
            };
            fields.push((kind, self.data_item()?));
            if !self.maybe_mark(",") {
                break;
            }
        }
        Some(Declaration::Struc {
            global,
            name,
            fields,
        })
    }

    fn enumeration(&mut self, global: bool) -> Option<Declaration> {
        let name = self.expect_name("the name of the enumeration")?;
        let mut constants = Vec::new();
        loop {
            constants.push(self.constant_name()?);
            if !self.maybe_mark(",") {
                break;
            }
        }
        Some(Declaration::Enum {
            global,
            name,
            constants,
        })
    }

    /// A constant of an enumeration may be spelled like a keyword.
    pub(super) fn constant_name(&mut self) -> Option<Name> {
        if let Token::Name(text) = self.peek() {
            let text = text.clone();
            let span = self.span();
            self.advance();
            return Some(Name { text, span });
        }
        self.expect_name("the name of a constant")
    }

    fn signal(&mut self, global: bool) -> Option<Declaration> {
        let name = self.expect_name("the name of the signal")?;
        let from = self.expression();
        let to = if self.maybe_word("to") {
            Some(self.expression())
        } else {
            None
        };
        Some(Declaration::Signal {
            global,
            name,
            from,
            to,
        })
    }

    fn external(&mut self) -> Option<Declaration> {
        let function = self.is_word("extfct");
        self.advance();
        let result = if function {
            let name = self.expect_name("the type of the result")?;
            self.brackets();
            Some(name)
        } else {
            None
        };
        let name = self.expect_name("the name of the routine")?;
        let mut parameters = Vec::new();
        if let Some(opening) = self.opening("(") {
            while !self.is_mark(")") && !self.is_line_end() {
                let kind = self.expect_name("the type of a parameter")?;
                let brackets = self.brackets() > 0;
                parameters.push((kind, brackets, self.mode()));
                if !self.maybe_mark(",") {
                    break;
                }
            }
            self.expect_closing(")", opening, "behind the parameters");
        }
        Some(Declaration::External {
            result,
            name,
            parameters,
        })
    }
}
