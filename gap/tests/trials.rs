//! Trials with something hidden, and with nothing.

use gap::blind::{Case, Grade, Hidden, Table, trial};
use gap::{Diagnosis, Options, Verdict};
use runs::Vocabulary;

const QUICK: Options = Options { seed: 1, false_alarms: 0.01, rerun: false };

fn diagnose(seed: u64, hidden: Hidden, options: &Options) -> (Diagnosis, Grade) {
    // the dither acts through inner lever arms: the filter that it is hidden from knows those
    let dithers = format!("{hidden:?}").contains("dither");
    let case = Case::with(seed, if dithers { "39d-p" } else { "36d-p" }, hidden).unwrap();
    let d = case.diagnose(options).unwrap();
    let grade = case.grade(&d);
    (d, grade)
}

#[test]
fn a_delay_is_found_and_added() {
    let hidden = Hidden::Effects(vec!["accel-delay"], 80.0);
    let (d, grade) = diagnose(3, hidden, &Options { rerun: true, ..QUICK });
    assert_eq!(grade, Grade::Right, "{}", d.sentence);
    assert!(d.verified && d.sentence.starts_with("Missing: accel-delay "), "{}", d.sentence);
    assert!(
        d.sentence.len() <= 240 && d.notes[0].starts_with("accel-delay, d_f = -tau f_b': tau = "),
        "{d:?}"
    );
    let effect = &d.effects[0];
    assert!((effect.estimate[0].abs() - 80.0 * 3.6e-6).abs() < 5.0 * effect.sigma[0]);
    // the closed loop gains what pricing said, and the gap shrinks on the log that was not used
    let gap = d.gap.unwrap();
    let gained = gap.fit.log_likelihood_after - gap.fit.log_likelihood_before;
    assert!((gained / gap.fit.log_likelihood_gain_priced - 1.0).abs() < 0.02, "{gap:?}");
    let verify = gap.verify.unwrap();
    assert!(verify.log_likelihood_after > verify.log_likelihood_before + 100.0);
    assert!(verify.free_run_after < verify.free_run_before);
    // free-inertial for half an hour: some hundred metres, and fewer with what was found
    let drift = gap.fit.horizontal.unwrap();
    assert!(drift.after_m < drift.before_m && drift.before_m < 2000.0, "{drift:?}");
    let source = d.source.as_deref().unwrap();
    assert!(
        source.contains("base: sinscal::Sins36P") && source.contains("accel_delay: AccelDelay"),
        "{source}"
    );
    let json = serde_json::to_value(&d).unwrap();
    assert_eq!(json["verdict"], "effects-found");
    assert_eq!(json["effects"][0]["name"], "accel-delay");
    assert!(json["where"].as_array().is_some_and(|places| !places.is_empty()));
}

#[test]
fn nothing_is_found_where_nothing_is() {
    let (d, _) = diagnose(5, Hidden::Nothing(1.0, 1.0), &QUICK);
    assert_eq!(d.verdict, Verdict::NothingMissing, "{}", d.sentence);
}

#[test]
fn misstated_noise_is_no_missing_effect() {
    let (d, _) = diagnose(6, Hidden::Nothing(2.0, 0.5), &QUICK);
    assert_eq!(d.verdict, Verdict::NothingMissing, "{}", d.sentence);
    assert!((d.noise_scale.accel - 2.0).abs() < 0.6 && d.noise_scale.gyro < 0.8, "{:?}", d.noise_scale);
}

#[test]
fn varying_dither_is_named_and_constant_dither_is_a_bias() {
    let (d, grade) = diagnose(7, Hidden::Effects(vec!["dither-size-effect"], 20.0), &QUICK);
    assert_eq!(grade, Grade::Right, "{}", d.sentence);
    let source = d.source.unwrap();
    assert!(source.contains("dither: Dither,") && source.contains("sinscal::Sins39P"), "{source}");

    let (d, grade) = diagnose(7, Hidden::NotExcited("dither-size-effect"), &QUICK);
    assert_eq!(grade, Grade::Right, "{}", d.sentence);
    let pair = |p: &Vec<String>| p[0] == "dither-size-effect" && p[1] == "accel-bias";
    assert!(d.indistinguishable.iter().any(pair), "{:?}", d.indistinguishable);
    assert!(d.next_run.iter().any(|s| s.contains("dither amplitude")));
}

#[test]
fn what_is_in_no_library_gets_no_name() {
    let (d, grade) = diagnose(9, Hidden::Outside("accelerometer transient after rotation", 60.0), &QUICK);
    assert_eq!(grade, Grade::Right, "{}", d.sentence);
    assert!(
        d.effects.is_empty() && d.correlates_with[0].contains("transient after rotation"),
        "{:?}",
        d.correlates_with
    );
}

/// Hidden, and what the law for it is called.
const LAWS: [(&str, &str); 3] = [
    ("accelerometer bias by (T - T_ref) f_i^2", "accel-bias-by-temperature-times-force-i-squared"),
    ("accelerometer bias by (dT/dt)^2", "accel-bias-by-temperature-rate-squared"),
    ("accelerometer bias by |omega| f_i", "accel-bias-by-size-of-rate-times-force-i"),
];

