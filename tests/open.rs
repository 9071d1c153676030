//! Blocks that join a filter at run time act as if they had been declared.

use calib_core::{Conventional, Filter, Shape};
use rig::{Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{AnyBlock, AnyEffect, Effect, OpenBlocks, Sample, Setup, Sins39P, Sins40P, Statistics};

/// 39D-P with room for what its user may ask for.
#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Roomy {
    #[base]
    sins: Sins39P,
    open: Open,
}

/// What two runs are compared by: values and sigmas by name, and how well the log was explained.
struct Found {
    parameters: Vec<(String, f64, f64)>,
    statistics: Statistics,
}

fn find<F: Filter<Dynamics = Strapdown>>(setup: &Setup, samples: &[Sample], open: OpenBlocks) -> Found {
    let mut run =
        Box::new(Calibration::<F, Conventional>::new(&Setup { open, ..*setup }).expect("a sound setup"));
    for pass in 0..2 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in samples {
            run.step(sample).unwrap();
        }
    }
    let mut parameters = Vec::new();
    run.parameters(&mut |p| {
        if p.info.block != Open::NAME {
            parameters.push((format!("{} {}", p.info.block, p.info.component), p.value, p.sigma));
        } else {
            assert_eq!((p.value, p.sigma, p.estimated), (0.0, 0.0, false), "a place that nobody takes");
        }
    });
    Found { parameters, statistics: *run.statistics() }
}

fn log() -> (rig::Description, Vec<Sample>) {
    let scenario = Scenario::parse(
        "[imu]\nrate = \"50 Hz\"\n[motion]\npath = \"nineteen-positions\"\nstill = \"20 s\"\ndwell = \"8 s\"",
    )
    .unwrap()
    .modelled_by::<Sins40P>();
    let simulation = Simulation::new(&scenario, 3).unwrap();
    (simulation.description().clone(), simulation.collect())
}

#[test]
fn a_filter_with_an_open_delay_is_the_filter_that_declares_it() {
    static DELAY: [&dyn AnyBlock; 1] = [<dyn AnyBlock>::of::<AccelDelay>()];
    let (description, samples) = log();
    let setup = description.setup(&[]);
    let open = find::<Roomy>(&setup, &samples, OpenBlocks::new(&DELAY).unwrap());
    let declared = find::<Sins40P>(&setup, &samples, OpenBlocks::NONE);
    assert_eq!(open.parameters.len(), declared.parameters.len());
    for ((name, value, sigma), (of, expected, by)) in open.parameters.iter().zip(&declared.parameters) {
        assert_eq!(name, of);
        assert!((value - expected).abs() <= 1e-9 * by, "{name}: {value} {expected} +- {by}");
        assert!((sigma / by - 1.0).abs() <= 1e-9, "{name}: sigma {sigma} {by}");
    }
    let delay = declared.parameters.last().unwrap();
    assert!(delay.1.abs() > 10.0 * delay.2, "the log shows the delay: {delay:?}");
    assert!((open.statistics.nis / declared.statistics.nis - 1.0).abs() < 1e-12);
    // and without it the same filter is another
    let without = find::<Roomy>(&setup, &samples, OpenBlocks::NONE);
    assert!(
        without.statistics.nis > 1.1 * declared.statistics.nis,
        "{} {}",
        without.statistics.nis,
        declared.statistics.nis
    );
}

#[test]
fn an_effect_of_the_reference_and_the_priors_of_a_setup_join_too() {
    static TWO: [&dyn AnyBlock; 2] =
        [<dyn AnyBlock>::of::<ReferenceDelay>(), <dyn AnyBlock>::of::<AccelDelay>()];
    #[derive(StateBlocks)]
    #[filter(measures(velocity, position))]
    struct Declared {
        #[base]
        sins: Sins39P,
        late: ReferenceDelay,
        delay: AccelDelay,
    }
    #[derive(StateBlocks)]
    #[filter(measures(velocity, position))]
    struct Swapped {
        #[base]
        sins: Sins39P,
        delay: AccelDelay,
        late: ReferenceDelay,
    }
    let (description, samples) = log();
    let priors = [("reference-delay", 1e-4), ("accel-delay", 1e-3)];
    let setup = description.setup(&priors);
    let open = find::<Roomy>(&setup, &samples, OpenBlocks::new(&TWO).unwrap());
    let declared = find::<Declared>(&setup, &samples, OpenBlocks::NONE);
    let swapped = find::<Swapped>(&setup, &samples, OpenBlocks::NONE);
    // rounding on this log: what swapping two fields of a declaration does
    let last = declared.parameters.len() - 2;
    let of = |found: &Found, i: usize| {
        (found.parameters[i].1 - declared.parameters[i].1) / declared.parameters[i].2
    };
    let rounding = (0..last).map(|i| of(&swapped, i).abs()).fold(0.0, f64::max);
    assert!(rounding < 1e-5);
    for (i, ((name, value, _), (as_declared, ..))) in
        open.parameters.iter().zip(&declared.parameters).enumerate()
    {
        assert_eq!(name, as_declared);
        assert!(of(&open, i).abs() <= 5.0 * rounding, "{name}: {value}, {} sigma off", of(&open, i));
        let sigma = open.parameters[i].2 / declared.parameters[i].2;
        assert!((sigma - 1.0).abs() <= 1e-7, "{name}: {sigma} of its sigma");
    }
}

/// Says that it has two states and describes one.
struct Short;

impl Block for Short {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "short";
    const DIM: usize = 2;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        let mut first = true;
        <GyroScale as Effect>::EFFECT.states(&mut |info| {
            if std::mem::take(&mut first) {
                visit(StateInfo { block: "short", ..info });
            }
        });
    }
}

#[test]
fn what_cannot_join_is_refused_by_name() {
    static SHORT: [&dyn AnyBlock; 1] = [<dyn AnyBlock>::of::<Short>()];
    static MANY: [&dyn AnyBlock; 2] = [<dyn AnyBlock>::of::<AccelErrors>(), <dyn AnyBlock>::of::<Sins36P>()];
    use sinscal::Sins36P;
    let short = OpenBlocks::new(&SHORT).unwrap_err().to_string();
    assert!(short.starts_with("`short` describes another number of states"), "{short}");
    let many = OpenBlocks::new(&MANY).unwrap_err().to_string();
    assert_eq!(many, "no room for `attitude`: blocks that join at run time have up to 32 states");
}

#[test]
fn effects_as_objects_say_what_their_types_say() {
    let delay = <dyn AnyEffect>::of::<AccelDelay>();
    assert_eq!(*delay.info(), <AccelDelay as Effect>::EFFECT);
    assert_eq!(format!("{delay:?}"), "accel-delay");
    let group = <dyn AnyBlock>::of::<GyroErrors>();
    assert_eq!(
        (group.dim(), format!("{group:?}")),
        (9, r#"["gyro-scale", "gyro-misalignment", "gyro-bias"]"#.to_owned())
    );
    assert_eq!(Roomy::DIM, <Roomy as Filter>::Shape::STATES);
}
