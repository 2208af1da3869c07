//! Tree to program: names, types, argument modes, and lowering in one pass over checked declarations.

mod aggregate;
mod arguments;
mod assignment;
mod call;
mod declared_types;
mod expression;
mod module_data;
mod operation;
mod place;
mod program;
mod routine;
mod scope;
mod statement;
pub(crate) mod types;
mod unused;
mod wait_until;

pub(crate) use program::{compile, undefined_signals};
pub(crate) use scope::Callee;
