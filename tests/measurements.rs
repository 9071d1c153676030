//! Measurements: Jacobians by channels against finite differences, rows of whole filters against a nonlinear model, and one of
//! one's own through everything that a run has.

mod common;

use calib_core::check::{central_jacobian, compare};
use calib_core::{Block, Filter, Shape, measurement_rows};
use common::{Numbers, point, sample, setup, signals};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use sinscal::measurements::{self, channel};
use sinscal::observability::{Observability, Segmenter};
use sinscal::prelude::*;
use sinscal::{
    Event, Form, Innovations, Observer, Point, Reference, Refusal, Sample, Setup, earth, own_columns,
};

const BEACON: Vector3<f64> = Vector3::new(30.0, -40.0, 5.0);
const GRAVITY_STEPS: usize = 300;

/// Distance of the observed point to the beacon.
struct Range;

fn from_beacon<T: Real>(at: &Point<T>) -> Vector3<T> {
    at.point_position - BEACON.map(T::of)
}

impl Measurement for Range {
    type Dynamics = Strapdown;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "range",
        components: &["r"],
        unit: "m",
        columns: &["range_m"],
        sigma: 0.01,
        channels: None,
    };
    fn residual<T: Real>(at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        put(0, from_beacon(at).norm() - reading[0]);
    }
    fn jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        let way = from_beacon(at).normalize();
        for i in 0..3 {
            put(0, channel::POSITION + i, way[i]);
        }
    }
}

/// Range, height and heading, with blocks that act on what is seen.
#[derive(StateBlocks)]
#[filter(measures(velocity, Range, height, heading, rate))]
struct Seen {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
    outer_lever: OuterLeverArm,
    delay: ReferenceDelay,
    tilt: ReferenceTilt,
    mounting: ReferenceMisalignment,
}

/// What a reference sees where the channels are off by so much.
fn moved(at: &Point<f64>, by: &[f64; 12]) -> Point<f64> {
    let part = |first: usize| Vector3::new(by[first], by[first + 1], by[first + 2]);
    Point {
        point_velocity: at.point_velocity + part(channel::VELOCITY),
        point_position: at.point_position + part(channel::POSITION),
        c_bn: Rotation3::from_scaled_axis(-part(channel::ATTITUDE)).into_inner() * at.c_bn,
        rate_eb: at.rate_eb + part(channel::RATE),
        ..*at
    }
}

/// Compares the Jacobian of a measurement with differences of its residuals, at many points; `reading` is what it reads there.
fn check<M: Measurement<Dynamics = Strapdown>, const ROWS: usize>(reading: impl Fn(&Point<f64>) -> Vec<f64>) {
    assert_eq!(ROWS, M::INFO.components.len());
    let mut numbers = Numbers(ROWS as u64 + 17);
    let mut done = 0;
    while done < 200 {
        let at = point(&mut numbers);
        let forward = at.c_bn.column(1).into_owned();
        // near the vertical a heading is no smooth function
        if forward.xy().norm() < 0.2 {
            continue;
        }
        let mut found = [[0.0; 12]; ROWS];
        M::jacobian(&at, &mut |row, channel, value: f64| found[row][channel] += value);
        let read = reading(&at);
        let residuals = |by: &[f64; 12]| {
            let mut residuals = [f64::NAN; ROWS];
            M::residual(&moved(&at, by), &read, &mut |row, z| residuals[row] = z);
            residuals
        };
        let expected = central_jacobian(residuals, &[0.0; 12], &[2e-3; 12]);
        // what the channels do not act on shows the rounding of the differences
        let expected = expected.map(|row| row.map(|value| if value.abs() < 1e-9 { 0.0 } else { value }));
        compare(&found, &expected, 1e-7).unwrap_or_else(|wrong| panic!("{}: {wrong}", M::INFO.name));
        done += 1;
    }
}

