//! A plan says what a calibration will state, is the same when made twice, and is better than what it is compared with.

use plan::{
    Criterion, Effort, Evaluator, KNOWN, Table, best_known, design, groups, known_paths, noise_alone,
};
use rig::{Scenario, Simulation};
use runs::{Options, Vocabulary, calibrate};
use sinscal::Sample;

type Tried = Result<(), Box<dyn std::error::Error>>;

/// A short path, at a rate that debug builds can do.
fn short() -> Result<Scenario, Box<dyn std::error::Error>> {
    let mut scenario = Scenario::default().with_rate(20.0)?;
    (scenario.motion.still, scenario.motion.dwell) = (30.0, 10.0);
    Ok(scenario)
}

#[test]
fn sigmas_are_those_that_a_calibration_states() -> Tried {
    let (scenario, vocabulary) = (short()?, Vocabulary::standard());
    for (name, close) in [("43d-b", 0.04), ("36d-p", 0.04)] {
        let filter = vocabulary.filter(name)?;
        let expected = Evaluator::new(filter.clone(), &scenario, 1).own()?;
        // a unit with all its errors, and every pass
        let simulation = Simulation::new(&scenario, 1)?;
        let description = simulation.description().clone();
        let samples: Vec<Sample> = simulation.collect();
        let outcome =
            calibrate(&*filter, &samples, &description.setup(&[]), &Options::of(&*filter), &mut ())?;
        assert_eq!(expected.sigma.len(), outcome.parameters.len());
        for ((info, sigma), stated) in expected.sigma.iter().zip(&outcome.parameters) {
            let ratio = sigma / stated.sigma;
            assert!((ratio - 1.0).abs() < close, "{name} {} {}: {ratio}", info.block, info.component);
        }
    }
    Ok(())
}

#[test]
fn a_rest_of_hours_is_one_of_the_same_noise() -> Tried {
    // readings of a long rest are used in lots
    let filter = Vocabulary::standard().filter("43d-b")?;
    let mut scenario = short()?;
    let stated = |scenario: &Scenario| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
        Ok(Evaluator::new(filter.clone(), scenario, 1).own()?.sigma.iter().map(|(_, sigma)| *sigma).collect())
    };
    (scenario.motion.dwell, scenario.reference.rate) = (180.0, 1.0);
    let often = stated(&scenario)?;
    // half as many readings of half the variance say the same
    scenario.reference.rate = 0.5;
    scenario.reference.velocity_sigma /= 2.0_f64.sqrt();
    scenario.reference.position_sigma /= 2.0_f64.sqrt();
    for (often, seldom) in often.iter().zip(stated(&scenario)?) {
        assert!((seldom / often - 1.0).abs() < 0.08, "{often} {seldom}");
    }
    Ok(())
}

#[test]
fn a_plan_made_twice_is_the_same_and_one_thread_makes_it_too() -> Tried {
    let scenario = short()?;
    let evaluator = Evaluator::new(Vocabulary::standard().filter("36d-p")?, &scenario, 1);
    let criterion = Criterion::against(&evaluator.own()?, &[], 200.0);
    let effort = Effort { evaluations: 250, seed: 5 };
    let make = || design(&evaluator, Table::ThreeAxis, 200.0, &criterion, &effort, &mut |_, _| true);
    let first = make()?;
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    assert_eq!(first, make()?);
    assert_eq!(first, alone.install(make)?);
    let (still, turns) = first;
    assert!((evaluator.along(&turns, still).duration() - 200.0).abs() < 1e-6);
    Ok(())
}

