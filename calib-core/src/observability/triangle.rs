//! Any number of rows in the memory of an N x N triangle, and what the triangle says.

use crate::{Array, Real, Shape};

/// Two columns count as orthogonal when their cosine is below this many times the machine epsilon.
const ORTHOGONAL: f64 = 8.0;
/// Sweeps of Jacobi rotations; ten are usual.
const SWEEPS: usize = 60;

/// The upper triangular factor R of rows appended one by one: `R' R = sum of row' row`.
///
/// Each row is rotated into the triangle (Givens), so that memory does not grow and nothing is squared: the singular
/// values of R are those of the stacked rows to the accuracy of the arithmetic.
#[derive(Debug)]
pub struct Triangle<S: Shape, T: Real> {
    r: S::Matrix<T>,
}

impl<S: Shape, T: Real> Clone for Triangle<S, T> {
    fn clone(&self) -> Self {
        Self { r: self.r.clone() }
    }
}

impl<S: Shape, T: Real> Default for Triangle<S, T> {
    fn default() -> Self {
        Self { r: S::matrix(T::zero()) }
    }
}

impl<S: Shape, T: Real> Triangle<S, T> {
    /// Rotates a row into the triangle.
    pub fn append(&mut self, row: &S::Vector<T>) {
        let mut row = row.clone();
        for j in 0..S::STATES {
            if row[j] == T::zero() {
                continue;
            }
            let (a, b) = (self.r[j][j], row[j]);
            let length = a.hypot(b);
            let (c, s) = (a / length, b / length);
            self.r[j][j] = length;
            for k in j + 1..S::STATES {
                let (above, below) = (self.r[j][k], row[k]);
                self.r[j][k] = c * above + s * below;
                row[k] = c * below - s * above;
            }
        }
    }

    /// Takes in the rows of another triangle.
    pub fn join(&mut self, other: &Self) {
        for i in 0..S::STATES {
            self.append(&other.r[i]);
        }
    }

    /// R itself; below the diagonal stand zeros.
    pub fn factor(&self) -> &S::Matrix<T> {
        &self.r
    }

    /// Square roots of the diagonal of `(R' R)^-1`: the standard deviations that the rows leave to the states when
    /// each row is a measurement with unit noise. Infinite where R is singular.
    pub fn sigmas(&self) -> S::Vector<T> {
        // column by column of R^-1, whose rows have the wanted norms
        let mut squares = S::vector(T::zero());
        for j in 0..S::STATES {
            let mut column = S::vector(T::zero());
            for i in (0..=j).rev() {
                let mut sum = if i == j { T::one() } else { T::zero() };
                for k in i + 1..=j {
                    // zero times infinity: what does not depend on an unknown state is not hurt by it
                    if self.r[i][k] != T::zero() {
                        sum -= self.r[i][k] * column[k];
                    }
                }
                column[i] = if sum == T::zero() { sum } else { sum / self.r[i][i] };
                squares[i] += column[i] * column[i];
            }
        }
        for i in 0..S::STATES {
            let square = squares[i];
            squares[i] = if square.is_finite() { square.sqrt() } else { T::one() / T::zero() };
        }
        squares
    }

    /// Singular values, largest first, with the right singular vectors: one-sided Jacobi rotations of the columns, which
    /// find small singular values to the accuracy that the columns allow.
    pub fn decompose(&self) -> Decomposition<S, T> {
        let n = S::STATES;
        // row i of `a` is column i of R, so that what is rotated lies together
        let mut a = S::matrix(T::zero());
        let mut v = S::matrix(T::zero());
        for i in 0..n {
            for j in 0..n {
                a[i][j] = self.r[j][i];
            }
            v[i][i] = T::one();
        }
        let small = T::of(ORTHOGONAL) * T::default_epsilon();
        for _ in 0..SWEEPS {
            let mut rotated = false;
            for p in 0..n {
                for q in p + 1..n {
                    rotated |= orthogonalise::<S, T>(&mut a, &mut v, p, q, small);
                }
            }
            if !rotated {
                break;
            }
        }
        let mut values = S::vector(T::zero());
        for i in 0..n {
            values[i] = dot(a[i].as_slice(), a[i].as_slice()).sqrt();
        }
        for i in 0..n {
            let mut largest = i;
            for k in i + 1..n {
                if values[k] > values[largest] {
                    largest = k;
                }
            }
            values.as_mut_slice().swap(i, largest);
            v.as_mut_slice().swap(i, largest);
        }
        Decomposition { values, vectors: v }
    }
}

/// Rotates columns p and q until they are orthogonal. Whether there was anything to do.
fn orthogonalise<S: Shape, T: Real>(
    a: &mut S::Matrix<T>,
    v: &mut S::Matrix<T>,
    p: usize,
    q: usize,
    small: T,
) -> bool {
    let (pp, qq) = (dot(a[p].as_slice(), a[p].as_slice()), dot(a[q].as_slice(), a[q].as_slice()));
    let pq = dot(a[p].as_slice(), a[q].as_slice());
    if pq.abs() <= small * (pp * qq).sqrt() || pp == T::zero() || qq == T::zero() {
        return false;
    }
    let zeta = (qq - pp) / (pq + pq);
    let t = T::one() / (zeta.abs() + (T::one() + zeta * zeta).sqrt());
    let t = if zeta < T::zero() { -t } else { t };
    let c = T::one() / (T::one() + t * t).sqrt();
    rotate::<S, T>(a, p, q, c, c * t);
    rotate::<S, T>(v, p, q, c, c * t);
    true
}

fn rotate<S: Shape, T: Real>(m: &mut S::Matrix<T>, p: usize, q: usize, c: T, s: T) {
    for k in 0..S::STATES {
        let (x, y) = (m[p][k], m[q][k]);
        m[p][k] = c * x - s * y;
        m[q][k] = s * x + c * y;
    }
}

fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sum = T::zero();
    for (a, b) in a.iter().zip(b) {
        sum += *a * *b;
    }
    sum
}

/// Singular values of stacked rows, with their directions among the states.
#[derive(Debug)]
pub struct Decomposition<S: Shape, T: Real> {
    values: S::Vector<T>,
    vectors: S::Matrix<T>,
}

impl<S: Shape, T: Real> Decomposition<S, T> {
    /// Singular values, largest first.
    pub fn values(&self) -> &[T] {
        self.values.as_slice()
    }

    /// Right singular vector of value `i`, of unit length.
    pub fn direction(&self, i: usize) -> &S::Vector<T> {
        &self.vectors[i]
    }

    /// Number of singular values above `tolerance`.
    pub fn rank(&self, tolerance: T) -> usize {
        self.values().iter().filter(|value| **value > tolerance).count()
    }

    /// What rounding alone can make of a singular value that is zero: `N epsilon` times the largest.
    pub fn rounding(&self) -> T {
        self.values[0] * T::of(S::STATES as f64) * T::default_epsilon()
    }

    /// Degree of observability of a state (Eq. 58): the singular value in whose direction the state has the largest
    /// component, that is the one that maximises the projection `v_i (u_i' y) / s_i` of the state on the right singular
    /// vectors. Zero when no row knows the state.
    pub fn degree(&self, state: usize) -> T {
        let mut best = 0;
        for i in 1..S::STATES {
            if self.vectors[i][state].abs() > self.vectors[best][state].abs() {
                best = i;
            }
        }
        self.values[best]
    }
}
