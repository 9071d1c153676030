//! Compensation undoes what the error model does, and forgets nothing between readings.

mod common;

use common::{Numbers, sample, setup, signals};
use nalgebra::Vector3;
use sinscal::{Compensator, Filter, Mems30, Sins43B, Sins43P, Strapdown, input_errors};

const DT: f64 = 0.01;

/// Largest relative error of rate and force after compensation of readings falsified by random parameters of `scale` times
/// the priors.
fn left_over<F: Filter<Dynamics = Strapdown>>(scale: f64, seed: u64) -> f64 {
    let mut numbers = Numbers(seed);
    let mut parameters = <F::Shape as sinscal::Shape>::vector(0.0);
    let mut i = 0;
    F::states(&mut |state| {
        parameters[i] = if i < 9 { 0.0 } else { scale * state.prior_sigma * numbers.next() };
        i += 1;
    });
    let mut truth = signals(3.0);
    truth.time = 0.0;
    // what a first sample can know
    truth.force_rate = truth.force.cross(&truth.rate);
    let (rate, force) = input_errors::<F, f64>(&truth, &parameters);
    let mut reading = sample(0.0, (truth.rate + rate) * DT, (truth.force + force) * DT);
    reading.temperature = truth.temperature.add_scalar(setup().reference_temperature);
    reading.dither = truth.dither.map(|mean_square| (2.0 * mean_square).sqrt());
    let mut compensator = Compensator::new(setup().reference_temperature);
    compensator.read(&reading);
    let (found, _) = compensator.compensate::<F>(&reading, DT, &parameters);
    let rate = (found.dtheta / DT - truth.rate).norm() / truth.rate.norm();
    let force = (found.dvel / DT - truth.force).norm() / truth.force.norm();
    rate.max(force)
}

#[test]
fn compensation_undoes_the_error_model() {
    for seed in 0..50 {
        // parameters at one sigma of their priors: scale errors of 1e-3
        let error = left_over::<Sins43B>(1.0, seed);
        assert!(error < 1e-11, "{error:e}");
        // a MEMS unit: 3 %
        let error = left_over::<Mems30>(30.0, seed);
        assert!(error < 1e-5, "{error:e}");
    }
}

#[test]
fn the_force_rate_is_that_of_turning_and_of_acceleration() {
    let parameters = [0.0; Sins43P::DIM];
    let mut compensator = Compensator::new(20.0);
    let (mut worst, mut of_turning) = (0.0_f64, 0.0_f64);
    for k in 0..1000 {
        let middle = (f64::from(k) + 0.5) * DT;
        let truth = signals(middle);
        let reading = sample(middle + 0.5 * DT, truth.rate * DT, truth.force * DT);
        compensator.read(&reading);
        let (_, found) = compensator.compensate::<Sins43P>(&reading, DT, &parameters);
        if k > 10 {
            worst = worst.max((found.force_rate - truth.force_rate).norm());
            of_turning = of_turning.max((truth.force.cross(&truth.rate) - truth.force_rate).norm());
        }
    }
    // late by 15 ms, and the change in n itself changes by up to 5 m/s^4
    assert!(worst < 0.09, "{worst}");
    assert!(of_turning > 3.0, "turning alone would be {of_turning} m/s^3 off");
}

#[test]
fn readings_are_held_and_rates_follow_from_them() {
    let parameters = [0.0; Sins43P::DIM];
    let mut compensator = Compensator::new(20.0);
    let mut signals_at = |time: f64, temperature: f64| {
        let mut reading = sample(time, Vector3::zeros(), Vector3::z() * 0.098);
        reading.temperature.y = temperature;
        compensator.read(&reading);
        compensator.compensate::<Sins43P>(&reading, DT, &parameters).1
    };
    assert_eq!(signals_at(10.0, f64::NAN).temperature, Vector3::zeros());
    assert_eq!(signals_at(10.5, 22.0).temperature, Vector3::new(0.0, 2.0, 0.0));
    let later = signals_at(11.0, f64::NAN);
    assert_eq!((later.temperature.y, later.temperature_rate.y, later.time), (2.0, 0.0, 1.0));
    let next = signals_at(12.5, 23.0);
    assert_eq!((next.temperature.y, next.temperature_rate.y), (3.0, 0.5));
    // without thermometers of their own the gyros take the accelerometers' temperature
    assert_eq!(next.gyro_temperature, next.temperature);
}

#[test]
fn what_is_not_declared_does_not_act() {
    // a NaN dither amplitude would spoil everything that looks at it
    let mut reading = sample(0.0, Vector3::new(1e-3, 2e-3, 1e-3), Vector3::z() * 0.098);
    let mut compensator = Compensator::new(25.0);
    reading.dither = Vector3::repeat(f64::INFINITY);
    compensator.read(&reading);
    let mut parameters = [0.0; Sins43P::DIM];
    parameters[sinscal::Sins39P::OFFSETS.inner_lever] = 0.05;
    let (found, _) = compensator.compensate::<Sins43P>(&reading, DT, &parameters);
    assert!(found.dvel.iter().all(|v| v.is_finite()));
    let (found, _) = compensator.compensate::<Sins43B>(&reading, DT, &parameters);
    assert!(!found.dvel.iter().all(|v| v.is_finite()));
}
