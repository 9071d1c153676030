//! A covariance for passes in which the parameters are known.

use calib_core::{Array, Fade, Form, Real, Shape, Whitened};

/// The covariance of the leading states alone: the parameters are exactly what they are said to be, and their states zero.
///
/// With priors of zero for the parameters every other form says the same, and takes the time of all states for it; but for
/// parameters that relax, to which those add noise: here they stay what they are said to be.
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

    fn times<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::Vector<T>) -> S::Vector<T> {
        let mut ph = S::vector(T::zero());
        for i in 0..S::CORE {
            ph[i] = dot(&h.as_slice()[..S::CORE], &cov[i].as_slice()[..S::CORE]);
        }
        ph
    }

    fn add_square<S: Shape, T: Real>(cov: &mut S::Matrix<T>, v: &S::Vector<T>) {
        for i in 0..S::CORE {
            for j in 0..S::CORE {
                cov[i][j] += v[i] * v[j];
            }
        }
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

#[cfg(test)]
mod tests {
    use calib_core::{Conventional, Dim};

    use super::*;

    type S = Dim<14, 9, 3>;

    #[test]
    fn says_what_the_usual_form_says_of_parameters_without_doubt() {
        let wave = |i: usize, j: usize| ((i * 31 + j * 17) as f64).sin();
        let mut rows = S::core_rows(0.0);
        let mut noise = S::core_matrix(0.0);
        let mut h = S::measurement_rows(0.0);
        let mut variances = S::vector(0.0);
        for i in 0..S::CORE {
            (variances[i], noise[i][i]) = (2.0, 0.1);
            for j in 0..S::STATES {
                rows[i][j] = 0.1 * wave(i, j) + f64::from(u8::from(i == j));
            }
        }
        for j in 0..S::STATES {
            // the second one is no measurement
            (h[0][j], h[2][j]) = (wave(0, j), wave(2, j));
        }
        let (mut known, mut usual) = (S::matrix(1.0), S::matrix(1.0));
        Known::set_diagonal::<S, f64>(&mut known, &variances);
        Conventional::set_diagonal::<S, f64>(&mut usual, &variances);
        let (mut x, mut y) = (S::vector(0.0), S::vector(0.0));
        for step in 0..10 {
            Known::propagate::<S, f64>(&mut known, &rows, &noise);
            Conventional::propagate::<S, f64>(&mut usual, &rows, &noise);
            let (s, t) = (Known::project::<S, f64>(&known, &h), Conventional::project::<S, f64>(&usual, &h));
            let (r, z) = ([0.5, 1.0, 2.0], [wave(step, 0), 0.0, wave(step, 1)]);
            let a = Known::update::<S, f64>(&mut known, &mut x, &h, &r, &z).unwrap();
            let b = Conventional::update::<S, f64>(&mut usual, &mut y, &h, &r, &z).unwrap();
            assert!((a.nis - b.nis).abs() < 1e-12 && (a.log_det - b.log_det).abs() < 1e-12);
            for i in 0..S::STATES {
                assert!((x[i] - y[i]).abs() < 1e-12);
                assert!((0..S::STATES).all(|j| (known[i][j] - usual[i][j]).abs() < 1e-12));
            }
            assert!((0..9).all(|k| (s[k / 3][k % 3] - t[k / 3][k % 3]).abs() < 1e-12));
        }
        let before = (x, known);
        assert!(Known::update::<S, f64>(&mut known, &mut x, &h, &[0.5, 1.0, f64::NAN], &[0.0; 3]).is_none());
        assert_eq!((x, known), before);
    }
}
