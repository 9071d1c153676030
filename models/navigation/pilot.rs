//! Navigating with a calibration whose filter is known by name only.

use std::boxed::Box;

use calib_core::{Filter, Vector};
use nalgebra::Vector3;

use super::{Alignment, Drift, FreeInertial, parameters_of};
use crate::{Diverged, FilterVisitor, Sample, Setup, StateInfo, Strapdown, visit_filter};

/// A calibration on its way through a log: first it aligns, then, once told to [`depart`](Self::depart), it navigates the log
/// from its first sample.
pub trait Pilot: Send {
    /// Name of the filter that the calibration belongs to.
    fn filter(&self) -> &'static str;

    /// Takes in the next sample. Returns the error of the observed point's position in n, m, where it was compared.
    ///
    /// # Errors
    /// When the alignment's filter has diverged.
    fn step(&mut self, sample: &Sample) -> Result<Option<Vector3<f64>>, Diverged>;

    /// Ends the alignment; the log begins again. `false` when nothing was there to align with.
    fn depart(&mut self) -> bool;

    /// The errors so far.
    fn drift(&self) -> Drift;
}

/// A pilot for the filter called `filter`, its parameters by name as in [`parameters_of`]; `None` when there is no such
/// filter.
pub fn pilot(
    filter: &str,
    setup: &Setup,
    value: impl FnMut(&StateInfo) -> Option<f64>,
) -> Option<Box<dyn Pilot>> {
    visit_filter(filter, Board { setup, value })
}

struct Board<'a, V> {
    setup: &'a Setup<'a>,
    value: V,
}

impl<V: FnMut(&StateInfo) -> Option<f64>> FilterVisitor for Board<'_, V> {
    type Output = Box<dyn Pilot>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        pilot_of::<F>(self.setup, &parameters_of::<F>(self.setup, self.value))
    }
}

/// A pilot for filter `F` with known `parameters`.
pub fn pilot_of<F: Filter<Dynamics = Strapdown>>(
    setup: &Setup,
    parameters: &Vector<F, f64>,
) -> Box<dyn Pilot> {
    Box::new(Aboard::<F> {
        alignment: Some(Alignment::new(setup, parameters)),
        run: FreeInertial::new(setup, parameters),
    })
}

struct Aboard<F: Filter<Dynamics = Strapdown>> {
    alignment: Option<Alignment<F>>,
    run: FreeInertial<F>,
}

impl<F: Filter<Dynamics = Strapdown>> Pilot for Aboard<F> {
    fn filter(&self) -> &'static str {
        F::NAME
    }

    fn step(&mut self, sample: &Sample) -> Result<Option<Vector3<f64>>, Diverged> {
        match &mut self.alignment {
            Some(alignment) => alignment.step(sample).map(|()| None),
            None => Ok(self.run.step(sample)),
        }
    }

    fn depart(&mut self) -> bool {
        let Some((time, solution)) = self.alignment.take().and_then(Alignment::finish) else { return false };
        self.run.depart(time, solution);
        true
    }

    fn drift(&self) -> Drift {
        *self.run.drift()
    }
}
