//! Filters of the literature know how wrong they are, and the demonstration of PSINS comes out as it went in.

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};
use rig::{Scenario, Simulation};
use sinscal::literature::{
    GnssIns15, MarkovAccelBias, MarkovGyroBias, PsinsCalibration, Systematic30, Systematic33,
};
use sinscal::prelude::*;
use sinscal::{Reference, Sample, Shape};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The band that holds the mean of `units` chi-squares of `dof` degrees of freedom in 99.9 % of all trials.
fn band(units: usize, dof: usize) -> (f64, f64) {
    let sum = ChiSquared::new((units * dof) as f64).unwrap();
    let mean = |p| sum.inverse_cdf(p) / units as f64;
    (mean(0.0005), mean(0.9995))
}

/// Normalised square of `error` with covariance `p`, scaled to unit diagonal first.
fn nees(error: &[f64], p: impl Fn(usize, usize) -> f64) -> f64 {
    let sigma: Vec<f64> = (0..error.len()).map(|i| p(i, i).sqrt()).collect();
    let scaled = DVector::from_fn(error.len(), |i, _| error[i] / sigma[i]);
    let correlation = DMatrix::from_fn(error.len(), error.len(), |i, j| p(i, j) / (sigma[i] * sigma[j]));
    scaled.dot(&correlation.cholesky().expect("a covariance").solve(&scaled))
}

/// NEES of the parameters of unit `seed` after two passes, and NIS per degree of freedom.
fn calibrated<F: Filter<Dynamics = Strapdown>>(
    scenario: &Scenario,
    seed: u64,
    known: impl Fn(&mut Sample),
) -> (f64, f64) {
    let simulation = Simulation::new(scenario, seed).unwrap();
    let truth = simulation.truth().clone();
    let mut run =
        Box::new(Calibration::<F>::new(&simulation.description().setup(&[])).expect("a sound setup"));
    let mut samples: Vec<_> = simulation.collect();
    samples.iter_mut().for_each(known);
    for pass in 0..2 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in &samples {
            run.step(sample).unwrap();
        }
    }
    let mut error = Vec::new();
    run.parameters(&mut |p| error.push(p.value - truth.of(&p.info)));
    let (p, core) = (run.covariance(), F::Shape::CORE);
    (nees(&error, |i, j| p[core + i][core + j]), run.statistics().nis_per_dof())
}

fn consistent<F: Filter<Dynamics = Strapdown>>(text: &str, units: u64, known: impl Fn(&mut Sample) + Copy) {
    let scenario = Scenario::parse(text).unwrap().modelled_by::<F>();
    let found: Vec<_> = (1..=units).map(|seed| calibrated::<F>(&scenario, seed, known)).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
    let (nees, nis) = (mean(|f| f.0), mean(|f| f.1));
    let dof = F::DIM - F::Shape::CORE;
    let (low, high) = band(found.len(), dof);
    println!("{}: NEES {nees:.2} of {dof}, band {low:.2} to {high:.2}; NIS {nis:.3}", F::NAME);
    assert!((low..high).contains(&nees), "{}: NEES {nees} outside {low} to {high}", F::NAME);
    assert!((nis - 1.0).abs() < 0.05, "{}: NIS {nis}", F::NAME);
}

const SHORT: &str = "[motion]\nstill = \"120 s\"\ndwell = \"40 s\"\n";

fn systematic(units: u64, text: &str) {
    consistent::<Systematic30>(text, units, |_| {});
    consistent::<Systematic33>(text, units, |_| {});
}

/// Whether the unit turns by more than a tenth of a degree per second.
fn turns(sample: &Sample, rate: f64) -> bool {
    sample.dtheta.norm() * rate > 0.1_f64.to_radians()
}

/// Every lever arm in a population whose priors they are drawn from: three directions of them do not show, and count all the same.
fn psins(units: u64) {
    let text = format!(
        "{SHORT}[population]\ngyro-scale = \"20 ppm\"\ngyro-misalignment = \"20 arcsec\"\ngyro-bias = \"0.03 deg/h\"\n\
         accel-scale = \"50 ppm\"\naccel-misalignment = \"20 arcsec\"\naccel-bias = \"50 ug\"\n\
         accel-quadratic = \"10 ug/g^2\"\naccel-delay = \"1 ms\"\ninner-lever-arm = \"100 mm\"\n\
         inner-lever-arm-tangential = \"100 mm\"\nouter-lever-arm = \"500 mm\"\n"
    );
    consistent::<PsinsCalibration>(&text, units, |sample| {
        if turns(sample, 50.0) {
            sample.reference = Reference::default();
        }
    });
}

#[test]
fn systematic_calibrations_know_how_wrong_they_are() {
    systematic(5, SHORT);
}

#[test]
fn the_calibration_of_psins_knows_how_wrong_it_is() {
    psins(5);
}

#[test]
#[ignore = "minutes in release"]
fn a_hundred_units_of_the_systematic_calibrations() {
    systematic(100, "");
}

#[test]
#[ignore = "minutes in release"]
fn a_hundred_units_of_the_calibration_of_psins() {
    psins(100);
}

#[test]
#[ignore = "minutes in release"]
fn a_hundred_units_under_gnss() {
    gnss(100);
}

