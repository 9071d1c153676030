//! The coarse stage against simulated units with errors far beyond any prior.

use nalgebra::Vector3;
use rig::{Scenario, Simulation, Truth};
use sinscal::{
    Calibration, Coarse, CoarseCalibration, Sample, Setup, Sins43B, StateInfo, UnknownPulses, effect,
};

/// 1 % of scale, 0.5 deg of installation, 20 mg and 5 deg/h of bias, everything else as in the default population.
const LARGE: &str = r#"
gyro-scale = { mean = ["1 %", "-1 %", "1 %"], sigma = "20 ppm" }
gyro-misalignment = { mean = ["0.5 deg", "-0.5 deg", "0.5 deg"], sigma = "20 arcsec" }
gyro-bias = { mean = ["5 deg/h", "-5 deg/h", "5 deg/h"], sigma = "0.03 deg/h" }
accel-scale = { mean = ["-1 %", "1 %", "1 %"], sigma = "50 ppm" }
accel-misalignment = { mean = ["0.5 deg", "-0.5 deg", "0.5 deg", "0.5 deg", "-0.5 deg", "0.5 deg"], sigma = "20 arcsec" }
accel-bias = { mean = ["20 mg", "-20 mg", "20 mg"], sigma = "50 ug" }
"#;
const SMALL: &str = r#"
gyro-scale = "20 ppm"
gyro-misalignment = "20 arcsec"
gyro-bias = "0.03 deg/h"
accel-scale = "50 ppm"
accel-misalignment = "20 arcsec"
accel-bias = "50 ug"
"#;
const OTHERS: &str = r#"
accel-quadratic = "10 ug/g^2"
outer-lever-arm = { mean = ["0.2 m", "0.15 m", "-0.12 m"], sigma = "10 mm" }
inner-lever-arm = { mean = ["40 mm", "45 mm", "35 mm"], sigma = "10 mm" }
accel-delay = { mean = "0.5 ms", sigma = "0.1 ms" }
accel-temperature-scale = "8 ppm/K"
"#;

/// A unit on the path of 18 rotations.
struct Unit {
    simulation: Simulation,
    samples: Vec<Sample>,
}

impl Unit {
    fn new(errors: &str, seed: u64) -> Self {
        let text = format!("[population]\n{errors}{OTHERS}");
        let simulation = Simulation::new(&Scenario::parse(&text).expect("a scenario"), seed).expect("a unit");
        let samples = simulation.clone().collect();
        Self { simulation, samples }
    }

    fn setup(&self) -> Setup<'static> {
        self.simulation.description().setup(&[])
    }

    fn truth(&self) -> &Truth {
        self.simulation.truth()
    }

    fn coarse(&self, pulses: UnknownPulses) -> CoarseCalibration {
        let setup = self.setup();
        let mut coarse = Coarse::new(setup.site, setup.rate, setup.noise);
        self.samples.iter().for_each(|sample| coarse.push(sample));
        coarse.finish(pulses, Some(&setup.initial)).expect("positions and turns")
    }

    /// Counts of pulses of these sizes, rad and m/s.
    fn counted(mut self, gyro: Vector3<f64>, accel: Vector3<f64>) -> Self {
        for sample in &mut self.samples {
            sample.dtheta.component_div_assign(&gyro);
            sample.dvel.component_div_assign(&accel);
        }
        self
    }
}

