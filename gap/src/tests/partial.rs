//! What is named where something remains, how sure of it, and what is too absurd to be named.

use std::sync::OnceLock;

use nalgebra::DMatrix;

use super::{THRESHOLD, UPDATES, apart, prices, scene};
use crate::decide::decide;
use crate::open::Open;
use crate::partial::{absurd, scattered};
use crate::report::Verdict;

const NAMES: [&str; 4] = ["delay", "lever", "cubic", "drift"];

/// A family that nothing of the library explains, before the library.
fn open(family: f64, library: [f64; 4]) -> Open {
    let names = ["|omega|", "delay", "lever", "cubic", "drift"];
    let estimates = [&[family], library.as_slice()].concat();
    Open::of_prices(apart(&names, &estimates), 1, THRESHOLD, vec![1.0; 5], UPDATES)
}

#[test]
fn what_dominates_is_named_and_what_remains_is_sized() {
    // gains of 5000 and 1800, about; then 72, 72 and 50
    let estimates = [10.0, -6.0, 1.2, 1.2];
    let (first, open) = (scene(apart(&NAMES, &estimates)), open(1.0, estimates));
    let decision = decide(&first, None, Some(&open), THRESHOLD, &|_| None).unwrap();
    assert_eq!(
        (decision.verdict, decision.best.groups.as_slice()),
        (Verdict::EffectsFound, [0, 1].as_slice())
    );
    let remainder = decision.remainder.unwrap();
    // 100 x 1.2^2 / 2 less what a prior of 1 costs
    assert!((remainder.log_likelihood - 69.0).abs() < 2.0, "{remainder:?}");
    assert!((remainder.share - 69.0 / 6869.0).abs() < 1e-3, "{remainder:?}");
    assert!(remainder.families[..2].iter().all(|f| f == "cubic" || f == "drift"), "{remainder:?}");
    assert_eq!(remainder.families.len(), 3);
    // the description says that the lever arm is no larger than 1
    let stated = |name: &str| (name == "lever").then_some(1.0);
    let decision = decide(&first, None, Some(&open), THRESHOLD, &stated).unwrap();
    assert!(!decision.best.groups.contains(&1) || decision.verdict != Verdict::EffectsFound, "{decision:?}");
}

#[test]
fn where_all_is_of_one_size_nothing_is_named() {
    let estimates = [1.2, 1.3, 1.2, 1.1];
    let (first, open) = (scene(apart(&NAMES, &estimates)), open(1.2, estimates));
    let decision = decide(&first, None, Some(&open), THRESHOLD, &|_| None).unwrap();
    assert_eq!(decision.verdict, Verdict::OutsideLibrary);
    assert!(decision.remainder.is_none());
}

#[test]
fn members_that_cancel_are_absurd_and_so_is_what_was_stated_to_be_small() {
    let none = |_: &str| None;
    let mut lambda = DMatrix::identity(2, 2) * 1e6;
    (lambda[(0, 1)], lambda[(1, 0)]) = (0.99e6, 0.99e6);
    let (why, blamed) =
        absurd(&prices(&["outer", "inner"], lambda.clone(), &[1.0, -1.0]), &[0, 1], &none).unwrap();
    assert!(why.contains("outer and inner only together") && blamed == [0, 1], "{why}");
    (lambda[(0, 1)], lambda[(1, 0)]) = (0.9e6, 0.9e6);
    let apart = prices(&["outer", "inner"], lambda, &[1.0, -1.0]);
    assert!(absurd(&apart, &[0, 1], &none).is_none());
    let (why, blamed) = absurd(&apart, &[0, 1], &|name| (name == "inner").then_some(0.1)).unwrap();
    assert!(why.contains("inner would be 10 times") && blamed == [1], "{why}");
}

#[test]
fn values_scatter_as_the_scores_of_the_stretches_do() {
    let log = |off: f64| {
        let mut log = scene(prices(&["delay"], DMatrix::identity(1, 1) * 99.0, &[1.0]));
        let (mean, _) = log.prices.posterior(&[0]).unwrap();
        // each a part of the whole, and off to either side in turn
        let stretch = |k: usize| {
            let off = if k.is_multiple_of(2) { off } else { -off };
            let mut part = prices(&["delay"], DMatrix::identity(1, 1) * 99.0 / 32.0, &[mean[0]]);
            part.b[0] += off;
            part
        };
        log.parts = OnceLock::from((0..32).map(stretch).collect::<Vec<_>>());
        scattered(&log, &[0]).unwrap().1[(0, 0)]
    };
    // what scatters no more than white noise does is believed
    assert!((log(1.0) - 0.01).abs() < 1e-12, "{}", log(1.0));
    // scores of variance 99 / 32 that scatter by 10: some 32 times the variance
    let wider = log(10.0) / 0.01;
    assert!((25.0..45.0).contains(&wider), "{wider}");
}
