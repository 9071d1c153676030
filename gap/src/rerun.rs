//! What was named is added and really run: the gap before and after.

use runs::navigate;
use sinscal::AnyEffect;

use crate::error::{Error, SceneError, Which};
use crate::linear::{FreeRun, Noise, Recorded, run_free};
use crate::log::{Log, Surveyed};
use crate::parallel::both;
use crate::report::{Diagnosis, Gap, Horizontal, LogGap};
use crate::review::Proposed;
use crate::run::{DELAY, Machine, Ran};
use crate::scene::Scene;

/// Longest alignment before navigation, s; a short log gives a quarter of itself.
const ALIGNMENT: f64 = 900.0;

/// What is added to the declared filter.
pub(crate) struct Added<'a> {
    /// Known effects, with how many times larger than expected each is.
    effects: Vec<(&'a str, f64)>,
    law: Option<&'static dyn AnyEffect>,
    /// What all of it was priced at on both logs.
    gains: [f64; 2],
}

impl<'a> Added<'a> {
    /// Groups of the first log, and perhaps a law beside them.
    pub(crate) fn new(
        (first, second): (&'a Scene, Option<&Scene>),
        groups: &[usize],
        law: Option<&Proposed>,
    ) -> Result<Self, Error> {
        let sizes = first.prices.sizes(groups).ok_or(Error::Indefinite { log: Which::FIRST })?;
        let name = |g: &usize| first.prices.groups[*g].name.as_str();
        let effects: Vec<(&str, f64)> =
            groups.iter().zip(sizes).map(|(g, size)| (name(g), size * first.wider.factor(name(g)))).collect();
        let gain = |scene: &Scene| {
            let there: Option<Vec<usize>> = effects.iter().map(|a| scene.prices.find(a.0)).collect();
            there.map_or(f64::NAN, |groups| scene.prices.gain(&groups))
        };
        let gains = law.map_or_else(|| [gain(first), second.map_or(f64::NAN, gain)], |law| law.gains);
        Ok(Self { effects, law: law.map(|law| law.law.effect()), gains })
    }

    /// How many times larger than expected a block is.
    fn size(&self, block: &str) -> f64 {
        let is_law = self.law.is_some_and(|law| law.name() == block);
        let known = self.effects.iter().find(|(name, _)| *name == block).map(|(_, size)| *size);
        known.unwrap_or(if is_law { 1.0 } else { 0.0 })
    }
}

/// The declared filter and the one extended by blocks with their sizes on one log, closed loop and relinearised.
struct Pair {
    before: Ran,
    after: Ran,
    gap: LogGap,
}

impl Pair {
    fn run(
        machine: &dyn Machine,
        added: &Added,
        gain: f64,
        logs: &[Surveyed],
        scene: &Scene,
    ) -> Result<Self, Error> {
        let size = |block: &str| added.size(block);
        let laws: Vec<_> = added.law.into_iter().collect();
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for one in logs {
            let (log, survey) = (&one.log, &one.survey);
            before.push(machine.rerun(log, &Noise::STATED, &[], &|_| 0.0).map_err(|e| one.fault(e))?);
            let stamped = survey.stamped(log);
            let ran = if survey.late.0 != 0 && size(DELAY) > 0.0 {
                let stamped = Log { samples: &stamped, ..*log };
                let ran = machine.rerun(&stamped, &Noise::STATED, &laws, &size);
                ran.map(|ran| ran.with_delay(survey.late.1))
            } else {
                machine.rerun(log, &Noise::STATED, &laws, &size)
            };
            after.push(ran.map_err(|e| one.fault(e))?);
        }
        let late = logs.iter().any(|log| log.survey.late.0 != 0);
        let indefinite = || Error::Indefinite { log: logs.first().map_or(Which::FIRST, |log| log.which) };
        let joined = |runs| Ran::joined(runs, &Noise::STATED).ok_or_else(indefinite);
        let (before, after) = (joined(before)?, joined(after)?);
        let (start, end) = before.recording.span();
        let horizon = ((end - start) / 40.0).min(60.0);
        let measure = |ran: &Ran| -> Result<(f64, f64, (f64, &'static str)), Error> {
            let mut columns = ran.recording.base();
            columns.extend(ran.recording.candidates());
            let mut free = FreeRun::new(horizon, (start + end) / 2.0);
            let none = Recorded(&[]);
            let found = run_free(&ran.recording, &columns, &none, &scene.noise, &mut |_| {}, &mut free)
                .ok_or_else(indefinite)?;
            let rms = (found.gram[0] / found.degrees_of_freedom as f64).sqrt();
            Ok((rms, found.log_likelihood, free.rms()))
        };
        let (b, a) = (measure(&before)?, measure(&after)?);
        let gap = LogGap {
            rms_before: b.0,
            rms_after: a.0,
            log_likelihood_before: b.1,
            log_likelihood_after: a.1,
            // no linear price holds over so long a delay
            log_likelihood_gain_priced: if late { f64::NAN } else { gain },
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
    logs: &[Surveyed],
    verify: Option<&Surveyed>,
    scenes: (&Scene, Option<&Scene>),
    added: &Added,
    d: &mut Diagnosis,
) -> Result<(), Error> {
    let (first, second) = scenes;
    let [gain, gain_there] = added.gains;
    let (there, here) = both(
        || {
            verify
                .zip(second)
                .map(|(log, scene)| Pair::run(machine, added, gain_there, core::slice::from_ref(log), scene))
        },
        || Pair::run(machine, added, gain, logs, first),
    );
    let (mut here, mut there) = (here?, there.transpose()?);
    for effect in &mut d.effects {
        let values = here.values(&effect.name);
        // pricing has the fitted noise, the closed loop the stated one: keep the former's standard deviations
        if values.len() == effect.estimate.len() {
            effect.estimate = values;
        }
        effect.estimate_verify = there.as_ref().map(|pair| pair.values(&effect.name));
    }
    for law in &mut d.laws {
        law.estimate = here.values(&law.name);
        if let Some(pair) = &there {
            law.estimate_verify = pair.values(&law.name);
        }
    }
    // the second log is navigated with what the first one said
    let fly = |one: &Surveyed| -> Result<_, Error> {
        let fly = |ran| navigated(machine, &one.log, one.survey.span, ran).map_err(|e| one.fault(e));
        if !one.survey.fixed {
            return Ok(None);
        }
        let (before, after) = both(|| fly(&here.before), || fly(&here.after));
        Ok(before?.zip(after?).map(|(before_m, after_m)| Horizontal { before_m, after_m }))
    };
    let beyond = verify.map(fly).transpose()?.flatten();
    // what was estimated of the unit is that of the last log
    if let Some(last) = logs.last() {
        here.gap.horizontal = fly(last)?;
    }
    if let Some(pair) = &mut there {
        pair.gap.horizontal = beyond;
    }
    d.gap = Some(Gap { fit: here.gap, verify: there.map(|pair| pair.gap) });
    Ok(())
}
