//! The filter proper: estimate, covariance, and the two steps that move them.

use core::marker::PhantomData;

use crate::{
    Array, Block, BlockVisitor, Conventional, CoreVector, Dynamics, Fade, Filter, Form, Matrix,
    MeasurementInfo, MeasurementMatrix, MeasurementRows, MeasurementVector, Real, Relaxation, Shape,
    Transition, Vector, Whitened, considered_in, relaxations, relaxes,
};

/// Residuals of a declared filter's measurements, row by row.
///
/// Starts empty; a row that is not [`set`](Self::set) measures nothing at this instant.
pub struct Residuals<F: Filter, T: Real> {
    z: MeasurementVector<F, T>,
    r: MeasurementVector<F, T>,
    present: MeasurementVector<F, T>,
}

impl<F: Filter, T: Real> Default for Residuals<F, T> {
    fn default() -> Self {
        Self {
            z: F::Shape::measurement(T::zero()),
            r: F::Shape::measurement(T::one()),
            present: F::Shape::measurement(T::zero()),
        }
    }
}

impl<F: Filter, T: Real> Clone for Residuals<F, T> {
    fn clone(&self) -> Self {
        Self { z: self.z.clone(), r: self.r.clone(), present: self.present.clone() }
    }
}

impl<F: Filter, T: Real> Residuals<F, T> {
    /// Sets `row` to a residual `computed - measured` with the standard deviation of the measurement.
    pub fn set(&mut self, row: usize, residual: T, sigma: T) {
        self.z[row] = residual;
        self.r[row] = sigma * sigma;
        self.present[row] = T::one();
    }

    /// Whether nothing is measured.
    pub fn is_empty(&self) -> bool {
        self.present.as_slice().iter().all(|p| *p == T::zero())
    }

    /// The residuals, row by row; zero where nothing is measured.
    pub fn values(&self) -> &MeasurementVector<F, T> {
        &self.z
    }

    /// Variances of the measurements, row by row; one where nothing is measured.
    pub fn variances(&self) -> &MeasurementVector<F, T> {
        &self.r
    }

    /// Whether `row` is measured.
    pub fn is_present(&self, row: usize) -> bool {
        self.present[row] != T::zero()
    }

    /// Takes out a measurement, by its place in [`Filter::MEASURES`]: there is none at this instant.
    pub fn leave_out(&mut self, measured: usize) {
        for row in F::rows(measured) {
            self.z[row] = T::zero();
            self.r[row] = T::one();
            self.present[row] = T::zero();
        }
    }

    fn count(&self) -> usize {
        self.present.as_slice().iter().filter(|p| **p != T::zero()).count()
    }
}

/// What one update found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation<T> {
    /// Normalised innovation squared over the rows used.
    pub nis: T,
    /// Rows used.
    pub degrees_of_freedom: usize,
    /// Gaussian log-likelihood of the rows used.
    pub log_likelihood: T,
    /// Measurements that the gate refused, as bits by their place in [`Filter::MEASURES`].
    pub rejected: u32,
}

/// The innovation covariance was not positive definite: the filter has diverged or was fed NaN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositiveDefinite;

impl core::fmt::Display for NotPositiveDefinite {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the innovation covariance is not positive definite")
    }
}

impl core::error::Error for NotPositiveDefinite {}

/// An error-state Kalman filter made from the declaration `F`, in scalar `T`, with its covariance in form `C`.
pub struct Kalman<F: Filter, T: Real = f64, C: Form = Conventional> {
    x: Vector<F, T>,
    cov: Matrix<F, T>,
    /// The states that are considered, and whether there is one.
    considered: Vector<F, bool>,
    considers: bool,
    form: PhantomData<C>,
}

impl<F: Filter, T: Real, C: Form> Clone for Kalman<F, T, C> {
    fn clone(&self) -> Self {
        let (x, cov, considered) = (self.x.clone(), self.cov.clone(), self.considered.clone());
        Self { x, cov, considered, considers: self.considers, form: PhantomData }
    }
}

