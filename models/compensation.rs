//! Takes the modelled sensor errors out of raw increments, in real time.

use calib_core::{Array, Dynamics, Filter, Real, Vector, first_state};
use nalgebra::Vector3;

use crate::strapdown::{Increments, NavigationState};
use crate::{InnerLeverArm, OpenBlocks, Sample, Signals, Strapdown, earth};

/// The error model is evaluated at the true motion, which is what compensation is after: each round puts the result of
/// the one before in, the first that of the sample before. When a round moves the signals by less than this fraction of them,
/// what is left is smaller by another factor of the errors: 1e-3 for a good unit, 3 % for a MEMS unit.
const STILL: f64 = 1e-10;
/// There are at most so many rounds: MEMS errors then reach 1e-10 of the signal even at the first sample.
const ROUNDS: usize = 6;

/// The specific force in n is smoothed over this time before its change is taken, s: as short as differences of single samples allow
/// that carry white noise, since a change is seen so much late.
const SMOOTHING: f64 = 0.01;

/// Follows the environment along a log and compensates each sample with filter `F`'s parameters.
///
/// Temperature and dither readings are held until the next one arrives; before the first, the temperature is the
/// reference temperature and nothing dithers.
#[derive(Clone, Copy, Debug)]
pub struct Compensator {
    reference_temperature: f64,
    start: f64,
    temperature: Held,
    gyro_temperature: Held,
    dither: Vector3<f64>,
    open: OpenBlocks,
    last_rate: Vector3<f64>,
    /// Smoothed specific force as read, turned along with the body: constant where it is constant in n. `None` where no block asks for
    /// its change.
    smooth_force: Option<Vector3<f64>>,
    /// Errors of rate and force at the last sample.
    last_error: (Vector3<f64>, Vector3<f64>),
    /// Where the unit stands, and what the filter asks of it.
    stands: Option<NavigationState<f64>>,
    asks: Asks,
}

/// What the errors of a filter depend on beside its sensors.
#[derive(Clone, Copy, Debug, Default)]
struct Asks {
    /// The site.
    site: bool,
    /// What the estimates say of temperature and dither.
    estimates: bool,
}

/// A vector of readings that arrive now and then, with their rate of change between the last two.
#[derive(Clone, Copy, Debug)]
struct Held {
    value: Vector3<f64>,
    rate: Vector3<f64>,
    since: Vector3<f64>,
}

impl Held {
    fn new(value: f64) -> Self {
        Self { value: Vector3::repeat(value), rate: Vector3::zeros(), since: Vector3::repeat(f64::NAN) }
    }

    fn read(&mut self, time: f64, reading: &Vector3<f64>) {
        for i in 0..3 {
            if !reading[i].is_nan() {
                let dt = time - self.since[i];
                if dt > 0.0 {
                    self.rate[i] = (reading[i] - self.value[i]) / dt;
                }
                self.value[i] = reading[i];
                self.since[i] = time;
            }
        }
    }

    fn has_read(&self) -> bool {
        self.since.iter().any(|t| !t.is_nan())
    }
}

impl Compensator {
    /// Temperature effects vanish at `reference_temperature`, degC.
    pub fn new(reference_temperature: f64) -> Self {
        Self {
            reference_temperature,
            start: f64::NAN,
            temperature: Held::new(reference_temperature),
            gyro_temperature: Held::new(reference_temperature),
            dither: Vector3::zeros(),
            open: OpenBlocks::NONE,
            last_rate: Vector3::repeat(f64::NAN),
            smooth_force: None,
            last_error: (Vector3::zeros(), Vector3::zeros()),
            stands: None,
            asks: Asks::default(),
        }
    }

    /// Takes down where the unit stands, for errors that the site makes; without, these are zero.
    #[inline]
    pub fn stand(&mut self, navigation: &NavigationState<f64>) {
        // what is asked is known from the first sample on
        if self.stands.is_none() || self.asks.site {
            self.stands = Some(*navigation);
        }
    }

    /// The same for a filter that `blocks` have joined at run time.
    #[must_use]
    pub fn with_open(self, blocks: OpenBlocks) -> Self {
        Self { open: blocks, ..self }
    }

    /// Takes in the slow readings of a sample.
    pub fn read(&mut self, sample: &Sample) {
        if self.start.is_nan() {
            self.start = sample.time;
        }
        self.temperature.read(sample.time, &sample.temperature);
        self.gyro_temperature.read(sample.time, &sample.gyro_temperature);
        for i in 0..3 {
            if !sample.dither[i].is_nan() {
                self.dither[i] = sample.dither[i];
            }
        }
    }

