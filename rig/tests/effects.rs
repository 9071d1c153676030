//! Effects of one's own are simulated like those of the catalogue, none of which is missing.

use nalgebra::Vector3;
use rig::{Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{AnyEffect, CATALOGUE, Effect, EffectInfo, FORCE, Kind, Point, Signals};

/// Accelerometers behind a rubber mount: `d_f_i = k_i |omega| f_i`.
struct MountSoftness;

impl Effect for MountSoftness {
    const EFFECT: EffectInfo = EffectInfo::new("mount-softness", Kind::Force, &["x", "y", "z"], "s", 1e-4)
        .model("d_f_i = k_i |omega| f_i", "accelerometers behind a rubber mount");
}

impl Block for MountSoftness {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "mount-softness";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Self::EFFECT.states(visit);
    }

    fn input_jacobian<T: Real>(s: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(FORCE + i, i, s.rate.norm() * s.force[i]);
        }
    }
}

/// A gyro that saturates: its error is a cubic whose size is no small matter, told apart from its Jacobian.
struct Saturation;

impl Effect for Saturation {
    const EFFECT: EffectInfo = EffectInfo::new("saturation", Kind::Rate, &["k"], "s^2", 1e-2)
        .model("omega_i read = tanh(sqrt(3 k) omega_i) / sqrt(3 k)", "gyros that saturate");

    fn error(s: &Signals<f64>, values: &[f64], error: &mut [f64; 6]) {
        let k = (3.0 * values[0]).sqrt();
        for i in 0..3 {
            error[i] += (k * s.rate[i]).tanh() / k - s.rate[i];
        }
    }
}

impl Block for Saturation {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "saturation";
    const DIM: usize = 1;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Self::EFFECT.states(visit);
    }

    fn input_jacobian<T: Real>(s: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(i, 0, -s.rate[i] * s.rate[i] * s.rate[i]);
        }
    }
}

/// A reference with a constant offset of its velocity.
struct VelocityOffset;

impl Effect for VelocityOffset {
    const EFFECT: EffectInfo =
        EffectInfo::new("velocity-offset", Kind::Measurement, &["e", "n", "u"], "m/s", 1e-2);
}

impl Block for VelocityOffset {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "velocity-offset";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Self::EFFECT.states(visit);
    }

    fn measurement_jacobian<T: Real>(_: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(i, i, -T::one());
        }
    }
}

/// Says that it is an error of the gyros and acts on the accelerometers.
struct Liar;

impl Effect for Liar {
    const EFFECT: EffectInfo = EffectInfo::new("liar", Kind::Rate, &["x", "y", "z"], "s", 1e-4);
}

impl Block for Liar {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "liar";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Self::EFFECT.states(visit);
    }

    fn input_jacobian<T: Real>(s: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        MountSoftness::input_jacobian(s, put);
    }
}

const OWN: [&dyn AnyEffect; 4] = [
    <dyn AnyEffect>::of::<MountSoftness>(),
    <dyn AnyEffect>::of::<Saturation>(),
    <dyn AnyEffect>::of::<VelocityOffset>(),
    <dyn AnyEffect>::of::<Liar>(),
];

/// Rocking by up to 100 deg/s without noise, the unit as `population` says.
fn rocking(population: &str) -> Result<Simulation, String> {
    let text = format!(
        "[imu]\nrate = \"100 Hz\"\n[motion]\npath = \"swing\"\nduration = \"20 s\"\n\
         [motion.swing]\namplitude = [\"30 deg\", \"25 deg\", \"35 deg\"]\nfrequency = [\"0.4 Hz\", \"0.5 Hz\", \"0.3 Hz\"]\n\
         [reference]\nvelocity_sigma = \"1e-9 m/s\"\n\
         [gyro]\nrandom_walk = \"0 deg/sqrt(h)\"\nquantum = \"0 arcsec\"\n\
         [accelerometer]\nrandom_walk = \"0 ug/sqrt(Hz)\"\nquantum = \"0 um/s\"\n[dither]\nmode = \"off\"\n\
         [population]\n{population}"
    );
    let scenario = Scenario::parse_with(&text, &OWN).map_err(|error| error.to_string())?;
    Simulation::new(&scenario, 1).map_err(|error| error.to_string())
}