#[test]
fn jacobians_are_the_derivatives_of_the_residuals() {
    let vector = |v: Vector3<f64>| v.as_slice().to_vec();
    check::<measurements::Velocity, 3>(|at| vector(at.point_velocity.add_scalar(0.1)));
    check::<measurements::Position, 3>(|at| vector(at.point_position.add_scalar(-0.2)));
    check::<measurements::Rate, 3>(|at| vector(at.rate_eb.add_scalar(0.01)));
    check::<measurements::Height, 1>(|at| vec![at.point_position.z + 0.3]);
    // a rotation vector is linear at zero only
    check::<measurements::Attitude, 3>(|at| {
        let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(at.c_bn));
        vec![q.w, q.i, q.j, q.k]
    });
    // also across the cut from +180 to -180 deg
    check::<measurements::Heading, 1>(|at| vec![at.c_bn.m12.atan2(at.c_bn.m22) + 0.4]);
    check::<measurements::Heading, 1>(|_| vec![3.1]);
    check::<Range, 1>(|at| vec![from_beacon(at).norm() - 0.7]);
}

#[test]
fn residuals_vanish_where_the_reading_is_what_is_seen() {
    let mut numbers = Numbers(5);
    for _ in 0..100 {
        let at = point(&mut numbers);
        let (east, north) = (at.c_bn.m12, at.c_bn.m22);
        let residual = |reading: f64| {
            let mut residual = f64::NAN;
            measurements::Heading::residual(&at, &[reading], &mut |_, z| residual = z);
            residual
        };
        let heading = east.atan2(north);
        assert!(residual(heading).abs() < 1e-12);
        assert!((residual(heading - 0.25) - 0.25).abs() < 1e-12);
        // whole turns do not matter
        assert!((residual(heading - 0.25 + 4.0 * std::f64::consts::PI) - 0.25).abs() < 1e-12);
    }
    // pointing up there is no heading
    let up = Point { c_bn: Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0), ..Point::default() };
    measurements::Heading::residual(&up, &[0.0], &mut |_, _| panic!("no heading"));
}

/// The residuals of [`Seen`] for wrong states: navigation, sensor parameters through `d_omega`, and the blocks of the reference.
fn nonlinear(at: &Point<f64>, s: &sinscal::Signals<f64>, x: &[f64; Seen::DIM]) -> [f64; 9] {
    let o = Seen::OFFSETS;
    let part = |first: usize| Vector3::new(x[first], x[first + 1], x[first + 2]);
    let (phi, dv, dp) = (part(0), part(3), part(6));
    // the true rate is what the gyros' compensation leaves: an error that is not removed is in the computed one
    let mut d_omega = Vector3::zeros();
    GyroErrors::input_jacobian(s, &mut |input, state, value: f64| {
        if input < 3 {
            d_omega[input] += value * x[o.gyro + state];
        }
    });
    let c_hat = Rotation3::from_scaled_axis(-phi).into_inner() * at.c_bn;
    let lever = at.lever - part(o.outer_lever);
    let rate = at.rate_eb + d_omega;
    let velocity = at.velocity + dv + c_hat * rate.cross(&lever);
    let position = at.position + dp + c_hat * lever;
    // late by what the delay still lacks, tilted and turned by what is not yet known
    let late = x[o.delay];
    let tilt = Rotation3::from_scaled_axis(Vector3::new(x[o.tilt], x[o.tilt + 1], 0.0)).into_inner();
    let seen_velocity = velocity + at.point_acceleration * late;
    let seen_position = position + at.point_velocity * late;
    let shifted = |v: Vector3<f64>, about: Vector3<f64>| v + (tilt * about - about);
    let seen = Point {
        point_velocity: shifted(seen_velocity, at.point_velocity),
        point_position: shifted(seen_position, at.point_position),
        c_bn: tilt * c_hat * Rotation3::from_scaled_axis(at.rate_eb * late - part(o.mounting)).into_inner(),
        ..*at
    };
    let meridian = 1.0 / (earth_radius(at.latitude) + at.height);
    let turned = |c: &Matrix3<f64>, latitude: f64| c.transpose() * earth::rotation_n(latitude);
    let z_r = d_omega - (turned(&c_hat, at.latitude + dp.y * meridian) - turned(&at.c_bn, at.latitude));
    let mut z = [0.0; 9];
    for i in 0..3 {
        z[i] = seen.point_velocity[i];
        z[6 + i] = z_r[i];
    }
    z[3] = from_beacon(&seen).norm();
    z[4] = seen.point_position.z;
    measurements::Heading::residual(&seen, &[at.c_bn.m12.atan2(at.c_bn.m22)], &mut |_, psi| z[5] = psi);
    z
}

