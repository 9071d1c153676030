//! What must hold of every filter, whatever its declaration, its path and its noise: on random points of random paths, with
//! priors over fifteen orders of magnitude.
//!
//! Two bounds are stated here. With priors over four orders of magnitude both forms keep P definite to 1e-12 of its
//! correlations and agree to 1e-7. Over fifteen orders only the factored form does: the conventional one stays finite and
//! symmetric with positive variances, but its correlations lose their definiteness. Such priors call for `Ud`.

mod common;

use calib_core::{Conventional, Filter, Form, Kalman, Residuals, Shape, Transition, Ud, Vector};
use common::{Numbers, point, signals};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use sinscal::{FILTERS, FilterVisitor, Strapdown, visit_filter};

/// Correlations are judged: they have no units. 4000 cases came to 4e-15.
const DEFINITE: f64 = 1e-12;
/// Between orders of updates, with priors over fifteen orders of magnitude.
const ROUNDING: f64 = 1e-8;

/// What a case is made of.
#[derive(Clone, Copy, Debug)]
struct Draw {
    seed: u64,
    /// Prior standard deviations lie between these powers of ten.
    priors: (i32, i32),
    /// Random walk of the sensors.
    walk: f64,
    cycles: usize,
}

impl Draw {
    /// Whether its priors are further apart than those of any unit.
    fn extreme(&self) -> bool {
        self.priors.1 - self.priors.0 > 4
    }
}

fn draws() -> impl Strategy<Value = Draw> {
    let priors = prop_oneof![Just((-6, -2)), Just((-12, 3)), Just((0, 0))];
    let walk = prop_oneof![Just(0.0), Just(1e-6), Just(1e-2)];
    (any::<u64>(), priors, walk, 1..6_usize).prop_map(|(seed, priors, walk, cycles)| Draw {
        seed,
        priors,
        walk,
        cycles,
    })
}

/// A filter in motion, with what moves it.
struct Case<F: Filter<Dynamics = Strapdown>> {
    numbers: Numbers,
    draw: Draw,
    time: f64,
    transition: Transition<F, f64>,
}

impl<F: Filter<Dynamics = Strapdown>> Case<F> {
    fn new(draw: Draw) -> Self {
        Self { numbers: Numbers(draw.seed), draw, time: 0.0, transition: Transition::new() }
    }

    /// Standard deviations; one parameter in eight is known exactly.
    fn priors(&mut self) -> Vector<F, f64> {
        let (low, high) = self.draw.priors;
        let mut sigmas = F::Shape::vector(0.0);
        for i in 0..F::Shape::STATES {
            let part = 0.5 + 0.5 * self.numbers.next();
            let known = i >= F::Shape::CORE && self.numbers.next() > 0.75;
            sigmas[i] = if known { 0.0 } else { 10_f64.powf(f64::from(low) + part * f64::from(high - low)) };
        }
        sigmas
    }

    /// Moves `kalman` a second along its path.
    fn predict<C: Form>(&mut self, kalman: &mut [&mut Kalman<F, f64, C>]) {
        self.transition.reset();
        for _ in 0..10 {
            let at = point(&mut self.numbers);
            self.transition.absorb(&at, &signals(self.time), 0.1);
            self.transition.advance(&at, 0.1);
            self.time += 0.1;
        }
        let density = self.density();
        for kalman in kalman {
            kalman.predict(&self.transition, &density);
        }
    }

    fn density(&self) -> calib_core::CoreVector<F, f64> {
        let mut density = F::Shape::core_vector(0.0);
        for i in 0..6 {
            density[i] = self.draw.walk * self.draw.walk;
        }
        density
    }

    /// Residuals of all rows, of sigmas over four orders of magnitude.
    fn residuals(&mut self) -> Residuals<F, f64> {
        let mut residuals = Residuals::default();
        for row in 0..F::Shape::ROWS {
            let sigma = 10_f64.powf(-3.0 + 2.0 * self.numbers.next());
            residuals.set(row, self.numbers.next() * sigma, sigma);
        }
        residuals
    }
}

fn dense<F: Filter, C: Form>(kalman: &Kalman<F, f64, C>) -> DMatrix<f64> {
    let p = kalman.covariance();
    DMatrix::from_fn(F::Shape::STATES, F::Shape::STATES, |i, j| p[i][j])
}

/// A matrix in units of the standard deviations of `p`; states that are known exactly count as uncorrelated.
fn scaled(m: &DMatrix<f64>, p: &DMatrix<f64>) -> DMatrix<f64> {
    let sigma = p.diagonal().map(f64::sqrt);
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| {
        let scale = sigma[i] * sigma[j];
        if scale > 0.0 { m[(i, j)] / scale } else { 0.0 }
    })
}

fn least_eigenvalue(m: DMatrix<f64>) -> f64 {
    m.symmetric_eigenvalues().min()
}

