//! What paths can tell the filters: the 18 rotations, rotations about the vertical only, dither of constant amplitude.

mod common;

use calib_core::Extended;
use common::{sample, setup};
use nalgebra::{DMatrix, UnitQuaternion, Vector3};
use sinscal::observability::{
    EXCITED, Information, Observability, Segment, Segmenter, TOLERANCE, basis, prior,
};
use sinscal::path::{EIGHTEEN_ROTATIONS, Turn, attitude};
use sinscal::{
    Calibration, Conventional, DitherSizeEffect, Filter, Sample, Setup, Shape, Sins43B, Sins43P, StateInfo,
    Strapdown, earth,
};

const DT: f64 = 0.1;
const SPANS: usize = 5;

/// What an ideal unit at a fixed point feels on a path: 10 deg/s, `dwell` seconds of rest before and after each turn.
struct Path {
    attitude: UnitQuaternion<f64>,
    time: f64,
    samples: Vec<Sample>,
    dither: fn(f64) -> Vector3<f64>,
}

impl Path {
    fn new(setup: &Setup, dither: fn(f64) -> Vector3<f64>) -> Self {
        Self { attitude: setup.initial.attitude, time: 0.0, samples: Vec::new(), dither }
    }

    fn step(&mut self, site_latitude: f64, rate_eb: Vector3<f64>) {
        let earth_n = earth::rotation_n(site_latitude);
        let middle = self.attitude * UnitQuaternion::from_scaled_axis(rate_eb * (0.5 * DT));
        let gravity = Vector3::new(0.0, 0.0, earth::gravity(site_latitude, 20.0));
        self.time += DT;
        let mut now =
            sample(self.time, (rate_eb + middle.inverse() * earth_n) * DT, (middle.inverse() * gravity) * DT);
        let warm = 15.0 * (1.0 - (-self.time / 1500.0).exp());
        now.temperature = Vector3::new(20.0 + warm, 20.6 + warm, 19.6 + warm);
        now.dither = (self.dither)(self.time);
        now.reference.velocity = Some(Vector3::zeros());
        now.reference.position = Some(Vector3::zeros());
        self.attitude *= UnitQuaternion::from_scaled_axis(rate_eb * DT);
        self.samples.push(now);
    }

    fn rest(&mut self, latitude: f64, seconds: f64) {
        (0..(seconds / DT) as usize).for_each(|_| self.step(latitude, Vector3::zeros()));
    }

    fn turn(&mut self, latitude: f64, turn: &Turn) {
        let mut rate = Vector3::zeros();
        rate[turn.axis] = 10f64.to_radians() * turn.angle.signum();
        let steps = (turn.angle.abs() / 10f64.to_radians() / DT).round() as usize;
        (0..steps).for_each(|_| self.step(latitude, rate));
    }
}

fn varying(t: f64) -> Vector3<f64> {
    Vector3::new(0.08, 0.09, 0.07) * (1.0 + 0.2 * (t / 800.0).sin())
}

fn constant(_: f64) -> Vector3<f64> {
    Vector3::new(0.08, 0.09, 0.07)
}

fn start(letters: &[u8; 3]) -> Setup<'static> {
    let mut setup = Setup { rate: 1.0 / DT, outer_lever: Vector3::zeros(), ..setup() };
    setup.initial.attitude = attitude(letters).expect("right-handed axes");
    setup
}

fn path(setup: &Setup, turns: &[Turn], dither: fn(f64) -> Vector3<f64>) -> Vec<Sample> {
    let latitude = setup.site.latitude;
    let mut path = Path::new(setup, dither);
    path.rest(latitude, 300.0);
    for turn in turns {
        path.turn(latitude, turn);
        path.rest(latitude, 180.0);
    }
    path.samples
}

fn segments(setup: &Setup, samples: &[Sample]) -> Vec<Segment> {
    let mut segmenter = Segmenter::new(setup);
    let mut segments: Vec<Segment> = samples.iter().filter_map(|sample| segmenter.push(sample)).collect();
    segments.extend(segmenter.finish());
    segments
}

