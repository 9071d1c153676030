//! Which logs a diagnosis takes, how, and what there is to say of each.

use sinscal::Setup;

use crate::error::{Error, Which};
use crate::log::{Log, Survey, Surveyed};
use crate::parallel::both;

/// What one look at each log tells.
pub(crate) struct Surveys<'a> {
    /// Those that are taken, by their places, with what they are run with.
    taken: Vec<(usize, Survey, Setup<'a>)>,
    verification: Option<(Survey, Setup<'a>)>,
    /// Places of logs that are one before them again.
    again: Vec<usize>,
    /// Whether the log to verify with is one of those to diagnose.
    is_same: bool,
}

impl<'a> Surveys<'a> {
    pub(crate) fn of(logs: &[Log<'a>], verify: Option<&Log<'a>>) -> Result<Self, Error> {
        let (there, here) =
            both(|| verify.map(Survey::of), || logs.iter().map(Survey::of).collect::<Vec<_>>());
        let there = there.transpose().map_err(|e| Error::of(Which::Verification, e.into()))?;
        let mut surveys = Vec::with_capacity(here.len());
        for (place, survey) in here.into_iter().enumerate() {
            surveys.push(survey.map_err(|e| Error::of(Which::Log(place), e.into()))?);
        }
        // the same data twice are no more evidence
        let is_again = |place: &usize| surveys[..*place].iter().any(|other| other.is_same(&surveys[*place]));
        let (again, places): (Vec<usize>, Vec<usize>) = (0..surveys.len()).partition(is_again);
        let is_same = there.is_some_and(|there| surveys.iter().any(|here| there.is_same(here)));
        let many = places.len();
        let taken = places.into_iter().map(|p| (p, surveys[p], surveys[p].setup(&logs[p], many))).collect();
        let verification = verify.zip(there.filter(|_| !is_same));
        let verification = verification.map(|(log, survey)| (survey, survey.setup(log, 1)));
        Ok(Self { taken, verification, again, is_same })
    }

    /// The logs to diagnose.
    pub(crate) fn logs<'b>(&'b self, logs: &[Log<'b>]) -> Vec<Surveyed<'b>> {
        let of = |(place, survey, setup): &'b (usize, Survey, Setup<'a>)| Surveyed {
            log: Log { setup, ..logs[*place] },
            survey: *survey,
            which: Which::Log(*place),
        };
        self.taken.iter().map(of).collect()
    }

    /// The one to verify with.
    pub(crate) fn verification<'b>(&'b self, verify: Option<&Log<'b>>) -> Option<Surveyed<'b>> {
        let ((survey, setup), log) = self.verification.as_ref().zip(verify)?;
        Some(Surveyed { log: Log { setup, ..*log }, survey: *survey, which: Which::Verification })
    }

    /// What there is to say of them; of the one to verify with where it `is_used`.
    pub(crate) fn notes(&self, logs: &[Log], verify: Option<&Log>, is_used: bool) -> Vec<String> {
        let called = |place: usize| match logs.len() {
            1 => "this log".to_owned(),
            _ => format!("the {}", Which::Log(place)),
        };
        let second = "the second log".to_owned();
        let of_logs =
            self.taken.iter().map(|(place, survey, used)| (called(*place), survey, logs[*place].setup, used));
        let of_second = self.verification.as_ref().zip(verify);
        let of_second = of_second.map(|((survey, used), asked)| (second, survey, asked.setup, used));
        let all: Vec<_> = of_logs.chain(of_second.filter(|_| is_used)).collect();
        let mut notes = Vec::new();
        for (log, survey, ..) in &all {
            notes.extend(late(log, survey));
            notes.extend(fahrenheit(log, survey));
        }
        if self.taken.len() > 1 {
            let many = self.taken.len();
            notes.push(format!("{many} logs are taken as one: times count on from each to the next"));
        }
        for place in &self.again {
            notes.push(format!("{} is one of those before it again, and was left out", called(*place)));
        }
        if self.is_same {
            notes.push(
                "the second log is the first one again, and confirms nothing: it was left out".to_owned(),
            );
        }
        for (log, _, asked, used) in &all {
            notes.extend(rarer(log, asked, used));
        }
        notes
    }

    /// Whether the log to verify with is one of those to diagnose.
    pub(crate) fn is_same(&self) -> bool {
        self.is_same
    }
}

/// Whether the reference was late by more than can be linearised.
fn late(log: &str, survey: &Survey) -> Option<String> {
    let (rows, late) = survey.late;
    (rows != 0).then(|| {
        format!(
            "in {log} reference and inertial sensors show the same motion {:.0} ms apart: the reference was taken {} rows {} before anything else; values of reference-delay are the whole delay",
            1e3 * late.abs(),
            rows.abs(),
            if rows > 0 { "earlier" } else { "later" }
        )
    })
}

/// Whether temperatures look like degF.
fn fahrenheit(log: &str, survey: &Survey) -> Option<String> {
    let (read, told) = survey.look.fahrenheit()?;
    Some(format!("the temperatures of {log} begin at {read:.1} degC: {read:.1} degF would be {told:.1} degC"))
}

/// Whether the reference of a log is used more rarely than asked for.
fn rarer(log: &str, asked: &Setup, used: &Setup) -> Option<String> {
    (used.update_rate < asked.update_rate)
        .then(|| format!("{log} is long: its reference was used once in {:.1} s", 1.0 / used.update_rate))
}
