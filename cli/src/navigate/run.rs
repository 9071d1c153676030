//! Driving the library's free-inertial navigation.

use miette::{Result, miette};
use nalgebra::Vector3;
use sinscal::navigation::{Drift, NAUTICAL_MILE, Pilot, pilot};
use sinscal::{InitialAttitude, Sample, StateInfo};

use crate::broadcast::{self, Reader};
use crate::setup;
use logs::Log;

/// Points kept of the error over time.
const POINTS: usize = 4096;

/// Values of parameters by name, as a calibration found them: SI, the outer lever arm with its first guess.
pub(crate) type Values = Vec<(String, String, Option<f64>)>;

/// A calibration to navigate with.
pub(crate) struct Calibrated {
    pub(crate) filter: &'static str,
    pub(crate) values: Values,
}

/// What came of navigating with one calibration.
pub(crate) struct Flight {
    pub(crate) filter: &'static str,
    pub(crate) drift: Drift,
    /// Time and east and north error, m.
    pub(crate) track: Vec<(f64, f64, f64)>,
}

impl Flight {
    pub(crate) fn hours(&self) -> f64 {
        self.drift.duration / 3600.0
    }

    pub(crate) fn largest(&self) -> f64 {
        self.drift.largest / NAUTICAL_MILE
    }

    pub(crate) fn last(&self) -> f64 {
        self.drift.last / NAUTICAL_MILE
    }
}

/// Navigates `log` with each of the calibrations, aligned over its first `align` seconds. Returns also the length of the
/// alignment: half the log where that is shorter.
pub(crate) fn navigate(log: &Log, calibrations: &[Calibrated], align: f64) -> Result<(Vec<Flight>, f64)> {
    let initial = setup::initial(log)?;
    let mut seconds = align;
    let mut travellers = embark(log, initial, calibrations)?;
    let extent = broadcast::broadcast(log, Some(seconds), "aligning", &mut travellers)?;
    let read = extent.last - extent.first;
    // half a second of slack: a log may be as long as the alignment to the sample
    if read < seconds - 0.5 {
        seconds = 0.5 * read;
        travellers = embark(log, initial, calibrations)?;
        broadcast::broadcast(log, Some(seconds), "aligning", &mut travellers)?;
    }
    for traveller in &mut travellers {
        if !traveller.pilot.depart() {
            return Err(miette!(
                "{}: {} found no reference of position or velocity to align with in its first {seconds:.0} s",
                log.table().display(),
                traveller.pilot.filter()
            ));
        }
    }
    broadcast::broadcast(log, None, "navigating", &mut travellers)?;
    let arrive = |traveller: Box<Traveller>| Flight {
        filter: traveller.pilot.filter(),
        drift: traveller.pilot.drift(),
        track: traveller.track.points,
    };
    let flights: Vec<Flight> = travellers.into_iter().map(arrive).collect();
    if flights.iter().any(|flight| flight.drift.comparisons == 0) {
        return Err(miette!("{}: no row has a reference position to compare with", log.table().display()));
    }
    Ok((flights, seconds))
}

#[allow(clippy::vec_box, reason = "other readers of a broadcast are of unlike types, so it takes boxes")]
fn embark(log: &Log, initial: InitialAttitude, calibrations: &[Calibrated]) -> Result<Vec<Box<Traveller>>> {
    let setup = setup::of(log, initial);
    let table = log.table().display().to_string();
    let board = |calibrated: &Calibrated| {
        let find = |info: &StateInfo| {
            let same = |(name, component, _): &&(String, String, Option<f64>)| {
                name == info.block && component == info.component
            };
            calibrated.values.iter().find(same).and_then(|(_, _, value)| *value)
        };
        let pilot = pilot(calibrated.filter, &setup, find)
            .ok_or_else(|| miette!("there is no filter called {}", calibrated.filter))?;
        Ok(Box::new(Traveller { pilot, track: Track::default(), table: table.clone() }))
    };
    calibrations.iter().map(board).collect()
}

/// A pilot with what is remembered of its way.
struct Traveller {
    pilot: Box<dyn Pilot>,
    track: Track,
    table: String,
}

impl Reader for Traveller {
    fn read(&mut self, samples: &[Sample]) -> Result<()> {
        for sample in samples {
            let compared = self
                .pilot
                .step(sample)
                .map_err(|error| miette!("{}: {}: {error}", self.table, self.pilot.filter()))?;
            if let Some(error) = compared {
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
