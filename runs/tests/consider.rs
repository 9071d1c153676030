//! What is considered is in the sigmas of a filter whose passes agree, and what was taken as exact is told.

use std::sync::Arc;

use rig::{Scenario, Simulation};
use runs::{AnyFilter, Options, Outcome, Vocabulary, calibrate, considering, exact};
use sinscal::{Sample, any_effect};

const LASER: &str = "[imu]\nrate = \"20 Hz\"\n[motion]\nstill = \"60 s\"\ndwell = \"30 s\"";

fn simulated(text: &str, unit: u64) -> (Simulation, Vec<Sample>) {
    let mut simulation = Simulation::new(&Scenario::parse(text).expect("a scenario"), unit).expect("a unit");
    let samples = simulation.by_ref().collect();
    (simulation, samples)
}

fn filter(considered: &[&str]) -> Arc<dyn AnyFilter> {
    let plain = Vocabulary::standard().filter("43d-b").expect("a filter");
    let effects: Vec<_> = considered.iter().map(|name| any_effect(name).expect("an effect")).collect();
    considering(&plain, &effects).expect("room")
}

fn options(filter: &dyn AnyFilter) -> Options {
    Options { passes: 2, settle: true, history_step: 10.0, ..Options::of(filter) }
}

fn run(filter: &dyn AnyFilter, simulation: &Simulation, samples: &Vec<Sample>) -> Outcome {
    let setup = simulation.description();
    calibrate(filter, samples, &setup.setup(&[]), &options(filter), &mut ()).expect("an outcome")
}

#[test]
fn sigmas_are_the_root_sum_of_squares_of_what_they_are_made_of() {
    let (simulation, samples) = simulated(LASER, 1);
    let plain = run(&*filter(&[]), &simulation, &samples);
    let with = filter(&["clock-scale", "site-gravity"]);
    let outcome = run(&*with, &simulation, &samples);
    assert!(plain.budget.is_empty() && outcome.budget.len() == plain.parameters.len());
    assert!(outcome.moved.is_some() && outcome.passes.len() == plain.passes.len());
    let mut matters = Vec::new();
    for part in &outcome.budget {
        let (parameter, alone) = (&outcome.parameters[part.parameter], &plain.parameters[part.parameter]);
        assert_eq!(parameter.info.block, alone.info.block);
        let name = format!("{} {}", parameter.info.block, parameter.info.component);
        assert!((part.combined() / parameter.sigma - 1.0).abs() < 1e-9, "{name}");
        let variance = outcome.covariance[part.parameter][part.parameter];
        assert!((variance.sqrt() / parameter.sigma - 1.0).abs() < 1e-9, "{name}");
        assert!(part.influences.iter().map(|(name, _)| *name).eq(["clock-scale", "site-gravity"]), "{name}");
        assert!(parameter.sigma > 0.999 * alone.sigma, "{name}: considering makes nothing better known");
        if part.largest().is_some_and(|(_, by)| by > 10.0 * alone.sigma) {
            matters.push(name.clone());
        }
        if part.repeatability == 0.0 {
            // nothing but what was stated grows the sigma, and that has no degrees of freedom
            assert!(part.degrees_of_freedom() > 1e3, "{name}");
        }
    }
    // gravity is in the scale factors of the accelerometers, and hides what noise would leave of them
    assert_eq!(matters, ["accel-scale x", "accel-scale y", "accel-scale z"]);
}

#[test]
fn wander_that_a_filter_lacks_makes_errors_as_large_as_told() {
    let (simulation, samples) = simulated(LASER, 1);
    let plain = filter(&[]);
    let found = run(&*plain, &simulation, &samples);
    let setup = simulation.description();
    let told = exact(&plain, &samples, &setup.setup(&[]), &options(&*plain), &found);
    let told = told.expect("read").expect("room");
    assert!(told.largest(&found).is_some());
    let named = |name: &str| {
        let named = |(_, p): &(usize, &sinscal::Parameter)| p.info.block == name;
        found.parameters.iter().enumerate().filter(named).map(|(i, _)| i).collect::<Vec<_>>()
    };
    let biases = named("gyro-bias");
    // the wander is seen where it is small beside the noise, as it is for the biases; so much that the sigma of one is four times what the filter says
    let doubles: Vec<f64> = biases.iter().filter_map(|i| told.doubled_by(&found, *i)[0]).collect();
    assert_eq!(doubles.len(), 3);
    let sigma = 5.0_f64.sqrt() * doubles.iter().fold(f64::INFINITY, |least, by| least.min(*by));
    let expected = |i: usize| {
        let by = told.doubled_by(&found, i)[0].map_or(0.0, |doubles| sigma / doubles);
        1.0 + 3.0 * by * by
    };
    let text = format!("{LASER}\n[gyro]\nbias_instability = \"{sigma:e} rad/s\"\nbias_correlation = \"1 h\"");
    let (mut squares, mut allowed, mut count) = (0.0, 0.0, 0.0);
    for unit in 1..=8 {
        let (simulation, samples) = simulated(&text, unit);
        let quick = Options { settle: false, ..options(&*plain) };
        let outcome = calibrate(&*plain, &samples, &simulation.description().setup(&[]), &quick, &mut ())
            .expect("an outcome");
        for i in &biases {
            let parameter = &outcome.parameters[*i];
            let off = (parameter.value - simulation.truth().of(&parameter.info)) / found.parameters[*i].sigma;
            println!("{off:.2} of {:.2}", expected(*i).sqrt());
            squares += off * off / expected(*i);
            allowed += expected(*i);
            count += 1.0;
        }
    }
    let (squares, allowed) = (squares / count, allowed / count);
    println!("{squares:.2} of what is told, which is {allowed:.1} times the variance");
    assert!(allowed > 4.0, "{allowed}");
    // 24 squares: 0.34 to 2.1 in 999 cases of 1000
    assert!((0.34..2.1).contains(&squares), "{squares}");
}
