//! What the library must know of a log before its first sample.

use clap::Args;
use miette::{Result, miette};
use runs::AnyFilter;
use sinscal::{Aligner, Coarse, CoarseCalibration, CoarseError, InitialAttitude, Setup, UnknownPulses};

use crate::arguments::tell;
use crate::say;
use logs::Log;

/// The setup of a run over `log` that begins at `initial`.
pub(crate) fn of(log: &Log, initial: InitialAttitude) -> Setup<'_> {
    let description = log.description();
    Setup {
        update_rate: log.update_rate(),
        reference_temperature: description.reference_temperature,
        outer_lever: description.outer_lever,
        priors: &description.priors,
        wander: description.wander,
        ..Setup::new(description.rate, description.site, initial, description.reference, description.noise)
    }
}

/// The attitude at the first row: that of the description, or from the still stretch the log begins with.
pub(crate) fn initial(log: &Log) -> Result<InitialAttitude> {
    let description = log.description();
    if let Some(initial) = description.initial {
        return Ok(initial);
    }
    let (gyro, accel) = (description.prior("gyro-bias"), description.prior("accel-bias"));
    if let Some(rest) = log.rests().first() {
        return Ok(InitialAttitude::at_rest(&rest.force.into(), accel));
    }
    let mut aligner = Aligner::new(description.site, description.rate, description.noise, gyro, accel);
    for sample in log.samples()? {
        if !aligner.push(&sample?) {
            break;
        }
    }
    aligner.finish().map_err(|error| miette!("{}: {error}", log.table().display()))
}

/// How a filter begins.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct Beginning {
    /// Begin with a coarse calibration from the log's own still positions and the turns between them: for errors far beyond the
    /// priors. Pulses of unknown size, and hand-carried units far off, need it and get it unasked
    #[arg(long)]
    coarse: bool,
}

impl Beginning {
    /// Readies a log for a filter: takes out of it what the coarse stage finds, where that is asked or needed, refers it to what the filter
    /// measures, and says what is assumed and odd.
    pub(crate) fn prepare(self, log: &mut Log, filter: &dyn AnyFilter) -> Result<()> {
        if self.coarse || log.unknown_pulses() != UnknownPulses::default() {
            coarse(log)?;
        }
        log.refer(&filter.measures())?;
        if log.coarse().is_none() && coarse_if_far(log)? {
            say::remark(
                "the still positions show errors beyond the priors: the coarse stage takes them out first",
            );
            log.refer(&filter.measures())?;
        }
        tell(log);
        Ok(())
    }
}

/// [`coarse`] for a log that is referred to its rests, where these show errors beyond the priors; whether it was so.
fn coarse_if_far(log: &mut Log) -> Result<bool> {
    if log.rests().is_empty() {
        return Ok(false);
    }
    let Ok(found) = find_coarse(log)? else { return Ok(false) };
    let far = found.is_far(|name| log.description().prior(name));
    if far {
        log.correct(found);
    }
    Ok(far)
}

fn find_coarse(log: &Log) -> Result<Result<CoarseCalibration, CoarseError>> {
    let description = log.description();
    let mut coarse = Coarse::new(description.site, description.rate, description.noise);
    for sample in log.samples()? {
        coarse.push(&sample?);
    }
    Ok(coarse.finish(log.unknown_pulses(), description.initial.as_ref()))
}

/// Takes the errors out of a log that its own still positions and turns show, and finds the sizes of its pulses.
fn coarse(log: &mut Log) -> Result<()> {
    let found = find_coarse(log)?.map_err(|error| {
        match log.lacking_scale(&format!("{error}; or give the sizes there")) {
            Some(fault) => fault.into(),
            None => miette!("{}: {error}", log.table().display()),
        }
    })?;
    log.correct(found);
    Ok(())
}
