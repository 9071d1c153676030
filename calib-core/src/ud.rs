//! The factored covariance P = U D U', by Thornton and Bierman.

use crate::form::{Fade, Form, Whitened, is_present};
use crate::{Real, Shape};

/// P = U D U' with U unit upper triangular and D diagonal: the robust form, and the only one fit for `f32`.
///
/// Stored transposed in the lower triangle, so that a column of U lies in memory in one piece: entry `[j][i]`
/// is U_ij for i < j, entry `[j][j]` is D_j, the rest is not used. With the leading states first, propagation
/// leaves the parameters' part of U and D untouched (Bierman, *Factorization Methods for Discrete Sequential
/// Estimation*, 1977, chapters V and VII).
#[derive(Clone, Copy, Debug)]
pub struct Ud;

/// `U' h`: what a measurement row sees of the factored state.
#[inline(always)]
fn through_u<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::Vector<T>) -> S::Vector<T> {
    let mut f = h.clone();
    for j in 0..S::STATES {
        let column = &cov[j];
        let mut sum = h[j];
        for i in 0..j {
            sum += column[i] * h[i];
        }
        f[j] = sum;
    }
    f
}

/// U D U' factors of the noise in its leading block, stored like the covariance; a zero pivot is no noise.
fn factor<S: Shape, T: Real>(noise: &S::CoreMatrix<T>) -> S::CoreMatrix<T> {
    let mut q = noise.clone();
    for j in (0..S::CORE).rev() {
        let d = q[j][j];
        let inverse = if d > T::zero() { T::one() / d } else { T::zero() };
        if inverse == T::zero() {
            q[j][j] = T::zero();
        }
        for i in 0..j {
            q[j][i] *= inverse;
        }
        for i in 0..j {
            for k in 0..=i {
                let change = q[j][i] * q[j][k] * d;
                q[i][k] -= change;
            }
        }
    }
    q
}

impl Form for Ud {
    fn set_diagonal<S: Shape, T: Real>(cov: &mut S::Matrix<T>, variances: &S::Vector<T>) {
        *cov = S::matrix(T::zero());
        for i in 0..S::STATES {
            cov[i][i] = variances[i];
        }
    }

    fn propagate<S: Shape, T: Real>(cov: &mut S::Matrix<T>, rows: &S::CoreRows<T>, noise: &S::CoreMatrix<T>) {
        // the parameters' columns: U12 <- Phi U12 + Psi U22
        for j in S::CORE..S::STATES {
            let column = cov[j].clone();
            for i in 0..S::CORE {
                let row = &rows[i];
                let mut sum = row[j];
                for k in 0..j {
                    sum += row[k] * column[k];
                }
                cov[j][i] = sum;
            }
        }
        // the leading block: orthogonalise the rows of [Phi U11, Uq] in the weights [D1, Dq]
        let q = factor::<S, T>(noise);
        let mut moved = S::core_matrix(T::zero());
        let mut driven = S::core_matrix(T::zero());
        let mut moved_weight = S::core_vector(T::zero());
        let mut driven_weight = S::core_vector(T::zero());
        for j in 0..S::CORE {
            moved_weight[j] = cov[j][j];
            driven_weight[j] = q[j][j];
            for i in 0..S::CORE {
                let mut sum = rows[i][j];
                for k in 0..j {
                    sum += rows[i][k] * cov[j][k];
                }
                moved[i][j] = sum;
                driven[i][j] = if i == j {
                    T::one()
                } else if i < j {
                    q[j][i]
                } else {
                    T::zero()
                };
            }
        }
        for j in (0..S::CORE).rev() {
            let mut d = T::zero();
            for k in 0..S::CORE {
                d += moved[j][k] * moved[j][k] * moved_weight[k];
                d += driven[j][k] * driven[j][k] * driven_weight[k];
            }
            cov[j][j] = d;
            let inverse = if d > T::zero() { T::one() / d } else { T::zero() };
            for i in 0..j {
                let mut sum = T::zero();
                for k in 0..S::CORE {
                    sum += moved[i][k] * moved_weight[k] * moved[j][k];
                    sum += driven[i][k] * driven_weight[k] * driven[j][k];
                }
                let u = sum * inverse;
                cov[j][i] = u;
                for k in 0..S::CORE {
                    let (m, n) = (moved[j][k], driven[j][k]);
                    moved[i][k] -= u * m;
                    driven[i][k] -= u * n;
                }
            }
        }
    }

