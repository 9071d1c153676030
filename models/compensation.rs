//! Takes the modelled sensor errors out of raw increments, in real time.

use calib_core::{Array, Dynamics, Filter, Real, Vector};
use nalgebra::Vector3;

use crate::strapdown::Increments;
use crate::{OpenBlocks, Sample, Signals, Strapdown};

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
            open: self.open,
        };
        self.last_rate = rate;
        Strapdown::restrict::<F, f64>(&mut signals);
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
