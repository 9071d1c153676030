//! The filters of the paper side by side on one log.

use miette::{Result, miette};
use sinscal::{
    Calibration, Conventional, Filter, FilterVisitor, InitialAttitude, Sample, Setup, Statistics, Strapdown,
    visit_filter,
};

use crate::broadcast::{Reader, broadcast};
use crate::navigate::run::{Calibrated, Values};
use crate::setup;
use logs::Log;

/// The five filters of the paper, in the order of its table 3.
pub(crate) const FILTERS: [&str; 5] = ["36d-p", "39d-p", "40d-p", "43d-p", "43d-b"];

/// What one filter made of the log.
pub(crate) struct Fit {
    pub(crate) calibrated: Calibrated,
    pub(crate) statistics: Statistics,
    pub(crate) states: usize,
}

/// Runs every filter over `log`.
pub(crate) fn calibrate(log: &Log, passes: u32) -> Result<Vec<Fit>> {
    let initial = setup::initial(log)?;
    let table = log.table().display().to_string();
    let mut runs = Vec::new();
    for name in FILTERS {
        let start = Start { log, initial, table: table.clone() };
        runs.push(visit_filter(name, start).ok_or_else(|| miette!("there is no filter called {name}"))?);
    }
    for pass in 0..passes {
        if pass > 0 {
            runs.iter_mut().for_each(|run| run.again());
        }
        broadcast(log, None, "calibrating", &mut runs)?;
    }
    let fits: Vec<Fit> = runs.iter().map(|run| run.fit()).collect();
    if fits.iter().any(|fit| fit.statistics.updates == 0) {
        return Err(miette!(
            "{table}: no update was made: the filters measure velocity and position, and no row has such a reference"
        ));
    }
    Ok(fits)
}

trait Run: Reader {
    fn again(&mut self);
    fn fit(&self) -> Fit;
}

struct Start<'a> {
    log: &'a Log,
    initial: InitialAttitude,
    table: String,
}

impl FilterVisitor for Start<'_> {
    type Output = Box<dyn Run>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        let setup: Setup = setup::of(self.log, self.initial);
        Box::new(Running { run: Calibration::<F, Conventional>::new(&setup), table: self.table })
    }
}

struct Running<F: Filter<Dynamics = Strapdown>> {
    run: Calibration<F, Conventional>,
    table: String,
}

impl<F: Filter<Dynamics = Strapdown>> Reader for Running<F> {
    fn read(&mut self, samples: &[Sample]) -> Result<()> {
        for sample in samples {
            self.run.step(sample).map_err(|error| miette!("{}: {}: {error}", self.table, F::NAME))?;
        }
        Ok(())
    }
}

impl<F: Filter<Dynamics = Strapdown>> Run for Running<F> {
    fn again(&mut self) {
        self.run.begin_pass();
    }

    fn fit(&self) -> Fit {
        let mut values = Values::new();
        self.run.parameters(&mut |parameter| {
            let info = &parameter.info;
            values.push((
                info.block.to_owned(),
                info.component.to_owned(),
                parameter.estimated.then_some(parameter.value),
            ));
        });
        Fit {
            calibrated: Calibrated { filter: F::NAME, values },
            statistics: *self.run.statistics(),
            states: F::DIM,
        }
    }
}