/// Finite, symmetric to the bit, no variance below zero, and if `definite` that of no combination of states.
fn sound(p: &DMatrix<f64>, what: &str, definite: bool) -> Result<(), TestCaseError> {
    prop_assert!(p.iter().all(|v| v.is_finite()), "{what}: not finite");
    prop_assert!(*p == p.transpose(), "{what}: not symmetric");
    prop_assert!(p.diagonal().iter().all(|v| *v >= 0.0), "{what}: {}", p.diagonal().min());
    let least = least_eigenvalue(scaled(p, p));
    prop_assert!(!definite || least > -DEFINITE, "{what}: eigenvalue {least:e}");
    Ok(())
}

/// A property of every filter of the library.
trait Property {
    fn of<F: Filter<Dynamics = Strapdown>>(draw: Draw) -> Result<(), TestCaseError>;
}

struct Visit<P>(Draw, core::marker::PhantomData<P>);

impl<P: Property> FilterVisitor for Visit<P> {
    type Output = Result<(), TestCaseError>;

    fn visit<F: Filter<Dynamics = Strapdown, Shape: sinscal::Sizes>>(self) -> Self::Output {
        P::of::<F>(self.0)
    }
}

fn every_filter<P: Property>(draw: Draw) -> Result<(), TestCaseError> {
    // another one for each case
    let filter = &FILTERS[draw.seed as usize % FILTERS.len()];
    visit_filter(filter.name, Visit::<P>(draw, core::marker::PhantomData)).expect("a filter of the list")
}

struct StaysSound;

impl StaysSound {
    fn in_form<F: Filter<Dynamics = Strapdown>, C: Form>(
        draw: Draw,
        definite: bool,
    ) -> Result<(), TestCaseError> {
        let mut case = Case::<F>::new(draw);
        let mut kalman = Kalman::<F, f64, C>::new(&case.priors());
        for _ in 0..draw.cycles {
            case.predict(&mut [&mut kalman]);
            let before = dense(&kalman);
            sound(&before, "predicted", definite)?;
            let (at, residuals) = (point(&mut case.numbers), case.residuals());
            let found = kalman.update(&at, &signals(case.time), residuals, None);
            if !definite && found.is_err() {
                // it broke down, and said so
                return Ok(());
            }
            prop_assert!(found.is_ok_and(|found| found.nis.is_finite() && found.nis >= 0.0), "{found:?}");
            let after = dense(&kalman);
            sound(&after, "updated", definite)?;
            if !definite {
                continue;
            }
            // what was measured is not forgotten: no combination of states is known less
            let least = least_eigenvalue(scaled(&(&before - &after), &before));
            prop_assert!(least > -DEFINITE, "information was lost: {least:e}");
        }
        Ok(())
    }
}

impl Property for StaysSound {
    fn of<F: Filter<Dynamics = Strapdown>>(draw: Draw) -> Result<(), TestCaseError> {
        Self::in_form::<F, Conventional>(draw, !draw.extreme())?;
        Self::in_form::<F, Ud>(draw, true)
    }
}

struct FormsAgree;

impl Property for FormsAgree {
    fn of<F: Filter<Dynamics = Strapdown>>(draw: Draw) -> Result<(), TestCaseError> {
        let run = |conventional: bool| {
            fn cycles<F: Filter<Dynamics = Strapdown>, C: Form>(
                draw: Draw,
            ) -> Option<(DMatrix<f64>, DVector<f64>)> {
                let mut case = Case::<F>::new(draw);
                let mut kalman = Kalman::<F, f64, C>::new(&case.priors());
                for _ in 0..draw.cycles {
                    case.predict(&mut [&mut kalman]);
                    let (at, residuals) = (point(&mut case.numbers), case.residuals());
                    kalman.update(&at, &signals(case.time), residuals, None).ok()?;
                }
                let x = DVector::from_fn(F::Shape::STATES, |i, _| kalman.x()[i]);
                Some((dense(&kalman), x))
            }
            if conventional { cycles::<F, Conventional>(draw) } else { cycles::<F, Ud>(draw) }
        };
        let (Some((p, x)), Some((q, y))) = (run(true), run(false)) else {
            return Err(TestCaseError::fail("the innovations were not positive definite"));
        };
        let apart = scaled(&(&p - &q), &q).amax();
        prop_assert!(apart < FORMS, "covariances are {apart:e} apart");
        for i in 0..x.len() {
            let sigma = q[(i, i)].sqrt();
            prop_assert!((x[i] - y[i]).abs() <= FORMS * sigma + 1e-30, "state {i}: {} and {}", x[i], y[i]);
        }
        Ok(())
    }
}

/// So far may the two forms be apart in units of the standard deviations; 2000 cases came to 5e-9.
const FORMS: f64 = 1e-7;

struct OrderDoesNotMatter;

