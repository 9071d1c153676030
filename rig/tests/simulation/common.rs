//! Calibrating simulated logs.

use nalgebra::{DMatrix, DVector};
use rig::{Scenario, Simulation};
use sinscal::{Calibration, Filter, Strapdown};

/// What came of one unit.
pub(crate) struct Outcome {
    /// Normalised estimation error squared of all parameters together.
    pub(crate) nees: f64,
    /// How many parameters there are.
    pub(crate) parameters: usize,
    /// Mean normalised innovation squared per measurement.
    pub(crate) nis: f64,
    /// Error of each parameter in standard deviations.
    pub(crate) scaled: Vec<f64>,
    /// Largest error of one parameter, in standard deviations, and which.
    pub(crate) worst: (f64, String),
}

/// Simulates unit `seed` and calibrates it in two passes.
pub(crate) fn calibrate<F: Filter<Dynamics = Strapdown>>(scenario: &Scenario, seed: u64) -> Outcome {
    let simulation = Simulation::new(scenario, seed).unwrap();
    let mut calibration = Calibration::<F>::new(&simulation.description().setup(&[])).expect("a sound setup");
    let log: Vec<_> = simulation.clone().collect();
    for sample in &log {
        calibration.step(sample).unwrap();
    }
    calibration.begin_pass();
    for sample in &log {
        calibration.step(sample).unwrap();
    }
    let mut errors = Vec::new();
    let mut worst = (0.0, String::new());
    calibration.parameters(&mut |p| {
        let error = p.value - simulation.truth().of(&p.info);
        if (error / p.sigma).abs() > worst.0 {
            worst =
                ((error / p.sigma).abs(), format!("{} {} of unit {seed}", p.info.block, p.info.component));
        }
        errors.push(error);
    });
    let n = errors.len();
    let covariance = calibration.covariance();
    let core = F::DIM - n;
    // scaled by the standard deviations, or the matrix is numerically singular
    let sigma: Vec<f64> = (0..n).map(|i| covariance[core + i][core + i].sqrt()).collect();
    let correlation = DMatrix::from_fn(n, n, |i, j| covariance[core + i][core + j] / (sigma[i] * sigma[j]));
    let scaled = DVector::from_fn(n, |i, _| errors[i] / sigma[i]);
    let solved = correlation.cholesky().unwrap().solve(&scaled);
    Outcome {
        nees: scaled.dot(&solved),
        parameters: n,
        nis: calibration.statistics().nis_per_dof(),
        scaled: scaled.iter().copied().collect(),
        worst,
    }
}

/// Whether a population can have an effect: the dither's follows from the inner lever arms, and how biases wander is a matter of the noise.
pub(crate) fn can_be_given(effect: &str) -> bool {
    effect != "dither-size-effect" && sinscal::any_effect(effect).is_some_and(|effect| !effect.is_wander())
}
