//! Assembly, accumulation and gating of declared filters against dense matrices built the slow way.

mod common;

use calib_core::{
    Block, Dynamics, Filter, Kalman, Residuals, Shape, Transition, measurement_rows, system_rows,
};
use common::{Numbers, point, signals};
use nalgebra::{DMatrix, DVector, Vector3};
use sinscal::{
    FilterVisitor, Point, Signals, Sins36P, Sins39P, Sins40P, Sins43B, Sins43P, Strapdown, Tracked35,
    visit_filter,
};

/// A matrix filled by whoever calls `put`.
fn filled(rows: usize, columns: usize, fill: impl FnOnce(&mut dyn FnMut(usize, usize, f64))) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(rows, columns);
    fill(&mut |i, j, v| m[(i, j)] += v);
    m
}

/// A, B, H, L of the dynamics, and the Jacobians of inputs and channels by the filter's states.
struct Dense {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    h: DMatrix<f64>,
    l: DMatrix<f64>,
    inputs: DMatrix<f64>,
    channels: DMatrix<f64>,
}

impl Dense {
    fn new<F: Filter<Dynamics = Strapdown>>(at: &Point<f64>, signals: &Signals<f64>) -> Self {
        let n = F::DIM;
        Self {
            a: filled(9, 9, |put| Strapdown::core_jacobian(at, &mut |i, j, v| put(i, j, v))),
            b: filled(9, 6, |put| {
                for input in 0..6 {
                    Strapdown::inject(at, input, 1.0, &mut |i, v| put(i, input, v));
                }
            }),
            h: filled(12, 9, |put| Strapdown::measurement_jacobian(at, &mut |i, j, v| put(i, j, v))),
            l: filled(12, 6, |put| {
                for input in 0..6 {
                    Strapdown::measure_input(at, input, 1.0, &mut |i, v| put(i, input, v));
                }
            }),
            inputs: filled(6, n, |put| F::input_jacobian(signals, &mut |i, j, v| put(i, j, v))),
            channels: filled(12, n, |put| F::measurement_jacobian(at, &mut |i, j, v| put(i, j, v))),
        }
    }

    /// `[A B J]`.
    fn system(&self) -> DMatrix<f64> {
        let mut f = &self.b * &self.inputs;
        let mut core = f.columns_mut(0, 9);
        core += &self.a;
        f
    }

    /// What `F` measures of the channels, `[H 0] + L J + direct`.
    fn measurement<F: Filter<Dynamics = Strapdown>>(&self, at: &Point<f64>) -> DMatrix<f64> {
        let mut all = &self.l * &self.inputs + &self.channels;
        let mut core = all.columns_mut(0, 9);
        core += &self.h;
        let mut slopes = DMatrix::<f64>::zeros(<F::Shape as Shape>::ROWS, Strapdown::CHANNELS);
        F::residual_jacobian(at, &mut |row, channel, value| slopes[(row, channel)] += value);
        slopes * all
    }
}

fn assert_rows<'a>(what: &str, got: impl Fn(usize, usize) -> f64 + 'a, want: &DMatrix<f64>) {
    for i in 0..want.nrows() {
        let scale = want.row(i).amax();
        for j in 0..want.ncols() {
            let error = (got(i, j) - want[(i, j)]).abs();
            assert!(error <= 1e-12 * scale, "{what} ({i}, {j}): {} for {}", got(i, j), want[(i, j)]);
        }
    }
}

struct Check;

impl FilterVisitor for Check {
    type Output = ();

    fn visit<F: Filter<Dynamics = Strapdown>>(self) {
        let mut numbers = Numbers(F::DIM as u64);
        for round in 0..100 {
            let at = point(&mut numbers);
            let mut s = signals(f64::from(round));
            Strapdown::restrict::<F, f64>(&mut s);
            let dense = Dense::new::<F>(&at, &s);
            let f = dense.system();
            assert_rows("system rows", |i, j| system_rows::<F, f64>(&at, &s)[i][j], &f);
            let rows = measurement_rows::<F, f64>(&at, &s);
            assert_rows("measurement rows", |i, j| rows[i][j], &dense.measurement::<F>(&at));

            // one step from the identity, a second from there: rows + h A (rows + (h A rows + d) / 2) + d
            let mut transition = Transition::<F, f64>::new();
            let mut expected = DMatrix::identity(9, F::DIM);
            for step in [0.02, 0.05] {
                transition.absorb(&at, &s, 0.25 * step);
                transition.absorb(&at, &s, 0.75 * step);
                transition.advance(&at, step);
                let drive = &dense.b * &dense.inputs * step;
                let slope = &dense.a * step;
                expected = &expected + &slope * (&expected + (&slope * &expected + &drive) * 0.5) + drive;
            }
            assert_rows("transition", |i, j| transition.rows()[i][j], &expected);
            assert!((transition.elapsed() - 0.07).abs() < 1e-15);
        }
    }
}