fn earth_radius(latitude: f64) -> f64 {
    let e2 = 0.006_694_379_990_141_316_5;
    6_378_137.0 * (1.0 - e2) / (1.0 - e2 * latitude.sin().powi(2)).powf(1.5)
}

#[test]
fn rows_of_a_filter_are_the_derivatives_of_a_nonlinear_model() {
    let mut numbers = Numbers(23);
    let mut done = 0;
    while done < 100 {
        let base = point(&mut numbers);
        if base.c_bn.column(1).xy().norm() < 0.2 {
            continue;
        }
        // the point as a run makes it
        let at = Point {
            point_position: base.position + base.c_bn * base.lever,
            point_velocity: base.velocity + base.c_bn * base.rate_eb.cross(&base.lever),
            ..base
        };
        let s = signals(f64::from(done));
        let found = measurement_rows::<Seen, f64>(&at, &s);
        let mut steps = [1e-4; Seen::DIM];
        steps[6..9].fill(0.1);
        let expected = central_jacobian(|x| nonlinear(&at, &s, x), &[0.0; Seen::DIM], &steps);
        for row in 0..9 {
            for state in 0..Seen::DIM {
                let (a, b) = (found[row][state], expected[row][state]);
                // the Earth's part of the rate is small: judged by itself
                let floor = if row >= 6 && state < 9 { 1e-13 } else { 1e-7 };
                assert!((a - b).abs() <= 1e-5 * b.abs() + floor, "({row}, {state}): {a:e}, expected {b:e}");
            }
        }
        done += 1;
    }
}

/// A unit that is turned by hand on a table, 0.1 m from its observed point, with an accelerometer bias and gyro biases; the
/// observed point goes round a circle.
fn samples(setup: &Setup, bias: &Vector3<f64>, gyro_bias: &Vector3<f64>) -> Vec<Sample> {
    use sinscal::strapdown::NavigationState;
    let mut truth = NavigationState::<f64>::at_rest(&setup.site, setup.initial.attitude);
    let mut numbers = Numbers(31);
    let dt = 1.0 / setup.rate;
    (0..(GRAVITY_STEPS as f64 / dt) as usize)
        .map(|k| {
            let t = k as f64 * dt;
            let turning = (t / 20.0).floor() as usize % 2 == 1;
            let axis = (t / 40.0).floor() as usize % 3;
            let mut rate_eb = Vector3::zeros();
            if turning {
                rate_eb[axis] = 0.1;
            }
            let c = truth.attitude;
            let rate = rate_eb + c.inverse() * earth::rotation_n(truth.latitude);
            // the IMU stands still and turns: only gravity is felt
            let force = c.inverse() * Vector3::new(0.0, 0.0, earth::gravity(truth.latitude, truth.height));
            truth.attitude = UnitQuaternion::from_scaled_axis(-earth::rotation_n(truth.latitude) * dt)
                * c
                * UnitQuaternion::from_scaled_axis(rate * dt);
            let middle = c.inverse() * truth.attitude;
            let half = UnitQuaternion::identity().slerp(&middle, 0.5);
            let mut now = sample(t + dt, (rate + gyro_bias) * dt, (half.inverse() * force + bias) * dt);
            let point = truth.attitude * setup.outer_lever;
            let velocity = truth.attitude * rate_eb.cross(&setup.outer_lever);
            if (k + 1) % 50 == 0 {
                now.reference =
                    Reference { velocity: Some(velocity + numbers.vector(1e-3)), ..Reference::default() };
                now.reference.own[0] = (point - BEACON).norm() + 0.01 * numbers.next();
            }
            now
        })
        .collect()
}