/// Four passes over what the coarse calibration leaves: error and sigma of each parameter, NIS per degree of freedom.
fn refine(unit: &Unit, coarse: &CoarseCalibration) -> (Vec<(StateInfo, f64, f64)>, f64) {
    let setup = unit.setup();
    let mut run = Calibration::<Sins43B>::with_prior(&setup, |_, info, sigma| coarse.prior(info, sigma));
    let scale = |pulse: Option<Vector3<f64>>| pulse.unwrap_or(Vector3::repeat(1.0));
    for pass in 0..4 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in &unit.samples {
            let mut sample = *sample;
            sample.dtheta.component_mul_assign(&scale(coarse.gyro_pulse));
            sample.dvel.component_mul_assign(&scale(coarse.accel_pulse));
            coarse.compensate(&mut sample, 1.0 / setup.rate);
            run.step(&sample).expect("no divergence");
        }
    }
    let (mut states, mut values, mut sigmas) = (Vec::new(), Vec::new(), Vec::new());
    run.parameters(&mut |parameter| {
        states.push(parameter.info);
        values.push(parameter.value);
        sigmas.push(parameter.sigma);
    });
    coarse.total(&states, &mut values);
    let results = states.iter().zip(values).zip(sigmas);
    let results = results.map(|((info, value), sigma)| (*info, value - unit.truth().of(info), sigma));
    (results.collect(), run.statistics().nis_per_dof())
}

/// The capture range that is promised: errors of 1 %, 0.5 deg, 20 mg and 5 deg/h end where small ones do.
#[test]
fn large_errors_end_where_small_ones_do() {
    let (large, small) = (Unit::new(LARGE, 4), Unit::new(SMALL, 4));
    let coarse = large.coarse(UnknownPulses::default());
    assert_eq!((coarse.positions, coarse.turns), (19, 18));
    for parameter in coarse.parameters() {
        let info = effect(parameter.name).expect("an effect");
        let i = info.components().iter().position(|name| *name == parameter.component).expect("a component");
        let error = parameter.value - large.truth().value(parameter.name, i);
        println!(
            "{} {}: {:.6e} +- {:.1e}, error {error:.1e} ({:.2} prior sigmas)",
            parameter.name,
            parameter.component,
            parameter.value,
            parameter.sigma,
            error / info.prior_sigma
        );
        assert!(parameter.determined, "{} {}", parameter.name, parameter.component);
        assert!(error.abs() < 0.5 * info.prior_sigma, "{} {}", parameter.name, parameter.component);
    }
    // the same random numbers: what differs is the way there
    let (from_large, nis) = refine(&large, &coarse);
    assert!((nis - 1.0).abs() < 0.05, "NIS per degree of freedom {nis}");
    let (from_small, _) = refine(&small, &small.coarse(UnknownPulses::default()));
    for ((info, error, sigma), (_, other, _)) in from_large.iter().zip(&from_small) {
        let name = format!("{} {}: {error:e} and {other:e} of {sigma:e}", info.block, info.component);
        println!("{name} {:.2} {:.2}", error / sigma, (error - other) / sigma);
        assert!(error.abs() < 4.0 * sigma && (error - other).abs() < 0.5 * sigma, "{name}");
    }
}

/// Pulses of unknown size, unlike on each axis, some counting backwards.
#[test]
fn sizes_and_signs_of_pulses_are_found() {
    let gyro = Vector3::new(4.8e-8, -5.2e-8, 9.0e-8);
    let accel = Vector3::new(-1.1e-6, 1.0e-6, 0.7e-6);
    let unit = Unit::new(SMALL, 5).counted(gyro, accel);
    let coarse = unit.coarse(UnknownPulses { gyro: true, accel: true });
    let found = (coarse.gyro_pulse.expect("sizes"), coarse.accel_pulse.expect("sizes"));
    // one size is what it reads on: the unit's own scale errors are in it
    let truth =
        |size: &Vector3<f64>, errors: &str| size.component_div(&unit.truth().vector(errors).add_scalar(1.0));
    for (found, truth) in [(found.0, truth(&gyro, "gyro-scale")), (found.1, truth(&accel, "accel-scale"))] {
        let off = found.component_div(&truth).add_scalar(-1.0);
        println!("{found:?} of {truth:?}: {off:?}");
        // the mean temperature error is in what positions read: 8 ppm/K over 10 K
        assert!(off.amax() < 2e-4, "{found:?} of {truth:?}");
    }
}