impl<F: Filter, T: Real, C: Form> Kalman<F, T, C> {
    /// A filter with mean zero and independent states of the given standard deviations.
    pub fn new(sigmas: &Vector<F, T>) -> Self {
        let mut variances = sigmas.clone();
        for v in variances.as_mut_slice() {
            *v *= *v;
        }
        let mut cov = F::Shape::matrix(T::zero());
        C::set_diagonal::<F::Shape, T>(&mut cov, &variances);
        let (x, considered) = (F::Shape::vector(T::zero()), F::Shape::vector(false));
        let mut kalman = Self { x, cov, considered, considers: false, form: PhantomData };
        considered_in::<F>(|state| kalman.consider(state));
        kalman
    }

    /// From now on no measurement changes state `i` or its variance, while what it makes uncertain is carried in the covariance of the
    /// others: a *considered* state (Schmidt, *Application of State-Space Methods to Navigation Problems*, 1966). What a declaration
    /// marks with `#[consider]` is considered from the beginning.
    pub fn consider(&mut self, i: usize) {
        self.considered[i] = true;
        self.considers = true;
    }

    /// Whether state `i` is considered.
    pub fn is_considered(&self, i: usize) -> bool {
        self.considered[i]
    }

    /// Prior standard deviations of the declaration's blocks.
    ///
    /// # Panics
    /// When a block describes more or fewer states than it has: the message names it. [`probe`](crate::probe()) returns it.
    pub fn prior() -> Vector<F, T> {
        let mut sigmas = F::Shape::vector(T::zero());
        F::blocks(0, &mut Prior(sigmas.as_mut_slice()));
        sigmas
    }

    /// The state vector.
    pub fn x(&self) -> &Vector<F, T> {
        &self.x
    }

    /// The state vector, to be corrected by what was fed back.
    pub fn x_mut(&mut self) -> &mut Vector<F, T> {
        &mut self.x
    }

    /// Standard deviation of state `i`.
    pub fn sigma(&self, i: usize) -> T {
        C::variance::<F::Shape, T>(&self.cov, i).sqrt()
    }

    /// The covariance as a dense matrix.
    pub fn covariance(&self) -> Matrix<F, T> {
        let mut p = F::Shape::matrix(T::zero());
        C::dense::<F::Shape, T>(&self.cov, &mut p);
        p
    }

    /// Time update over the interval of `transition`; `density` is the white noise on the leading states,
    /// (unit)^2/s. Parameters that relax fade towards zero as they are declared to.
    pub fn predict(&mut self, transition: &Transition<F, T>, density: &CoreVector<F, T>) {
        self.predict_relaxing(transition, density, &relaxing::<F, T>());
    }

    /// [`predict`](Self::predict) with `relaxing` by state in place of those that are declared; of a state that is not declared
    /// to relax it is not asked.
    pub fn predict_relaxing(
        &mut self,
        transition: &Transition<F, T>,
        density: &CoreVector<F, T>,
        relaxing: &Vector<F, Relaxation<T>>,
    ) {
        let rows = transition.rows();
        let mut moved = F::Shape::core_vector(T::zero());
        for i in 0..F::Shape::CORE {
            for j in 0..F::Shape::STATES {
                moved[i] += rows[i][j] * self.x[j];
            }
        }
        for i in 0..F::Shape::CORE {
            self.x[i] = moved[i];
        }
        C::propagate::<F::Shape, T>(&mut self.cov, rows, &transition.noise(density));
        if const { relaxes::<F>() } {
            relaxations::<F, T>(|state, _| {
                let Relaxation { rate, density } = relaxing[state];
                if rate == T::zero() && density == T::zero() {
                    return;
                }
                let fade = Fade::over(relaxing[state], state, transition.elapsed());
                self.x[state] *= fade.keep;
                C::fade::<F::Shape, T>(&mut self.cov, &fade);
            });
        }
    }

