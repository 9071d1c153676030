//! Free-inertial navigation: an ideal unit stays where it is, a wrong calibration drifts as theory says.

mod common;

use common::{sample, setup};
use nalgebra::{UnitQuaternion, Vector3};
use sinscal::navigation::{FreeInertial, parameters_of, pilot};
use sinscal::{Block, Filter, Sample, Setup, Shape, Sins36P, Sins43B, earth};

/// What an ideal unit at rest feels; `bias` is added to the specific force.
fn at_rest(setup: &Setup, seconds: f64, bias: Vector3<f64>) -> Vec<Sample> {
    let attitude = setup.initial.attitude;
    let gravity = Vector3::z() * earth::gravity(setup.site.latitude, setup.site.height);
    let rate = attitude.inverse() * earth::rotation_n(setup.site.latitude);
    let force = attitude.inverse() * gravity + bias;
    let dt = 1.0 / setup.rate;
    (1..=(seconds / dt) as usize)
        .map(|k| {
            let mut now = sample(k as f64 * dt, rate * dt, force * dt);
            now.reference.velocity = Some(Vector3::zeros());
            now.reference.position = Some(Vector3::zeros());
            now
        })
        .collect()
}

fn level() -> Setup<'static> {
    let mut setup = Setup { rate: 10.0, outer_lever: Vector3::zeros(), ..setup() };
    setup.initial.attitude = UnitQuaternion::identity();
    setup
}

#[test]
fn an_ideal_unit_stays_where_it_is() {
    let setup = level();
    let none = <Sins36P as Filter>::Shape::vector(0.0);
    let mut run = FreeInertial::<Sins36P>::new(&setup, &none);
    for sample in at_rest(&setup, 6.0 * 3600.0, Vector3::zeros()) {
        run.step(&sample);
    }
    assert_eq!(run.drift().comparisons, 6 * 3600);
    assert!((run.drift().duration - 6.0 * 3600.0).abs() < 1.0);
    assert!(run.drift().largest < 1e-2, "{}", run.drift().largest);
}

#[test]
fn an_accelerometer_bias_oscillates_with_schulers_period() {
    // dp = (b / w^2) (1 - cos w t), w^2 = g / R: largest after half a period of 84 minutes
    let setup = level();
    let bias = 1e-3;
    let samples = at_rest(&setup, 84.4 * 60.0, Vector3::x() * bias);
    let largest = |value: f64| {
        let parameters = parameters_of::<Sins36P>(&setup, |info| {
            (info.block == "accel-bias" && info.component == "x").then_some(value)
        });
        let mut run = FreeInertial::<Sins36P>::new(&setup, &parameters);
        samples.iter().for_each(|sample| {
            run.step(sample);
        });
        *run.drift()
    };
    let (_, prime_vertical) = earth::radii(setup.site.latitude);
    let expected = 2.0 * bias * prime_vertical / earth::gravity(setup.site.latitude, setup.site.height);
    let uncompensated = largest(0.0);
    assert!((uncompensated.largest / expected - 1.0).abs() < 0.02, "{} {expected}", uncompensated.largest);
    assert!(uncompensated.last < 0.1 * expected, "{}", uncompensated.last);
    // the calibration that knows it takes it away
    assert!(largest(bias).largest < 1e-2);
}

#[test]
fn alignment_absorbs_a_bias_while_nothing_turns() {
    // the level is off by b / g, and the unit stays
    let mut setup = level();
    setup.initial.level_sigma = 1e-3;
    setup.initial.heading_sigma = 1e-3;
    let samples = at_rest(&setup, 3600.0, Vector3::x() * 1e-3);
    let mut pilot = pilot("43d-b", &setup, |_| None).expect("a filter of this name");
    for sample in samples.iter().take_while(|sample| sample.time <= 900.0) {
        pilot.step(sample).expect("the alignment converges");
    }
    assert!(pilot.depart());
    for sample in &samples {
        pilot.step(sample).expect("nothing can diverge");
    }
    // against 1300 m without
    assert!(pilot.drift().largest < 30.0, "{}", pilot.drift().largest);
}

#[test]
fn names_reach_their_states_and_the_first_guess_is_taken_off() {
    let setup = Setup { outer_lever: Vector3::new(0.1, 0.2, 0.3), ..level() };
    let parameters = parameters_of::<Sins43B>(&setup, |info| match (info.block, info.component) {
        ("outer-lever-arm", "y") => Some(0.25),
        ("outer-lever-arm", _) => Some(0.0),
        ("accel-delay", _) => Some(5e-4),
        _ => None,
    });
    let mut found = Vec::new();
    let mut i = 0;
    Sins43B::states(&mut |info| {
        if parameters[i] != 0.0 {
            found.push((info.block, info.component, (parameters[i] * 1e6).round() / 1e6));
        }
        i += 1;
    });
    let expected = [
        ("outer-lever-arm", "x", -0.1),
        ("outer-lever-arm", "y", 0.05),
        ("outer-lever-arm", "z", -0.3),
        ("accel-delay", "tau", 5e-4),
    ];
    assert_eq!(found, expected);
}

/// 48 h at 100 Hz within 4 s on one core: 231 ns a sample.
#[test]
#[ignore = "a matter of seconds in release; run with --release -- --ignored --nocapture"]
fn forty_eight_hours_in_four_seconds() {
    let setup = Setup { rate: 100.0, ..level() };
    let samples = at_rest(&setup, 600.0, Vector3::zeros());
    let parameters = parameters_of::<Sins43B>(&setup, |info| Some(0.1 * info.prior_sigma));
    let mut run = FreeInertial::<Sins43B>::new(&setup, &parameters);
    let started = std::time::Instant::now();
    let rounds = 48 * 6;
    for round in 0..rounds {
        for sample in &samples {
            let mut now = *sample;
            now.time += 600.0 * f64::from(round);
            run.step(&now);
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    println!("43d-b, 48 h at 100 Hz: {seconds:.2} s, {} m", run.drift().last);
    assert!(seconds < 4.0, "{seconds} s");
}

/// The largest of errors of which one is no number is no number.
#[test]
fn an_error_that_is_no_number_is_the_largest() {
    let setup = level();
    let mut run = FreeInertial::<Sins36P>::new(&setup, &parameters_of::<Sins36P>(&setup, |_| None));
    let mut samples = at_rest(&setup, 30.0, Vector3::zeros());
    samples[150].dvel.x = f64::NAN;
    for (k, sample) in samples.iter().enumerate() {
        run.step(sample);
        assert_eq!(run.drift().largest.is_nan(), k >= 160 || run.drift().last.is_nan(), "{k}");
    }
    assert!(run.drift().largest.is_nan() && run.drift().last.is_nan());
}