    /// Compensates the increments of a sample that took `dt` seconds, after [`read`](Self::read). Returns them with the
    /// signals at which filter `F`'s Jacobians are to be evaluated; of the change of the specific force only what turning does where no
    /// block of `F` depends on more.
    pub fn compensate<F: Filter<Dynamics = Strapdown>>(
        &mut self,
        sample: &Sample,
        dt: f64,
        parameters: &Vector<F, f64>,
    ) -> (Increments<f64>, Signals<f64>) {
        let rate = sample.dtheta / dt;
        let force = sample.dvel / dt;
        let gyro_temperature = if self.gyro_temperature.has_read() {
            self.gyro_temperature.value
        } else {
            self.temperature.value
        };
        let dither = self.dither.component_mul(&self.dither) * 0.5;
        let first = self.last_rate.x.is_nan();
        let before = if first { rate } else { self.last_rate };
        let mut signals = Signals {
            rate,
            angular_acceleration: (rate - before) / dt,
            force,
            force_rate: Vector3::zeros(),
            temperature: self.temperature.value.add_scalar(-self.reference_temperature),
            temperature_rate: self.temperature.rate,
            gyro_temperature: gyro_temperature.add_scalar(-self.reference_temperature),
            dither,
            coupled_dither: if self.open.couples_dither() { dither } else { Vector3::zeros() },
            time: sample.time - self.start,
            gyro_temperature_rate: if self.gyro_temperature.has_read() {
                self.gyro_temperature.rate
            } else {
                self.temperature.rate
            },
            open: self.open,
            ..Signals::default()
        };
        self.last_rate = rate;
        Strapdown::restrict::<F, f64>(&mut signals);
        if first {
            self.asks = Asks::of::<F>(&signals);
        }
        if let Some(navigation) = self.stands.as_ref().filter(|_| self.asks.site) {
            stand_on(&mut signals, navigation);
        }
        if self.asks.estimates {
            take_estimates::<F>(&mut signals, parameters);
        }
        let change_n = self.follow(&force, &((rate + before) * (0.5 * dt)), dt);
        if first && asks_for_change::<F>(&signals) {
            self.smooth_force = Some(force);
        }
        let mut error = self.last_error;
        let (still_rate, still_force) = (STILL * rate.amax(), STILL * force.amax());
        for _ in 0..ROUNDS {
            signals.rate = rate - error.0;
            signals.force = force - error.1;
            signals.force_rate = change_n + signals.force.cross(&signals.rate);
            let before = error;
            error = input_errors::<F, f64>(&signals, parameters);
            if (error.0 - before.0).amax() <= still_rate && (error.1 - before.1).amax() <= still_force {
                break;
            }
        }
        signals.rate = rate - error.0;
        signals.force = force - error.1;
        self.last_error = error;
        (Increments { dtheta: signals.rate * dt, dvel: signals.force * dt }, signals)
    }
}

/// What takes the errors out of one sample after the other.
#[cfg(feature = "std")]
pub type Corrector = Box<dyn FnMut(&Sample) -> Increments<f64> + Send>;

/// Takes the errors that `parameters` of filter `F` make out of the samples of a log, in their order.
#[cfg(feature = "std")]
pub fn corrector_of<F: Filter<Dynamics = Strapdown>>(
    setup: &crate::Setup,
    parameters: &Vector<F, f64>,
) -> Corrector {
    let mut compensator = Compensator::new(setup.reference_temperature).with_open(setup.open);
    let (interval, parameters) = (1.0 / setup.rate, parameters.clone());
    let mut last: Option<f64> = None;
    Box::new(move |sample| {
        let step = last.replace(sample.time).map_or(interval, |last| sample.time - last);
        compensator.read(sample);
        compensator.compensate::<F>(sample, step, &parameters).0
    })
}

impl Compensator {
    /// Change of the specific force in n, m/s^3, along the axes of b, smoothed; `turn` has brought the body from the middle of the last
    /// interval to that of this one.
    ///
    /// It is taken from the readings as they are. Their errors count as little as the delay is short; what has been compensated
    /// with the delay would feed its own noise back.
    #[inline]
    fn follow(&mut self, force: &Vector3<f64>, turn: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        let Some(smooth) = &mut self.smooth_force else { return Vector3::zeros() };
        let carried = *smooth - turn.cross(&(*smooth - turn.cross(smooth) * 0.5));
        let change = (force - carried) / (SMOOTHING + dt);
        *smooth = carried + change * dt;
        change
    }
}

impl Asks {
    /// What is not a number in the errors where these are none.
    fn of<F: Filter<Dynamics = Strapdown>>(signals: &Signals<f64>) -> Self {
        let (unknown, nan) = (Vector3::repeat(f64::NAN), f64::NAN);
        let asks = |signals: &Signals<f64>| {
            let mut asks = false;
            F::input_jacobian(signals, &mut |_, _, value: f64| asks |= value.is_nan());
            asks
        };
        Self {
            site: asks(&Signals {
                up: unknown,
                earth_rate: unknown,
                earth_turn: unknown,
                gravity: nan,
                gravity_by_latitude: nan,
                gravity_by_height: nan,
                ..*signals
            }),
            estimates: asks(&Signals {
                temperature_slope: unknown,
                gyro_temperature_slope: unknown,
                arms: unknown,
                ..*signals
            }),
        }
    }
}