/// Counts what the gate refused.
#[derive(Default)]
struct Refused(Vec<(&'static str, Refusal)>);

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for Refused {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        if let Event::Refused { group, why, .. } = event {
            self.0.push((group, why));
        }
    }
}

/// Velocity and range.
#[derive(StateBlocks)]
#[filter(measures(velocity, Range))]
struct Ranged {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroBias,
    accel: AccelBias,
}

/// Standard deviation of the position along the direction to the beacon; what is across is known to metres only.
fn sigma_along(run: &Calibration<Ranged>, setup: &Setup) -> f64 {
    let point = run.position() + run.attitude() * setup.outer_lever;
    let (p, way) = (run.covariance(), (point - BEACON).normalize());
    let variance: f64 = (0..9).map(|k| way[k / 3] * p[6 + k / 3][6 + k % 3] * way[k % 3]).sum();
    variance.sqrt()
}

#[test]
fn one_s_own_works_in_a_run_its_gate_and_its_innovations() {
    let setup = Setup { update_rate: 2.0, ..setup() };
    let (bias, gyro_bias) = (Vector3::new(2e-3, -1e-3, 3e-3), Vector3::new(2e-6, -1e-6, 3e-6));
    let mut log = samples(&setup, &bias, &gyro_bias);
    assert_eq!(own_columns::<Ranged>().collect::<Vec<_>>(), ["range_m"]);
    // once the range jumps by 50 m
    let spoilt = log.len() * 3 / 4 / 50 * 50 + 49;
    log[spoilt].reference.own[0] += 50.0;
    let mut run = Calibration::<Ranged>::new(&setup).expect("a sound setup");
    let mut innovations = Innovations::<Ranged>::default();
    let mut refused = Refused::default();
    let mut rejected = Vec::new();
    for sample in &log {
        let mut both = (std::mem::take(&mut innovations), std::mem::take(&mut refused));
        let update = run.step_observed(sample, &mut both).expect("the run converges");
        (innovations, refused) = both;
        rejected.extend(update.map(|update| update.rejected).filter(|bits| *bits != 0));
    }
    // by the filter's order: range is its second measurement
    assert_eq!((rejected, refused.0), (vec![0b10], vec![("range", Refusal::Outlier)]));
    let channels = innovations.finish();
    let names: Vec<_> = channels.iter().map(|c| (c.group, c.component, c.unit)).collect();
    assert_eq!(names[3], ("range", "r", "m"));
    // the noise is even over one sigma to both sides: its rms is 0.58
    assert!((0.4..0.8).contains(&channels[3].rms()), "{}", channels[3].rms());
    assert_eq!(channels[3].points.len() + 1, channels[0].points.len());
    let mut off = Vec::new();
    run.parameters(&mut |p| {
        let truth = if p.info.block == "gyro-bias" { gyro_bias } else { bias };
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == p.info.component).unwrap();
        assert!(p.estimated, "{} {}", p.info.block, p.info.component);
        off.push((p.value - truth[axis]) / p.sigma);
    });
    assert!(off.len() == 6 && off.iter().all(|off| off.abs() < 3.0), "{off:?}");
    // and it is the range that places the unit: along the beacon's direction far better than the 10 m it began with
    let along = sigma_along(&run, &setup);
    assert!(along < 0.01, "{along}");
}

#[test]
fn a_reading_may_state_its_sigma() {
    let setup = Setup { update_rate: 2.0, ..setup() };
    let log = samples(&setup, &Vector3::zeros(), &Vector3::zeros());
    let sigma_of = |stated: f64| {
        let mut run = Calibration::<Ranged>::new(&setup).expect("a sound setup");
        // the first one
        for sample in log.iter().take(50) {
            let mut sample = *sample;
            sample.reference.sigma.own[0] = stated;
            run.step(&sample).expect("the run converges");
        }
        sigma_along(&run, &setup)
    };
    // before it the position is known to 10 m
    for (stated, expected) in [(f64::NAN, Range::INFO.sigma), (0.005, 0.005), (0.1, 0.1)] {
        let found = sigma_of(stated);
        assert!((found / expected - 1.0).abs() < 0.02, "{stated}: {found}");
    }
}

#[test]
fn one_s_own_counts_in_observability() {
    /// The same filter without the range.
    #[derive(StateBlocks)]
    #[filter(measures(velocity))]
    struct Blind {
        attitude: Attitude,
        velocity: Velocity,
        position: Position,
        gyro: GyroBias,
        accel: AccelBias,
    }
    let setup = setup();
    let log = samples(&setup, &Vector3::zeros(), &Vector3::zeros());
    fn rank<F: Filter<Dynamics = Strapdown>>(setup: &Setup, log: &[Sample]) -> usize {
        let mut segmenter = Segmenter::new(setup);
        let mut observability = Observability::<F>::new(setup);
        for sample in log {
            if let Some(segment) = segmenter.push(sample) {
                observability.add(&segment);
            }
        }
        observability.decompose().rank(sinscal::observability::TOLERANCE)
    }
    // the direction to the beacon, with the position that velocity alone never tells
    assert_eq!(rank::<Ranged>(&setup, &log), rank::<Blind>(&setup, &log) + 1);
}

