//! Driving the library's free-inertial navigation.

use miette::{Result, miette};
use nalgebra::Vector3;
use sinscal::navigation::{Alignment, Drift, FreeInertial, NAUTICAL_MILE, parameters_of};
use sinscal::{Filter, FilterVisitor, InitialAttitude, Sample, Setup, StateInfo, Strapdown, visit_filter};

use crate::broadcast::{self, Reader};
use crate::log::Log;
use crate::setup;

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
    let mut pilots = embark(log, initial, calibrations)?;
    let extent = broadcast::broadcast(log, Some(seconds), "aligning", &mut pilots)?;
    let read = extent.last - extent.first;
    // half a second of slack: a log may be as long as the alignment to the sample
    if read < seconds - 0.5 {
        seconds = 0.5 * read;
        pilots = embark(log, initial, calibrations)?;
        broadcast::broadcast(log, Some(seconds), "aligning", &mut pilots)?;
    }
    for pilot in &mut pilots {
        pilot.depart().ok_or_else(|| {
            miette!(
                "{}: {} found no reference of position or velocity to align with in its first {seconds:.0} s",
                log.table().display(),
                pilot.filter()
            )
        })?;
    }
    broadcast::broadcast(log, None, "navigating", &mut pilots)?;
    let flights: Vec<Flight> = pilots.into_iter().map(|pilot| pilot.arrive()).collect();
    if flights.iter().any(|flight| flight.drift.comparisons == 0) {
        return Err(miette!(
            "{}: no row has a reference position to compare with",
            log.table().display()
        ));
    }
    Ok((flights, seconds))
}

fn embark(
    log: &Log,
    initial: InitialAttitude,
    calibrations: &[Calibrated],
) -> Result<Vec<Box<dyn Pilot>>> {
    let table = log.table().display().to_string();
    calibrations
        .iter()
        .map(|calibrated| {
            let board = Board { setup: setup::of(log, initial), values: &calibrated.values, table: table.clone() };
            visit_filter(calibrated.filter, board)
                .ok_or_else(|| miette!("there is no filter called {}", calibrated.filter))
        })
        .collect()
}

/// One calibration on its way: aligns, departs, navigates, arrives.
trait Pilot: Reader {
    fn filter(&self) -> &'static str;
    /// Ends the alignment; nothing when there was no update.
    fn depart(&mut self) -> Option<()>;
    fn arrive(self: Box<Self>) -> Flight;
}

struct Board<'a> {
    setup: Setup<'a>,
    values: &'a Values,
    table: String,
}

impl FilterVisitor for Board<'_> {
    type Output = Box<dyn Pilot>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        let find = |info: &StateInfo| {
            let same = |(name, component, _): &&(String, String, Option<f64>)| {
                name == info.block && component == info.component
            };
            self.values.iter().find(same).and_then(|(_, _, value)| *value)
        };
        let parameters = parameters_of::<F>(&self.setup, find);
        Box::new(Aboard::<F> {
            alignment: Some(Alignment::new(&self.setup, &parameters)),
            run: FreeInertial::new(&self.setup, &parameters),
            track: Track::default(),
            table: self.table,
        })
    }
}

struct Aboard<F: Filter<Dynamics = Strapdown>> {
    alignment: Option<Alignment<F>>,
    run: FreeInertial<F>,
    track: Track,
    table: String,
}

impl<F: Filter<Dynamics = Strapdown>> Reader for Aboard<F> {
    fn read(&mut self, samples: &[Sample]) -> Result<()> {
        for sample in samples {
            if let Some(alignment) = &mut self.alignment {
                alignment.step(sample).map_err(|error| miette!("{}: {}: {error}", self.table, F::NAME))?;
            } else if let Some(error) = self.run.step(sample) {
                self.track.push(sample.time, &error);
            }
        }
        Ok(())
    }
}

impl<F: Filter<Dynamics = Strapdown>> Pilot for Aboard<F> {
    fn filter(&self) -> &'static str {
        F::NAME
    }

    fn depart(&mut self) -> Option<()> {
        let (time, solution) = self.alignment.take()?.finish()?;
        self.run.depart(time, solution);
        Some(())
    }

    fn arrive(self: Box<Self>) -> Flight {
        Flight { filter: F::NAME, drift: *self.run.drift(), track: self.track.points }
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
