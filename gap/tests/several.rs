//! Several logs of one unit: what is too faint for one is named by three.

use gap::{Diagnosis, Log, Options, Verdict, diagnose};
use rig::scenario::Population;
use rig::{Description, DitherMode, Scenario, Simulation};
use runs::Vocabulary;
use sinscal::{Sample, any_effect};

/// The effect, some six standard deviations of what one log shows, s.
const DELAY: f64 = 1.8e-5;

/// A run of a unit whose accelerometers are late by a little, which 36d-p does not know.
fn run(number: u64, delay: f64) -> (Vec<Sample>, Description) {
    let mut scenario = Scenario::default().with_rate(20.0).unwrap();
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").unwrap();
    let known = filter.blocks();
    scenario.keep_effects(|name| known.iter().any(|leaf| leaf.name == name));
    let effect = any_effect("accel-delay").unwrap();
    scenario.population.push(Population { effect, mean: vec![delay], sigma: vec![0.0] });
    scenario.dither.mode = DitherMode::Off;
    scenario.motion.still = 100.0;
    scenario.motion.dwell = 30.0;
    scenario.run = number;
    let simulation = Simulation::new(&scenario, 77).unwrap();
    let description = simulation.description().clone();
    (simulation.collect(), description)
}

fn diagnosed(
    runs: &[(Vec<Sample>, Description)],
    verify: &(Vec<Sample>, Description),
    options: &Options,
) -> Diagnosis {
    let setups: Vec<_> = runs.iter().map(|run| run.1.setup(&[])).collect();
    let logs: Vec<Log> =
        runs.iter().zip(&setups).map(|(run, setup)| Log { samples: &run.0, setup }).collect();
    let there = verify.1.setup(&[]);
    let verify = Log { samples: &verify.0, setup: &there };
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").unwrap();
    diagnose(&*filter, vocabulary.effects(), &logs, Some(&verify), options, &mut |_, _| {}).unwrap()
}

#[test]
fn three_logs_name_what_one_leaves_open() {
    let runs: Vec<_> = (0..3).map(|number| run(number, DELAY)).collect();
    let verify = run(3, DELAY);
    let options = Options { rerun: false, ..Options::default() };
    let of = |d: &Diagnosis| d.rivals.iter().find(|rival| rival.name == "accel-delay").unwrap().gain_alone;
    let one = diagnosed(&runs[..1], &verify, &options);
    let all = diagnosed(&runs, &verify, &Options::default());
    println!("{} {}\n{} {}", of(&one), one.sentence, of(&all), all.sentence);
    assert_ne!(one.verdict, Verdict::EffectsFound, "{}", one.sentence);
    assert!(all.verdict == Verdict::EffectsFound && all.verified, "{}", all.sentence);
    let [found] = all.effects.as_slice() else { panic!("{}", all.sentence) };
    assert_eq!(found.name, "accel-delay");
    assert!((found.estimate[0] - DELAY).abs() < 4.0 * found.sigma[0], "{found:?}");
    // the evidence adds, and the closed loops gain what it was priced at
    assert!(of(&all) > 2.0 * of(&one), "{} and {}", of(&all), of(&one));
    let fit = all.gap.unwrap().fit;
    let gained = fit.log_likelihood_after - fit.log_likelihood_before;
    assert!((gained - fit.log_likelihood_gain_priced).abs() < 0.1 * gained, "{fit:?}");
}

#[test]
fn the_same_log_twice_is_no_more_evidence() {
    let runs = [run(0, DELAY), run(0, DELAY)];
    let verify = run(1, DELAY);
    let options = Options { rerun: false, ..Options::default() };
    let (one, twice) = (diagnosed(&runs[..1], &verify, &options), diagnosed(&runs, &verify, &options));
    assert_eq!((&one.sentence, &one.rivals), (&twice.sentence, &twice.rivals));
    assert!(twice.notes.iter().any(|note| note.contains("the log number 2 is one of those before it again")));
}