#[test]
fn effects_of_ones_own_have_a_size_are_drawn_and_stand_in_the_truth() {
    let ideal = rocking("").unwrap();
    let soft = rocking("mount-softness = \"1e-4 s\"\n").unwrap();
    let truth = soft.truth().clone();
    let k = truth.vector("mount-softness");
    assert!(k.amin() > 0.0 || k.iter().any(|k| *k != 0.0));
    let mut state = None;
    MountSoftness::states(&mut |info| state = Some(info));
    assert_eq!(truth.of(&state.unwrap()), k.z);
    assert!(truth.to_json().contains("\"mount-softness\": ["));
    let mut most = 0.0_f64;
    for (k_sample, (with, without)) in soft.zip(ideal.clone()).enumerate() {
        assert_eq!(with.dtheta, without.dtheta);
        let felt = ideal.felt((k_sample as f64 + 0.5) * 0.01);
        let expected = k.component_mul(&felt.force) * felt.rate.norm() * 0.01;
        let found = with.dvel - without.dvel;
        // the middle of an interval against its mean
        assert!((found - expected).amax() < 2e-3 * expected.amax() + 1e-9, "{found} {expected}");
        most = most.max(found.amax());
    }
    assert!(most > 1e-6, "{most}");
}

#[test]
fn an_effect_that_says_how_it_is_when_it_is_not_small_is_simulated_so() {
    let ideal = rocking("").unwrap();
    let saturated = rocking("saturation = { mean = \"0.05 s^2\", sigma = \"0 s^2\" }\n").unwrap();
    let root = 0.15_f64.sqrt();
    let mut differs = 0.0_f64;
    for (k, (with, without)) in saturated.zip(ideal.clone()).enumerate() {
        let rate = ideal.felt((k as f64 + 0.5) * 0.01).rate;
        let expected = rate.map(|w| (root * w).tanh() / root - w) * 0.01;
        let linear = rate.map(|w| -0.05 * w * w * w) * 0.01;
        let found = with.dtheta - without.dtheta;
        assert!((found - expected).amax() < 1e-5, "{found} {expected}");
        differs = differs.max((found - linear).amax());
    }
    // forty times the tolerance: the Jacobian times the size would not have passed
    assert!(differs > 4e-4, "{differs}");
}

#[test]
fn an_effect_of_ones_own_on_the_reference_shifts_its_readings() {
    let ideal = rocking("").unwrap();
    let shifted = rocking("velocity-offset = \"1 m/s\"\n").unwrap();
    let offset = shifted.truth().vector("velocity-offset");
    assert!(offset.norm() > 0.1);
    let mut readings = 0;
    for (with, without) in shifted.zip(ideal) {
        if let (Some(with), Some(without)) = (with.reference.velocity, without.reference.velocity) {
            assert!((with - without - offset).amax() < 1e-7);
            readings += 1;
        }
    }
    assert!(readings > 10);
}

#[test]
fn an_effect_whose_jacobian_is_of_another_kind_is_refused() {
    let refused = rocking("liar = \"1e-4 s\"\n").unwrap_err();
    assert!(refused.contains("liar") && refused.contains("another kind"), "{refused}");
    let unknown = rocking("mount-softnes = \"1e-4 s\"\n").unwrap_err();
    assert!(unknown.contains("mount-softness"), "{unknown}");
}

/// Effects of the catalogue without which every log would be the same: each one changes some reading, and by what its Jacobian says
/// where it has no form of its own.
#[test]
fn the_simulator_has_every_effect_of_the_catalogue() {
    let log = |population: &str| {
        let text = format!(
            "[motion]\npath = \"swing\"\nduration = \"20 s\"\n\
             [table]\nvibration_acceleration = [\"0.5 m/s^2\", \"0.7 m/s^2\", \"0.2 m/s^2\"]\n\
             vibration_frequency = [\"0.5 Hz\", \"0.3 Hz\", \"0.8 Hz\"]\n[reference]\nattitude = true\n[population]\n{population}"
        );
        Simulation::new(&Scenario::parse(&text).unwrap(), 1).unwrap()
    };
    // how biases wander is a matter of the noise: `tests/simulation/wander.rs`
    for effect in CATALOGUE.iter().filter(|effect| !effect.is_wander()) {
        let (name, info) = (effect.name(), effect.info());
        let one = |name: &str| format!("{name} = \"{:e} {}\"\n", info.prior_sigma, info.unit());
        // dither acts through the inner lever arms, and does where these are
        let other = if name == "dither-size-effect" { one("inner-lever-arm") } else { one(name) };
        let with = log(&other);
        assert!(with.truth().effects().contains_key(name), "{name} is not in the truth");
        let differ = |a: &Vector3<f64>, b: &Vector3<f64>| (a - b).amax() > 0.0;
        let changed = with.zip(log("")).any(|(a, b)| {
            let (r, s) = (a.reference, b.reference);
            differ(&a.dtheta, &b.dtheta)
                || differ(&a.dvel, &b.dvel)
                || r.velocity.zip(s.velocity).is_some_and(|(a, b)| differ(&a, &b))
                || r.position.zip(s.position).is_some_and(|(a, b)| differ(&a, &b))
                || r.attitude != s.attitude
                || a.time != b.time
                || differ(&a.temperature, &b.temperature)
                || differ(&a.gyro_temperature, &b.gyro_temperature)
                || differ(&a.dither, &b.dither)
        });
        assert!(changed, "{name} changes nothing in a simulated log");
    }
}
