//! Passes that agree where linearisation bears, and sigmas that stay formal where the model is right and grow where it is not.

use rig::{Scenario, Simulation};
use runs::{Options, Outcome, Together, Verdict, Vocabulary, calibrate};
use sinscal::{Sample, SiteFault};

struct Log {
    description: rig::Description,
    samples: Vec<Sample>,
}

fn log(text: &str, unit: u64) -> Log {
    let simulation = Simulation::new(&Scenario::parse(text).expect("a scenario"), unit).expect("a unit");
    Log { description: simulation.description().clone(), samples: simulation.collect() }
}

fn run(filter: &str, log: &Log, passes: u32, settle: bool) -> Outcome {
    let filter = Vocabulary::standard().filter(filter).expect("a filter");
    let options = Options { passes, settle, history_step: 10.0, ..Options::of(&*filter) };
    calibrate(&*filter, &log.samples, &log.description.setup(&[]), &options, &mut ()).expect("an outcome")
}

/// Largest difference of two outcomes in the first's standard deviations.
fn apart(a: &Outcome, b: &Outcome) -> f64 {
    let both = a.parameters.iter().zip(&b.parameters);
    both.fold(0.0, |most, (a, b)| most.max((a.value - b.value).abs() / a.sigma))
}

const LASER: &str = "[imu]\nrate = \"20 Hz\"\n[motion]\nstill = \"60 s\"\ndwell = \"30 s\"";

#[test]
fn on_sound_logs_the_figures_are_those_of_the_passes_alone_and_halves_agree() {
    let (mut widened, mut sum, mut count) = (0, 0.0, 0.0);
    for unit in 1..=8 {
        let log = log(LASER, unit);
        let (settled, plain) = (run("43d-b", &log, 2, true), run("43d-b", &log, 2, false));
        let repeat = settled.repeat.as_ref().expect("asked for");
        assert!(settled.moved.is_some_and(|moved| moved < 0.01), "{:?}", settled.moved);
        assert_eq!(settled.passes.len(), 2);
        assert!(apart(&settled, &plain) < 1e-9);
        // eighteen rests show where the log was taken
        let shown = settled.site.expect("rests in many positions");
        let off = (shown.latitude.0 - log.description.site.latitude) / shown.latitude.1;
        assert!(off.abs() < 4.0 && shown.latitude.1 < 1e-3 && settled.site_fault.is_none(), "{shown:?}");
        widened += usize::from(repeat.factors.iter().any(|factor| *factor > 1.01));
        let halves: Vec<f64> = repeat.halves.iter().flatten().copied().collect();
        sum += halves.iter().map(|half| half * half).sum::<f64>();
        count += halves.len() as f64;
    }
    assert!(widened <= 1, "{widened} of 8 sound logs have other sigmas than the filter's");
    // 8 times some 30 dependent numbers
    assert!(((0.7..1.3).contains(&(sum / count))) && count > 200.0, "{sum} of {count}");
}

#[test]
fn rests_that_contradict_the_site_are_no_fit() {
    let mut log = log(LASER, 1);
    assert!(run("43d-b", &log, 2, true).verdict().fits());
    log.description.site.latitude += 0.5_f64.to_radians();
    let elsewhere = run("43d-b", &log, 2, true);
    assert_eq!(elsewhere.verdict(), Verdict::Site(SiteFault::Latitude), "{:?}", elsewhere.site);
}

