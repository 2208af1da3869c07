//! Tree to program: names, types, argument modes, and lowering in one pass over checked declarations.

mod arguments;
mod declare;
mod expression;
mod scope;
mod statement;
pub(crate) mod types;

pub(crate) use declare::{compile, undefined_signals};
pub(crate) use scope::Callee;
