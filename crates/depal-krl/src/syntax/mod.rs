//! Text to tree, and back.

mod declaration;
mod expression;
mod file;
mod keywords;
mod lexer;
mod motion;
pub(crate) mod parser;
pub(crate) mod print;
pub(crate) mod print_expression;
mod statement;
pub(crate) mod tree;

#[cfg(test)]
mod tests;
