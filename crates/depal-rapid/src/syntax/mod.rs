//! Text to tree: lexer, recursive-descent parser, syntax tree; and tree to text.

mod declaration;
pub(crate) mod expression;
pub(crate) mod keywords;
pub(crate) mod lexer;
pub(crate) mod parser;
pub(crate) mod print;
mod routine;
pub(crate) mod statement;
pub(crate) mod tree;

#[cfg(test)]
mod tests;
