//! Whether filters know how wrong they are: normalised estimation errors over a hundred units.

use crate::common::{Outcome, calibrate};
use rig::Scenario;
use sinscal::{Filter, Sins36P, Sins39P, Sins40P, Sins43B, Sins43P, Strapdown};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// 99 % of the mean of `units` sums over `parameters` squares lie in this band.
fn band(units: usize, parameters: usize) -> (f64, f64) {
    let distribution = ChiSquared::new((units * parameters) as f64).unwrap();
    let mean = |p| distribution.inverse_cdf(p) / units as f64;
    (mean(0.005), mean(0.995))
}

fn consistent<F: Filter<Dynamics = Strapdown>>(units: u64) {
    let scenario = Scenario::default().modelled_by::<F>();
    let outcomes: Vec<Outcome> = (1..=units).map(|seed| calibrate::<F>(&scenario, seed)).collect();
    let n = outcomes.len() as f64;
    let parameters = outcomes[0].parameters;
    let nees = outcomes.iter().map(|outcome| outcome.nees).sum::<f64>() / n;
    let nis = outcomes.iter().map(|outcome| outcome.nis).sum::<f64>() / n;
    let worst = outcomes
        .iter()
        .map(|outcome| &outcome.worst)
        .fold((0.0, ""), |most, (error, name)| if *error > most.0 { (*error, name) } else { most });
    let (low, high) = band(outcomes.len(), parameters);
    println!(
        "{}: NEES {nees:.2} of {parameters}, band {low:.2} to {high:.2}; NIS {nis:.4}; worst {:.2} sigma, {}",
        F::NAME,
        worst.0,
        worst.1
    );
    // Each parameter by itself: its mean within four sigmas of a mean of so many.
    let square = |i: usize| outcomes.iter().map(|outcome| outcome.scaled[i].powi(2)).sum::<f64>() / n;
    let mean = |i: usize| outcomes.iter().map(|outcome| outcome.scaled[i]).sum::<f64>() / n;
    for i in 0..parameters {
        println!("  parameter {i}: mean {:.2}, mean square {:.2}", mean(i), square(i));
        assert!(mean(i).abs() < 4.0 / n.sqrt(), "{}: parameter {i}: mean {}", F::NAME, mean(i));
        assert!((0.4..2.0).contains(&square(i)), "{}: parameter {i}: mean square {}", F::NAME, square(i));
    }
    assert!((low..high).contains(&nees), "{}: NEES {nees} outside {low} to {high}", F::NAME);
}

#[test]
#[ignore = "five minutes in release"]
fn nees_of_a_hundred_units_is_in_its_band() {
    // each filter is tried whatever the others did
    let results = [
        std::panic::catch_unwind(|| consistent::<Sins36P>(100)),
        std::panic::catch_unwind(|| consistent::<Sins39P>(100)),
        std::panic::catch_unwind(|| consistent::<Sins40P>(100)),
        std::panic::catch_unwind(|| consistent::<Sins43P>(100)),
        std::panic::catch_unwind(|| consistent::<Sins43B>(100)),
    ];
    assert!(results.iter().all(Result::is_ok));
}