    /// Adds variances to those of the leading states: something has changed there that no model foretells.
    pub fn widen(&mut self, variances: &CoreVector<F, T>) {
        let mut rows = F::Shape::core_rows(T::zero());
        let mut noise = F::Shape::core_matrix(T::zero());
        for i in 0..F::Shape::CORE {
            rows[i][i] = T::one();
            noise[i][i] = variances[i];
        }
        C::propagate::<F::Shape, T>(&mut self.cov, &rows, &noise);
    }

    /// Measurement update. With a `gate`, a measurement whose own normalised innovation squared per row
    /// exceeds it is left out.
    ///
    /// # Errors
    /// When the innovation covariance is not positive definite; state and covariance then no longer mean anything.
    pub fn update(
        &mut self,
        at: &<F::Dynamics as Dynamics>::Point<T>,
        signals: &<F::Dynamics as Dynamics>::Signals<T>,
        mut residuals: Residuals<F, T>,
        gate: Option<T>,
    ) -> Result<Innovation<T>, NotPositiveDefinite> {
        let mut h = measurement_rows::<F, T>(at, signals);
        for m in 0..F::Shape::ROWS {
            if residuals.present[m] == T::zero() {
                h[m] = F::Shape::vector(T::zero());
            }
        }
        let rejected = match gate {
            Some(limit) => self.reject(&mut h, &mut residuals, limit)?,
            None => 0,
        };
        let whitened = if self.considers {
            self.update_considering(&h, &residuals)
        } else {
            C::update::<F::Shape, T>(&mut self.cov, &mut self.x, &h, &residuals.r, &residuals.z)
        };
        let whitened = whitened.ok_or(NotPositiveDefinite)?;
        let degrees_of_freedom = residuals.count();
        let constant = T::of(degrees_of_freedom as f64) * T::two_pi().ln();
        Ok(Innovation {
            nis: whitened.nis,
            degrees_of_freedom,
            log_likelihood: -T::of(0.5) * (whitened.nis + whitened.log_det + constant),
            rejected,
        })
    }

    /// The update that leaves considered states alone. The gain of the others is that of the usual update, and so are their covariance and
    /// the covariance between both; what the usual update takes from the covariance of considered states, `W S^-1 W'` with their rows
    /// W of `P H'`, is given back as squares (for U D U': Zanetti and D'Souza, *Journal of the Astronautical Sciences* 60, 2013).
    fn update_considering(
        &mut self,
        h: &MeasurementRows<F, T>,
        residuals: &Residuals<F, T>,
    ) -> Option<Whitened<T>> {
        let mut s = C::project::<F::Shape, T>(&self.cov, h);
        let mut taken = h.clone();
        for m in 0..F::Shape::ROWS {
            s[m][m] += residuals.r[m];
            taken[m] = C::times::<F::Shape, T>(&self.cov, &h[m]);
            for i in 0..F::Shape::STATES {
                if !self.considered[i] {
                    taken[m][i] = T::zero();
                }
            }
        }
        // S = L L', row by row, and W L^-T with it
        for m in 0..F::Shape::ROWS {
            for k in 0..m {
                for n in 0..k {
                    let known = s[m][n] * s[k][n];
                    s[m][k] -= known;
                }
                let weight = s[m][k] / s[k][k];
                s[m][k] = weight;
                s[m][m] -= weight * weight;
                for i in 0..F::Shape::STATES {
                    let known = taken[k][i];
                    taken[m][i] -= weight * known;
                }
            }
            if !(s[m][m] > T::zero()) {
                return None;
            }
            let root = s[m][m].sqrt();
            s[m][m] = root;
            for i in 0..F::Shape::STATES {
                taken[m][i] /= root;
            }
        }
        let before = self.x.clone();
        let whitened = C::update::<F::Shape, T>(&mut self.cov, &mut self.x, h, &residuals.r, &residuals.z)?;
        for i in 0..F::Shape::STATES {
            if self.considered[i] {
                self.x[i] = before[i];
            }
        }
        for m in 0..F::Shape::ROWS {
            C::add_square::<F::Shape, T>(&mut self.cov, &taken[m]);
        }
        Some(whitened)
    }

