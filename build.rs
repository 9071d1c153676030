//! `models/tables/*.toml` -> `OUT_DIR/tables.rs`: read -> check -> emit.
//!
//! The tables are derived by `models/derivation` and committed. This script runs no other program and writes
//! nothing into the source tree.

#[path = "build/emit.rs"]
mod emit;
#[path = "build/expr.rs"]
mod expr;
#[path = "build/ir.rs"]
mod ir;
#[path = "build/load.rs"]
mod load;
#[path = "build/raw.rs"]
mod raw;
#[path = "build/read.rs"]
mod read;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs};

const TABLES: &str = "models/tables";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(messages) => {
            for message in &messages {
                println!("cargo::error={message}");
            }
            ExitCode::FAILURE
        }
    }
}

/// Every table's mistake is reported, not only the first.
fn run() -> Result<(), Vec<String>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed={TABLES}");
    let one = |message: String| vec![message];
    let (mut tables, mut wrong) = (Vec::new(), Vec::new());
    for path in table_files().map_err(one)? {
        println!("cargo::rerun-if-changed={}", path.display());
        match load(&path) {
            Ok(table) => tables.push(table),
            Err(message) => wrong.push(message),
        }
    }
    if !wrong.is_empty() {
        return Err(wrong);
    }
    if tables.is_empty() {
        return Err(one(format!("{TABLES}: no table")));
    }
    let tokens = emit::emit(&tables);
    let file = syn::parse2(tokens).map_err(|e| one(format!("generated code does not parse: {e}")))?;
    let out = env::var_os("OUT_DIR").ok_or_else(|| one("OUT_DIR is not set".to_owned()))?;
    let out = Path::new(&out).join("tables.rs");
    fs::write(&out, prettyplease::unparse(&file)).map_err(|e| one(format!("{}: {e}", out.display())))
}

/// The tables in order of their names.
fn table_files() -> Result<Vec<PathBuf>, String> {
    let failed = |e| format!("{TABLES}: {e}");
    let mut files = Vec::new();
    for entry in fs::read_dir(TABLES).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e == "toml") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn load(path: &Path) -> Result<ir::Table, String> {
    let file = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|e| format!("{file}: {e}"))?;
    load::table(&file, &text)
}
