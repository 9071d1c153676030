//! What happens when the reference speaks: residuals, gate, update.

use calib_core::{Array, CoreVector, Dynamics, Filter, Form, MeasurementVector, Residuals, Shape};
use nalgebra::{ComplexField, Rotation3, Vector3};

use super::{Calibration, Turned};
use crate::gate::Verdict;
use crate::measurements::channel;
use crate::outcome::{Diverged, Update};
use crate::{Event, Missed, Observer, Point, Reference, Refusal, Sample, Signals, Strapdown};

/// A rate carried on to the end of its interval is as noisy as the mean over so much of it: the squares of 3/2 and 1/2 make 5/2.
const CARRIED_ON: f64 = 0.4;

/// The leading state whose error a channel shows first of all.
fn seen_state(channel: usize) -> Option<usize> {
    match channel {
        0..6 => Some(channel + 3),
        6..9 => Some(channel - 6),
        _ => None,
    }
}

impl<F: Filter<Dynamics = Strapdown>, C: Form> Calibration<F, C> {
    pub(super) fn update(
        &mut self,
        sample: &Sample,
        signals: &Signals<f64>,
        observer: &mut impl Observer<F>,
    ) -> Result<Option<Update>, Diverged> {
        let at = self.point(self.navigation.c_bn(), self.navigation.attitude * signals.force, &signals.rate);
        let mut residuals = self.residuals(&sample.reference, &at);
        if residuals.is_empty() {
            return Ok(None);
        }
        // half a sample of slack, so that rounding of the time stamps does not skip a reading
        self.open_missed(observer);
        self.next_update = sample.time + 1.0 / self.setup.update_rate - 0.5 / self.setup.rate;
        self.turned = Turned::NOTHING;
        let repeated = self.repeats(&sample.reference, &mut residuals);
        self.statistics.repeated += repeated.count_ones() as usize;
        let diverged = |channel| Diverged { time: sample.time, channel };
        let rejected = self.judge(&at, signals, &mut residuals, observer).map_err(diverged)?;
        for (refused, why) in [(repeated, Refusal::Repeated), (rejected, Refusal::Outlier)] {
            for (measured, info) in F::MEASURES.iter().enumerate() {
                if refused & 1 << measured != 0 {
                    observer.observe::<C>(Event::Refused { time: sample.time, group: info.name, why });
                }
            }
        }
        self.statistics.rejected += rejected.count_ones() as usize;
        if residuals.is_empty() {
            return Ok(None);
        }
        observer.observe::<C>(Event::Measured { time: sample.time, at: &at, signals, residuals: &residuals });
        let before = self.kalman.x().clone();
        let all = |_| diverged("the reference");
        if let Some(pilot) = &mut self.pilot {
            pilot.update(&at, signals, residuals.clone(), None).map_err(all)?;
        }
        let found = self.kalman.update(&at, signals, residuals, None).map_err(all)?;
        if !found.nis.is_finite() || !self.kalman.x().as_slice().iter().all(|x| x.is_finite()) {
            return Err(diverged("the reference"));
        }
        let mut change = self.kalman.x().clone();
        for i in 0..F::Shape::STATES {
            change[i] -= before[i];
        }
        self.feed_back(self.pilot.is_none(), observer);
        let navigation = &self.navigation();
        observer.observe::<C>(Event::Updated { time: sample.time, change: &change, navigation });
        self.statistics.updates += 1;
        self.statistics.degrees_of_freedom += found.degrees_of_freedom;
        self.statistics.nis += found.nis;
        self.statistics.log_likelihood += found.log_likelihood;
        Ok(Some(Update {
            time: sample.time,
            nis: found.nis,
            degrees_of_freedom: found.degrees_of_freedom,
            rejected,
        }))
    }

    /// Takes readings that are no news out of the residuals; as bits by measurement.
    fn repeats(&mut self, reference: &Reference, residuals: &mut Residuals<F, f64>) -> u32 {
        let mut repeated = 0;
        for measured in 0..F::MEASURES.len() {
            let Some(reading) = self.readings.read(measured, reference) else { continue };
            if self.gate.repeats(measured, &reading) {
                repeated |= 1 << measured;
                residuals.leave_out(measured);
            }
        }
        repeated
    }