    /// Visits the measurements present by their place in [`Filter::MEASURES`], each with its own normalised innovation squared per
    /// row: what a gate judges.
    ///
    /// # Errors
    /// When the innovation covariance is not positive definite.
    pub fn innovations(
        &self,
        at: &<F::Dynamics as Dynamics>::Point<T>,
        signals: &<F::Dynamics as Dynamics>::Signals<T>,
        residuals: &Residuals<F, T>,
        visit: impl FnMut(usize, T),
    ) -> Result<(), NotPositiveDefinite> {
        let mut h = measurement_rows::<F, T>(at, signals);
        for m in 0..F::Shape::ROWS {
            if residuals.present[m] == T::zero() {
                h[m] = F::Shape::vector(T::zero());
            }
        }
        self.measured(&h, residuals, visit)
    }

    fn measured(
        &self,
        h: &MeasurementRows<F, T>,
        residuals: &Residuals<F, T>,
        mut visit: impl FnMut(usize, T),
    ) -> Result<(), NotPositiveDefinite> {
        let s = C::project::<F::Shape, T>(&self.cov, h);
        for measured in 0..F::MEASURES.len() {
            let rows = F::rows(measured);
            if rows.clone().any(|row| residuals.is_present(row)) {
                let count = T::of(rows.len() as f64);
                visit(measured, self.nis(&s, h, residuals, rows)? / count);
            }
        }
        Ok(())
    }

    /// Takes out the measurements that the gate refuses.
    fn reject(
        &self,
        h: &mut MeasurementRows<F, T>,
        residuals: &mut Residuals<F, T>,
        limit: T,
    ) -> Result<u32, NotPositiveDefinite> {
        let mut rejected = 0;
        self.measured(h, residuals, |measured, nis| {
            if nis > limit {
                rejected |= 1 << measured;
            }
        })?;
        for measured in (0..F::MEASURES.len()).filter(|measured| rejected & 1 << measured != 0) {
            residuals.leave_out(measured);
            for row in F::rows(measured) {
                h[row] = F::Shape::vector(T::zero());
            }
        }
        Ok(rejected)
    }

    /// Normalised innovation squared of some rows on their own.
    fn nis(
        &self,
        s: &MeasurementMatrix<F, T>,
        h: &MeasurementRows<F, T>,
        residuals: &Residuals<F, T>,
        rows: core::ops::Range<usize>,
    ) -> Result<T, NotPositiveDefinite> {
        let mut l = s.clone();
        let mut e = residuals.values().clone();
        let mut nis = T::zero();
        for i in rows.clone() {
            for j in 0..F::Shape::STATES {
                e[i] -= h[i][j] * self.x[j];
            }
            l[i][i] += residuals.r[i];
            for j in rows.start..=i {
                let mut sum = l[i][j];
                for k in rows.start..j {
                    sum -= l[i][k] * l[j][k];
                }
                if i == j && !(sum > T::zero()) {
                    return Err(NotPositiveDefinite);
                }
                l[i][j] = if i == j { sum.sqrt() } else { sum / l[j][j] };
            }
            for k in rows.start..i {
                let known = e[k];
                e[i] -= l[i][k] * known;
            }
            e[i] /= l[i][i];
            nis += e[i] * e[i];
        }
        Ok(nis)
    }
}

/// Where the states' prior standard deviations go.
struct Prior<'a, T>(&'a mut [T]);

