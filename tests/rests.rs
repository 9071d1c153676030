//! A unit carried by hand: its rests calibrate it, and what its increments make of the turns between is not believed further than
//! that is worth.

mod common;

use common::{Numbers, sample};
use nalgebra::{UnitQuaternion, Vector3};
use sinscal::strapdown::NavigationState;
use sinscal::{
    Calibration, InitialAttitude, Mems30, Missed, Parameter, Reference, ReferenceSigma, Sample, SensorNoise,
    Setup, Site, earth,
};

const RATE: f64 = 50.0;
const REST: f64 = 4.0;
const TURN: f64 = 2.0;
const NOISE: SensorNoise = SensorNoise { angle_random_walk: 1e-4, velocity_random_walk: 1.5e-3 };
const SITE: Site = Site { latitude: 0.56, longitude: 2.07, height: 20.0 };
const GYRO_BIAS: Vector3<f64> = Vector3::new(0.01, -0.02, 0.015);
const GYRO_SCALE: Vector3<f64> = Vector3::new(5e-3, -4e-3, 8e-3);
const ACCEL_BIAS: Vector3<f64> = Vector3::new(0.15, -0.1, 0.2);
const ACCEL_SCALE: Vector3<f64> = Vector3::new(8e-3, -5e-3, 4e-3);
const PRIORS: &[(&str, f64)] = &[
    ("gyro-bias", 0.035),
    ("gyro-scale", 0.03),
    ("gyro-misalignment", 0.01),
    ("accel-bias", 0.3),
    ("accel-scale", 0.02),
    ("accel-misalignment", 0.01),
];

/// Eighteen rests with quarter turns about changing axes between; each turn leaves 0.3 m/s and 1.5 mrad that the increments miss.
/// `missed` is what the readings say of that.
fn log(missed: Missed) -> Vec<Sample> {
    let mut numbers = Numbers(5);
    let mut truth =
        NavigationState::<f64>::at_rest(&SITE, UnitQuaternion::from_scaled_axis(Vector3::z() * 1.1));
    let dt = 1.0 / RATE;
    let (rest, turn) = ((REST * RATE) as usize, (TURN * RATE) as usize);
    // a uniform number from -1 to 1 has a variance of a third
    let white = |walk: f64| walk * (3.0 / dt).sqrt();
    let mut samples = Vec::new();
    for position in 0..18 {
        let mut axis = Vector3::zeros();
        axis[[0, 1, 0, 2, 1][position % 5]] = std::f64::consts::FRAC_PI_2;
        let slip = numbers.vector(1.0).normalize() * 0.3 / TURN;
        let miss = numbers.vector(1.0).normalize() * 1.5e-3 / TURN;
        for k in 0..rest + turn {
            let moves = k >= rest;
            let rate_eb = if moves { axis / TURN } else { Vector3::zeros() };
            let c = truth.attitude;
            let rate = rate_eb + c.inverse() * earth::rotation_n(truth.latitude);
            truth.attitude = UnitQuaternion::from_scaled_axis(-earth::rotation_n(truth.latitude) * dt)
                * c
                * UnitQuaternion::from_scaled_axis(rate * dt);
            let middle = c.slerp(&truth.attitude, 0.5);
            let force = middle.inverse() * Vector3::z() * earth::gravity(truth.latitude, truth.height);
            let (rate, force) = if moves { (rate + miss, force + slip) } else { (rate, force) };
            let gyro = rate + rate.component_mul(&GYRO_SCALE) + GYRO_BIAS + numbers.vector(white(1e-4));
            let accel =
                force + force.component_mul(&ACCEL_SCALE) + ACCEL_BIAS + numbers.vector(white(1.5e-3));
            let mut now = sample((samples.len() + 1) as f64 * dt, gyro * dt, accel * dt);
            if !moves {
                let zero = Some(Vector3::zeros());
                now.reference = Reference { velocity: zero, rate: zero, ..Reference::default() };
                // the Earth's rate, ten times a second for four seconds
                now.reference.sigma.rate = Vector3::repeat(earth::ROTATION_RATE * 40_f64.sqrt());
                if k == 0 && position > 0 {
                    now.reference.missed = missed;
                }
            }
            samples.push(now);
        }
    }
    samples
}

