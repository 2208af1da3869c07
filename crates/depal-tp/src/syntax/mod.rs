//! Text to tree and back.

mod cursor;
mod expression;
mod keywords;
mod lexer;
mod listing;
mod motion;
mod positions;
mod print;
mod statement;
pub(crate) mod tree;

pub(crate) use listing::parse;
pub(crate) use print::print;
