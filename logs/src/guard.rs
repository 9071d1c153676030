//! Decoders of other people's formats: a panic in one of them is a damaged file, not a fault of the program.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is inside a decoder, whose panics are caught and reported as a damaged file.
pub fn decoding() -> bool {
    DECODING.get()
}

/// Runs a decoder. It checks most of what it reads, but a damaged file may still bring it to panic; the file is then refused
/// like any other damaged one.
pub(super) fn guarded<T, E: std::fmt::Display>(decode: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    DECODING.set(true);
    let result = catch_unwind(AssertUnwindSafe(decode));
    DECODING.set(false);
    match result {
        Ok(result) => result.map_err(|error| error.to_string()),
        Err(_) => Err("its contents contradict each other".into()),
    }
}
