//! Text to tree, and back.

mod declaration;
mod expression;
mod keywords;
mod lexer;
mod motion;
pub(crate) mod parser;
pub(crate) mod print;
mod statement;
pub(crate) mod tree;

#[cfg(test)]
mod tests;