impl Property for OrderDoesNotMatter {
    fn of<F: Filter<Dynamics = Strapdown>>(draw: Draw) -> Result<(), TestCaseError> {
        let mut case = Case::<F>::new(draw);
        let mut start = Kalman::<F, f64, Ud>::new(&case.priors());
        case.predict(&mut [&mut start]);
        let (at, now, residuals) = (point(&mut case.numbers), signals(case.time), case.residuals());
        let groups = F::MEASURES.len();
        let run = |order: &[&[usize]]| {
            let mut kalman = start.clone();
            for together in order {
                let mut part = residuals.clone();
                (0..groups).filter(|group| !together.contains(group)).for_each(|group| part.leave_out(group));
                kalman.update(&at, &now, part, None).ok()?;
            }
            Some((dense(&kalman), DVector::from_fn(F::Shape::STATES, |i, _| kalman.x()[i])))
        };
        let all: Vec<usize> = (0..groups).collect();
        let single: Vec<&[usize]> = all.chunks(1).collect();
        let reversed: Vec<&[usize]> = single.iter().rev().copied().collect();
        let Some((p, x)) = run(&[&all]) else { return Err(TestCaseError::fail("not positive definite")) };
        for order in [single, reversed] {
            let Some((q, y)) = run(&order) else { return Err(TestCaseError::fail("not positive definite")) };
            let apart = scaled(&(&p - &q), &p).amax();
            prop_assert!(apart < ROUNDING, "{order:?}: covariances are {apart:e} apart");
            for i in 0..x.len() {
                let bound = ROUNDING * p[(i, i)].sqrt() * (1.0 + residual_sigmas(&residuals));
                prop_assert!((x[i] - y[i]).abs() <= bound, "{order:?}, state {i}: {} and {}", x[i], y[i]);
            }
        }
        // a measurement made twice is one of half the variance
        let mut twice = start.clone();
        for _ in 0..2 {
            prop_assert!(twice.update(&at, &now, residuals.clone(), None).is_ok());
        }
        let mut halved = Residuals::default();
        for row in 0..F::Shape::ROWS {
            halved.set(row, residuals.values()[row], (0.5 * residuals.variances()[row]).sqrt());
        }
        let mut once = start.clone();
        prop_assert!(once.update(&at, &now, halved, None).is_ok());
        let apart = scaled(&(dense(&once) - dense(&twice)), &dense(&once)).amax();
        prop_assert!(apart < ROUNDING, "made twice: {apart:e}");
        Ok(())
    }
}

/// The largest residual in its standard deviations.
fn residual_sigmas<F: Filter>(residuals: &Residuals<F, f64>) -> f64 {
    (0..F::Shape::ROWS)
        .map(|row| residuals.values()[row].abs() / residuals.variances()[row].sqrt())
        .fold(0.0, f64::max)
}

/// A state that nothing couples keeps its variance to the bit; one that is known exactly and does not forget stays known.
struct UnseenStays;

impl Property for UnseenStays {
    fn of<F: Filter<Dynamics = Strapdown>>(draw: Draw) -> Result<(), TestCaseError> {
        let mut case = Case::<F>::new(draw);
        let sigmas = case.priors();
        let mut kalman = Kalman::<F, f64, Conventional>::new(&sigmas);
        let mut relaxing = Vec::new();
        calib_core::relaxations::<F, f64>(|state, _| relaxing.push(state));
        for _ in 0..draw.cycles {
            case.predict(&mut [&mut kalman]);
            // no channel is measured
            let nothing =
                kalman.update(&point(&mut case.numbers), &signals(case.time), Residuals::default(), None);
            prop_assert!(nothing.is_ok_and(|found| found.nis == 0.0 && found.degrees_of_freedom == 0));
        }
        for i in (F::Shape::CORE..F::Shape::STATES).filter(|i| !relaxing.contains(i)) {
            prop_assert_eq!(dense(&kalman)[(i, i)], sigmas[i] * sigmas[i], "state {}", i);
        }
        let residuals = case.residuals();
        prop_assert!(kalman.update(&point(&mut case.numbers), &signals(case.time), residuals, None).is_ok());
        for i in (F::Shape::CORE..F::Shape::STATES).filter(|i| sigmas[*i] == 0.0 && !relaxing.contains(i)) {
            prop_assert_eq!((kalman.sigma(i), kalman.x()[i]), (0.0, 0.0), "state {}", i);
        }
        Ok(())
    }
}

proptest! {
    #[test]
    fn covariance_stays_sound_and_information_grows(draw in draws()) {
        every_filter::<StaysSound>(draw)?;
    }

    #[test]
    fn forms_agree(draw in draws().prop_filter("sane priors", |draw| !draw.extreme())) {
        every_filter::<FormsAgree>(draw)?;
    }

    #[test]
    fn order_of_updates_does_not_matter(draw in draws()) {
        every_filter::<OrderDoesNotMatter>(draw)?;
    }

    #[test]
    fn what_is_not_seen_stays(draw in draws()) {
        every_filter::<UnseenStays>(draw)?;
    }
}