    /// Takes out of the residuals what the gate refuses; as bits by measurement.
    fn judge(
        &mut self,
        at: &Point<f64>,
        signals: &Signals<f64>,
        residuals: &mut Residuals<F, f64>,
        observer: &mut impl Observer<F>,
    ) -> Result<u32, &'static str> {
        let mut rejected = 0;
        let mut reopened = 0;
        let mut lost = None;
        let mut next = 0;
        let gate = &mut self.gate;
        let sound = self.kalman.innovations(at, signals, residuals, |measured, nis| {
            next = measured + 1;
            if !nis.is_finite() {
                lost = lost.or(Some(F::MEASURES[measured].name));
            }
            match gate.judge(measured, nis) {
                Verdict::Use => {}
                Verdict::Refuse => rejected |= 1 << measured,
                Verdict::Reopen => reopened |= 1 << measured,
            }
        });
        if sound.is_err() || lost.is_some() {
            // the measurement that was not reached is the one whose covariance broke down
            let broken = (next..F::MEASURES.len()).find(|k| F::rows(*k).any(|row| residuals.is_present(row)));
            return Err(lost.or(broken.map(|k| F::MEASURES[k].name)).unwrap_or("the reference"));
        }
        for measured in 0..F::MEASURES.len() {
            if rejected & 1 << measured != 0 {
                residuals.leave_out(measured);
            }
            if reopened & 1 << measured != 0 {
                self.statistics.reopened += 1;
                self.open(measured, at, observer);
            }
        }
        Ok(rejected)
    }

    /// Opens attitude and velocity by what the increments have missed.
    pub(super) fn open_missed(&mut self, observer: &mut impl Observer<F>) {
        let missed = core::mem::take(&mut self.missed);
        if missed != Missed::default() {
            let mut variances = F::Shape::core_vector(0.0);
            for axis in 0..3 {
                variances[axis] = missed.attitude * missed.attitude;
                variances[3 + axis] = missed.velocity * missed.velocity;
            }
            self.widen(&variances, observer);
        }
    }

    /// Opens the leading states that a measurement sees as wide as they were at the first sample.
    fn open(&mut self, measured: usize, at: &Point<f64>, observer: &mut impl Observer<F>) {
        let mut variances = F::Shape::core_vector(0.0);
        let (rows, prior) = (F::rows(measured), &self.prior);
        F::residual_jacobian(at, &mut |row, channel, slope| {
            if let Some(state) = seen_state(channel).filter(|_| rows.contains(&row) && slope != 0.0) {
                variances[state] = prior[state] * prior[state];
            }
        });
        self.widen(&variances, observer);
    }

    fn widen(&mut self, variances: &CoreVector<F, f64>, observer: &mut impl Observer<F>) {
        self.kalman.widen(variances);
        if let Some(pilot) = &mut self.pilot {
            pilot.widen(variances);
        }
        observer.observe::<C>(Event::Widened(variances));
        observer.observe(Event::Moved(&self.kalman));
    }

    /// Residuals `computed - read`, by the estimates of the blocks that act on the measurement.
    pub(super) fn residuals(&self, reference: &Reference, at: &Point<f64>) -> Residuals<F, f64> {
        let seen = self.seen(reference, at);
        let noise = self.rate_noise(&seen);
        let mut residuals = Residuals::<F, f64>::default();
        for measured in 0..F::MEASURES.len() {
            let Some(reading) = self.readings.read(measured, reference) else { continue };
            let first = F::rows(measured).start;
            let count = F::MEASURES[measured].columns.len();
            F::residual(measured, &seen, &reading[..count], &mut |row, z| {
                let (sigma, noise) = (self.readings.sigma(measured, row, reference), noise[first + row]);
                let sigma = if noise > 0.0 { ComplexField::sqrt(sigma * sigma + noise) } else { sigma };
                residuals.set(first + row, z, sigma);
            });
        }
        residuals
    }

    /// Variances of the rows by the random walk of the gyros, which is in the rate as it is seen.
    fn rate_noise(&self, seen: &Point<f64>) -> MeasurementVector<F, f64> {
        let time = if self.turned.time > 0.0 { self.turned.time } else { CARRIED_ON / self.setup.rate };
        let mut noise = F::Shape::measurement(0.0);
        F::residual_jacobian(seen, &mut |row, channel, slope| {
            if channel >= channel::RATE {
                noise[row] +=
                    slope * slope * self.setup.angle_random_walk * self.setup.angle_random_walk / time;
            }
        });
        noise
    }

    /// What the reference should see: the point `at` with the effects of the blocks that act on channels, and with the rate since
    /// the last update where it is measured.
    fn seen(&self, reference: &Reference, at: &Point<f64>) -> Point<f64> {
        let mut expected = [0.0; Strapdown::CHANNELS];
        // the direct effect of a block's estimate is minus that of its remaining error; the first guess of the lever arm
        // is no state and stands in `point_velocity` and `point_position`
        F::measurement_jacobian(at, &mut |channel, state, value| {
            expected[channel] -= value * self.parameters[state];
        });
        let expected = |first: usize| Vector3::new(expected[first], expected[first + 1], expected[first + 2]);
        let guess = at.c_bn * self.setup.outer_lever;
        let guess_velocity = at.c_bn * at.rate_eb.cross(&self.setup.outer_lever);
        let turn = expected(channel::ATTITUDE);
        let rate_eb = match &reference.rate {
            Some(reading) if self.turned.time > 0.0 => reading + self.turned.angle / self.turned.time,
            _ => at.rate_eb,
        };
        Point {
            point_velocity: at.velocity + guess_velocity + expected(channel::VELOCITY),
            point_position: at.position + guess + expected(channel::POSITION),
            c_bn: if turn == Vector3::zeros() {
                at.c_bn
            } else {
                // C_pred = (I - [z x]) C
                Rotation3::from_scaled_axis(-turn).into_inner() * at.c_bn
            },
            rate_eb: rate_eb + expected(channel::RATE),
            ..*at
        }
    }
}
