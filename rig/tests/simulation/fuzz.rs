//! Damaged scenarios are read or refused, and what is read can be simulated.

use proptest::prelude::*;
use rig::{DEFAULT_SCENARIO, Scenario, Simulation};

use self::damage::damaged;

#[path = "../../../tests/common/damage.rs"]
mod damage;

proptest! {
    #[test]
    fn fuzz_scenario(damaged in damaged(DEFAULT_SCENARIO.into())) {
        let Ok(text) = std::str::from_utf8(&damaged) else { return Ok(()) };
        match Scenario::parse(text) {
            Ok(scenario) => {
                let simulation = Simulation::new(&scenario, 1);
                prop_assert!(simulation.is_ok(), "{:?}", simulation.err());
                for sample in simulation.into_iter().flatten().take(3) {
                    prop_assert!(sample.dvel.iter().chain(&sample.dtheta).all(|value| value.is_finite()));
                }
            }
            Err(error) => prop_assert!(!error.faults.is_empty() && !error.to_string().is_empty()),
        }
    }
}
