//! Whether a second log, or the second half of the only one, bears out what was named.

use super::{THRESHOLD, apart, scene};
use crate::verify::{held_out, verify};

const NAMES: [&str; 3] = ["delay", "lever", "cubic"];

/// ln of how much better an estimate `x` of variance 0.01 is predicted by N(mean, variance) than by zero.
fn by_hand(x: f64, mean: f64, variance: f64) -> f64 {
    0.5 * x * x / 0.01 - 0.5 * (x - mean).powi(2) / (variance + 0.01) - 0.5 * ((variance + 0.01) / 0.01).ln()
}

#[test]
fn a_second_log_is_predicted_from_the_first_with_three_times_its_sigma() {
    let first = scene(apart(&NAMES, &[1.0, 0.5, 0.0]));
    let second = scene(apart(&NAMES, &[0.9, 0.6, 0.0]));
    let found = verify(&first, &second, &[0, 1], THRESHOLD).unwrap();
    let share = 100.0 / 101.0;
    let each = [by_hand(0.9, share, 9.0 / 101.0), by_hand(0.6, 0.5 * share, 9.0 / 101.0)];
    assert!((found.each[0] - each[0]).abs() < 1e-9 && (found.each[1] - each[1]).abs() < 1e-9, "{found:?}");
    assert!((found.ln_e - each[0] - each[1]).abs() < 1e-9);
    assert!(found.same == [true, true] && !found.something_left);
}

#[test]
fn absent_opposite_and_other_values_are_told_apart() {
    let first = scene(apart(&NAMES, &[1.0, 0.0, 0.0]));
    let of = |there: f64, other: f64| {
        verify(&first, &scene(apart(&NAMES, &[there, 0.0, other])), &[0], THRESHOLD).unwrap()
    };
    // nothing there, and the other sign: the log speaks against it
    assert!(of(0.0, 0.0).ln_e < -4.0 && !of(0.0, 0.0).same[0]);
    assert!(of(-1.0, 0.0).ln_e < 40.0 && !of(-1.0, 0.0).same[0]);
    // 1.0 and 1.6 differ by 4.2 sigma of their difference, 1.0 and 1.8 by 5.7
    assert!(of(1.6, 0.0).same[0] && !of(1.8, 0.0).same[0]);
    assert!(!of(1.0, 0.3).something_left);
    let left = of(1.0, 1.0);
    assert!(left.something_left && left.left.is_some_and(|(g, _)| g == 2));
}

#[test]
fn a_log_without_the_effect_says_nothing() {
    let first = scene(apart(&NAMES, &[1.0, 0.0, 0.0]));
    let second = scene(apart(&["other"], &[0.0]));
    assert!(verify(&first, &second, &[0], THRESHOLD).is_none());
}

#[test]
fn halves_of_one_log() {
    let mut log = scene(apart(&NAMES, &[1.0, 0.5, 0.0]));
    let gain =
        |x: f64, lambda: f64| 0.5 * x * x * lambda * lambda / (1.0 + lambda) - 0.5 * (1.0 + lambda).ln();
    let (all, each) = held_out(&log, &[0, 1]);
    let by_hand = [1.0, 0.5].map(|x| gain(x, 100.0) - gain(x, 50.0));
    assert!((each[0] - by_hand[0]).abs() < 1e-9 && (each[1] - by_hand[1]).abs() < 1e-9);
    assert!((all - by_hand[0] - by_hand[1]).abs() < 1e-9);
    // all of it in the first half, nothing in the second
    log.half.b[0] = log.prices.b[0];
    assert!(held_out(&log, &[0]).1[0] < 0.0);
}
