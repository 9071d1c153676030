//! The parts of the build script that read tables.

#[path = "../../build/expr.rs"]
mod expr;
mod expressions;
mod fuzz;
#[allow(dead_code, reason = "only the emitter reads all of a table")]
#[path = "../../build/ir.rs"]
mod ir;
#[path = "../../build/load.rs"]
mod load;
#[path = "../../build/raw.rs"]
mod raw;
#[path = "../../build/read.rs"]
mod read;
mod tables;