    /// Scales the state's row of U, then adds its noise (Agee and Turner's rank-one update).
    fn fade<S: Shape, T: Real>(cov: &mut S::Matrix<T>, fade: &Fade<T>) {
        let s = fade.state;
        for j in s + 1..S::STATES {
            cov[j][s] *= fade.keep;
        }
        cov[s][s] *= fade.keep * fade.keep;
        let mut a = S::vector(T::zero());
        a[s] = T::one();
        for i in 0..s {
            cov[s][i] /= fade.keep;
        }
        let mut c = fade.variance;
        for j in (0..=s).rev() {
            let d = cov[j][j];
            let pivot = a[j];
            let grown = d + c * pivot * pivot;
            cov[j][j] = grown;
            if !(grown > T::zero()) {
                continue;
            }
            let weight = c * pivot / grown;
            for i in 0..j {
                let u = cov[j][i];
                a[i] -= pivot * u;
                cov[j][i] = u + weight * a[i];
            }
            c *= d / grown;
        }
    }

    fn update<S: Shape, T: Real>(
        cov: &mut S::Matrix<T>,
        x: &mut S::Vector<T>,
        h: &S::MeasurementRows<T>,
        r: &S::Measurement<T>,
        z: &S::Measurement<T>,
    ) -> Option<Whitened<T>> {
        // a scalar at a time; each innovation variance is at least its noise, so only a negative or NaN input fails
        let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
        for m in 0..S::ROWS {
            if !is_present::<S, T>(&h[m]) {
                continue;
            }
            let f = through_u::<S, T>(cov, &h[m]);
            let mut total = r[m];
            for j in 0..S::STATES {
                total += cov[j][j] * f[j] * f[j];
            }
            if !(total > T::zero()) {
                return None;
            }
            let mut residual = z[m];
            for j in 0..S::STATES {
                residual -= h[m][j] * x[j];
            }
            let mut gain = S::vector(T::zero());
            let mut alpha = r[m];
            for j in 0..S::STATES {
                let d = cov[j][j];
                let v = d * f[j];
                let before = alpha;
                alpha += v * f[j];
                if alpha > T::zero() {
                    cov[j][j] = d * before / alpha;
                }
                let pull = if before > T::zero() { -f[j] / before } else { T::zero() };
                for i in 0..j {
                    let u = cov[j][i];
                    cov[j][i] = u + gain[i] * pull;
                    gain[i] += u * v;
                }
                gain[j] = v;
            }
            let innovation = residual / alpha;
            for j in 0..S::STATES {
                x[j] += gain[j] * innovation;
            }
            whitened.nis += residual * innovation;
            whitened.log_det += alpha.ln();
        }
        Some(whitened)
    }

    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T> {
        let mut f = h.clone();
        for m in 0..S::ROWS {
            f[m] = through_u::<S, T>(cov, &h[m]);
        }
        let mut s = S::measurement_matrix(T::zero());
        for i in 0..S::ROWS {
            for l in 0..=i {
                let mut sum = T::zero();
                for j in 0..S::STATES {
                    sum += f[i][j] * cov[j][j] * f[l][j];
                }
                s[i][l] = sum;
                s[l][i] = sum;
            }
        }
        s
    }

    fn variance<S: Shape, T: Real>(cov: &S::Matrix<T>, i: usize) -> T {
        let mut sum = cov[i][i];
        for j in i + 1..S::STATES {
            sum += cov[j][i] * cov[j][i] * cov[j][j];
        }
        sum
    }

    fn dense<S: Shape, T: Real>(cov: &S::Matrix<T>, p: &mut S::Matrix<T>) {
        for i in 0..S::STATES {
            for l in 0..=i {
                // sum over the columns j at or right of the diagonal of both rows
                let mut sum = if l == i { cov[i][i] } else { cov[i][l] * cov[i][i] };
                for j in i + 1..S::STATES {
                    sum += cov[j][i] * cov[j][l] * cov[j][j];
                }
                p[i][l] = sum;
                p[l][i] = sum;
            }
        }
    }
}