#[test]
fn a_plan_is_never_worse_than_what_is_known_and_a_table_does_what_it_can() -> Tried {
    let scenario = short()?;
    let evaluator = Evaluator::new(Vocabulary::standard().filter("36d-p")?, &scenario, 1);
    for table in Table::ALL {
        let reference = best_known(&evaluator, table, 240.0)?;
        let noise = noise_alone(&evaluator, table, 240.0)?;
        assert_eq!(noise.len(), groups(&reference).len());
        let criterion = Criterion::against(&reference, &noise, 240.0);
        let effort = Effort { evaluations: 150, seed: 2 };
        let (still, turns) = design(&evaluator, table, 240.0, &criterion, &effort, &mut |_, _| true)?;
        let found = criterion.of(&evaluator.turns(&turns, still)?);
        for (known, (still, turns)) in known_paths(&evaluator, table, 240.0) {
            let value = criterion.of(&evaluator.turns(&turns, still)?);
            assert!(found <= value, "{}: {found}, {} {value}", table.name(), known.name);
        }
        for turn in &turns {
            assert!(table.axes().contains(&turn.axis) && turn.dwell >= table.least_dwell());
            assert!(table.angles().iter().any(|angle| (angle - turn.angle.abs().to_degrees()).abs() < 1e-9));
        }
    }
    Ok(())
}

#[test]
#[ignore = "designs plans for tables of fewer axes: minutes in a release build"]
fn fewer_axes_show_more_than_known_paths_too() -> Tried {
    for (table, filter, duration) in [
        (Table::TwoAxis, "43d-b", 1883.0),
        (Table::TwoAxis, "43d-b", 3765.0),
        (Table::Hand, "mems-30d", 600.0),
        (Table::Hand, "mems-30d", 1800.0),
    ] {
        let evaluator = Evaluator::new(Vocabulary::standard().filter(filter)?, &Scenario::default(), 1);
        let reference = best_known(&evaluator, table, duration)?;
        let criterion = Criterion::against(&reference, &noise_alone(&evaluator, table, duration)?, duration);
        let effort = Effort { evaluations: Effort::usual(duration), seed: 1 };
        let (still, turns) = design(&evaluator, table, duration, &criterion, &effort, &mut |_, _| true)?;
        let found = evaluator.turns(&turns, still)?;
        let pairs = groups(&found).into_iter().zip(groups(&reference));
        let mut ratios: Vec<f64> = pairs.map(|((_, sigma), (_, known))| sigma / known).collect();
        ratios.sort_by(f64::total_cmp);
        let (value, known) = (criterion.of(&found), criterion.of(&reference));
        let name = table.name();
        println!(
            "{name}, {filter}, {duration} s: criterion {value:.3}, known {known:.3}, ratios {ratios:.3?}"
        );
        assert!(value <= known && ratios[ratios.len() / 2] <= 0.7, "{name}, {duration} s");
    }
    Ok(())
}

#[test]
fn what_is_told_to_stop_leaves_the_best_so_far() -> Tried {
    let evaluator = Evaluator::new(Vocabulary::standard().filter("36d-p")?, &short()?, 1);
    let criterion = Criterion::against(&evaluator.own()?, &[], 240.0);
    let effort = Effort { evaluations: 1_000_000, seed: 2 };
    let mut told = 0;
    let (_, turns) = design(&evaluator, Table::ThreeAxis, 240.0, &criterion, &effort, &mut |_, _| {
        told += 1;
        told < 2
    })?;
    assert!(told == 2 && !turns.is_empty());
    Ok(())
}

#[test]
fn noise_alone_leaves_less_than_all_doubts_together() -> Tried {
    let evaluator = Evaluator::new(Vocabulary::standard().filter("36d-p")?, &short()?, 1);
    let (still, turns) = KNOWN[0].lasting(&evaluator, Table::ThreeAxis, 400.0, 1)?;
    let all = groups(&evaluator.turns(&turns, still)?);
    for ((name, sigma), (_, alone)) in all.iter().zip(evaluator.alone(&turns, still)?) {
        assert!(alone > 0.0 && alone <= sigma * 1.0001, "{name}: {alone} {sigma}");
    }
    Ok(())
}

#[test]
fn what_does_not_fit_is_said() -> Tried {
    let evaluator = Evaluator::new(Vocabulary::standard().filter("36d-p")?, &short()?, 1);
    let criterion = Criterion::against(&evaluator.own()?, &[], 6.0);
    let effort = Effort { evaluations: 16, seed: 2 };
    let error = design(&evaluator, Table::ThreeAxis, 6.0, &criterion, &effort, &mut |_, _| true);
    assert!(error.is_err_and(|error| error.to_string().contains("fits into 6 s")));
    Ok(())
}