/// A unit at rest whose rate is known.
#[derive(StateBlocks)]
#[filter(measures(velocity, rate))]
struct AtRest {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroBias,
}

/// Mean square of error over sigma of the gyro biases of a MEMS unit at rest, 30 s with readings of the rate that err by `sigma`
/// from one second to the next, and their standard deviations by what the data can tell at best.
fn at_rest(sigma: f64) -> (f64, [f64; 3]) {
    let noise = 1e-4_f64; // rad/sqrt(s)
    let sigmas = [("rate", sigma)];
    let mut setup = Setup { outer_lever: Vector3::zeros(), sigmas: &sigmas, ..setup() };
    setup.update_rate = 1.0;
    setup.noise.angle_random_walk = noise;
    let bias = Vector3::new(1e-3, -2e-3, 3e-3);
    let c = setup.initial.attitude;
    let rate = c.inverse() * earth::rotation_n(setup.site.latitude);
    let force = c.inverse() * Vector3::new(0.0, 0.0, earth::gravity(setup.site.latitude, setup.site.height));
    let (dt, seconds, runs) = (1.0 / setup.rate, 30.0_f64, 40);
    let best = ((noise * noise + sigma * sigma) / seconds).sqrt();
    let (mut nees, mut sigmas) = (0.0, [0.0; 3]);
    for seed in 0..runs {
        let mut numbers = Numbers(seed);
        // even numbers of unit variance
        let mut noisy = |size: f64| numbers.vector(size * 3.0_f64.sqrt());
        let mut run =
            Calibration::<AtRest>::with_prior(
                &setup,
                |_, info, sigma| {
                    if info.block == "gyro-bias" { 3e-3 } else { sigma }
                },
            );
        let mut reading = Vector3::zeros();
        for k in 0..(seconds / dt) as usize {
            if k % 100 == 0 {
                reading = noisy(sigma);
            }
            let walk = noisy(noise / dt.sqrt());
            let mut now = sample((k + 1) as f64 * dt, (rate + bias + walk) * dt, force * dt);
            now.reference.velocity = Some(Vector3::zeros());
            now.reference.rate = Some(reading);
            run.step(&now).expect("the run converges");
        }
        run.parameters(&mut |p| {
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == p.info.component).unwrap();
            sigmas[axis] = p.sigma / best;
            nees += ((p.value - bias[axis]) / p.sigma).powi(2) / (3 * runs) as f64;
        });
    }
    (nees, sigmas)
}

#[test]
fn a_known_rate_shows_the_gyro_biases_at_once() {
    // 60 deg/h: the wander of such a unit
    let (nees, sigmas) = at_rest(3e-4);
    assert!((0.7..1.3).contains(&nees), "{nees}");
    // level shows the two horizontal ones as well, through the velocity
    assert!(sigmas.iter().all(|sigma| (0.2..1.1).contains(sigma)), "{sigmas:?}");
    // a rate that is known better than the gyros read it: their random walk is in the rate and in the attitude, and counts
    // twice where both show a bias
    let (nees, sigmas) = at_rest(1e-7);
    assert!((0.8..2.2).contains(&nees), "{nees}");
    assert!(sigmas.iter().all(|sigma| (0.65..1.1).contains(sigma)), "{sigmas:?}");
}

#[test]
fn columns_without_a_field_are_its_own() {
    // what the log is asked for is what the readings are taken from
    let names: Vec<&str> = <Seen as Filter>::MEASURES.iter().flat_map(|info| info.columns).copied().collect();
    assert_eq!(names[3..6], ["range_m", "ref_height", "ref_heading"]);
    assert_eq!(own_columns::<Seen>().collect::<Vec<_>>(), ["range_m"]);
    assert_eq!(<<Seen as Filter>::Shape as Shape>::ROWS, 9);
}