#[test]
fn a_wander_that_the_filter_lacks_is_in_the_sigmas() {
    const NAMES: [&str; 2] = ["gyro-scale", "gyro-misalignment"];
    let text = format!("{LASER}\n[gyro]\nbias_random_walk = \"0.1 deg/h/sqrt(h)\"");
    let (mut formal, mut stated, mut count) = (0.0, 0.0, 0.0);
    for unit in 1..=6 {
        let simulation = Simulation::new(&Scenario::parse(&text).expect("a scenario"), unit).expect("a unit");
        let truth = NAMES.map(|name| [0, 1, 2].map(|i| simulation.truth().value(name, i)));
        let log = Log { description: simulation.description().clone(), samples: simulation.collect() };
        let settled = run("43d-b", &log, 2, true);
        let repeat = settled.repeat.as_ref().expect("asked for");
        for (name, truth) in NAMES.iter().zip(truth) {
            let all = settled.parameters.iter().zip(&repeat.factors);
            let named = all.filter(|(parameter, _)| parameter.info.block == *name);
            for ((parameter, factor), truth) in named.zip(truth) {
                let off = ((parameter.value - truth) / parameter.sigma).powi(2);
                stated += off;
                formal += off * factor.powi(2);
                count += 1.0;
            }
        }
    }
    // the mean of so many squares is 1, give or take 0.24
    let (formal, stated) = (formal / count, stated / count);
    assert!(
        formal > 2.0 && (0.4..1.7).contains(&stated) && count == 36.0,
        "{formal} formal, {stated} stated"
    );
}

#[test]
fn several_runs_of_a_unit_add_up_and_runs_of_two_units_contradict_each_other() {
    let mut scenario = Scenario::parse(LASER).expect("a scenario");
    let mut of = |unit: u64, noise: u64| {
        scenario.run = noise;
        let simulation = Simulation::new(&scenario, unit).expect("a unit");
        let truth = simulation.truth().clone();
        let log = Log { description: simulation.description().clone(), samples: simulation.collect() };
        (run("43d-b", &log, 2, true), truth)
    };
    let runs: Vec<_> = (0..4).map(|noise| of(1, noise)).collect();
    let outcomes: Vec<&Outcome> = runs.iter().map(|(outcome, _)| outcome).collect();
    let filter = Vocabulary::standard().filter("43d-b").expect("a filter");
    let alone = Together::of(&*filter, &outcomes[..1]).expect("one log");
    for (a, b) in alone.parameters.iter().zip(&outcomes[0].parameters) {
        assert!(((a.value - b.value) / b.sigma).abs() < 1e-6 && (a.sigma / b.sigma - 1.0).abs() < 1e-6);
    }
    let together = Together::of(&*filter, &outcomes).expect("four logs");
    assert!(!together.contradict(), "{:?}", together.scatter);
    let mut nees = 0.0;
    for (parameter, own) in together.parameters.iter().zip(&outcomes[0].parameters) {
        // half, where the prior says nothing
        assert!((0.45..0.65).contains(&(parameter.sigma / own.sigma)), "{}", parameter.info.block);
        nees += ((parameter.value - runs[0].1.of(&parameter.info)) / parameter.sigma).powi(2);
    }
    let nees = nees / together.parameters.len() as f64;
    assert!((0.4..1.8).contains(&nees), "{nees}");
    let (other, _) = of(2, 0);
    let both = Together::of(&*filter, &[outcomes[0], &other]).expect("two logs");
    assert!(
        both.contradict() && both.factors.iter().filter(|factor| **factor > 10.0).count() > 25,
        "{:?}",
        both.scatter
    );
}

#[test]
fn what_wanders_is_not_common_to_logs() {
    let text = format!("{LASER}\n[gyro]\nbias_instability = \"0.02 deg/h\"\nbias_correlation = \"300 s\"");
    let log = log(&text, 1);
    let base = Vocabulary::standard().filter("36d-p").expect("a filter");
    let filter = runs::wandering(&base, &log.description.wander).expect("room");
    let options = Options { history_step: 10.0, ..Options::of(&*filter) };
    let outcome =
        calibrate(&*filter, &log.samples, &log.description.setup(&[]), &options, &mut ()).expect("one");
    let together = Together::of(&*filter, &[&outcome, &outcome]).expect("two logs");
    assert_eq!(outcome.parameters.len(), together.parameters.len() + 3);
    for (parameter, place) in together.parameters.iter().zip(&together.places) {
        assert_eq!(parameter.info, outcome.parameters[*place].info);
        assert_ne!(parameter.info.block, "gyro-bias-wander");
    }
}
