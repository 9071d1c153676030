//! The parts of the build script that read tables.

#[path = "../../build/expr.rs"]
mod expr;
mod expressions;
