//! The coarse stage against simulated units with errors far beyond any prior.

use nalgebra::Vector3;
use rig::{Scenario, Simulation, Truth};
use sinscal::{
    Calibration, Coarse, CoarseCalibration, CoarseError, Filter, Mems30, Sample, Setup, Sins43B, StateInfo,
    Strapdown, UnknownPulses, effect,
};

/// 1 % of scale, 0.5 deg of installation, 20 mg and 5 deg/h of bias beside what the default population has.
const LARGE: &str = include_str!("../docs/large-errors.toml");
/// A MEMS unit, on the same path.
const MEMS: &str = r#"
[gyro]
random_walk = "0.3 deg/sqrt(h)"
[accelerometer]
random_walk = "100 ug/sqrt(Hz)"
[motion]
rate = "60 deg/s"
acceleration = "120 deg/s^2"
dwell = "10 s"
still = "30 s"
[reference]
velocity_sigma = "5 mm/s"
"#;

/// A unit on the path of 18 rotations.
struct Unit {
    simulation: Simulation,
    samples: Vec<Sample>,
}

impl Unit {
    fn new(scenario: &Scenario, seed: u64) -> Self {
        let simulation = Simulation::new(scenario, seed).expect("a unit");
        let samples = simulation.clone().collect();
        Self { simulation, samples }
    }

    fn setup(&self) -> Setup<'static> {
        self.simulation.description().setup(&[])
    }

    fn collected(&self) -> Coarse {
        let setup = self.setup();
        let mut coarse = Coarse::new(setup.site, setup.rate, setup.noise);
        self.samples.iter().for_each(|sample| coarse.push(sample));
        coarse
    }

    fn truth(&self) -> &Truth {
        self.simulation.truth()
    }

    fn coarse(&self, pulses: UnknownPulses) -> CoarseCalibration {
        self.collected().finish(pulses, Some(&self.setup().initial)).expect("positions and turns")
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

type Refined = (Vec<(StateInfo, f64, f64)>, f64);

/// Four passes over what the coarse calibration leaves: error and sigma of each parameter, NIS per degree of freedom.
fn refine<F: Filter<Dynamics = Strapdown>>(unit: &Unit, coarse: &CoarseCalibration) -> Refined {
    let setup = unit.setup();
    let mut run = Calibration::<F>::with_prior(&setup, |_, info, sigma| coarse.prior(info, sigma));
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

fn default() -> Scenario {
    Scenario::default()
}

fn scenario(text: &str) -> Scenario {
    Scenario::parse(text).expect("a scenario")
}

/// The same unit with the same random numbers, its errors near zero and far out: both end in the same place.
fn compare<F: Filter<Dynamics = Strapdown>>(large: &Scenario, small: &Scenario, seed: u64, coarse_part: f64) {
    let (large, small) = (Unit::new(large, seed), Unit::new(small, seed));
    let coarse = large.coarse(UnknownPulses::default());
    assert_eq!((coarse.positions, coarse.turns), (19, 18));
    for parameter in coarse.parameters() {
        let info = effect(parameter.name).expect("an effect");
        let i = info.components().iter().position(|name| *name == parameter.component).expect("a component");
        let error = parameter.value - large.truth().value(parameter.name, i);
        let name = format!("{} {}: error {error:.1e}", parameter.name, parameter.component);
        println!("{name}, {:.3} prior sigmas", error / info.prior_sigma);
        assert!(parameter.determined && error.abs() < coarse_part * info.prior_sigma, "{name}");
    }
    let (from_large, nis) = refine::<F>(&large, &coarse);
    assert!((nis - 1.0).abs() < 0.05, "NIS per degree of freedom {nis}");
    let (from_small, _) = refine::<F>(&small, &small.coarse(UnknownPulses::default()));
    for ((info, error, sigma), (_, other, _)) in from_large.iter().zip(&from_small) {
        let name = format!("{} {}: {error:.1e} and {other:.1e} of {sigma:.1e}", info.block, info.component);
        println!("{name}: {:.2} sigmas, {:.2} apart", error / sigma, (error - other) / sigma);
        assert!(error.abs() < 4.0 * sigma && (error - other).abs() < 0.3 * sigma, "{name}");
    }
}

/// The capture range that is promised: errors of 1 %, 0.5 deg, 20 mg and 5 deg/h end where small ones do.
#[test]
fn large_errors_end_where_small_ones_do() {
    compare::<Sins43B>(&scenario(LARGE), &default(), 4, 0.5);
}

/// The same of a MEMS unit, with noise a few hundred times larger and positions of ten seconds.
#[test]
fn large_errors_of_a_mems_unit_end_where_small_ones_do() {
    let [large, small] =
        [LARGE, ""].map(|population| scenario(&format!("{MEMS}{population}")).modelled_by::<Mems30>());
    compare::<Mems30>(&large, &small, 4, 20.0);
}

/// How much further it reaches: ten times the errors that are promised.
#[test]
fn ten_times_the_promised_errors_are_captured() {
    let mut scenario = scenario(LARGE);
    for population in &mut scenario.population {
        if Coarse::EFFECTS.contains(&population.effect.name()) {
            population.mean.iter_mut().for_each(|mean| *mean *= 10.0);
        }
    }
    let unit = Unit::new(&scenario, 4);
    let coarse = unit.coarse(UnknownPulses::default());
    for parameter in coarse.parameters() {
        let info = effect(parameter.name).expect("an effect");
        let i = info.components().iter().position(|name| *name == parameter.component).expect("a component");
        let error = parameter.value - unit.truth().value(parameter.name, i);
        println!("{} {}: error {error:.1e}", parameter.name, parameter.component);
        assert!(error.abs() < info.prior_sigma, "{} {}", parameter.name, parameter.component);
    }
}

#[test]
fn a_log_without_positions_says_what_is_missing() {
    let unit = Unit::new(&scenario("[motion]\npath = \"swing\"\nduration = \"60 s\""), 1);
    let refused = unit.collected().finish(UnknownPulses::default(), None);
    assert!(matches!(refused, Err(CoarseError::TooFewPositions { found }) if found < 6), "{refused:?}");
    // four positions about one vertical axis
    let turn = r#"{ axis = "up", angle = "90 deg", dwell = "20 s" }"#;
    let text = format!("[motion]\npath = \"turns\"\nturns = [{}]", [turn; 8].join(", "));
    let unit = Unit::new(&scenario(&text), 1);
    let known = unit.collected().finish(UnknownPulses::default(), None).expect("nine positions");
    assert!(known.parameters().any(|parameter| !parameter.determined));
    let unknown = unit.collected().finish(UnknownPulses { gyro: true, accel: true }, None);
    assert_eq!(unknown, Err(CoarseError::PulsesUnclear));
}

/// Pulses of unknown size, unlike on each axis, some counting backwards.
#[test]
fn sizes_and_signs_of_pulses_are_found() {
    let gyro = Vector3::new(4.8e-8, -5.2e-8, 9.0e-8);
    let accel = Vector3::new(-1.1e-6, 1.0e-6, 0.7e-6);
    let unit = Unit::new(&default(), 5).counted(gyro, accel);
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