#[test]
fn what_resembles_a_known_effect_becomes_a_law_and_not_that_name() {
    for (seed, (hidden, law)) in (31..).zip(LAWS) {
        let (d, grade) = diagnose(seed, Hidden::Outside(hidden, 60.0), &QUICK);
        assert_eq!(grade, Grade::Right, "{hidden}: {}", d.sentence);
        let names: Vec<&str> = d.laws.iter().map(|law| law.name.as_str()).collect();
        let rivals = d.laws.iter().flat_map(|law| &law.rivals);
        assert!(names == [law] || rivals.clone().any(|rival| rival == law), "{hidden}: {:?}", d.laws);
    }
}

/// One way and the other, at a third of that and at three times as much.
#[test]
#[ignore = "eighteen trials: run with --release -- --ignored --nocapture"]
fn many_laws() {
    let mut right = 0;
    for (seed, (hidden, law)) in (41..).zip(LAWS.iter().cycle().take(18)) {
        let strength = [20.0, 60.0, 200.0][(seed as usize - 41) / 6];
        let (d, grade) = diagnose(seed, Hidden::Outside(hidden, strength), &QUICK);
        let found: Vec<&str> = d.laws.iter().map(|law| law.name.as_str()).collect();
        let is_right = found == [*law] || d.laws.iter().any(|found| found.rivals.iter().any(|r| r == law));
        right += usize::from(is_right);
        println!("{hidden} at {strength}: {grade:?}, laws {found:?}; {}", d.sentence);
        assert_ne!(grade, Grade::Wrong, "{hidden}: {}", d.sentence);
    }
    println!("{right} of 18 laws are the right one, or list it");
    assert!(right >= 12);
}

#[test]
fn a_burst_is_found_where_it_is() {
    let case = Case::with(22, "36d-p", Hidden::Outside("gyro bias for 60 s", 80.0)).unwrap();
    let truth = case.burst().unwrap();
    let d = case.diagnose(&QUICK).unwrap();
    assert_eq!(case.grade(&d), Grade::Right, "{}", d.sentence);
    assert!(d.correlates_with[0].starts_with("burst of the bias"), "{:?}", d.correlates_with);
    let place = &d.r#where[0];
    assert!(
        (place.start_s - truth.0).abs() < 15.0 && (place.end_s - truth.1).abs() < 15.0,
        "{place:?} {truth:?}"
    );
}

#[test]
fn an_effect_far_beyond_its_prior_is_named() {
    let (d, grade) = diagnose(309, Hidden::Effects(vec!["gyro-bias-drift"], 340.0), &QUICK);
    assert_eq!(grade, Grade::Right, "{}", d.sentence);
    let size = d.effects[0].estimate.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(size > 50.0 * sinscal::effect("gyro-bias-drift").unwrap().prior_sigma, "{:?}", d.effects);
}

/// Ten to a hundred times the prior; two minutes.
#[test]
#[ignore = "eleven trials: run with --release -- --ignored"]
fn every_kind_of_effect_far_beyond_its_prior_is_named() {
    let large = [
        ("accel-temperature-bias", 3000.0),
        ("accel-temperature-rate", 2100.0),
        ("accel-temperature-scale", 5000.0),
        ("gyro-temperature-bias", 1800.0),
        ("gyro-g-sensitivity", 1000.0),
        ("accel-cubic", 5000.0),
        ("accel-cross-coupling", 5000.0),
        ("accel-bias-drift", 5000.0),
        ("gyro-bias-drift", 340.0),
        ("inner-lever-arm", 3450.0),
        ("accel-delay", 13900.0),
    ];
    for (seed, (name, strength)) in (301..).zip(large) {
        let (d, grade) = diagnose(seed, Hidden::Effects(vec![name], strength), &QUICK);
        assert_eq!(grade, Grade::Right, "{name}: {}", d.sentence);
    }
}

#[test]
fn the_same_log_twice_confirms_nothing() {
    let mut scenario = rig::Scenario::default().with_rate(20.0).unwrap().modelled_by::<sinscal::Sins36P>();
    scenario.motion.still = 60.0;
    scenario.motion.dwell = 20.0;
    let simulation = rig::Simulation::new(&scenario, 3).unwrap();
    let description = simulation.description().clone();
    let samples: Vec<sinscal::Sample> = simulation.collect();
    let setup = description.setup(&[]);
    let log = gap::Log { samples: &samples, setup: &setup };
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").unwrap();
    let d =
        gap::diagnose(&*filter, vocabulary.effects(), &[log], Some(&log), &QUICK, &mut |_, _| {}).unwrap();
    assert!(!d.verified && d.notes.iter().any(|n| n.contains("confirms nothing")), "{:?}", d.notes);
}

#[test]
fn the_same_case_twice_is_the_same_trial() {
    let once = trial(4, &QUICK).unwrap();
    assert_eq!(once, trial(4, &QUICK).unwrap());
    let table = Table::of(&[once]);
    assert_eq!(table.cases(), 1);
}

/// Cases that none of the rules was tuned to; `sinscal diagnose --self-test` prints the same at length. Ten minutes.
#[test]
#[ignore = "minutes of trials: run with --release -- --ignored --nocapture"]
fn many_trials() {
    let trials: Vec<_> = (7000..7120).map(|seed| trial(seed, &QUICK).unwrap()).collect();
    let table = Table::of(&trials);
    println!("{table}");
    assert_eq!(table.count(Grade::Wrong), 0);
    assert!(table.count(Grade::Alarm) <= 1 && table.score > 0.85);
}
