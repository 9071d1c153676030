//! A filter composed at run time says what the declared one says.

use rig::{Scenario, Simulation};
use runs::{AnyFilter, Options, Outcome, Vocabulary, calibrate, observe};
use sinscal::Sample;

/// Compositions that are declared filters too: base, with, without, declared.
const SAME: [(&str, &[&str], &[&str], &str); 4] = [
    ("39d-p", &["accel-delay"], &[], "40d-p"),
    ("36d-p", &["inner-lever-arm", "accel-delay", "accel-temperature-scale"], &[], "43d-p"),
    ("43d-p", &["dither-size-effect"], &[], "43d-b"),
    ("43d-b", &[], &["accel-temperature-scale", "accel-delay", "dither"], "39d-p"),
];

/// What another order of the states makes of rounding on this log, in standard deviations: so much differ two declared filters of
/// the same blocks in another order (`tests/open.rs` of the library measures it).
const ROUNDING: f64 = 1e-5;

fn log() -> (rig::Description, Vec<Sample>) {
    let text =
        "[imu]\nrate = \"50 Hz\"\n[motion]\npath = \"nineteen-positions\"\nstill = \"20 s\"\ndwell = \"8 s\"";
    let simulation = Simulation::new(&Scenario::parse(text).expect("a scenario"), 3).expect("a unit");
    (simulation.description().clone(), simulation.collect())
}

fn run(
    filter: &dyn AnyFilter,
    passes: u32,
    (description, samples): &(rig::Description, Vec<Sample>),
) -> Outcome {
    let priors = [("accel-bias", 5e-3)];
    let setup = description.setup(&priors);
    let options = Options { passes, ..Options::of(filter) };
    calibrate(filter, samples, &setup, &options, &mut ()).expect("an outcome")
}

/// Runs a test where a quarter of a test's usual stack of 2 MiB is left to whoever calls: all blocks at once make large matrices.
fn in_three_quarters_of_a_stack(test: fn()) {
    let thread = std::thread::Builder::new().stack_size(3 << 19).spawn(test).expect("a thread");
    thread.join().expect("a test that passes");
}

#[test]
fn composed_and_declared_filters_say_the_same() {
    in_three_quarters_of_a_stack(say_the_same);
}

fn say_the_same() {
    let vocabulary = Vocabulary::standard();
    let log = log();
    for ((base, with, without, declared), passes) in SAME.into_iter().flat_map(|same| [(same, 1), (same, 2)])
    {
        let composed = vocabulary.composed(base, with, without).expect("a composition");
        let declared = vocabulary.filter(declared).expect("a filter");
        assert_eq!(composed.needs_dither(), declared.needs_dither(), "{}", composed.title());
        let (a, b) = (run(&*composed, passes, &log), run(&*declared, passes, &log));
        assert_eq!(a.parameters.len(), b.parameters.len());
        for p in &b.parameters {
            let same = |q: &&sinscal::Parameter| {
                (q.info.block, q.info.component) == (p.info.block, p.info.component)
            };
            let q = a.parameters.iter().find(same).expect("the same parameters");
            let (off, sigma) = ((q.value - p.value) / p.sigma, q.sigma / p.sigma - 1.0);
            assert!(
                off.abs() < ROUNDING && sigma.abs() < ROUNDING,
                "{passes} passes of {}, {} {}: {off:e} sigma off, sigma by {sigma:e}",
                composed.title(),
                p.info.block,
                p.info.component
            );
        }
        assert_eq!(a.statistics.updates, b.statistics.updates);
    }
}

#[test]
fn a_composed_filter_sees_of_a_log_what_the_declared_one_sees() {
    in_three_quarters_of_a_stack(see_the_same);
}

fn see_the_same() {
    let vocabulary = Vocabulary::standard();
    let (description, samples) = log();
    let setup = description.setup(&[]);
    let composed = vocabulary.composed("39d-p", &["accel-delay"], &[]).expect("a composition");
    let declared = vocabulary.filter("40d-p").expect("a filter");
    let a = observe(&*composed, &samples, &setup).expect("an analysis");
    let b = observe(&*declared, &samples, &setup).expect("an analysis");
    assert_eq!((a.rank, a.states.len(), a.segments), (b.rank, b.states.len(), b.segments));
    assert_eq!(a.singular_values.len(), b.singular_values.len());
    for (a, b) in a.singular_values.iter().zip(&b.singular_values) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
    for (a, b) in a.states.iter().zip(&b.states) {
        assert_eq!(a.info, b.info);
        assert!((a.degree / b.degree - 1.0).abs() < 1e-6, "{:?}: {} {}", a.info, a.degree, b.degree);
    }
}

#[test]
fn what_does_not_go_together_is_refused_by_name() {
    let vocabulary = Vocabulary::standard();
    let refused = |base, with: &[&str], without: &[&str]| {
        vocabulary.composed(base, with, without).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert_eq!(refused("40d-p", &["accel-delay"], &[]), "40d-p has `accel-delay` already");
    assert_eq!(refused("36d-p", &[], &["accel-delay"]), "36d-p has no `accel-delay` that could be left out");
    assert_eq!(refused("36d-p", &[], &["attitude"]), "36d-p has no `attitude` that could be left out");
    assert_eq!(refused("36d-p", &["acel-delay"], &[]), "there is no effect called acel-delay");
}

/// What joins at run time is told apart by type: objects without size may stand at one address.
#[test]
fn compositions_of_other_blocks_are_others() -> Result<(), Box<dyn std::error::Error>> {
    let vocabulary = Vocabulary::standard();
    for name in ["gyro-bias-wander", "accel-bias-wander", "gyro-bias-random-walk", "accel-bias-random-walk"] {
        let filter = vocabulary.composed("36d-p", &[name], &[])?;
        let joined = format!("{:?}", filter.compiled().1.open);
        assert_eq!(joined, format!("[[{name:?}]]"));
    }
    Ok(())
}