#[test]
fn declared_filters_are_assembled_as_dense_matrices_are() {
    for filter in sinscal::FILTERS {
        visit_filter(filter.name, Check).expect("a declared filter");
    }
}

#[test]
fn the_paper_s_dimensions_and_orders() {
    assert_eq!([Sins36P::DIM, Sins39P::DIM, Sins40P::DIM, Sins43P::DIM, Sins43B::DIM], [36, 39, 40, 43, 43]);
    let mut names = Vec::new();
    Sins43B::states(&mut |s| names.push(s.block));
    names.dedup();
    assert_eq!(
        names,
        [
            "attitude",
            "velocity",
            "position",
            "gyro-scale",
            "gyro-misalignment",
            "gyro-bias",
            "accel-scale",
            "accel-misalignment",
            "accel-bias",
            "accel-quadratic",
            "outer-lever-arm",
            "inner-lever-arm",
            "accel-delay",
            "accel-temperature-scale",
        ]
    );
    assert_eq!(Sins43B::OFFSETS.inner_lever, 36);
    assert_eq!(Sins43B::OFFSETS.dither, 43);
}

#[test]
fn p_filters_never_look_at_the_dither() {
    let mut s = signals(1.0);
    s.dither = Vector3::repeat(f64::NAN);
    s.coupled_dither = Vector3::repeat(f64::NAN);
    let spoilt = |restrict: fn(&mut Signals<f64>)| {
        let mut s = s;
        restrict(&mut s);
        let mut sum = 0.0;
        Sins43P::input_jacobian(&s, &mut |_, _, value| sum += value);
        sum.is_nan()
    };
    assert!(!spoilt(Strapdown::restrict::<Sins43P, f64>));
    assert!(spoilt(Strapdown::restrict::<Sins43B, f64>));
}

#[test]
fn a_reading_gone_wrong_is_left_out_alone() {
    type F = Sins36P;
    let mut numbers = Numbers(4);
    let at = point(&mut numbers);
    let s = signals(0.0);
    let mut sigmas = Kalman::<F>::prior();
    sigmas[..9].copy_from_slice(&[1e-4, 1e-4, 1e-3, 0.01, 0.01, 0.01, 0.05, 0.05, 0.05]);
    let run = |position_error: f64, gate: Option<f64>| {
        let mut kalman = Kalman::<F>::new(&sigmas);
        let mut residuals = Residuals::<F, f64>::default();
        for i in 0..3 {
            residuals.set(i, 1e-3, 1e-3);
            residuals.set(3 + i, 2e-3 + position_error, 2e-3);
        }
        let found = kalman.update(&at, &s, residuals, gate).expect("definite");
        (found, *kalman.x())
    };
    let (clean, ungated) = run(0.0, None);
    assert_eq!((clean.rejected, clean.degrees_of_freedom), (0, 6));
    // a gate that refuses nothing changes nothing
    assert_eq!(run(0.0, Some(25.0)), (clean, ungated));
    // a jump of 30 m in position: velocity is still used
    let (gated, x) = run(30.0, Some(25.0));
    assert_eq!((gated.rejected, gated.degrees_of_freedom), (0b10, 3));
    assert!(DVector::from_row_slice(&x).amax() < 0.01);
    let (spoilt, x) = run(30.0, None);
    assert!(spoilt.nis > 1e3 && DVector::from_row_slice(&x).amax() > 0.1);
    // the group's own NIS is judged, not the sum
    let alone = {
        let mut kalman = Kalman::<F>::new(&sigmas);
        let mut residuals = Residuals::<F, f64>::default();
        for i in 0..3 {
            residuals.set(i, 1e-3, 1e-3);
        }
        kalman.update(&at, &s, residuals, None).expect("definite").nis
    };
    assert!((gated.nis - alone).abs() < 1e-12);
}

#[test]
fn rows_are_those_of_the_measurements_in_order() {
    assert_eq!((Tracked35::rows(0), Tracked35::rows(1)), (0..3, 3..6));
    assert_eq!(<<Tracked35 as Filter>::Shape as Shape>::ROWS, 6);
    let mut residuals = Residuals::<Tracked35, f64>::default();
    assert!(residuals.is_empty());
    residuals.set(3, 1.0, 2.0);
    assert!(!residuals.is_empty());
    assert_eq!(residuals.values()[3], 1.0);
    assert_eq!(residuals.variances()[3], 4.0);
    assert!(residuals.is_present(3) && !residuals.is_present(0));
    residuals.leave_out(1);
    assert!(residuals.is_empty());
}