fn stacked<'a, F: Filter<Dynamics = Strapdown>>(
    setup: &Setup,
    segments: impl IntoIterator<Item = &'a Segment>,
) -> Box<Observability<F>> {
    let mut all = Box::new(Observability::<F>::new(setup));
    segments.into_iter().for_each(|segment| all.add(segment));
    all
}

fn infos<F: Filter>() -> Vec<StateInfo> {
    let mut infos = Vec::new();
    F::states(&mut |info| infos.push(info));
    infos
}

/// What cannot be found, in words.
fn lost<F: Filter<Dynamics = Strapdown>>(setup: &Setup, segments: &[Segment]) -> Vec<String> {
    let found = stacked::<F>(setup, segments).decompose();
    let rank = found.rank(TOLERANCE);
    basis::<F>(&found, rank..F::Shape::STATES).iter().map(ToString::to_string).collect()
}

#[test]
fn the_eighteen_rotations_show_everything() {
    let setup = start(b"NED");
    let samples = path(&setup, &EIGHTEEN_ROTATIONS, varying);
    let segments = segments(&setup, &samples);
    // six half turns are cut in two
    assert_eq!(segments.iter().filter(|segment| segment.turning).count(), 24);
    assert_eq!(segments.iter().filter(|segment| !segment.turning).count(), 19);
    let total: f64 = segments.iter().map(|segment| segment.duration).sum();
    assert!((total - samples.len() as f64 * DT).abs() < 1e-6);

    let found = stacked::<Sins43B>(&setup, &segments).decompose();
    assert_eq!(found.rank(TOLERANCE), 43);
    // far from the tolerance, and that far from rounding
    assert!(found.values()[42] > 100.0 * TOLERANCE, "{}", found.values()[42]);
    assert!(found.rounding() < 1e-6 * TOLERANCE);

    let end = samples.len() as f64 * DT;
    let spans: Vec<_> = (0..SPANS)
        .map(|span| {
            let inside = |segment: &&Segment| {
                ((segment.start + 0.5 * segment.duration) / end * SPANS as f64) as usize == span
            };
            stacked::<Sins43B>(&setup, segments.iter().filter(inside)).decompose()
        })
        .collect();
    for (i, info) in infos::<Sins43B>().iter().enumerate().skip(36) {
        let best = spans.iter().map(|span| span.degree(i)).fold(0.0, f64::max);
        assert!(best > EXCITED, "{} {}: {best}", info.block, info.component);
    }
}

#[test]
fn rotations_about_the_vertical_leave_the_rest_unknown() {
    let setup = start(b"ENU");
    let quarter = Turn { axis: 2, angle: std::f64::consts::FRAC_PI_2 };
    let samples = path(&setup, &[quarter; 18], varying);
    let segments = segments(&setup, &samples);
    let found = stacked::<Sins43B>(&setup, &segments).decompose();
    let rank = found.rank(TOLERANCE);
    assert!(rank < 43);
    let lost = lost::<Sins43B>(&setup, &segments);
    assert_eq!(lost.len(), 43 - rank);
    // gravity lies along z all the time: what acts through the other two components does not act at all
    for name in [
        "accel-scale x",
        "accel-scale y",
        "accel-quadratic x",
        "accel-misalignment xy",
        "accel-temperature-scale x",
    ] {
        assert!(lost.iter().any(|line| line == name), "{name} is not among {lost:#?}");
    }
    // nobody sees the height of the unit over the centre of rotation, and scale, bias and square of z are one number
    let pairs = [["accel-quadratic z", "accel-"], ["outer-lever-arm z", "position u"]];
    for [one, other] in pairs {
        let (block, component) = one.split_once(' ').expect("two words");
        let together =
            |line: &&String| line.contains(block) && line.contains(component) && line.contains(other);
        assert!(lost.iter().find(together).is_some(), "{one} and {other} are not in {lost:#?}");
    }
    // what turning about the vertical does show
    for name in ["gyro-bias x", "accel-bias x", "outer-lever-arm x", "inner-lever-arm x"] {
        assert!(!lost.iter().any(|line| line == name), "{name} is among {lost:#?}");
    }
}

