//! The program `sinscal`.
fn main() {}
