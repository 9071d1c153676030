//! Verdicts.

use nalgebra::DMatrix;

use super::{THRESHOLD, UPDATES, apart, prices, scene};
use crate::decide::{Decision, decide};
use crate::open::Open;
use crate::prices::Prices;
use crate::report::Verdict;
use crate::scene::Scene;

const NAMES: [&str; 4] = ["delay", "lever", "cubic", "drift"];

fn log(estimates: &[f64; 4]) -> Scene {
    scene(apart(&NAMES, estimates))
}

fn judged(first: &Scene, second: Option<&Scene>, open: Option<&Open>) -> Decision {
    decide(first, second, open, THRESHOLD, &|_| None).unwrap()
}

fn reason(decision: &Decision) -> &str {
    decision.reason.as_deref().unwrap_or_default()
}

/// Two families before the library, one of them `alike` to the delay.
fn open(families: [f64; 2], library: [f64; 4], alike: f64) -> Open {
    let names = ["|omega|", "t^2", "delay", "lever", "cubic", "drift"];
    let mut lambda = DMatrix::identity(6, 6) * 100.0;
    (lambda[(0, 2)], lambda[(2, 0)]) = (100.0 * alike, 100.0 * alike);
    let estimates = [families.as_slice(), &library].concat();
    Open::of_prices(prices(&names, lambda, &estimates), 2, THRESHOLD, vec![1.0; 6], UPDATES)
}

#[test]
fn nothing_is_missing_unless_the_noise_may_hide_it() {
    let mut quiet = log(&[0.1, -0.1, 0.2, 0.05]);
    let decision = judged(&quiet, None, None);
    assert!(decision.verdict == Verdict::NothingMissing && decision.best.groups.is_empty(), "{decision:?}");
    quiet.noise_hides = true;
    let decision = judged(&quiet, None, None);
    assert!(
        decision.verdict == Verdict::NotConfirmed && reason(&decision).contains("may hide"),
        "{decision:?}"
    );
}

#[test]
fn one_and_two_effects_are_found() {
    let first = log(&[0.0, 1.0, 0.1, 0.0]);
    let alone = judged(&first, None, None);
    assert_eq!((alone.verdict, alone.best.groups.as_slice()), (Verdict::EffectsFound, [1].as_slice()));
    assert!(alone.verification.is_none() && (alone.each[0] - 24.5).abs() < 1.0, "{:?}", alone.each);
    let second = log(&[0.1, 0.9, 0.0, 0.0]);
    let both = judged(&first, Some(&second), None);
    assert_eq!((both.verdict, both.best.groups.as_slice()), (Verdict::EffectsFound, [1].as_slice()));
    assert!(both.verification.is_some_and(|v| v.same == [true]) && both.each[0] > 30.0);
    let pair = judged(&log(&[1.0, 0.0, 0.0, -0.8]), Some(&log(&[1.1, 0.0, 0.0, -0.9])), None);
    assert_eq!((pair.verdict, pair.best.groups.as_slice()), (Verdict::EffectsFound, [0, 3].as_slice()));
}

#[test]
fn what_other_data_do_not_speak_for_is_not_confirmed() {
    let first = log(&[1.0, 0.0, 0.0, 0.0]);
    let absent = judged(&first, Some(&log(&[0.0; 4])), None);
    assert_eq!(absent.verdict, Verdict::NotConfirmed);
    assert!(reason(&absent).contains("the second log does not speak for delay"), "{}", reason(&absent));
    // it cannot show it at all
    let other = scene(apart(&NAMES[1..], &[0.0; 3]));
    let blind = judged(&first, Some(&other), None);
    assert_eq!((blind.verdict, reason(&blind)), (Verdict::NotConfirmed, "the second log cannot show it"));
    // all of it in the first half
    let mut early = log(&[1.0, 0.0, 0.0, 0.0]);
    early.half.b[0] = early.prices.b[0];
    let early = judged(&early, None, None);
    assert_eq!(early.verdict, Verdict::NotConfirmed);
    assert!(reason(&early).contains("the second half of the log does not speak for delay"));
}

#[test]
fn another_value_is_not_a_confirmation() {
    let sharp = |x: f64| scene(prices(&NAMES[..1], DMatrix::from_element(1, 1, 1e4), &[x]));
    let decision = judged(&sharp(1.0), Some(&sharp(0.4)), None);
    assert!(decision.each[0] > 500.0, "{:?}", decision.each);
    assert_eq!(decision.verdict, Verdict::NotConfirmed);
    assert!(reason(&decision).contains("delay has another value"), "{}", reason(&decision));
    // a tenth off is within what a unit is on another day
    assert_eq!(judged(&sharp(1.0), Some(&sharp(0.95)), None).verdict, Verdict::EffectsFound);
}

