//! Free-inertial navigation of a log with calibrations applied.

use core::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;
use sinscal::navigation::{Drift, NAUTICAL_MILE, Pilot};
use sinscal::{Corrector, Diverged, Sample, Setup, StateInfo};

use crate::Error;
use crate::filter::AnyFilter;
use crate::samples::{Extent, Samples};

/// Points kept of the error over time.
const POINTS: usize = 4096;
/// A log that is shorter than the alignment by less than this is as long as it, s.
const SLACK: f64 = 0.5;

/// Values of parameters by name, as a calibration found them: SI, the outer lever arm with its first guess.
pub type Values = Vec<(String, String, Option<f64>)>;

/// A calibration to navigate with.
#[derive(Clone)]
pub struct Calibrated {
    /// The filter that it belongs to.
    pub filter: Arc<dyn AnyFilter>,
    /// What that found.
    pub values: Values,
    /// Temperature at which its temperature effects vanish, degC; that of the log navigated where nothing is said.
    pub reference_temperature: Option<f64>,
}

/// What came of navigating with one calibration.
#[derive(Clone, Debug)]
pub struct Flight {
    /// What people call the filter.
    pub filter: String,
    /// The errors.
    pub drift: Drift,
    /// Time and east and north error, s and m.
    pub track: Vec<(f64, f64, f64)>,
}

impl Flight {
    /// Length of the navigation, h.
    pub fn hours(&self) -> f64 {
        self.drift.duration / 3600.0
    }

    /// Largest horizontal error, nautical miles.
    pub fn largest(&self) -> f64 {
        self.drift.largest / NAUTICAL_MILE
    }

    /// Horizontal error at the end, nautical miles.
    pub fn last(&self) -> f64 {
        self.drift.last / NAUTICAL_MILE
    }
}

impl Calibrated {
    /// A pilot with what was found, with its name.
    pub fn pilot(&self, setup: &Setup) -> (String, Box<dyn Pilot>) {
        (self.filter.title(), self.filter.pilot(&self.setup(setup), &mut |info| self.value(info)))
    }

    /// What takes the errors that were found out of samples.
    pub fn corrector(&self, setup: &Setup) -> Corrector {
        self.filter.corrector(&self.setup(setup), &mut |info| self.value(info))
    }

    fn value(&self, info: &StateInfo) -> Option<f64> {
        let same = |(name, component, _): &&(String, String, Option<f64>)| {
            name == info.block && component == info.component
        };
        self.values.iter().find(same).and_then(|(_, _, value)| *value)
    }

    fn setup<'a>(&self, setup: &Setup<'a>) -> Setup<'a> {
        let reference_temperature = self.reference_temperature.unwrap_or(setup.reference_temperature);
        Setup { reference_temperature, ..*setup }
    }
}

/// Navigates a log with each of the pilots that `board` gives, aligned over its first `align` seconds. Returns also the length of
/// the alignment: half the log where that is shorter.
///
/// # Errors
/// When the log cannot be read, an alignment diverges or finds no reference, nothing is there to compare with, or the solution is no
/// number any more.
pub fn navigate(
    samples: &dyn Samples,
    board: &dyn Fn() -> Vec<(String, Box<dyn Pilot>)>,
    align: f64,
) -> Result<(Vec<Flight>, f64), Error> {
    let embark = || {
        let travellers = board().into_iter();
        travellers.map(|(filter, pilot)| Traveller { filter, pilot, track: Track::default() }).collect()
    };
    let mut seconds = align;
    let mut travellers: Vec<Traveller> = embark();
    let extent = travel(samples, Some(seconds), &mut travellers)?;
    let read = extent.last - extent.first;
    if read < seconds - SLACK {
        seconds = 0.5 * read;
        travellers = embark();
        travel(samples, Some(seconds), &mut travellers)?;
    }
    for traveller in &mut travellers {
        if !traveller.pilot.depart() {
            return Err(Error::NoAlignment { filter: traveller.filter.clone(), seconds });
        }
    }
    travel(samples, None, &mut travellers)?;
    let arrive = |traveller: Traveller| Flight {
        filter: traveller.filter,
        drift: traveller.pilot.drift(),
        track: traveller.track.points,
    };
    let flights: Vec<Flight> = travellers.into_iter().map(arrive).collect();
    if flights.iter().any(|flight| flight.drift.comparisons == 0) {
        return Err(Error::NoPosition);
    }
    if let Some(lost) = flights.iter().find(|flight| !flight.drift.largest.is_finite()) {
        return Err(Error::Lost { filter: lost.filter.clone() });
    }
    Ok((flights, seconds))
}

/// Reads samples, up to `seconds` after the first where given, for all travellers; these work in parallel.
fn travel(
    samples: &dyn Samples,
    seconds: Option<f64>,
    travellers: &mut [Traveller],
) -> Result<Extent, Error> {
    let mut extent = Extent::default();
    let mut fault = None;
    samples.read(&mut |samples| {
        let mut taken = 0;
        for sample in samples {
            let first = if extent.samples == 0 { sample.time } else { extent.first };
            if seconds.is_some_and(|seconds| sample.time > first + seconds) {
                break;
            }
            extent.push(sample.time);
            taken += 1;
        }
        let step = |traveller: &mut Traveller| traveller.read(&samples[..taken]);
        match travellers.par_iter_mut().try_for_each(step) {
            Ok(()) if taken == samples.len() => ControlFlow::Continue(()),
            Ok(()) => ControlFlow::Break(()),
            Err(error) => {
                fault = Some(error);
                ControlFlow::Break(())
            }
        }
    })?;
    fault.map_or(Ok(extent), Err)
}

/// A pilot with what is remembered of its way.
struct Traveller {
    filter: String,
    pilot: Box<dyn Pilot>,
    track: Track,
}

impl Traveller {
    fn read(&mut self, samples: &[Sample]) -> Result<(), Error> {
        for sample in samples {
            let diverged = |diverged: Diverged| Error::Diverged { filter: self.filter.clone(), diverged };
            if let Some(error) = self.pilot.step(sample).map_err(diverged)? {
                self.track.push(sample.time, &error);
            }
        }
        Ok(())
    }
}

/// The error over time, thinned evenly.
#[derive(Default)]
struct Track {
    points: Vec<(f64, f64, f64)>,
    seen: usize,
    stride: usize,
}

impl Track {
    fn push(&mut self, time: f64, error: &Vector3<f64>) {
        let stride = self.stride.max(1);
        if self.seen.is_multiple_of(stride) {
            self.points.push((time, error.x, error.y));
        }
        self.seen += 1;
        if self.points.len() == POINTS {
            let mut index = 0;
            self.points.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride = stride * 2;
        }
    }
}
