//! What sets of effects are worth, against the formulas for one number.

use nalgebra::{DMatrix, DVector};

use super::{apart, prices};
use crate::name::search;

const NAMES: [&str; 3] = ["one", "two", "three"];

#[test]
fn the_gain_of_one_number() {
    let found = apart(&NAMES, &[1.0, 0.0, -0.5]);
    // estimate x with variance 0.01, prior variance 1: ln N(x; 0, 1.01) - ln N(x; 0, 0.01)
    let by_hand = |x: f64| 0.5 * x * x * (1.0 / 0.01 - 1.0 / 1.01) - 0.5 * (1.01_f64 / 0.01).ln();
    for (g, x) in [(0, 1.0), (1, 0.0), (2, 0.5)] {
        assert!((found.gain(&[g]) - by_hand(x)).abs() < 1e-12, "{g}");
    }
    assert!((found.gain(&[0, 2]) - by_hand(1.0) - by_hand(0.5)).abs() < 1e-12);
    assert_eq!(found.gain(&[]), 0.0);
    // BIC: half of 100 less half of ln 1000
    assert!((found.likelihood(&[0], 1000) - 0.5 * (100.0 - 1000_f64.ln())).abs() < 1e-12);
}

#[test]
fn estimates_are_drawn_to_zero_by_their_prior_unless_it_was_too_narrow() {
    let found = apart(&NAMES, &[1.0, 0.0, 30.0]);
    let (mean, covariance) = found.posterior(&[0]).unwrap();
    assert!((mean[0] - 100.0 / 101.0).abs() < 1e-12 && (covariance[(0, 0)] - 1.0 / 101.0).abs() < 1e-12);
    // 30 priors off: the prior is taken to be as wide as that
    let (mean, _) = found.posterior(&[2]).unwrap();
    let size = 3000.0 / 101.0;
    assert!((mean[0] - 3000.0 / (100.0 + 1.0 / (size * size))).abs() < 1e-9, "{mean}");
    // physical units
    let scaled = crate::prices::Prices { sigma: vec![2e-3; 3], ..found };
    let (mean, covariance) = scaled.posterior(&[0]).unwrap();
    assert!((mean[0] - 2e-3 * 100.0 / 101.0).abs() < 1e-15);
    assert!((covariance[(0, 0)] - 4e-6 / 101.0).abs() < 1e-18);
}

#[test]
fn the_e_value_of_one_number() {
    let found = apart(&NAMES, &[0.8, 0.0, 0.0]);
    let (mean, variance) = (0.9, 0.04);
    let ln_e =
        found.ln_e(&[0], &DVector::from_element(1, mean), &DMatrix::from_element(1, 1, variance)).unwrap();
    // the estimate 0.8 with variance 0.01: N(0.9, 0.05) against N(0, 0.01)
    let by_hand =
        0.5 * 0.8_f64.powi(2) / 0.01 - 0.5 * (0.8_f64 - mean).powi(2) / 0.05 - 0.5 * (0.05_f64 / 0.01).ln();
    assert!((ln_e - by_hand).abs() < 1e-12, "{ln_e} {by_hand}");
}

#[test]
fn what_is_known_takes_its_part_out_of_what_is_left() {
    let rho = 0.6;
    let found = prices(
        &NAMES[..2],
        DMatrix::from_row_slice(2, 2, &[100.0, 100.0 * rho, 100.0 * rho, 100.0]),
        &[1.0, 0.0],
    );
    assert!((found.b[1] - 60.0).abs() < 1e-12);
    let rest = found.given(&[0]).unwrap();
    // as if the first had a prior of ten
    let kept = 100.0 * rho / 100.01;
    assert!((rest.b[1] - (60.0 - kept * 100.0)).abs() < 1e-9);
    assert!((rest.lambda[(1, 1)] - (100.0 - kept * 60.0)).abs() < 1e-9);
    assert!(rest.score(1).ln_p > -0.1 && found.score(1).ln_p < -15.0);
    assert!((found.excitation(0).0 - 10.0).abs() < 1e-12);
}

#[test]
fn the_smallest_adequate_set_is_found() {
    let names = ["a", "b", "c", "d", "e"];
    let all: Vec<usize> = (0..5).collect();
    for truth in [vec![], vec![3], vec![1, 4], vec![0, 2, 3], vec![0, 1, 2, 4]] {
        let mut estimates = [0.05, -0.08, 0.02, 0.06, -0.04];
        truth.iter().for_each(|g: &usize| estimates[*g] += 1.0);
        let found = search(&apart(&names, &estimates), &all, super::THRESHOLD);
        assert!(found.adequate && found.sets[0].groups == truth, "{truth:?}: {:?}", found.sets[0]);
    }
}

#[test]
fn a_set_that_cannot_be_priced_is_not_adequate() {
    let mut found = apart(&NAMES, &[0.0; 3]);
    found.lambda[(0, 0)] = f64::NAN;
    assert!(!crate::name::Tried::new(&found, vec![0], &[0, 1, 2]).is_adequate(super::THRESHOLD));
}
