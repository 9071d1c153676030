//! Damaged tables are read or refused with their file and line.

use proptest::prelude::*;

use self::damage::damaged;
use crate::load::table;

#[path = "../common/damage.rs"]
mod damage;

const FILE: &str = "inner-lever-arm.toml";

proptest! {
    #[test]
    fn fuzz_tables(damaged in damaged(include_bytes!("../../models/tables/inner-lever-arm.toml").to_vec())) {
        let Ok(text) = std::str::from_utf8(&damaged) else { return Ok(()) };
        if let Err(message) = table(FILE, text) {
            prop_assert!(message.starts_with("inner-lever-arm.toml:"), "{message}");
        }
    }
}
