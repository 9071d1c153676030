//! Only benchmarks: see `benches/peers.rs`.