impl<D: Dynamics, T: Real> BlockVisitor<D> for Prior<'_, T> {
    fn visit<B: Block<Dynamics = D>>(&mut self, first: usize) {
        let mut described = 0;
        B::states(&mut |info| {
            if described < B::DIM {
                self.0[first + described] = T::of(info.prior_sigma);
            }
            described += 1;
        });
        assert!(described == B::DIM, "block `{}` describes {described} states, `DIM` is {}", B::NAME, B::DIM);
    }
}

/// How the states relax as they are declared, by state; nothing for those that are constant, and for the leading ones.
#[inline]
pub fn relaxing<F: Filter, T: Real>() -> Vector<F, Relaxation<T>> {
    let mut relaxing = F::Shape::vector(Relaxation { rate: T::zero(), density: T::zero() });
    relaxations::<F, T>(|state, relaxation| relaxing[state] = relaxation);
    relaxing
}

/// The measurement matrix of a declared filter: how the channels depend on the states (the leading states' part, the direct
/// effects of blocks, and what sensor errors do to them), and by the chain rule the rows that are made of them.
pub fn measurement_rows<F: Filter, T: Real>(
    at: &<F::Dynamics as Dynamics>::Point<T>,
    signals: &<F::Dynamics as Dynamics>::Signals<T>,
) -> MeasurementRows<F, T> {
    let mut h = F::Shape::measurement_rows(T::zero());
    let mut add = |channel: usize, state: usize, value: T| {
        let mut row = 0;
        let mut k = 0;
        while k < F::MEASURES.len() {
            let MeasurementInfo { components, channels, .. } = F::MEASURES[k];
            if let Some(first) = channels
                && channel >= first
                && channel < first + components.len()
            {
                h[row + channel - first][state] += value;
            }
            row += components.len();
            k += 1;
        }
    };
    channels_by_states::<F, T>(at, signals, &mut add);
    if const { has_functions(F::MEASURES) } {
        add_functions::<F, T>(at, signals, &mut h);
    }
    h
}

/// How the channels depend on the states: `put(channel, state, value)`.
#[inline(always)]
fn channels_by_states<F: Filter, T: Real>(
    at: &<F::Dynamics as Dynamics>::Point<T>,
    signals: &<F::Dynamics as Dynamics>::Signals<T>,
    put: &mut impl FnMut(usize, usize, T),
) {
    F::Dynamics::measurement_jacobian(at, put);
    F::measurement_jacobian(at, put);
    F::input_jacobian(signals, &mut |input, state, value| {
        F::Dynamics::measure_input(at, input, value, &mut |channel, part| put(channel, state, part));
    });
}

/// Whether some rows are functions of channels.
const fn has_functions(measures: &[MeasurementInfo]) -> bool {
    let mut k = 0;
    while k < measures.len() {
        if measures[k].channels.is_none() {
            return true;
        }
        k += 1;
    }
    false
}

/// The rows that are functions of channels. Each of their derivatives goes through the channels' rows once: there are few.
fn add_functions<F: Filter, T: Real>(
    at: &<F::Dynamics as Dynamics>::Point<T>,
    signals: &<F::Dynamics as Dynamics>::Signals<T>,
    h: &mut MeasurementRows<F, T>,
) {
    F::residual_jacobian(at, &mut |row, of, slope| {
        let function = (0..F::MEASURES.len()).find(|k| F::rows(*k).contains(&row));
        if function.is_some_and(|k| F::MEASURES[k].channels.is_none()) {
            add_slope::<F, T>(at, signals, of, slope, &mut h[row]);
        }
    });
}

/// Adds a channel's row times `slope`.
fn add_slope<F: Filter, T: Real>(
    at: &<F::Dynamics as Dynamics>::Point<T>,
    signals: &<F::Dynamics as Dynamics>::Signals<T>,
    of: usize,
    slope: T,
    row: &mut Vector<F, T>,
) {
    channels_by_states::<F, T>(at, signals, &mut |channel, state, value| {
        if channel == of {
            row[state] += slope * value;
        }
    });
}
