//! What was named is added and really run: the gap before and after.

use runs::navigate;

use crate::decide::Decision;
use crate::error::{Error, FIRST, SECOND, SceneError};
use crate::linear::{FreeRun, Noise, Recorded, run_free};
use crate::log::Log;
use crate::parallel::both;
use crate::report::{Diagnosis, Gap, Horizontal, LogGap};
use crate::run::{DELAY, Machine, Ran};
use crate::scene::Scene;

/// Longest alignment before navigation, s; a short log gives a quarter of itself.
const ALIGNMENT: f64 = 900.0;

/// The declared filter and the one extended by blocks with their sizes on one log, closed loop and relinearised.
struct Pair {
    before: Ran,
    after: Ran,
    gap: LogGap,
}

impl Pair {
    fn run(
        machine: &dyn Machine,
        added: &[(&str, f64)],
        log: &Log,
        scene: &Scene,
    ) -> Result<Self, SceneError> {
        let before = machine.rerun(log, &Noise::STATED, &|_| 0.0)?;
        let size = |block: &str| added.iter().find(|a| a.0 == block).map_or(0.0, |a| a.1);
        let late = scene.survey.late;
        let stamped = scene.survey.stamped(log);
        let after = if late.0 != 0 && size(DELAY) > 0.0 {
            machine.rerun(&Log { samples: &stamped, ..*log }, &Noise::STATED, &size)?.with_delay(late.1)
        } else {
            machine.rerun(log, &Noise::STATED, &size)?
        };
        let (start, end) = before.recording.span();
        let horizon = ((end - start) / 40.0).min(60.0);
        let measure = |ran: &Ran| -> Result<(f64, f64, (f64, &'static str)), SceneError> {
            let mut columns = ran.recording.base();
            columns.extend(ran.recording.candidates());
            let mut free = FreeRun::new(horizon, (start + end) / 2.0);
            let none = Recorded(&[]);
            let found = run_free(&ran.recording, &columns, &none, &scene.noise, &mut |_| {}, &mut free)
                .ok_or(SceneError::Indefinite)?;
            let rms = (found.gram[0] / found.degrees_of_freedom as f64).sqrt();
            Ok((rms, found.log_likelihood, free.rms()))
        };
        let (b, a) = (measure(&before)?, measure(&after)?);
        let there: Option<Vec<usize>> = added.iter().map(|a| scene.prices.find(a.0)).collect();
        let gap = LogGap {
            rms_before: b.0,
            rms_after: a.0,
            log_likelihood_before: b.1,
            log_likelihood_after: a.1,
            // no linear price holds over so long a delay
            log_likelihood_gain_priced: there
                .filter(|_| late.0 == 0)
                .map_or(f64::NAN, |g| scene.prices.gain(&g)),
            free_run_before: b.2.0,
            free_run_after: a.2.0,
            free_run_of: b.2.1,
            horizon_s: horizon,
            horizontal: None,
        };
        Ok(Self { before, after, gap })
    }

    /// Values of an added block.
    fn values(&self, block: &str) -> Vec<f64> {
        let columns = self.after.recording.columns().iter().zip(&self.after.estimate);
        columns.filter(|(c, _)| c.info.block == block && !c.base).map(|(_, e)| *e).collect()
    }
}

/// Largest horizontal error, m, of `log` navigated free-inertially with the parameters that a run found.
/// Nothing where it cannot be aligned, navigation diverges, or there is nothing to compare with.
fn navigated(
    machine: &dyn Machine,
    log: &Log,
    (first, last): (f64, f64),
    ran: &Ran,
) -> Result<Option<f64>, SceneError> {
    let board = || vec![(String::new(), machine.pilot(log.setup, ran))];
    match navigate(log.samples, &board, ALIGNMENT.min(0.25 * (last - first))) {
        Ok((flights, _)) => {
            let largest = flights.first().map(|flight| flight.drift.largest);
            Ok(largest.filter(|largest| largest.is_finite()))
        }
        Err(runs::Error::Unreadable(source)) => Err(SceneError::Unreadable(source)),
        Err(_) => Ok(None),
    }
}

/// Runs base and extended filter on both logs and compares.
pub(crate) fn rerun(
    machine: &dyn Machine,
    log: &Log,
    verify: Option<&Log>,
    scenes: (&Scene, Option<&Scene>),
    decision: &Decision,
    d: &mut Diagnosis,
) -> Result<(), Error> {
    let (first, second) = scenes;
    let best = &decision.best.groups;
    let sizes = first.prices.sizes(best).ok_or(Error::Indefinite { log: FIRST })?;
    let name = |g: &usize| first.prices.groups[*g].name.as_str();
    let added: Vec<(&str, f64)> =
        best.iter().zip(sizes).map(|(g, size)| (name(g), size * first.wider.factor(name(g)))).collect();
    let (there, here) = both(
        || verify.zip(second).map(|(log, scene)| Pair::run(machine, &added, log, scene)),
        || Pair::run(machine, &added, log, first),
    );
    let mut here = here.map_err(|e| Error::of(FIRST, e))?;
    let mut there = there.transpose().map_err(|e| Error::of(SECOND, e))?;
    for effect in &mut d.effects {
        let values = here.values(&effect.name);
        // pricing has the fitted noise, the closed loop the stated one: keep the former's standard deviations
        if values.len() == effect.estimate.len() {
            effect.estimate = values;
        }
        effect.estimate_verify = there.as_ref().map(|pair| pair.values(&effect.name));
    }
    // the second log is navigated with what the first one said
    let fly = |log: &Log, scene: &Scene| {
        let fly = |ran| navigated(machine, log, scene.survey.span, ran);
        if !scene.survey.fixed {
            return Ok(None);
        }
        let (before, after) = both(|| fly(&here.before), || fly(&here.after));
        Ok(before?.zip(after?).map(|(before_m, after_m)| Horizontal { before_m, after_m }))
    };
    let beyond = verify.zip(second).map(|(log, scene)| fly(log, scene)).transpose();
    let beyond = beyond.map_err(|e| Error::of(SECOND, e))?.flatten();
    here.gap.horizontal = fly(log, first).map_err(|e| Error::of(FIRST, e))?;
    if let Some(pair) = &mut there {
        pair.gap.horizontal = beyond;
    }
    d.gap = Some(Gap { fit: here.gap, verify: there.map(|pair| pair.gap) });
    Ok(())
}
