//! The whole workflow.

use nalgebra::{DMatrix, DVector};
use runs::AnyFilter;
use sinscal::{AnyEffect, DitherScale, Effect as _, EffectInfo};

use crate::chain::{amplitudes, by_construction};
use crate::decide::{Decision, decide, withheld};
use crate::declaration::declaration;
use crate::error::{Error, Which};
use crate::excite::indistinguishable;
use crate::linear::Noise;
use crate::locate::{locate, locate_family};
use crate::log::Log;
use crate::open::Open;
use crate::parallel::both;
use crate::partial::scattered;
use crate::report::{Diagnosis, FoundEffect, NoiseScale, Rival, Verdict};
use crate::rerun::{Added, rerun};
use crate::review::review;
use crate::run::{DELAY, Machine, Runs};
use crate::scene::{EXCITED, Scene};
use crate::taken::Surveys;
use crate::white::whiteness;
use crate::{say, threshold};

/// How to diagnose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Of the simulated thresholds.
    pub seed: u64,
    /// Probability of an alarm when nothing is missing.
    pub false_alarms: f64,
    /// Whether the extended filter is really run, before and after.
    pub rerun: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 1, false_alarms: 0.01, rerun: true }
    }
}

/// log10 of a p-value of whiteness that is worth a note.
const COLOURED: f64 = -6.0;

