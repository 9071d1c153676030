//! The price of a set of effects is what running the filter with them says.

use gap::{Log, Noise, Pricing};
use rig::{Scenario, Simulation, TemperatureProfile};
use runs::Vocabulary;
use sinscal::Sample;

fn log() -> (Vec<Sample>, rig::Description) {
    let mut scenario = Scenario::default().with_rate(20.0).unwrap();
    scenario.motion.still = 60.0;
    scenario.motion.dwell = 30.0;
    scenario.temperature.profile = TemperatureProfile::Ramps(vec![(0.0, 20.0), (500.0, 40.0), (900.0, 25.0)]);
    let simulation = Simulation::new(&scenario, 11).unwrap();
    let description = simulation.description().clone();
    (simulation.collect(), description)
}

#[test]
fn prices_equal_the_augmented_filter() {
    let (samples, description) = log();
    let setup = description.setup(&[]);
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").expect("a filter of the library");
    let prices =
        Pricing::of(&*filter, vocabulary.effects(), &Log { samples: &samples, setup: &setup }, Noise::STATED)
            .unwrap();
    let sets: &[&[&str]] = &[
        &["accel-delay"],
        &["inner-lever-arm"],
        &["accel-temperature-scale"],
        &["gyro-bias-drift"],
        &["reference-tilt"],
        &["inner-lever-arm-tangential"],
        &["accel-delay", "inner-lever-arm"],
        &["dither-size-effect", "accel-temperature-bias"],
        &["accel-cubic", "gyro-g-sensitivity"],
        &["accel-delay", "inner-lever-arm", "accel-temperature-scale"],
        &["accel-bias-drift", "accel-temperature-rate", "accel-scale-asymmetry"],
    ];
    for set in sets {
        let priced = prices.gain(set).unwrap();
        let run = prices.gain_by_running(set).unwrap();
        // relative to the log-likelihood; the smaller gains are held to the same absolute error
        let error = (priced - run).abs() / prices.base().abs();
        assert!(error < 1e-9, "{set:?}: priced {priced}, run {run}");
        assert!(
            (priced - run).abs() < 1e-6 * run.abs().max(1.0) * 10.0,
            "{set:?}: priced {priced}, run {run}"
        );
    }
    // what the unit has is seen with its value
    let delay =
        prices.estimate(&["accel-delay", "inner-lever-arm", "accel-temperature-scale", "dither-size-effect"]);
    let truth = Simulation::new(&Scenario::default(), 11).unwrap().truth().value("accel-delay", 0);
    let (value, sigma) = delay.unwrap()[0];
    assert!((value - truth).abs() < 4.0 * sigma, "{value} +- {sigma}, truth {truth}");
    assert!(prices.gain(&["no-such-effect"]).is_none());
}
