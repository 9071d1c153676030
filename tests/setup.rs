//! What is said of a setup that is wrong, and what one can be told.

mod common;

use common::{Numbers, sample, setup};
use nalgebra::Vector3;
use sinscal::prelude::*;
use sinscal::{InitialAttitude, InitialVelocity, Reference, Setup, Sins36P, Tracked35};

fn said(setup: &Setup) -> String {
    match (setup.check::<Sins36P>(), Calibration::<Sins36P>::new(setup)) {
        (Err(error), Err(same)) => {
            assert_eq!(error.to_string(), same.to_string());
            error.to_string()
        }
        (Ok(()), Ok(_)) => "sound".into(),
        _ => panic!("the check and the run disagree"),
    }
}

/// What makes a setup wrong, and what is said of it.
type Case = (fn(&mut Setup), &'static str);

#[test]
fn every_field_is_looked_at() {
    let cases: [Case; 20] = [
        (|_| {}, "sound"),
        (|s| s.initial = InitialAttitude::unknown_heading(), "sound"),
        (|s| s.rate = 0.0, "`rate` is 0, it should be positive"),
        (|s| s.site.latitude = 32.0, "`site.latitude` is 32, it should be within a quarter turn, in rad"),
        (|s| s.site.longitude = f64::NAN, "`site.longitude` is NaN, it should be a number"),
        (|s| s.site.height = f64::INFINITY, "`site.height` is inf, it should be a number"),
        (
            |s| s.initial.attitude = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::default()),
            "`initial.attitude` is 0, it should be of norm 1",
        ),
        (|s| s.initial.level_sigma = -1e-3, "`initial.level_sigma` is -0.001, it should be between 0 and pi"),
        (
            |s| s.initial.heading_sigma = 180.0,
            "`initial.heading_sigma` is 180, it should be between 0 and pi",
        ),
        (|s| s.velocity.velocity.y = f64::NAN, "`velocity.velocity` is NaN, it should be three numbers"),
        (|s| s.velocity.sigma = -1.0, "`velocity.sigma` is -1, it should be zero or more"),
        (|s| s.reference.velocity = 0.0, "`reference.velocity` is 0, it should be positive"),
        (|s| s.reference.position = -2.0, "`reference.position` is -2, it should be positive"),
        (|s| s.reference.attitude = f64::NAN, "`reference.attitude` is NaN, it should be positive"),
        (|s| s.update_rate = -1.0, "`update_rate` is -1, it should be positive"),
        (
            |s| s.noise.angle_random_walk = -1e-7,
            "`noise.angle_random_walk` is -0.0000001, it should be zero or more",
        ),
        (
            |s| s.noise.velocity_random_walk = f64::NAN,
            "`noise.velocity_random_walk` is NaN, it should be zero or more",
        ),
        (|s| s.reference_temperature = f64::NAN, "`reference_temperature` is NaN, it should be a number"),
        (|s| s.outer_lever.z = f64::INFINITY, "`outer_lever` is inf, it should be three numbers"),
        (|s| s.reference.attitude = 1e-3, "sound"),
    ];
    for (spoil, expected) in cases {
        let mut setup = setup();
        spoil(&mut setup);
        assert_eq!(said(&setup), expected);
    }
}

#[test]
fn names_are_looked_at() {
    let prior = |name, sigma| said(&Setup { priors: &[(name, sigma)], ..setup() });
    assert_eq!(prior("gyro-bias", 1e-6), "sound");
    // of the catalogue, though not in this filter
    assert_eq!(prior("accel-delay", 1e-3), "sound");
    assert_eq!(
        prior("gyro-bais", 1e-6),
        "`priors`: there is no block `gyro-bais`; did you mean `gyro-bias`?"
    );
    assert_eq!(prior("flux", 1.0), "`priors`: there is no block `flux`");
    // the leading states begin as `initial` and `velocity` say
    assert_eq!(prior("velocity", 1.0), "`priors`: there is no block `velocity`");
    assert_eq!(prior("gyro-bias", -1.0), "`priors`: that of `gyro-bias` is -1, it should be zero or more");
    let long = "a-name-that-is-longer-than-what-an-error-holds-\u{e4}";
    assert!(prior(long, 1.0).starts_with("`priors`: there is no block `a-name-that-is-longer"));

    let sigma = |name, sigma| said(&Setup { sigmas: &[(name, sigma)], ..setup() });
    assert_eq!(sigma("rate", 1e-5), "sound");
    assert_eq!(sigma("rat", 1e-5), "`sigmas`: there is no measurement `rat`; did you mean `rate`?");
    assert_eq!(sigma("height", 0.0), "`sigmas`: that of `height` is 0, it should be positive");

    let time = |name, time| said(&Setup { correlation_times: &[(name, time)], ..setup() });
    let constant = "`correlation_times`: there is no Gauss-Markov block `gyro-bias`";
    assert_eq!(time("gyro-bias", 100.0), constant);
}

/// A gyro bias about x that wanders; 300 s unless told otherwise.
struct Wander;

impl Block for Wander {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "gyro-wander";
    const DIM: usize = 1;
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] =
        &[(0, Relaxation { rate: 1.0 / 300.0, density: 2.0 * 1e-10 / 300.0 })];

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        visit(StateInfo {
            block: Self::NAME,
            component: "x",
            unit: "rad/s",
            prior_sigma: 1e-5,
            sheet_unit: "rad/s",
            sheet_scale: 1.0,
        });
    }
    fn input_jacobian<T: Real>(_: &sinscal::Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        put(sinscal::RATE, 0, T::one());
    }
}

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Wandering {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    wander: Wander,
}

