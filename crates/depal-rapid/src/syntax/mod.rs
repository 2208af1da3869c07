//! Text to tree: lexer, recursive-descent parser, syntax tree.

pub(crate) mod expression;
pub(crate) mod lexer;
pub(crate) mod parser;
pub(crate) mod statement;
pub(crate) mod tree;
