//! The closed-loop calibration run: navigation, sensitivities and filter over a log.

mod beginning;
mod estimates;
mod foresee;
mod known;
mod update;

use calib_core::{
    Conventional, CoreVector, Fade, Filter, Form, Kalman, Relaxation, Shape, StateInfo, Transition, Vector,
    first_state, relaxations,
};
use nalgebra::{Matrix3, Vector3};

pub(crate) use self::beginning::Beginning;
pub use self::known::Known;
use crate::compensation::Compensator;
use crate::gate::Gate;
use crate::measurements::{self, Measurement, Readings};
use crate::outcome::{Diverged, Statistics, Update};
use crate::strapdown::{Before, Increments, NavigationState};
use crate::{
    Event, InitialAttitude, Missed, Observer, OpenBlocks, OuterLeverArm, Point, Sample, Setup, SetupError,
    Signals, Strapdown, earth, probe,
};

/// The Jacobians of the sensor errors may be taken as constant while the body turns by less than this, rad.
const STEP_ANGLE: f64 = 0.02;
/// The leading dynamics move in steps of at most this length, s.
const STEP_TIME: f64 = 0.1;
/// Without a reference the covariance still moves at least this often, s.
const PREDICT_TIME: f64 = 1.0;
/// A closed-loop calibration with the declared filter `F`, its covariance in form `C`.
///
/// Navigation runs at the rate of the samples. Between updates the rows `[Phi Psi]` are accumulated; at the reference's
/// rate the covariance moves, the residuals `computed - reference` update it, and the navigation errors are fed back.
/// In the first pass the parameters are fed back too. A further pass ([`begin_pass`](Self::begin_pass)) linearises about
/// the parameters found, held fixed, and estimates the rest that remains: iterated to the end this is the
/// maximum of the posterior, prior included, whatever the number of passes. What steers the navigation in such a pass is
/// not the filter, which begins as ignorant as in the first and would take the initial tilt for accelerometer biases once
/// more, but a second one that takes the parameters for known.
pub struct Calibration<F: Filter<Dynamics = Strapdown>, C: Form = Conventional> {
    kalman: Kalman<F, f64, C>,
    transition: Transition<F, f64>,
    density: CoreVector<F, f64>,
    parameters: Vector<F, f64>,
    prior: Vector<F, f64>,
    considered: Vector<F, bool>,
    relaxing: Vector<F, Relaxation<f64>>,
    lever_at: Option<usize>,
    /// Steers the navigation of a further pass: the same filter without any doubt of the parameters.
    pilot: Option<Kalman<F, f64, Known>>,
    compensator: Compensator,
    navigation: NavigationState<f64>,
    before: Before<f64>,
    previous_rate: Vector3<f64>,
    time: Option<f64>,
    next_update: f64,
    step: Step,
    turned: Turned,
    /// Time that predictions have covered in this pass, s.
    covered: f64,
    /// What readings since the last update say was missed.
    missed: Missed,
    gate: Gate,
    readings: Readings<F>,
    /// Where the error model was last linearised.
    at: Point<f64>,
    statistics: Statistics,
    setup: Scalars,
}

/// The part of a [`Setup`] that outlives it.
#[derive(Clone, Copy)]
struct Scalars {
    rate: f64,
    site: crate::Site,
    initial: crate::InitialAttitude,
    velocity: Vector3<f64>,
    /// Whether a reading of the velocity is better than what is known at the beginning.
    reads_velocity: bool,
    update_rate: f64,
    angle_random_walk: f64,
    reference_temperature: f64,
    outer_lever: Vector3<f64>,
    open: OpenBlocks,
}

/// What the samples since the last step of the leading dynamics add up to.
#[derive(Clone, Copy)]
struct Step {
    elapsed: f64,
    turned: f64,
    velocity_n: Vector3<f64>,
}

impl Step {
    const EMPTY: Self = Self { elapsed: 0.0, turned: 0.0, velocity_n: Vector3::new(0.0, 0.0, 0.0) };
}

/// By how much more than the readings of its rate say the body has turned, over the samples that have such readings.
#[derive(Clone, Copy)]
struct Turned {
    angle: Vector3<f64>,
    time: f64,
}

impl Turned {
    const NOTHING: Self = Self { angle: Vector3::new(0.0, 0.0, 0.0), time: 0.0 };
}

/// A filter with priors that considers some states.
fn considering<F: Filter, C: Form>(
    prior: &Vector<F, f64>,
    considered: &Vector<F, bool>,
) -> Kalman<F, f64, C> {
    let mut kalman = Kalman::new(prior);
    (F::Shape::CORE..F::Shape::STATES).filter(|i| considered[*i]).for_each(|i| kalman.consider(i));
    kalman
}