/// A vehicle that rocks and sways, with biases that wander as the filter says, under GNSS of 1 m and 5 cm/s.
fn gnss(units: u64) {
    let text = format!(
        "[imu]\nrate = \"50 Hz\"\n[motion]\npath = \"swing\"\nstart = \"ENU\"\nduration = \"900 s\"\n\
         [motion.swing]\namplitude = [\"10 deg\", \"8 deg\", \"40 deg\"]\nfrequency = [\"0.1 Hz\", \"0.13 Hz\", \"0.02 Hz\"]\n\
         [table]\nvibration_acceleration = [\"0.5 m/s^2\", \"0.7 m/s^2\", \"0.2 m/s^2\"]\n\
         vibration_frequency = [\"0.05 Hz\", \"0.03 Hz\", \"0.08 Hz\"]\n\
         [reference]\nrate = \"1 Hz\"\nvelocity_sigma = \"50 mm/s\"\nposition_sigma = \"1 m\"\n\
         [initial]\nlevel_sigma = \"0.2 deg\"\nheading_sigma = \"1 deg\"\n\
         [gyro]\nrandom_walk = \"0.1 deg/sqrt(h)\"\nquantum = \"0 arcsec\"\nbias_instability = \"{:e} rad/s\"\n\
         bias_correlation = \"{} s\"\n\
         [accelerometer]\nrandom_walk = \"100 ug/sqrt(Hz)\"\nquantum = \"0 um/s\"\nbias_instability = \"{:e} m/s^2\"\n\
         bias_correlation = \"{} s\"\n[dither]\nmode = \"off\"\n[population]\n",
        MarkovGyroBias::SIGMA,
        MarkovGyroBias::CORRELATION,
        MarkovAccelBias::SIGMA,
        MarkovAccelBias::CORRELATION
    );
    let scenario = Scenario::parse(&text).unwrap();
    let (mut sum, mut nis) = (0.0, 0.0);
    for seed in 1..=units {
        let simulation = Simulation::new(&scenario, seed).unwrap();
        let mut run = Box::new(
            Calibration::<GnssIns15>::new(&simulation.description().setup(&[])).expect("a sound setup"),
        );
        let samples: Vec<_> = simulation.clone().collect();
        for sample in &samples {
            run.step(sample).unwrap();
        }
        let time = samples.last().unwrap().time;
        let (position, velocity) = simulation.position(time);
        let (rotation, _) = simulation.motion(time);
        // C_hat = (I - [phi x]) C
        let phi = -(run.attitude() * rotation.attitude().inverse()).scaled_axis();
        let error = [phi, run.navigation().velocity - velocity, run.position() - position];
        let error: Vec<f64> = error.iter().flat_map(|v| v.iter().copied()).collect();
        let p = run.covariance();
        sum += nees(&error, |i, j| p[i][j]);
        nis += run.statistics().nis_per_dof();
    }
    let (low, high) = band(units as usize, 9);
    let (mean, nis) = (sum / units as f64, nis / units as f64);
    println!("gnss-ins-15d: NEES {mean:.2} of 9, band {low:.2} to {high:.2}; NIS {nis:.3}");
    assert!((low..high).contains(&mean), "NEES {mean} outside {low} to {high}");
    assert!((nis - 1.0).abs() < 0.05, "NIS {nis}");
}

#[test]
fn navigation_with_wandering_biases_knows_how_wrong_it_is() {
    gnss(10);
}

/// The filter of the example, whose scenario this is too.
#[derive(StateBlocks)]
#[filter(name = "46d", measures(velocity, position))]
struct Sins46 {
    #[base]
    sins: sinscal::Sins40P,
    tangential: InnerLeverArmTangential,
}

#[test]
fn the_demonstration_of_psins_comes_out_as_it_went_in() {
    let mut scenario = Scenario::parse(include_str!("../../examples/psins/scenario.toml")).unwrap();
    let about =
        |axis: Vector3<f64>, degrees: f64| UnitQuaternion::from_scaled_axis(axis * degrees.to_radians());
    scenario.motion.start =
        about(Vector3::z(), -91.0) * about(Vector3::x(), 1.0) * about(Vector3::y(), -91.0);
    let simulation = Simulation::new(&scenario, 1).unwrap();
    let truth = simulation.truth().clone();
    let mut run =
        Box::new(Calibration::<Sins46>::new(&simulation.description().setup(&[])).expect("a sound setup"));
    let samples: Vec<_> = simulation.collect();
    let time = samples.last().unwrap().time;
    assert!((time - 982.0).abs() < 2.0, "{time} s");
    for pass in 0..2 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in &samples {
            run.step(sample).unwrap();
        }
    }
    let (mut arms, mut outer) = (nalgebra::Matrix3::zeros(), Vector3::zeros());
    let axis = |name: &str| ["x", "y", "z"].iter().position(|axis| *axis == name);
    run.parameters(&mut |p| {
        let error = p.value - truth.of(&p.info);
        let (in_sheet, c) = (error / p.info.sheet_scale, p.info.component);
        println!("{} {c}: {in_sheet:.5} {} off", p.info.block, p.info.sheet_unit);
        let allowed = match p.info.block {
            "inner-lever-arm" => return arms[(axis(c).unwrap(), axis(c).unwrap())] = error,
            "inner-lever-arm-tangential" => {
                return arms[(axis(&c[..1]).unwrap(), axis(&c[1..]).unwrap())] = error;
            }
            "outer-lever-arm" => return outer[axis(c).unwrap()] = error,
            "gyro-misalignment" | "accel-misalignment" => 0.02,
            "gyro-bias" => 0.0002,
            "accel-delay" => 0.0002,
            _ => 0.1,
        };
        assert!(in_sheet.abs() < allowed, "{} {c}: {in_sheet} {} off", p.info.block, p.info.sheet_unit);
    });
    // no log shows a shift of all accelerometers and of the observed point together: what is left must be just that
    println!("common shift {:.3?} mm", (outer * 1e3).as_slice());
    for i in 0..3 {
        let left = arms.row(i).transpose() - outer;
        assert!(left.amax() < 0.2e-3, "arm {i}: {left} m beside the common shift {outer}");
    }
}
