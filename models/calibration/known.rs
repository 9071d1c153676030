//! A covariance for passes in which the parameters are known.

use calib_core::{Array, Fade, Form, Real, Shape, Whitened};

/// The covariance of the leading states alone: the parameters are exactly what they are said to be, and their states zero.
///
/// With priors of zero for the parameters every other form says the same, and takes the time of all states for it.
#[derive(Clone, Copy, Debug)]
pub struct Known;

/// Leading state by leading state: the part of a covariance that is not zero.
fn leading<S: Shape, T: Real>(cov: &S::Matrix<T>) -> S::CoreMatrix<T> {
    let mut p = S::core_matrix(T::zero());
    for i in 0..S::CORE {
        p[i].as_mut_slice().copy_from_slice(&cov[i].as_slice()[..S::CORE]);
    }
    p
}

fn dot<T: Real>(left: &[T], right: &[T]) -> T {
    left.iter().zip(right).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

impl Form for Known {
    fn set_diagonal<S: Shape, T: Real>(cov: &mut S::Matrix<T>, variances: &S::Vector<T>) {
        *cov = S::matrix(T::zero());
        for i in 0..S::CORE {
            cov[i][i] = variances[i];
        }
    }

    fn propagate<S: Shape, T: Real>(cov: &mut S::Matrix<T>, rows: &S::CoreRows<T>, noise: &S::CoreMatrix<T>) {
        let p = leading::<S, T>(cov);
        for i in 0..S::CORE {
            let mut moved = S::core_vector(T::zero());
            for j in 0..S::CORE {
                moved[j] = dot(rows[i].as_slice(), p[j].as_slice());
            }
            for l in 0..=i {
                cov[i][l] = noise[i][l] + dot(rows[l].as_slice(), moved.as_slice());
                cov[l][i] = cov[i][l];
            }
        }
    }

    fn fade<S: Shape, T: Real>(_: &mut S::Matrix<T>, _: &Fade<T>) {}

    /// One measurement after the other, as their noise is independent.
    fn update<S: Shape, T: Real>(
        cov: &mut S::Matrix<T>,
        x: &mut S::Vector<T>,
        h: &S::MeasurementRows<T>,
        r: &S::Measurement<T>,
        z: &S::Measurement<T>,
    ) -> Option<Whitened<T>> {
        let mut p = leading::<S, T>(cov);
        let mut state = S::core_vector(T::zero());
        state.as_mut_slice().copy_from_slice(&x.as_slice()[..S::CORE]);
        let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
        for m in 0..S::ROWS {
            let h = &h[m].as_slice()[..S::CORE];
            if h.iter().all(|h| *h == T::zero()) {
                continue;
            }
            let mut ph = S::core_vector(T::zero());
            for i in 0..S::CORE {
                ph[i] = dot(h, p[i].as_slice());
            }
            let variance = dot(h, ph.as_slice()) + r[m];
            if !(variance > T::zero()) {
                return None;
            }
            let innovation = z[m] - dot(h, state.as_slice());
            whitened.nis += innovation * innovation / variance;
            whitened.log_det += variance.ln();
            for i in 0..S::CORE {
                let gain = ph[i] / variance;
                state[i] += gain * innovation;
                for j in 0..=i {
                    let removed = gain * ph[j];
                    p[i][j] -= removed;
                    p[j][i] = p[i][j];
                }
            }
        }
        x.as_mut_slice()[..S::CORE].copy_from_slice(state.as_slice());
        for i in 0..S::CORE {
            cov[i].as_mut_slice()[..S::CORE].copy_from_slice(p[i].as_slice());
        }
        Some(whitened)
    }

    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T> {
        let mut s = S::measurement_matrix(T::zero());
        for i in 0..S::ROWS {
            let mut ph = S::core_vector(T::zero());
            for k in 0..S::CORE {
                ph[k] = dot(&h[i].as_slice()[..S::CORE], cov[k].as_slice());
            }
            for j in 0..=i {
                s[i][j] = dot(h[j].as_slice(), ph.as_slice());
                s[j][i] = s[i][j];
            }
        }
        s
    }

    fn variance<S: Shape, T: Real>(cov: &S::Matrix<T>, i: usize) -> T {
        cov[i][i]
    }

    fn dense<S: Shape, T: Real>(cov: &S::Matrix<T>, p: &mut S::Matrix<T>) {
        p.clone_from(cov);
    }
}