impl<F: Filter<Dynamics = Strapdown>, C: Form> Calibration<F, C> {
    /// A run that has seen nothing yet, with the priors of the setup and, where it names none, of the blocks.
    ///
    /// # Errors
    /// When the setup is wrong, or a block contradicts itself ([`Setup::check`]).
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        setup.check::<F>()?;
        Ok(Self::with_prior(setup, |_, _, sigma| sigma))
    }

    /// A run whose prior standard deviations go through `adjust(state, info, sigma)`; a parameter with zero takes no
    /// part. What the setup names and the filter does not have is passed over: [`Setup::check`] finds it.
    ///
    /// # Panics
    /// When a block contradicts itself: the message is the [`Fault`](crate::Fault) that [`probe`](crate::probe()) returns.
    pub fn with_prior(setup: &Setup, mut adjust: impl FnMut(usize, &StateInfo, f64) -> f64) -> Self {
        Self::adjusted(setup, &mut adjust)
    }

    /// Compiled once, whatever adjusts the priors.
    fn adjusted(setup: &Setup, adjust: &mut dyn FnMut(usize, &StateInfo, f64) -> f64) -> Self {
        if let Err(fault) = probe::<F>() {
            panic!("{fault}");
        }
        let Beginning { prior, considered, relaxing } = Beginning::<F>::new(setup, adjust);
        let mut density = F::Shape::core_vector(0.0);
        for i in 0..F::Shape::CORE {
            density[i] = match i {
                0..3 => setup.noise.angle_random_walk,
                3..6 => setup.noise.velocity_random_walk,
                _ => 0.0,
            };
            density[i] *= density[i];
        }
        let scalars = Scalars {
            rate: setup.rate,
            site: setup.site,
            initial: setup.initial,
            velocity: setup.velocity.velocity,
            reads_velocity: setup.velocity.sigma > setup.sigma(&measurements::Velocity::INFO),
            update_rate: setup.update_rate,
            angle_random_walk: setup.noise.angle_random_walk,
            reference_temperature: setup.reference_temperature,
            outer_lever: setup.outer_lever,
            open: setup.open,
        };
        let mut navigation = NavigationState::at_rest(&setup.site, setup.initial.attitude);
        navigation.velocity = setup.velocity.velocity;
        Self {
            kalman: considering(&prior, &considered),
            transition: Transition::new(),
            density,
            parameters: F::Shape::vector(0.0),
            prior,
            considered,
            relaxing,
            lever_at: first_state::<F, OuterLeverArm>(),
            pilot: None,
            compensator: Compensator::new(setup.reference_temperature).with_open(setup.open),
            navigation,
            before: Before::nothing(),
            previous_rate: Vector3::zeros(),
            time: None,
            next_update: f64::NEG_INFINITY,
            step: Step::EMPTY,
            turned: Turned::NOTHING,
            covered: 0.0,
            missed: Missed::default(),
            gate: Gate::new(F::MEASURES),
            readings: Readings::new(setup),
            at: Point::default(),
            statistics: Statistics::default(),
            setup: scalars,
        }
    }

    /// How the states relax, by state; nothing for those that are constant.
    pub fn relaxing(&self) -> &Vector<F, Relaxation<f64>> {
        &self.relaxing
    }

    /// Begins another pass over the same log, linearised about the parameters found so far; the prior stays what it was.
    pub fn begin_pass(&mut self) {
        self.begin_pass_about(&self.estimate());
    }

    /// Begins another pass over the same log, linearised about given `parameters`; the prior stays what it was.
    pub fn begin_pass_about(&mut self, parameters: &Vector<F, f64>) {
        for i in F::Shape::CORE..F::Shape::STATES {
            self.parameters[i] = parameters[i];
        }
        self.kalman = considering(&self.prior, &self.considered);
        for i in F::Shape::CORE..F::Shape::STATES {
            // a parameter state is truth - estimate, and the prior's mean of the truth is zero
            self.kalman.x_mut()[i] = -self.parameters[i];
        }
        self.pilot = Some(Kalman::new(&self.prior));
        self.transition.reset();
        self.compensator = Compensator::new(self.setup.reference_temperature).with_open(self.setup.open);
        self.navigation = NavigationState::at_rest(&self.setup.site, self.setup.initial.attitude);
        self.navigation.velocity = self.setup.velocity;
        self.before = Before::nothing();
        self.time = None;
        self.next_update = f64::NEG_INFINITY;
        self.step = Step::EMPTY;
        self.turned = Turned::NOTHING;
        self.covered = 0.0;
        self.missed = Missed::default();
        self.gate = self.gate.again();
        self.statistics = Statistics::default();
    }

    /// Begins another pass over the same log with the parameters taken as known: what remains is navigation with the
    /// reference's help, as in an alignment.
    pub fn begin_known(&mut self, parameters: &Vector<F, f64>) {
        for i in F::Shape::CORE..F::Shape::STATES {
            self.prior[i] = 0.0;
        }
        self.begin_pass_about(parameters);
        for i in F::Shape::CORE..F::Shape::STATES {
            self.kalman.x_mut()[i] = 0.0;
        }
        self.pilot = None;
    }

    /// Lets further passes begin with another attitude, and other standard deviations of it.
    pub fn restart(&mut self, initial: &InitialAttitude) {
        self.setup.initial = *initial;
        for (sigma, prior) in
            [initial.level_sigma, initial.level_sigma, initial.heading_sigma].iter().zip(0..)
        {
            self.prior[prior] = *sigma;
        }
    }

    /// How the readings of the reference were spread so far.
    pub fn gate(&self) -> Gate {
        self.gate
    }

    /// Judges the reference in the next pass by how its readings were spread in one of another filter over the same log.
    pub fn judge_as(&mut self, gate: Gate) {
        self.gate.adopt(&gate);
    }

    /// [`judge_as`](Self::judge_as) after the run of another filter.
    pub fn judge_after<G: Filter<Dynamics = Strapdown>, K: Form>(&mut self, before: &Calibration<G, K>) {
        self.judge_as(before.gate);
    }

    /// Takes in the next sample. Returns what the update found where there was one.
    ///
    /// # Errors
    /// When the filter has diverged; the run cannot go on.
    pub fn step(&mut self, sample: &Sample) -> Result<Option<Update>, Diverged> {
        self.step_observed(sample, &mut ())
    }

    /// [`step`](Self::step) with somebody watching.
    ///
    /// # Errors
    /// When the filter has diverged; the run cannot go on.
    pub fn step_observed(
        &mut self,
        sample: &Sample,
        observer: &mut impl Observer<F>,
    ) -> Result<Option<Update>, Diverged> {
        let dt = match self.time {
            Some(before) => sample.time - before,
            None => 1.0 / self.setup.rate,
        };
        self.compensator.read(sample);
        self.compensator.stand(&self.navigation);
        let (now, mut signals) = self.compensator.compensate::<F>(sample, dt, &self.parameters);
        let end_rate = if self.time.is_some() {
            // the mean rates of two intervals, carried on to the end of the second
            signals.rate + (signals.rate - self.previous_rate) * 0.5
        } else {
            signals.rate
        };
        let rests = sample.reference.is_rest();
        if self.time.is_some() {
            if rests {
                self.navigate(&now, &self.at_rest(&signals), dt);
            } else {
                self.navigate(&now, &signals, dt);
            }
        } else {
            self.begin(sample);
            self.before.follow(&now);
        }
        self.time = Some(sample.time);
        self.previous_rate = signals.rate;
        match &sample.reference.rate {
            Some(reading) => {
                let earth = earth::rotation_n(self.navigation.latitude);
                let rate_eb = signals.rate - self.navigation.c_bn().transpose() * earth;
                self.turned.angle += (rate_eb - reading) * dt;
                self.turned.time += dt;
            }
            None => self.turned = Turned::NOTHING,
        }

        self.missed = self.missed.or(sample.reference.missed);
        let wanted = sample.time >= self.next_update;
        let residuals_due = wanted && sample.reference.is_read();
        if !residuals_due && self.transition.elapsed() + self.step.elapsed < PREDICT_TIME {
            return Ok(None);
        }
        signals.rate = end_rate;
        if rests {
            signals = self.at_rest(&signals);
        }
        self.predict(observer);
        if !residuals_due {
            return Ok(None);
        }
        self.update(sample, &signals, observer)
    }

    /// The signals of a unit at rest, where errors are linearised: what its sensors read there is noise beside them, and a scale factor
    /// that multiplies noise seems to show in it.
    fn at_rest(&self, signals: &Signals<f64>) -> Signals<f64> {
        let NavigationState { latitude, height, .. } = self.navigation;
        let to_body = self.navigation.c_bn().transpose();
        let force = to_body * Vector3::z() * earth::gravity(latitude, height);
        Signals {
            rate: to_body * earth::rotation_n(latitude),
            angular_acceleration: Vector3::zeros(),
            force,
            force_rate: Vector3::zeros(),
            ..*signals
        }
    }

    /// The first sample says where the run begins; its attitude is the initial one.
    fn begin(&mut self, sample: &Sample) {
        if let Some(velocity) = sample.reference.velocity.filter(|_| self.setup.reads_velocity) {
            self.navigation.velocity = velocity;
        }
        if let Some(position) = sample.reference.position {
            let lever = self.lever();
            self.navigation.displace(&(position - self.navigation.attitude * lever));
        }
    }

    fn navigate(&mut self, now: &Increments<f64>, signals: &Signals<f64>, dt: f64) {
        // C_bn in the middle of the interval
        let c = self.navigation.c_bn();
        let middle = c + c * now.dtheta.cross_matrix() * 0.5;
        self.navigation.step(now, &mut self.before, dt);
        self.step.velocity_n += middle * now.dvel;
        self.step.elapsed += dt;
        let turn = now.dtheta.norm();
        self.step.turned += turn;
        self.statistics.largest_turn = self.statistics.largest_turn.max(turn);
        // how sensor errors enter depends on the attitude; the rest of the point is needed once a step
        self.at.c_bn = middle;
        self.transition.absorb(&self.at, signals, dt);
        if self.step.elapsed >= STEP_TIME || self.step.turned >= STEP_ANGLE {
            self.at = self.point(middle, self.step.velocity_n / self.step.elapsed, &signals.rate);
            self.transition.advance(&self.at, self.step.elapsed);
            self.step = Step::EMPTY;
        }
    }

    fn predict(&mut self, observer: &mut impl Observer<F>) {
        if self.step.elapsed > 0.0 {
            let at = self.point(
                self.navigation.c_bn(),
                self.step.velocity_n / self.step.elapsed,
                &self.previous_rate,
            );
            self.transition.advance(&at, self.step.elapsed);
            self.step = Step::EMPTY;
        }
        if self.transition.elapsed() == 0.0 {
            return;
        }
        let elapsed = self.transition.elapsed();
        self.covered += elapsed;
        self.kalman.predict_relaxing(&self.transition, &self.density, &self.relaxing);
        observer.observe::<C>(Event::Predicted { transition: &self.transition, density: &self.density });
        observer.observe(Event::Moved(&self.kalman));
        relaxations::<F, f64>(|state, _| {
            self.parameters[state] *= Fade::over(self.relaxing[state], state, elapsed).keep;
        });
        if let Some(pilot) = &mut self.pilot {
            pilot.predict_relaxing(&self.transition, &self.density, &self.relaxing);
        }
        self.transition.reset();
        self.feed_back(false, observer);
    }

    /// Puts the estimated navigation errors into the navigation solution, those of the pilot if there is one, and if
    /// asked the parameters into theirs.
    fn feed_back(&mut self, parameters: bool, observer: &mut impl Observer<F>) {
        let mut correction = F::Shape::vector(0.0);
        let last = if parameters { F::Shape::STATES } else { F::Shape::CORE };
        let steering = self.pilot.as_ref().map_or(self.kalman.x(), Kalman::x);
        for i in 0..last {
            correction[i] = steering[i];
        }
        for x in [Some(self.kalman.x_mut()), self.pilot.as_mut().map(Kalman::x_mut)].into_iter().flatten() {
            for i in 0..last {
                x[i] -= correction[i];
            }
        }
        let part =
            |first: usize| Vector3::new(correction[first], correction[first + 1], correction[first + 2]);
        self.navigation.correct(&part(0), &part(3), &part(6));
        for i in F::Shape::CORE..last {
            self.parameters[i] += correction[i];
        }
        observer.observe::<C>(Event::FedBack(&correction));
    }

    /// Current estimate of the outer lever arm, b, m.
    fn lever(&self) -> Vector3<f64> {
        match self.lever_at {
            Some(i) => {
                let p = &self.parameters;
                self.setup.outer_lever + Vector3::new(p[i], p[i + 1], p[i + 2])
            }
            None => self.setup.outer_lever,
        }
    }

    fn point(&self, c_bn: Matrix3<f64>, force_n: Vector3<f64>, rate: &Vector3<f64>) -> Point<f64> {
        let navigation = &self.navigation;
        let rate_eb = rate - c_bn.transpose() * earth::rotation_n(navigation.latitude);
        let lever = self.lever();
        let position = navigation.position(&self.setup.site);
        Point {
            c_bn,
            velocity: navigation.velocity,
            latitude: navigation.latitude,
            height: navigation.height,
            position,
            force_n,
            rate_eb,
            lever,
            point_velocity: navigation.velocity + c_bn * rate_eb.cross(&lever),
            point_acceleration: force_n
                - Vector3::z() * earth::gravity(navigation.latitude, navigation.height)
                + c_bn * rate_eb.cross(&rate_eb.cross(&lever)),
            point_position: position + c_bn * lever,
            open: self.setup.open,
        }
    }
}