fn calibrated(samples: &[Sample]) -> Vec<Parameter> {
    let mean = samples[..100].iter().map(|sample| sample.dvel * RATE).sum::<Vector3<f64>>() / 100.0;
    let setup = Setup {
        priors: PRIORS,
        update_rate: 10.0,
        ..Setup::new(
            RATE,
            SITE,
            InitialAttitude::at_rest(&mean, 0.3),
            ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
            NOISE,
        )
    };
    let mut run = Calibration::<Mems30>::new(&setup).expect("a sound setup");
    for pass in 0..3 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in samples {
            run.step(sample).expect("a run that does not diverge");
        }
    }
    let mut found = Vec::new();
    run.parameters(&mut |parameter| found.push(parameter));
    found
}

/// Error of each parameter over its sigma; the gyros' biases contain the Earth's rate where the heading is not known.
fn errors(found: &[Parameter]) -> Vec<(String, f64)> {
    let mut axes = std::collections::HashMap::<&str, usize>::new();
    let error = |parameter: &Parameter| {
        let axis = axes.entry(parameter.info.block).or_default();
        let (truth, more) = match parameter.info.block {
            "gyro-bias" => (GYRO_BIAS[*axis], earth::ROTATION_RATE),
            "gyro-scale" => (GYRO_SCALE[*axis], 0.0),
            "accel-bias" => (ACCEL_BIAS[*axis], 0.0),
            "accel-scale" => (ACCEL_SCALE[*axis], 0.0),
            _ => (0.0, 0.0),
        };
        *axis += 1;
        let name = format!("{} {}", parameter.info.block, parameter.info.component);
        (name, (parameter.value - truth) / parameter.sigma.hypot(more))
    };
    found.iter().map(error).collect()
}

#[test]
fn rests_calibrate_a_unit_whose_increments_miss_what_a_turn_does() {
    let found = calibrated(&log(Missed { attitude: 2e-3, velocity: 1.0 }));
    assert_eq!(found.iter().filter(|parameter| parameter.estimated).count(), 21);
    for (name, error) in errors(&found) {
        assert!(error.abs() < 3.5, "{name}: {error:.1} sigma");
    }
    // who believes the increments bends the sensors until they agree
    let believed = errors(&calibrated(&log(Missed::default())));
    assert!(believed.iter().any(|(_, error)| error.abs() > 10.0), "{believed:?}");
}

/// Noise that a scale factor multiplies is no evidence of the scale factor: what a rest shows of bias and scale is their sum, and it is
/// shared out by the priors.
#[test]
fn one_rest_shares_gravity_out_by_the_priors() {
    let mut one = log(Missed::default());
    one.truncate((REST * RATE) as usize);
    let found = calibrated(&one);
    let of = |block: &str| found.iter().filter(|p| p.info.block == block).nth(2).expect("z").value;
    let gravity = earth::gravity(SITE.latitude, SITE.height);
    let sum = ACCEL_BIAS.z + ACCEL_SCALE.z * gravity;
    let (bias, scale) = (0.3_f64.powi(2), (0.02 * gravity).powi(2));
    assert!((of("accel-bias") - sum * bias / (bias + scale)).abs() < 0.01, "{}", of("accel-bias"));
    assert!((of("accel-scale") * gravity - sum * scale / (bias + scale)).abs() < 0.01);
}

#[test]
fn a_rest_gives_level_from_any_attitude() {
    for force in [Vector3::z(), -Vector3::z(), Vector3::x(), Vector3::new(1.0, -2.0, -0.5)] {
        let initial = InitialAttitude::at_rest(&(force * 9.8), 0.3);
        assert!((initial.attitude * force.normalize() - Vector3::z()).norm() < 1e-12, "{force}");
        assert!(
            (initial.level_sigma - 0.3 / (force.norm() * 9.8)).abs() < 1e-12 || initial.level_sigma > 0.017
        );
        assert!((initial.heading_sigma - std::f64::consts::PI).abs() < 1e-12);
    }
}