/// What the site does, along the axes of the body; few filters ask.
#[cold]
#[inline(never)]
fn stand_on(signals: &mut Signals<f64>, navigation: &NavigationState<f64>) {
    let NavigationState { attitude, latitude, height, .. } = navigation;
    let (latitude, height) = (*latitude, *height);
    let to_body = attitude.inverse();
    let slope = |of: &dyn Fn(f64) -> f64, step: f64| (of(step) - of(-step)) / (2.0 * step);
    signals.up = to_body * Vector3::z();
    signals.earth_rate = to_body * earth::rotation_n(latitude);
    // further north the Earth's rate turns about east
    signals.earth_turn = (to_body * Vector3::x()).cross(&signals.earth_rate);
    signals.gravity = earth::gravity(latitude, height);
    signals.gravity_by_latitude = slope(&|step| earth::gravity(latitude + step, height), 1e-4);
    signals.gravity_by_height = slope(&|step| earth::gravity(latitude, height + step), 10.0);
}

/// What the estimates say of temperature and dither; few filters ask.
#[cold]
#[inline(never)]
fn take_estimates<F: Filter<Dynamics = Strapdown>>(signals: &mut Signals<f64>, parameters: &Vector<F, f64>) {
    let warm = Signals {
        temperature: signals.temperature.add_scalar(1.0),
        gyro_temperature: signals.gyro_temperature.add_scalar(1.0),
        ..*signals
    };
    let (cold, warm) =
        (input_errors::<F, f64>(signals, parameters), input_errors::<F, f64>(&warm, parameters));
    signals.gyro_temperature_slope = warm.0 - cold.0;
    signals.temperature_slope = warm.1 - cold.1;
    if let Some(i) = first_state::<F, InnerLeverArm>() {
        signals.arms = Vector3::new(parameters[i], parameters[i + 1], parameters[i + 2]);
    }
}

/// Whether a Jacobian of `F` depends on the change of the specific force: few do, and it takes time at each sample.
fn asks_for_change<F: Filter<Dynamics = Strapdown>>(signals: &Signals<f64>) -> bool {
    let unknown = Signals { force_rate: Vector3::repeat(f64::NAN), ..*signals };
    let mut asks = false;
    F::input_jacobian(&unknown, &mut |_, _, value: f64| asks |= value.is_nan());
    asks
}

/// Errors of angular rate (rad/s) and specific force (m/s^2) that `parameters` cause under `signals`, in b.
#[inline]
pub fn input_errors<F: Filter<Dynamics = Strapdown>, T: Real>(
    signals: &Signals<T>,
    parameters: &Vector<F, T>,
) -> (Vector3<T>, Vector3<T>) {
    let parameters = parameters.as_slice();
    let mut error = [T::zero(); 6];
    F::input_jacobian(signals, &mut |input, state, value| error[input] += value * parameters[state]);
    let [a, b, c, d, e, f] = error;
    (Vector3::new(a, b, c), Vector3::new(d, e, f))
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::Site;

    /// What the site does against differences over latitude and height.
    #[test]
    fn the_site_makes_what_its_formulas_say() {
        let site = Site { latitude: 0.56, longitude: 2.07, height: 20.0 };
        let attitude = UnitQuaternion::from_euler_angles(0.3, -0.8, 2.1);
        let navigation = NavigationState::at_rest(&site, attitude);
        let mut signals = Signals::default();
        stand_on(&mut signals, &navigation);
        let step = 1e-5;
        let rate = |by: f64| attitude.inverse() * earth::rotation_n(site.latitude + by);
        let turn = (rate(step) - rate(-step)) / (2.0 * step);
        assert!((signals.earth_turn - turn).norm() < 1e-9 * turn.norm(), "{} {turn}", signals.earth_turn);
        assert!((signals.earth_rate - rate(0.0)).norm() < 1e-18);
        assert!((signals.up - attitude.inverse() * Vector3::z()).norm() < 1e-15);
        let gravity = |by: f64| earth::gravity(site.latitude + by, site.height);
        let slope = (gravity(step) - gravity(-step)) / (2.0 * step);
        assert!((signals.gravity_by_latitude - slope).abs() < 1e-6 * slope.abs());
        let by_height = (earth::gravity(site.latitude, 30.0) - earth::gravity(site.latitude, 10.0)) / 20.0;
        assert!((signals.gravity_by_height - by_height).abs() < 1e-6 * by_height.abs());
    }
}
