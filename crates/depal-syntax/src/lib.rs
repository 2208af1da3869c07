//! Program texts of robot languages: places in them, messages about them, and what their parsers have in common.
//!
//! A language cuts its text into tokens with a [`Scanner`], reads them through [`Tokens`] and makes a tree of
//! [`Node`]s and [`Name`]s. What is wrong becomes a [`Diagnostic`] with its [`Span`]; reading goes on behind it, so
//! that all errors of all files come at once.
//!
//! It must never know: a particular language's words and codes, what a program does, files, printing.
//!
//! ```
//! use depal_syntax::{Scanner, Span, Token, Tokens};
//!
//! let mut scanner = Scanner::new(0, "speed 12.5");
//! let word = scanner.take_while(char::is_alphabetic).to_owned();
//! let tokens = vec![
//!     (Token::Name(word), scanner.span_from(0)).into(),
//!     (Token::End, Span::new(0, 10, 10)).into(),
//! ];
//! let mut diagnostics = Vec::new();
//! let mut tokens = Tokens::new(tokens, "DEMO0010", &mut diagnostics);
//! assert!(tokens.maybe_word("SPEED"));
//! assert!(!tokens.expect_mark(";", "behind the speed"));
//! assert_eq!(diagnostics[0].message, "expected `;` behind the speed, found the end of the file");
//! ```
//!
//! Units: places are bytes of the decoded text; lines and columns count from 1.
//!
//! Limitations: a text is read whole; a mark is a fixed string.

mod diagnostic;
mod nearest;
mod scanner;
mod source;
mod token;
mod tokens;
mod tree;

pub use diagnostic::{Diagnostic, Label, Severity, in_order};
pub use nearest::nearest_name;
pub use scanner::Scanner;
pub use source::{LineColumn, LineStarts, SourceFile, Span, decode};
pub use token::{SpannedToken, Token};
pub use tokens::Tokens;
pub use tree::{Name, Node};

#[cfg(test)]
mod tests;
