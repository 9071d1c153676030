//! What happens when the reference speaks: residuals, gate, update.

use calib_core::{Array, Dynamics, Filter, Form, Residuals, Shape};
use nalgebra::Vector3;

use super::Calibration;
use crate::gate::Verdict;
use crate::outcome::{Diverged, Update};
use crate::{Event, Observer, Point, Reference, Refusal, Sample, Signals, Strapdown};

/// First of the three leading states that each channel group measures: velocity, position, attitude.
const MEASURED: [usize; 3] = [3, 6, 0];

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
        self.next_update = sample.time + 1.0 / self.setup.update_rate - 0.5 / self.setup.rate;
        let mut repeated = self.gate.repeats(&sample.reference);
        for group in 0..Strapdown::CHANNELS.len() {
            match F::MEASURES.iter().position(|measured| *measured == group) {
                Some(measured) if repeated & 1 << group != 0 => residuals.leave_out(measured),
                Some(_) => {}
                None => repeated &= !(1 << group),
            }
        }
        self.statistics.repeated += repeated.count_ones() as usize;
        let diverged = |channel| Diverged { time: sample.time, channel };
        let rejected = self.judge(&at, signals, &mut residuals, observer).map_err(diverged)?;
        for (groups, why) in [(repeated, Refusal::Repeated), (rejected, Refusal::Outlier)] {
            for (bit, group) in Strapdown::CHANNELS.iter().enumerate() {
                if groups & 1 << bit != 0 {
                    observer.observe::<C>(Event::Refused { time: sample.time, group: group.name, why });
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

    /// Takes out of the residuals what the gate refuses, as bits of the dynamics' channel groups.
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
            let group = F::MEASURES[measured];
            if !nis.is_finite() {
                lost = lost.or(Some(Strapdown::CHANNELS[group].name));
            }
            match gate.judge(group, nis) {
                Verdict::Use => {}
                Verdict::Refuse => rejected |= 1 << group,
                Verdict::Reopen => reopened |= 1 << group,
            }
        });
        if sound.is_err() || lost.is_some() {
            // the group that was not reached is the one whose covariance broke down
            let mut rest = F::MEASURES[next..].iter().map(|group| &Strapdown::CHANNELS[*group]);
            let broken = rest.find(|group| F::row(group.first).is_some_and(|row| residuals.is_present(row)));
            return Err(lost.or(broken.map(|group| group.name)).unwrap_or("the reference"));
        }
        for (measured, group) in F::MEASURES.iter().enumerate() {
            if rejected & 1 << group != 0 {
                residuals.leave_out(measured);
            }
            if reopened & 1 << group != 0 {
                self.statistics.reopened += 1;
                self.open(MEASURED[*group], observer);
            }
        }
        Ok(rejected)
    }

    /// Opens three leading states as wide as they were at the first sample.
    fn open(&mut self, first: usize, observer: &mut impl Observer<F>) {
        let mut variances = F::Shape::core_vector(0.0);
        for i in first..first + 3 {
            variances[i] = self.prior[i] * self.prior[i];
        }
        self.kalman.widen(&variances);
        if let Some(pilot) = &mut self.pilot {
            pilot.widen(&variances);
        }
        observer.observe::<C>(Event::Widened(&variances));
        observer.observe(Event::Moved(&self.kalman));
    }

    /// Residuals `computed - reference`, by the estimates of the blocks that act on the measurement.
    fn residuals(&self, reference: &Reference, at: &Point<f64>) -> Residuals<F, f64> {
        let mut expected = [0.0; 9];
        // the direct effect of a block's estimate is minus that of its remaining error; the first guess of the lever arm
        // is no state and stands in `point_velocity` and `point_position`
        F::measurement_jacobian(at, &mut |channel, state, value| {
            expected[channel] -= value * self.parameters[state];
        });
        let expected = |first: usize| Vector3::new(expected[first], expected[first + 1], expected[first + 2]);
        let mut residuals = Residuals::<F, f64>::default();
        let guess = at.c_bn * self.setup.outer_lever;
        let guess_velocity = at.c_bn * at.rate_eb.cross(&self.setup.outer_lever);
        let sigma = &self.setup.reference;
        let mut set = |first: usize, z: Vector3<f64>, sigma: f64| {
            for i in 0..3 {
                residuals.set(first + i, z[i], sigma);
            }
        };
        if let Some(velocity) = reference.velocity {
            set(0, at.velocity + guess_velocity + expected(0) - velocity, sigma.velocity);
        }
        if let Some(position) = reference.position {
            set(3, at.position + guess + expected(3) - position, sigma.position);
        }
        if let Some(attitude) = &reference.attitude {
            // C_hat = (I - [z x]) C_ref
            let z = -(self.navigation.attitude * attitude.inverse()).scaled_axis();
            set(6, z + expected(6), sigma.attitude);
        }
        residuals
    }
}

pub(super) fn has_reference(reference: &Reference) -> bool {
    reference.velocity.is_some() || reference.position.is_some() || reference.attitude.is_some()
}
