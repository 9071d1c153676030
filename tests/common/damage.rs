//! Damaged copies of sound files, for fuzzing whatever reads them.
//!
//! Every fuzz test runs a couple of hundred cases with the other tests. A longer run of all of them:
//! `PROPTEST_RNG_SEED=$RANDOM PROPTEST_CASES=100000 cargo test --release --workspace fuzz`.

use proptest::prelude::*;
use proptest::sample::{Index, select};

/// What readers stumble over.
const WORDS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-0",
    "1e-320",
    "99999999999999999999",
    "\0",
    "\u{feff}",
    "\r",
    "\n",
    ",",
    ";",
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    "'''",
    "#",
    "\u{1f600}",
    "-",
    ".",
];

/// Bytes that have nothing to do with `sound`, or, more often, a copy of it with up to eight faults: bytes changed, pieces
/// cut out, doubled or moved, words put in, the end cut off.
pub(crate) fn damaged(sound: Vec<u8>) -> impl Strategy<Value = Vec<u8>> {
    let fault = (any::<Index>(), any::<Index>(), 0..6_u8, any::<u8>(), select(&WORDS[..]));
    let faulty = prop::collection::vec(fault, 1..8).prop_map(move |faults| {
        let mut bytes = sound.clone();
        for (from, to, kind, byte, word) in faults {
            if bytes.is_empty() {
                break;
            }
            let (from, to) = (from.index(bytes.len()), to.index(bytes.len()));
            // pieces of a line or two, now and then of any length
            let to = if byte % 8 == 0 { to.max(from) } else { (from + usize::from(byte)).min(bytes.len()) };
            match kind {
                0 => bytes[from] = byte,
                1 => drop(bytes.drain(from..to)),
                2 => {
                    let piece = bytes[from..to].to_vec();
                    drop(bytes.splice(from..from, piece));
                }
                3 => bytes[from..to].reverse(),
                4 => drop(bytes.splice(from..from, word.bytes())),
                _ => bytes.truncate(from.max(to)),
            }
        }
        bytes
    });
    prop_oneof![1 => prop::collection::vec(any::<u8>(), 0..2000), 7 => faulty]
}