/// Standard deviation and estimate of the wander after it has been seen for a while and then not at all for `blind` seconds.
fn after(setup: &Setup, blind: f64) -> (f64, f64) {
    let mut run = Calibration::<Wandering>::new(setup).expect("a sound setup");
    let dt = 1.0 / setup.rate;
    let seen = 60.0;
    let c = setup.initial.attitude;
    let earth = c.inverse() * sinscal::earth::rotation_n(setup.site.latitude);
    let gravity = sinscal::earth::gravity(setup.site.latitude, setup.site.height);
    let mut at_last_sight = None;
    for k in 0..((seen + blind) / dt) as usize {
        let t = (k + 1) as f64 * dt;
        let bias = Vector3::new(2e-5, 0.0, 0.0);
        let mut now = sample(t, (earth + bias) * dt, c.inverse() * Vector3::new(0.0, 0.0, gravity * dt));
        if t < seen {
            now.reference = Reference { velocity: Some(Vector3::zeros()), ..Reference::default() };
        }
        run.step(&now).expect("the run converges");
        if t < seen {
            run.parameters(&mut |p| at_last_sight = Some((p.sigma, p.value)));
        }
    }
    let mut end = (f64::NAN, f64::NAN);
    run.parameters(&mut |p| end = (p.sigma, p.value));
    let (sigma, value) = at_last_sight.expect("it was seen");
    // what a first-order Gauss-Markov process does: towards zero, and back to its prior
    let stated = setup.correlation_times.first().map_or(300.0, |(_, time)| *time);
    let prior = setup.prior("gyro-wander").unwrap_or(1e-5);
    let keep = (-blind / stated).exp();
    let expected = (prior * prior + (sigma * sigma - prior * prior) * keep * keep).sqrt();
    assert!((end.0 / expected - 1.0).abs() < 1e-3, "{} {expected}", end.0);
    assert!((end.1 / (value * keep) - 1.0).abs() < 1e-2, "{} {}", end.1, value * keep);
    end
}

#[test]
fn correlation_times_are_stated_at_run_time() {
    let base = Setup { outer_lever: Vector3::zeros(), ..setup() };
    let declared = after(&base, 100.0);
    let same = after(&Setup { correlation_times: &[("gyro-wander", 300.0)], ..base }, 100.0);
    assert!((declared.0 / same.0 - 1.0).abs() < 1e-9 && (declared.1 / same.1 - 1.0).abs() < 1e-9);
    let short = after(&Setup { correlation_times: &[("gyro-wander", 30.0)], ..base }, 100.0);
    assert!(short.0 > declared.0 && short.1 < declared.1);
    // stationary about another prior
    let priors = &[("gyro-wander", 3e-5)];
    after(&Setup { correlation_times: &[("gyro-wander", 50.0)], priors, ..base }, 100.0);
}

#[test]
fn a_wander_that_takes_no_part_adds_nothing() {
    let setup = setup();
    let run = |wander: bool| {
        let mut run = Calibration::<Wandering>::with_prior(&setup, |_, info, sigma| {
            if info.block == "gyro-wander" && !wander { 0.0 } else { sigma }
        });
        for k in 1..500 {
            run.step(&sample(f64::from(k) * 0.01, Vector3::zeros(), Vector3::new(0.0, 0.0, 0.098)))
                .expect("it does not diverge");
        }
        run.covariance()[9][9]
    };
    assert_eq!(run(false), 0.0);
    assert!(run(true) > 0.0);
}

/// The velocity at the end of a flight at constant velocity that only position shows, and its standard deviation.
fn flown(initial: InitialVelocity, first_reading: Option<f64>) -> (Vector3<f64>, f64) {
    #[derive(StateBlocks)]
    #[filter(measures(velocity, position))]
    struct Flight {
        attitude: Attitude,
        velocity: Velocity,
        position: Position,
    }
    let setup = Setup { velocity: initial, outer_lever: Vector3::zeros(), ..setup() };
    let mut run = Calibration::<Flight>::new(&setup).expect("a sound setup");
    let mut numbers = Numbers(3);
    let mut now = sample(0.01, numbers.vector(0.0), Vector3::zeros());
    now.reference.velocity = first_reading.map(|east| Vector3::new(east, 0.0, 0.0));
    run.step(&now).expect("the run converges");
    (run.navigation().velocity, run.covariance()[3][3].sqrt())
}

#[test]
fn the_velocity_at_the_beginning_is_stated() {
    let known = |sigma| InitialVelocity { velocity: Vector3::new(30.0, 0.0, 0.0), sigma };
    // stated, and nothing read
    let (velocity, sigma) = flown(known(0.1), None);
    assert_eq!((velocity.x, sigma), (30.0, 0.1));
    // a reading of 1 mm/s is better than 0.1 m/s...
    let (velocity, sigma) = flown(known(0.1), Some(30.05));
    assert!((velocity.x - 30.05).abs() < 1e-5 && sigma < 1.1e-3, "{velocity} {sigma}");
    // ...and worse than what is known to 1 um/s
    let (velocity, sigma) = flown(known(1e-6), Some(30.0005));
    assert!((velocity.x - 30.0).abs() < 1e-8 && sigma < 1.1e-6, "{velocity} {sigma}");
    // by default at rest, until something is read
    assert_eq!(flown(InitialVelocity::default(), None).0, Vector3::zeros());
}

#[test]
fn one_setup_serves_several_filters() {
    let setup = Setup { sigmas: &[("attitude", 1e-3)], priors: &[("accel-delay", 1e-3)], ..setup() };
    assert!(setup.check::<Sins36P>().is_ok() && setup.check::<Tracked35>().is_ok());
    assert_eq!(setup.sigma(&sinscal::measurements::OURS[2]), 1e-3);
}
