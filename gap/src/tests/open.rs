//! Families of the dictionary on prices made by hand.

use nalgebra::DMatrix;

use super::{THRESHOLD, UPDATES, apart, prices};
use crate::name::MARGIN;
use crate::open::Open;

const NAMES: [&str; 4] = ["|omega|", "t^2", "delay", "lever"];
/// The library begins after two families.
const FAMILIES: usize = 2;

fn open(estimates: &[f64; 4]) -> Open {
    Open::of_prices(apart(&NAMES, estimates), FAMILIES, THRESHOLD, vec![1.0; 4], UPDATES)
}

/// The same with a family that is nearly the delay.
fn alike(rho: f64, estimates: &[f64; 4]) -> Open {
    let mut lambda = DMatrix::identity(4, 4) * 100.0;
    (lambda[(0, 2)], lambda[(2, 0)]) = (100.0 * rho, 100.0 * rho);
    Open::of_prices(prices(&NAMES, lambda, estimates), FAMILIES, THRESHOLD, vec![1.0; 4], UPDATES)
}

#[test]
fn loud_families_come_first_and_library_effects_never() {
    let families = |open: &Open| open.loud(&[]).iter().map(|l| l.0).collect::<Vec<_>>();
    assert_eq!(families(&open(&[1.0, 2.0, 5.0, 5.0])), [1, 0]);
    assert_eq!(families(&open(&[1.0, 0.1, 5.0, 5.0])), [0]);
    assert!(families(&open(&[0.1, 0.1, 5.0, 5.0])).is_empty());
    let loud = open(&[1.0, 0.0, 0.0, 0.0]);
    let first = loud.loud(&[])[0];
    assert!((loud.beyond(&first) - (crate::ln_survival(100.0, 1) - THRESHOLD)).abs() < 1e-9);
}

#[test]
fn on_top_of_a_name_two_decades_of_slack() {
    // chi-squared of 29 with one degree of freedom: ln p = -16.5, between the threshold and that with slack
    let between = open(&[0.54, 0.0, 1.0, 0.0]);
    let ln_p = between.loud(&[])[0].1.ln_p;
    assert!((THRESHOLD - MARGIN..THRESHOLD).contains(&ln_p), "{ln_p}");
    assert!(between.loud(&[0]).is_empty());
    assert_eq!(open(&[0.6, 0.0, 1.0, 0.0]).loud(&[0]).len(), 1);
}

#[test]
fn a_name_silences_the_family_that_is_nearly_it() {
    // the delay is there, the family only looks like it: b is that of [0, 0, 1, 0]
    let both = alike(0.95, &[0.0, 0.0, 1.0, 0.0]);
    assert_eq!(both.loud(&[]).len(), 1);
    assert!(both.loud(&[0]).is_empty());
    assert!(both.gain_on(0, &[0]) < 1.0 && both.gain_on(0, &[]) > 30.0);
    // what is left to the delay beside a family so alike is a small part of its gain
    assert!(!both.stand(0, &[0]));
    assert!(open(&[1.0, 0.0, 1.0, 0.0]).stand(0, &[0]));
}

#[test]
fn a_family_that_explains_as_much_is_a_rival_until_another_log_speaks() {
    let first = alike(0.9999, &[0.0, 0.0, 1.0, 0.0]);
    let rivals = first.rivals(&[0], None);
    assert!(rivals.len() == 1 && rivals[0].0 == 0 && rivals[0].1.abs() < 0.1, "{rivals:?}");
    assert!(first.rivals(&[], None).is_empty());
    // the other log shows the effect, and the family not at all
    let other = open(&[0.0, 0.0, 1.0, 0.0]);
    assert!(first.rivals(&[0], Some((&other, 40.0))).is_empty());
    // less alike it leaves the delay something to add
    assert!(alike(0.5, &[0.0, 0.0, 1.0, 0.0]).rivals(&[0], None).is_empty());
}

#[test]
fn a_family_is_carried_to_another_log_by_the_size_of_its_signal() {
    let first = alike(0.9999, &[0.0, 0.0, 1.0, 0.0]);
    let before = first.rivals(&[0], None)[0].1;
    // there the signal is twice as large, and so is the effect of the same coefficient
    let there = apart(&NAMES, &[2.0, 0.0, 0.0, 0.0]);
    let other = Open::of_prices(there, FAMILIES, THRESHOLD, vec![2.0, 1.0, 1.0, 1.0], UPDATES);
    let ahead = first.rivals(&[0], Some((&other, 0.0)))[0].1;
    let (mean, variance) = (2.0 * 0.9999 * 100.0 / 101.0, 9.0 * 4.0 / 101.0 + 0.01);
    let ln_e =
        0.5 * 4.0 / 0.01 - 0.5 * (2.0_f64 - mean).powi(2) / variance - 0.5 * (variance / 0.01_f64).ln();
    assert!((ahead - before - ln_e).abs() < 1e-6, "{ahead} {before} {ln_e}");
}
