//! A cycle of any shape: nothing of it is zero but two thirds of the measurement matrix.

use calib_core::{Form, Shape};

/// One interval and its measurement.
pub(crate) struct Wave<S: Shape> {
    rows: S::CoreRows<f64>,
    noise: S::CoreMatrix<f64>,
    h: S::MeasurementRows<f64>,
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
        Self { rows, noise, h }
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
        let (r, z) = (S::measurement(0.5), S::measurement(0.1));
        C::update::<S, f64>(cov, x, &self.h, &r, &z).map_or(f64::NAN, |whitened| whitened.nis)
    }
}