#[test]
fn dither_of_constant_amplitude_is_a_bias() {
    type Asked = Extended<Sins43P, DitherSizeEffect>;
    let setup = start(b"NED");
    let still = segments(&setup, &path(&setup, &EIGHTEEN_ROTATIONS, constant));
    let lost_names = lost::<Asked>(&setup, &still);
    assert_eq!(lost_names.len(), 3, "{lost_names:#?}");
    for axis in ["x", "y", "z"] {
        let pair = |line: &String| {
            line.contains("accel-bias") && line.contains("dither-size-effect") && line.contains(axis)
        };
        assert!(lost_names.iter().any(pair), "{axis}: {lost_names:#?}");
    }
    // an amplitude that changes tells them apart
    let changing = segments(&setup, &path(&setup, &EIGHTEEN_ROTATIONS, varying));
    assert_eq!(lost::<Asked>(&setup, &changing), Vec::<String>::new());
}

#[test]
fn the_triangle_has_the_rank_of_the_dense_matrix() {
    // the rows of every segment, stacked and decomposed by other means
    let setup = start(b"ENU");
    let quarter = Turn { axis: 2, angle: std::f64::consts::FRAC_PI_2 };
    let segments = segments(&setup, &path(&setup, &[quarter; 5], varying));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let prior = prior(&Calibration::<Sins43B, Conventional>::new(&setup).expect("a sound setup"));
    for segment in &segments {
        let mut powers = calib_core::ObservabilityRows::<Sins43B, f64>::new(
            &segment.point,
            &segment.signals,
            segment.duration,
        );
        let mut factorial = 1.0;
        for k in 0..=9 {
            if k > 0 {
                powers.advance();
                factorial *= f64::from(k);
            }
            for (m, row) in powers.rows().iter().enumerate() {
                let sigma = if m < 3 { setup.reference.velocity } else { setup.reference.position };
                rows.push(row.iter().zip(&prior).map(|(h, p)| h * p / (sigma * factorial)).collect());
            }
        }
    }
    let dense = DMatrix::from_fn(rows.len(), 43, |i, j| rows[i][j]);
    let mut expected: Vec<f64> = dense.svd(false, false).singular_values.iter().copied().collect();
    expected.sort_by(|a, b| b.total_cmp(a));
    let largest = expected[0];
    let found = stacked::<Sins43B>(&setup, &segments).decompose();
    for (found, expected) in found.values().iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-12 * largest, "{found} {expected}");
    }
    let dense_rank = expected.iter().filter(|value| **value > TOLERANCE).count();
    assert_eq!(found.rank(TOLERANCE), dense_rank);
}

#[test]
fn information_bounds_what_the_filter_reaches() {
    let setup = start(b"NED");
    let samples = path(&setup, &EIGHTEEN_ROTATIONS[..6], varying);
    let mut run = Box::new(Calibration::<Sins43B, Conventional>::new(&setup).expect("a sound setup"));
    let before = prior(&run);
    let mut information = Box::new(Information::new(&run));
    for sample in &samples {
        run.step_observed(sample, information.as_mut()).expect("the run converges");
    }
    let (bound, after) = (information.sigmas(), prior(&run));
    for (i, info) in infos::<Sins43B>().iter().enumerate().skip(9) {
        // random walks only take information away
        assert!(bound[i] <= after[i] * 1.001, "{} {}: {} {}", info.block, info.component, bound[i], after[i]);
        assert!(after[i] <= before[i] * (1.0 + 1e-9));
    }
    let ignorance = information.ignorance(&run);
    assert!(ignorance.values()[0] < 1.0 + 1e-6);
}
