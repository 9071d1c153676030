//! Verdicts over many units: the right filter fits, one that lacks effects does not.

use rig::{Scenario, Simulation};
use runs::{Options, Vocabulary, calibrate};
use sinscal::Sample;

#[test]
fn with_readings_the_right_filter_fits_nineteen_units_of_twenty() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::default().with_rate(20.0)?;
    scenario.motion.still = 60.0;
    scenario.motion.dwell = 30.0;
    let vocabulary = Vocabulary::standard();
    let mut fitting = [0, 0];
    for unit in 1..=20 {
        let simulation = Simulation::new(&scenario, unit)?;
        let description = simulation.description().clone();
        let samples: Vec<Sample> = simulation.collect();
        for (count, name) in fitting.iter_mut().zip(["43d-b", "36d-p"]) {
            let filter = vocabulary.filter(name)?;
            let options = Options { history_step: 10.0, ..Options::of(&*filter) };
            let outcome = calibrate(&*filter, &samples, &description.setup(&[]), &options, &mut ())?;
            *count += usize::from(outcome.verdict().fits());
        }
    }
    assert!(fitting[0] >= 19 && fitting[1] <= 1, "{fitting:?}");
    Ok(())
}
