//! Logs that are not as their description says, or not as the trials are: none may be given a false name.

use gap::{Diagnosis, Log, Options, Verdict, diagnose};
use nalgebra::{UnitQuaternion, Vector3};
use rig::scenario::{Path, Population};
use rig::{DitherMode, Scenario, Simulation, TemperatureProfile};
use runs::Vocabulary;
use sinscal::{Sample, Setup, Sins36P, any_effect};

/// What is hidden from 36d-p, and the size of its first component, SI.
const HIDDEN: [Option<(&str, f64)>; 4] =
    [None, Some(("accel-delay", 5e-5)), Some(("gyro-g-sensitivity", 4e-7)), Some(("accel-cubic", 7e-7))];

/// What is unusual about a pair of logs.
struct Oddity {
    name: &'static str,
    /// Of the simulation of run 0 or 1.
    scenario: fn(&mut Scenario, u64),
    /// Of its samples.
    samples: fn(&mut Vec<Sample>),
    /// Of what the description says.
    setup: fn(&mut Setup),
}

const USUAL: Oddity = Oddity { name: "as described", scenario: |_, _| {}, samples: |_| {}, setup: |_| {} };

fn stated(setup: &mut Setup, factor: f64) {
    setup.noise.angle_random_walk *= factor;
    setup.noise.velocity_random_walk *= factor;
}

fn stated_reference(setup: &mut Setup, factor: f64) {
    setup.reference.velocity *= factor;
    setup.reference.position *= factor;
}

fn rated(scenario: &mut Scenario, rate: f64) {
    *scenario = scenario.clone().with_rate(rate).unwrap();
}

const ODDITIES: &[Oddity] = &[
    USUAL,
    Oddity { name: "noise stated at a third", setup: |s| stated(s, 1.0 / 3.0), ..USUAL },
    Oddity { name: "noise stated at a half", setup: |s| stated(s, 0.5), ..USUAL },
    Oddity { name: "noise stated twice", setup: |s| stated(s, 2.0), ..USUAL },
    Oddity { name: "noise stated three times", setup: |s| stated(s, 3.0), ..USUAL },
    Oddity { name: "reference stated at 0.4", setup: |s| stated_reference(s, 0.4), ..USUAL },
    Oddity { name: "reference stated at 2.5", setup: |s| stated_reference(s, 2.5), ..USUAL },
    Oddity { name: "100 Hz", scenario: |s, _| rated(s, 100.0), ..USUAL },
    Oddity { name: "200 Hz", scenario: |s, _| rated(s, 200.0), ..USUAL },
    Oddity {
        name: "second log at 100 Hz",
        scenario: |s, run| rated(s, if run == 0 { 50.0 } else { 100.0 }),
        ..USUAL
    },
    Oddity { name: "the first 600 s", samples: |s| s.retain(|s| s.time < 600.0), ..USUAL },
    Oddity {
        name: "no temperatures",
        samples: |s| {
            for s in s {
                s.temperature = Vector3::repeat(f64::NAN);
                s.gyro_temperature = s.temperature;
            }
        },
        ..USUAL
    },
    Oddity {
        name: "counts of 0.5 arcsec and 0.5 mm/s",
        scenario: |s, _| (s.gyro.quantum, s.accelerometer.quantum) = (2.4e-6, 5e-4),
        ..USUAL
    },
    Oddity {
        name: "attitude off by 5 sigma",
        setup: |s| {
            let (level, heading) = (s.initial.level_sigma, s.initial.heading_sigma);
            let off = Vector3::new(4.0 * level, -4.0 * level, 5.0 * heading);
            s.initial.attitude = UnitQuaternion::from_scaled_axis(off) * s.initial.attitude;
        },
        ..USUAL
    },
    Oddity {
        name: "biases that wander by 20 ug and 0.003 deg/h",
        scenario: |s, _| {
            (s.accelerometer.instability, s.accelerometer.correlation) = (2e-4, 600.0);
            (s.gyro.instability, s.gyro.correlation) = (0.003_f64.to_radians() / 3600.0, 600.0);
        },
        ..USUAL
    },
];

fn log(odd: &Oddity, hidden: Option<(&str, f64)>, run: u64) -> (Vec<Sample>, rig::Description) {
    let mut scenario = Scenario::default().with_rate(50.0).unwrap().modelled_by::<Sins36P>();
    scenario.run = run;
    scenario.motion.still = 150.0;
    scenario.motion.dwell = 80.0;
    scenario.dither.mode = DitherMode::Off;
    if run == 1 {
        scenario.motion.path = Path::NineteenPositions;
    }
    scenario.temperature.profile = TemperatureProfile::Ramps(if run == 0 {
        vec![(0.0, 20.0), (700.0, 38.0), (1300.0, 30.0), (2000.0, 33.0)]
    } else {
        vec![(0.0, 33.0), (500.0, 22.0), (1200.0, 36.0), (2000.0, 24.0)]
    });
    if let Some((name, size)) = hidden {
        let effect = any_effect(name).unwrap();
        let mean: Vec<f64> =
            [1.0, -0.9, 0.6].into_iter().cycle().take(effect.dim()).map(|k| k * size).collect();
        scenario.population.retain(|p| p.effect.name() != name);
        scenario.population.push(Population { effect, sigma: vec![0.0; mean.len()], mean });
    }
    (odd.scenario)(&mut scenario, run);
    let simulation = Simulation::new(&scenario, 61).unwrap();
    let description = simulation.description().clone();
    let mut samples: Vec<Sample> = simulation.collect();
    (odd.samples)(&mut samples);
    (samples, description)
}

fn diagnosed(odd: &Oddity, hidden: Option<(&str, f64)>) -> Diagnosis {
    let (first, second) = (log(odd, hidden, 0), log(odd, hidden, 1));
    let [here, there] = [&first, &second].map(|log| {
        let mut setup = log.1.setup(&[]);
        (odd.setup)(&mut setup);
        setup
    });
    let options = Options { rerun: false, ..Options::default() };
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").unwrap();
    diagnose(
        &*filter,
        vocabulary.effects(),
        &[Log { samples: &first.0, setup: &here }],
        Some(&Log { samples: &second.0, setup: &there }),
        &options,
        &mut |_, _| {},
    )
    .unwrap()
}

/// Prints a line for each; a minute and a half on two idle cores.
#[test]
#[ignore = "sixty diagnoses: run with --release -- --ignored --nocapture"]
fn odd_logs_get_no_false_name() {
    let mut false_names = Vec::new();
    for odd in ODDITIES {
        for hidden in HIDDEN {
            let d = diagnosed(odd, hidden);
            let names: Vec<&str> = d.effects.iter().map(|e| e.name.as_str()).collect();
            let hides = hidden.map_or("nothing", |h| h.0);
            println!("{:44} {hides:20} {:?} {}", odd.name, d.verdict, names.join(" "));
            if names.iter().any(|n| *n != hides) {
                false_names.push(format!("{}, {hides}: {}", odd.name, d.sentence));
            }
        }
    }
    assert!(false_names.is_empty(), "{false_names:#?}");
}

#[test]
fn a_short_log_without_temperatures_shows_no_more_than_it_can() {
    let odd = Oddity {
        samples: |s| {
            s.retain(|s| s.time < 600.0);
            s.iter_mut().for_each(|s| s.temperature = Vector3::repeat(f64::NAN));
        },
        ..USUAL
    };
    let d = diagnosed(&odd, None);
    assert_eq!(d.verdict, Verdict::NothingMissing, "{}", d.sentence);
    assert!(d.not_excited.iter().any(|n| n == "accel-temperature-bias"), "{:?}", d.not_excited);
}