#[test]
fn two_names_for_the_same_are_ambiguous_until_a_second_log_tells_them_apart() {
    let near = |rho: f64, estimates: &[f64; 2]| {
        let lambda = DMatrix::from_row_slice(2, 2, &[100.0, 100.0 * rho, 100.0 * rho, 100.0]);
        scene(prices(&NAMES[..2], lambda, estimates))
    };
    let first = near(0.9999, &[1.0, 0.0]);
    let decision = judged(&first, None, None);
    assert_eq!(decision.verdict, Verdict::Ambiguous);
    assert_eq!(decision.rivals.len(), 1, "{:?}", decision.rivals);
    let second = near(0.1, &[1.0, 0.0]);
    let told = judged(&first, Some(&second), None);
    assert_eq!((told.verdict, told.best.groups.as_slice()), (Verdict::EffectsFound, [0].as_slice()));
}

#[test]
fn a_trace_beside_a_large_effect_is_taken_out_and_told() {
    let decision = judged(&log(&[100.0, 0.7, 0.0, 0.0]), None, None);
    assert_eq!((decision.verdict, decision.best.groups.as_slice()), (Verdict::EffectsFound, [0].as_slice()));
    assert_eq!((decision.stripped.as_slice(), decision.remains.as_deref()), ([1].as_slice(), Some("lever")));
}

#[test]
fn what_barely_shows_and_is_not_in_the_second_log_is_chance() {
    // chi-squared of 30: ln p = -17, three below the threshold and within what may be chance
    let weak = log(&[0.55, 0.0, 0.0, 0.0]);
    assert_eq!(judged(&weak, Some(&log(&[0.0; 4])), None).verdict, Verdict::NothingMissing);
    assert_eq!(judged(&weak, Some(&log(&[0.55, 0.0, 0.0, 0.0])), None).verdict, Verdict::EffectsFound);
    // beyond three decades it is not called chance
    assert_eq!(
        judged(&log(&[0.8, 0.0, 0.0, 0.0]), Some(&log(&[0.0; 4])), None).verdict,
        Verdict::NotConfirmed
    );
}

#[test]
fn a_family_without_a_name_is_outside_the_library() {
    let quiet = log(&[0.0; 4]);
    let decision = judged(&quiet, None, Some(&open([1.0, 0.1], [0.0; 4], 0.0)));
    assert_eq!((decision.verdict, decision.correlates.as_slice()), (Verdict::OutsideLibrary, [0].as_slice()));
    // beside a name that does not outweigh it
    let named = log(&[1.0, 0.0, 0.0, 0.0]);
    let beside = judged(&named, None, Some(&open([1.0, 0.0], [1.0, 0.0, 0.0, 0.0], 0.0)));
    assert_eq!((beside.verdict, beside.correlates.as_slice()), (Verdict::OutsideLibrary, [0].as_slice()));
    assert!(reason(&beside).contains("something significant remains"));
    // and beside one that does
    let strong = log(&[5.0, 0.0, 0.0, 0.0]);
    let dominated = judged(&strong, None, Some(&open([0.7, 0.0], [5.0, 0.0, 0.0, 0.0], 0.0)));
    assert_eq!((dominated.verdict, dominated.remains.as_deref()), (Verdict::EffectsFound, Some("|omega|")));
}

#[test]
fn a_family_that_explains_as_much_leaves_a_name_unconfirmed() {
    let named = log(&[1.0, 0.0, 0.0, 0.0]);
    let decision = judged(&named, None, Some(&open([0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 0.9999)));
    assert_eq!(decision.verdict, Verdict::NotConfirmed);
    assert!(reason(&decision).contains("|omega|, which is no known effect"), "{}", reason(&decision));
}

#[test]
fn effects_that_the_path_does_not_excite_are_not_named() {
    let lambda = DMatrix::from_row_slice(2, 2, &[100.0, 0.0, 0.0, 4.0]);
    // forty sigma of an effect whose prior would show as two
    let Prices { b, .. } = prices(&NAMES[..2], lambda.clone(), &[0.0, 20.0]);
    let mut found = prices(&NAMES[..2], lambda, &[0.0, 0.0]);
    found.b = b;
    assert_eq!(judged(&scene(found), None, None).verdict, Verdict::NothingMissing);
}

#[test]
fn a_reason_in_the_samples_withholds_every_name() {
    let decision = crate::decide::withheld(&log(&[5.0, 0.0, 0.0, 0.0]), "a sensor is saturated".into());
    assert_eq!((decision.verdict, reason(&decision)), (Verdict::NotConfirmed, "a sensor is saturated"));
    assert!(decision.best.groups.is_empty() && decision.rivals.is_empty() && decision.correlates.is_empty());
}

#[test]
fn amplitudes_that_may_be_told_wrongly_rival_what_they_nearly_explain() {
    let alike = DMatrix::from_row_slice(2, 2, &[1.0, 0.99, 0.99, 1.0]) * 1e6;
    let of = |size: f64| scene(prices(&["lever", "dither-scale"], alike.clone(), &[size, 0.0]));
    let gross = judged(&of(1.0), None, None);
    assert_eq!((gross.verdict, gross.rivals.as_slice()), (Verdict::Ambiguous, [vec![1]].as_slice()));
    // a scale of a few percent is as linear as anything
    let small = judged(&of(0.05), None, None);
    assert_eq!((small.verdict, small.rivals.len()), (Verdict::EffectsFound, 0));
}
