//! Tree to program: names, types, argument modes, and lowering in one pass over checked declarations.

mod aggregate;
mod assignment;
mod call;
mod constant;
mod data;
mod declared_types;
mod expression;
mod interrupt;
mod loops;
mod motion;
mod operation;
mod place;
mod program;
mod routine;
mod scope;
mod signal;
mod statement;
mod system;
pub(crate) mod types;

pub(crate) use program::{Signals, Unit, compile};
pub(crate) use scope::{Compiler, ParameterType, Signature};