/// Diagnoses `logs` of one unit with `filter` against those of `effects` that it lacks, and asks `verify` where there is one.
///
/// What is missing is the same in all logs, and their evidence adds: what the filter estimates begins anew with each. `progress` is told the stage and how much of the work is done.
///
/// # Errors
/// When a filter diverges, a log is too short, or the effects cannot be added to the filter.
pub fn diagnose(
    filter: &dyn AnyFilter,
    effects: &[&'static dyn AnyEffect],
    logs: &[Log],
    verify: Option<&Log>,
    options: &Options,
    progress: &mut dyn FnMut(&'static str, f64),
) -> Result<Diagnosis, Error> {
    workflow(&Runs::new(filter, effects)?, logs, verify, options, progress)
}

fn workflow(
    machine: &dyn Machine,
    logs: &[Log],
    verify: Option<&Log>,
    options: &Options,
    progress: &mut dyn FnMut(&'static str, f64),
) -> Result<Diagnosis, Error> {
    progress("reading", 0.0);
    let surveys = Surveys::of(logs, verify)?;
    let taken = surveys.logs(logs);
    let Some(log) = taken.first().map(|one| one.log) else {
        return Err(Error::TooShort { log: Which::FIRST, updates: 0 });
    };
    let there = surveys.verification(verify);
    progress("recording a pass with every effect", 0.05);
    let (second, first) = both(
        || there.as_ref().map(|there| Scene::new(machine, core::slice::from_ref(there))),
        || Scene::new(machine, &taken),
    );
    let first = first?;
    let (second, unusable) = usable(second)?;
    // nor may what stands in it keep a name from the first
    let there = there.filter(|_| second.is_some());
    progress("pricing what is in no library", 0.45);
    let rate = options.false_alarms / 2.0;
    let (open, limit) = both(
        || Open::new(&first, rate, options.seed),
        || threshold::simulate(&first.prices, &first.excited(), rate, options.seed, "library"),
    );
    let open = open.map_err(|e| Error::of(Which::FIRST, e))?;
    progress("naming and verifying", 0.6);
    let mut decision = decide(&first, second.as_ref(), open.as_ref(), limit, &|name| {
        log.setup.priors.iter().find(|prior| prior.0 == name && prior.0 != DELAY).map(|prior| prior.1)
    })
    .map_err(|e| Error::of(Which::Verification, e))?;
    let saturated = taken.iter().chain(&there).find_map(|one| one.survey.look.saturated());
    let mut law = None;
    match saturated {
        Some(saturated) => decision = withheld(&first, format!("the {saturated}")),
        None => {
            progress("asking the neighbours", 0.65);
            let kind = |name: &str| machine.entry(name).map(EffectInfo::kind);
            law = review(&first, second.as_ref(), open.as_ref(), &mut decision, &kind);
        }
    }
    let mut d = report(machine, &first, second.as_ref(), open.as_ref(), &decision);
    if let Some(law) = &law {
        d.laws.push(law.said.clone());
        let name = law.said.name.as_str();
        let added: Vec<&str> = law.said.beside.iter().map(String::as_str).chain([name]).collect();
        d.source = Some(declaration(&machine.base(), &added));
    }
    let groups = law.as_ref().map_or(&decision.best.groups, |law| &law.beside);
    if options.rerun && (law.is_some() || !groups.is_empty()) {
        progress("running the filter with what was found", 0.7);
        let scenes = (&first, second.as_ref());
        let added = Added::new(scenes, groups, law.as_ref())?;
        match rerun(machine, &taken, there.as_ref(), scenes, &added, &mut d) {
            // what was found stands; a filter that lacks it may well not survive a long log
            Err(Error::Diverged { log, source }) => {
                let time = source.time;
                d.notes.push(format!(
                    "before and after are not compared: on the {log} one of them diverges at {time} s"
                ));
            }
            done => done?,
        }
    }
    for effect in d.effects.iter_mut().filter(|effect| effect.name == DitherScale::EFFECT.name()) {
        let (values, sigmas) = (&mut effect.estimate, &mut effect.sigma);
        effect.estimate_verify.iter_mut().flatten().for_each(|value| *value = amplitudes((*value, 0.0)).0);
        values
            .iter_mut()
            .zip(sigmas)
            .for_each(|(value, sigma)| (*value, *sigma) = amplitudes((*value, *sigma)));
    }
    d.notes.extend(surveys.notes(logs, verify, there.is_some()));
    d.notes.extend(unusable);
    d.notes.splice(0..0, say::details(&d, decision.best.gain, &log.setup.site));
    d.sentence = say::sentence(&d, decision.reason.as_deref(), surveys.is_same());
    progress("done", 1.0);
    Ok(d)
}

/// The second log, or why it was left out: what a filter cannot run over confirms nothing, and does not end the diagnosis of the
/// first. A sample that cannot be read is a fault of the file, and stays an error.
fn usable(second: Option<Result<Scene, Error>>) -> Result<(Option<Scene>, Option<String>), Error> {
    match second.transpose() {
        Ok(second) => Ok((second, None)),
        Err(unreadable @ Error::Unreadable { .. }) => Err(unreadable),
        Err(why) => Ok((None, Some(format!("the second log cannot be used, and was left out: {why}")))),
    }
}

/// Everything but the re-run.
fn report(
    machine: &dyn Machine,
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    decision: &Decision,
) -> Diagnosis {
    let prices = &first.prices;
    let names = |groups: &[usize]| groups.iter().map(|g| prices.groups[*g].name.clone()).collect::<Vec<_>>();
    let best = &decision.best.groups;
    let confirmed = decision.verdict == Verdict::EffectsFound;
    let pairs = indistinguishable(first);
    let mut ambiguous: Vec<Vec<String>> = Vec::new();
    if !confirmed && !best.is_empty() && decision.verdict != Verdict::OutsideLibrary {
        ambiguous.push(names(best));
        ambiguous.extend(decision.rivals.iter().map(|r| names(r)));
    }
    let not_excited: Vec<String> = first
        .ran
        .recording
        .columns()
        .iter()
        .filter(|c| !c.base && !machine.has(c.info.block))
        .map(|c| c.info.block)
        .filter(|b| prices.find(b).is_none_or(|g| prices.excitation(g).0 < EXCITED))
        .fold(Vec::new(), |mut all: Vec<String>, block| {
            if all.last().is_none_or(|last| last != block) {
                all.push(block.into());
            }
            all
        });
    let mut indistinct: Vec<Vec<String>> = Vec::new();
    for pair in &pairs {
        if !indistinct.iter().any(|p| p[0] == pair.other && p[1] == pair.effect) {
            indistinct.push(vec![pair.effect.clone(), pair.other.clone()]);
        }
    }
    indistinct.extend(by_construction(&|name| machine.has(name)));
    let mut next_run: Vec<String> = pairs.iter().filter_map(|p| say::advice(&p.effect, &p.other)).collect();
    if let Some((_, blamed)) = &decision.degenerate
        && let [one, other] = names(blamed).as_slice()
    {
        next_run.extend(say::advice(one, other).filter(|advice| !next_run.contains(advice)));
    }
    let (places, evidence) = match (open, decision.correlates.first()) {
        (Some(open), Some(family)) if decision.verdict == Verdict::OutsideLibrary => {
            locate_family(first, open, *family)
        }
        _ => locate(first, best),
    };
    let base = machine.base();
    let source =
        confirmed.then(|| declaration(&base, &names(best).iter().map(String::as_str).collect::<Vec<_>>()));
    let mut d = Diagnosis {
        verdict: decision.verdict,
        sentence: String::new(),
        verified: confirmed && second.is_some(),
        complete: decision.verdict == Verdict::NothingMissing || confirmed && decision.remainder.is_none(),
        remainder: decision.remainder.clone(),
        base_filter: base.name,
        logs: first.surveys.len(),
        effects: Vec::new(),
        ambiguous,
        not_excited,
        indistinguishable: indistinct,
        correlates_with: open.map_or(Vec::new(), |o| {
            decision.correlates.iter().map(|g| o.prices.groups[*g].name.clone()).collect()
        }),
        laws: Vec::new(),
        r#where: places,
        noise_scale: NoiseScale {
            gyro: first.noise.gyro,
            accel: first.noise.accel,
            reference: first.noise.reference,
        },
        whiteness: whiteness(first, best),
        gap: None,
        declaration: None,
        source,
        rivals: rivals(first, best),
        evidence,
        notes: Vec::new(),
        next_run,
    };
    if confirmed {
        effects(machine, first, second, decision, scattered(first, best), &mut d);
    }
    notes(first, second, open, decision, &mut d);
    if let Some(white) = d.whiteness.filter(|w| w.log10_p_after < COLOURED) {
        d.notes.push(format!(
            "what is left is not white noise (Ljung-Box p = 1e{:.0}): the errors of the reference or of the sensors are correlated in time, or smaller than stated",
            white.log10_p_after
        ));
    }
    d.notes.extend(say::hidden(&d.indistinguishable));
    d
}

/// Values as priced, with their covariance; the re-run replaces the values.
fn effects(
    machine: &dyn Machine,
    first: &Scene,
    second: Option<&Scene>,
    decision: &Decision,
    spread: Option<(DVector<f64>, DMatrix<f64>)>,
    d: &mut Diagnosis,
) {
    let best = &decision.best.groups;
    let Some((mean, covariance)) = spread else { return };
    let there = second.and_then(|s| {
        let mapped: Option<Vec<usize>> =
            best.iter().map(|g| s.prices.find(&first.prices.groups[*g].name)).collect();
        s.prices.posterior(&mapped?)
    });
    let columns = first.columns(best);
    let recording = &first.ran.recording;
    let mut at = 0;
    for (i, g) in best.iter().enumerate() {
        let group = &first.prices.groups[*g];
        let range = at..at + group.members.len();
        at = range.end;
        let others: Vec<usize> = best.iter().copied().filter(|o| o != g).collect();
        let info = &recording.columns()[columns[range.start]].info;
        let entry = machine.entry(&group.name);
        d.effects.push(FoundEffect {
            name: group.name.clone(),
            components: range
                .clone()
                .map(|k| recording.columns()[columns[k]].info.component.into())
                .collect(),
            estimate: range.clone().map(|k| mean[k]).collect(),
            sigma: range.clone().map(|k| covariance[(k, k)].sqrt()).collect(),
            estimate_verify: there.as_ref().map(|t| range.clone().map(|k| t.0[k]).collect()),
            unit: info.unit.into(),
            sheet_unit: info.sheet_unit.into(),
            sheet_scale: info.sheet_scale,
            equation: entry.map_or(String::new(), |entry| entry.equation().into()),
            description: entry.map_or(String::new(), |entry| entry.description().into()),
            log_likelihood_gain: first.prices.gain(best) - first.prices.gain(&others),
            log_e_verify: decision.each[i],
        });
    }
}

fn rivals(first: &Scene, best: &[usize]) -> Vec<Rival> {
    let prices = &first.prices;
    let ln10 = core::f64::consts::LN_10;
    let mut table: Vec<Rival> = prices
        .all()
        .into_iter()
        .map(|g| {
            let others: Vec<usize> = best.iter().copied().filter(|o| *o != g).collect();
            let mut all = others.clone();
            all.push(g);
            let after = prices.given(best).map_or(0.0, |p| p.score(g).ln_p);
            let member = best.contains(&g);
            Rival {
                name: prices.groups[g].name.clone(),
                log10_p_before: prices.score(g).ln_p / ln10,
                log10_p_after: if member { 0.0 } else { after / ln10 },
                gain_alone: prices.gain(&[g]),
                gain_on_top: prices.gain(&all) - prices.gain(&others),
                chosen_on_top: if member { 0.0 } else { prices.gain(&all) - prices.gain(&[g]) },
                excitation: prices.excitation(g).0,
                information: prices.information(g),
            }
        })
        .collect();
    table.sort_by(|a, b| b.gain_alone.total_cmp(&a.gain_alone));
    table
}

fn notes(first: &Scene, second: Option<&Scene>, open: Option<&Open>, decision: &Decision, d: &mut Diagnosis) {
    let mut notes = core::mem::take(&mut d.notes);
    let mut note = |text: String| notes.push(text);
    for (log, scene) in [(d.called(), Some(first)), ("the second log", second)] {
        let Some(Noise { gyro, accel, reference }) = scene.map(|s| s.noise) else { continue };
        for (what, scale) in [("gyros", gyro), ("accelerometers", accel), ("reference", reference)] {
            if !(0.5..=2.0).contains(&scale) {
                note(format!("in {log} the noise of the {what} is {scale:.2} times what is stated"));
            }
        }
    }
    if let Some(remains) = &decision.remains {
        note(format!("something remains on top of it; the largest part goes with {remains}"));
    }
    if let Some((why, _)) = &decision.degenerate {
        note(format!("what explains most of {} is not named: {why}", d.called()));
    }
    for g in &decision.stripped {
        note(format!(
            "{} was tried on top and taken out again: it carries too little, or other data do not speak for it",
            first.prices.groups[*g].name
        ));
    }
    if let Some(v) = &decision.verification {
        for (g, _) in decision.best.groups.iter().zip(&v.same).filter(|(_, same)| !**same) {
            let name = &first.prices.groups[*g].name;
            let there = d.effects.iter().find(|e| e.name == *name).and_then(say::there);
            let values = there.map_or(String::new(), |values| format!(": {values}"));
            note(format!("{name} has another value in the second log{values}"));
        }
        let total = say::power(v.ln_e);
        note(format!("on the second log the set as a whole has the e-value {total}"));
    }
    if let Some(open) = open {
        for g in &decision.correlates {
            let gain = open.gain_on(*g, &decision.best.groups);
            if gain > 1.0 {
                let (name, unit) = (&open.prices.groups[*g].name, &open.units[*g]);
                note(format!(
                    "{name}, in {unit}, gains {gain:.0} in log-likelihood on top of what is named here"
                ));
            }
        }
    }
    d.notes = notes;
}

#[cfg(test)]
mod tests {
    use runs::Declared;
    use sinscal::navigation::Pilot;
    use sinscal::{CATALOGUE, Diverged, Sample, Setup, Sins36P};

    use super::*;
    use crate::declaration::BaseFilter;
    use crate::error::SceneError;
    use crate::log::{Survey, Surveyed};
    use crate::run::{Ran, Size};

    /// 36d-p, which diverges without help, and with too much of it.
    struct Fragile<'a>(Runs<'a>);

    impl Machine for Fragile<'_> {
        fn base(&self) -> BaseFilter {
            self.0.base()
        }

        fn has(&self, block: &str) -> bool {
            self.0.has(block)
        }

        fn entry(&self, effect: &str) -> Option<&'static sinscal::EffectInfo> {
            self.0.entry(effect)
        }

        fn run(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError> {
            if size("accel-delay") > 2.0 {
                return Err(SceneError::Diverged(Diverged { time: 123.0, channel: "velocity" }));
            }
            self.0.run(log, noise, size)
        }

        fn rerun(
            &self,
            log: &Log,
            noise: &Noise,
            laws: &[&'static dyn AnyEffect],
            size: &Size,
        ) -> Result<Ran, SceneError> {
            if size("accel-delay") == 0.0 {
                return Err(SceneError::Diverged(Diverged { time: 321.0, channel: "velocity" }));
            }
            self.0.rerun(log, noise, laws, size)
        }

        fn pilot(&self, setup: &Setup, ran: &Ran) -> Box<dyn Pilot> {
            self.0.pilot(setup, ran)
        }
    }

    /// A unit with a delay of its accelerometers that 36d-p lacks: samples and description.
    fn delayed(machine: &dyn Machine) -> (rig::Description, Vec<Sample>) {
        let mut scenario = rig::Scenario::default().with_rate(20.0).unwrap();
        scenario.keep_effects(|name| machine.has(name) || name == "accel-delay");
        scenario.motion.still = 100.0;
        scenario.motion.dwell = 30.0;
        scenario.dither.mode = rig::DitherMode::Off;
        let simulation = rig::Simulation::new(&scenario, 5).unwrap();
        let description = simulation.description().clone();
        (description, simulation.collect())
    }

    #[test]
    fn what_was_found_stands_though_the_filter_without_it_diverges() {
        let filter = Declared::<Sins36P>::new(2, "");
        let machine = Fragile(Runs::new(&filter, CATALOGUE).unwrap());
        let (description, samples) = delayed(&machine);
        let setup = description.setup(&[]);
        let log = Log { samples: &samples, setup: &setup };
        let d = workflow(&machine, &[log], None, &Options::default(), &mut |_, _| {}).unwrap();
        assert!(d.sentence.contains("accel-delay") && d.gap.is_none(), "{}", d.sentence);
        assert!(d.notes.iter().any(|n| n.contains("diverges at 321 s")), "{:?}", d.notes);
    }

    #[test]
    fn a_prior_that_the_filter_does_not_survive_is_not_widened_to() {
        let filter = Declared::<Sins36P>::new(2, "");
        let machine = Fragile(Runs::new(&filter, CATALOGUE).unwrap());
        let (description, samples) = delayed(&machine);
        // the delay shows at five times this, and the machine lets none of more than twice this through
        let setup = description.setup(&[("accel-delay", 1e-4)]);
        let log = Log { samples: &samples, setup: &setup };
        let survey = Survey::of(&log).unwrap();
        let scene = Scene::new(&machine, &[Surveyed { log, survey, which: Which::FIRST }]).unwrap();
        assert_eq!(scene.wider.factor("accel-delay"), 1.0);
        let delay = scene.prices.find("accel-delay").unwrap();
        let value = scene.prices.posterior(&[delay]).unwrap().0[0];
        assert!((value - 4.95e-4).abs() < 2e-4, "{value}");
    }

    #[test]
    fn a_second_log_that_cannot_be_used_does_not_end_the_diagnosis_of_the_first() {
        let filter = Declared::<Sins36P>::new(2, "");
        let machine = Runs::new(&filter, CATALOGUE).unwrap();
        let (description, samples) = delayed(&machine);
        // too short to judge by
        let short = samples[samples.len() / 2..][..200].to_vec();
        let setup = description.setup(&[]);
        let log = Log { samples: &samples, setup: &setup };
        let second = Log { samples: &short, setup: &setup };
        let options = Options { rerun: false, ..Options::default() };
        let said = |verify| workflow(&machine, &[log], verify, &options, &mut |_, _| {}).unwrap();
        let (alone, with) = (said(None), said(Some(&second)));
        assert_eq!((with.verdict, with.verified), (alone.verdict, false));
        assert_eq!(with.sentence, alone.sentence);
        let note = |n: &String| n.contains("second log cannot be used") && n.contains("too few");
        assert!(with.notes.iter().any(note) && !alone.notes.iter().any(note), "{:?}", with.notes);
    }

    #[test]
    fn a_second_log_that_cannot_be_read_is_an_error() {
        let unreadable = Error::Unreadable { log: Which::Verification, source: "three".into() };
        assert!(matches!(usable(Some(Err(unreadable))), Err(Error::Unreadable { .. })));
    }
}
