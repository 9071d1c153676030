//! A cycle of any shape: nothing of it is zero but two thirds of the measurement matrix.

use calib_core::{Form, Shape};

/// What is done with one number of states after another, 9 of them leading, and of measurements.
pub(crate) trait Size {
    fn of<const N: usize, const M: usize>(&mut self);
}

/// Growing states with six measurements, then growing measurements with 43 states.
pub(crate) fn sizes(size: &mut impl Size) {
    size.of::<15, 6>();
    size.of::<21, 6>();
    size.of::<30, 6>();
    size.of::<36, 6>();
    size.of::<43, 6>();
    size.of::<60, 6>();
    size.of::<90, 6>();
    size.of::<43, 1>();
    size.of::<43, 3>();
    size.of::<43, 9>();
}

/// One interval and its measurement.
pub(crate) struct Wave<S: Shape> {
    pub(crate) rows: S::CoreRows<f64>,
    pub(crate) noise: S::CoreMatrix<f64>,
    pub(crate) h: S::MeasurementRows<f64>,
    pub(crate) r: S::Measurement<f64>,
}

impl<S: Shape> Wave<S> {
    pub(crate) fn new() -> Self {
        let wave = |i: usize, j: usize| ((i * 31 + j * 17) as f64).sin();
        let (mut rows, mut noise) = (S::core_rows(0.0), S::core_matrix(0.0));
        let mut h = S::measurement_rows(0.0);
        for i in 0..S::CORE {
            for j in 0..S::STATES {
                rows[i][j] = 0.1 * wave(i, j) + f64::from(u8::from(i == j));
            }
            noise[i][i] = 0.1;
        }
        for m in 0..S::ROWS {
            for j in (0..S::STATES).step_by(3) {
                h[m][j] = wave(m, j);
            }
        }
        Self { rows, noise, h, r: S::measurement(0.5) }
    }

    /// A covariance in which the leading states are correlated.
    pub(crate) fn start<C: Form>(&self) -> S::Matrix<f64> {
        let mut cov = S::matrix(0.0);
        C::set_diagonal::<S, f64>(&mut cov, &S::vector(1.0));
        C::propagate::<S, f64>(&mut cov, &self.rows, &self.noise);
        cov
    }

    pub(crate) fn cycle<C: Form>(&self, cov: &mut S::Matrix<f64>, x: &mut S::Vector<f64>) -> f64 {
        C::propagate::<S, f64>(cov, &self.rows, &self.noise);
        C::update::<S, f64>(cov, x, &self.h, &self.r, &S::measurement(0.1))
            .map_or(f64::NAN, |whitened| whitened.nis)
    }
}
