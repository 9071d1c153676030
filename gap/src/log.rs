//! What is diagnosed: samples that can be read again and again, and what one look at them tells.

use std::hash::{DefaultHasher, Hasher};

use runs::{Look, ReadError, Samples, Timing, each};
use sinscal::{Reference, Sample, Setup};

use crate::error::{Error, SceneError, Which};
use crate::shifted::Shifted;

/// A reference that stays within so many of its standard deviations does not move.
const STILL: f64 = 10.0;
/// A diagnosis remembers some 12 kB of each update, and uses no more updates than this.
const MOST_UPDATES: f64 = 10_000.0;
/// Samples are joined up to this length, s...
const JOINED_TIME: f64 = 0.5;
/// ...and this angle, rad: what is between them is then as good as straight.
const JOINED_ANGLE: f64 = 0.02;

/// A delay of the reference beyond this is taken out before it is linearised, s.
const LATE: f64 = 0.01;

/// A log to be diagnosed: its samples, and the description that goes with them.
#[derive(Clone, Copy)]
pub struct Log<'a> {
    /// Where its samples come from.
    pub samples: &'a dyn Samples,
    /// What must be known to run a filter over them.
    pub setup: &'a Setup<'a>,
}

impl Log<'_> {
    /// Gives each sample to `work`, until there is an error.
    pub(crate) fn try_each<E: From<ReadError>>(
        &self,
        work: impl FnMut(&Sample) -> Result<(), E>,
    ) -> Result<(), E> {
        each(self.samples, work)
    }

    /// The same with samples as a unit of a slower rate would have given them: increments are sums, and what is read now and then
    /// is the last reading. A joined sample ends where an update by the reference is due.
    pub(crate) fn try_each_joined<E: From<ReadError>>(
        &self,
        mut work: impl FnMut(&Sample) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut joined: Option<Sample> = None;
        let (mut start, mut due) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        self.try_each(|sample| {
            match &mut joined {
                Some(joined) => join(joined, sample),
                None => joined = Some(*sample),
            }
            let is_due = sample.time >= due && sample.reference.is_read();
            let is_longer = |all: &Sample| {
                all.time - start >= JOINED_TIME || all.dtheta.norm_squared() >= JOINED_ANGLE * JOINED_ANGLE
            };
            let Some(mut all) = joined.take_if(|all| is_due || is_longer(all)) else { return Ok(()) };
            start = sample.time;
            all.reference = Reference::default();
            if is_due {
                all.reference = sample.reference;
                due = sample.time + 1.0 / self.setup.update_rate - 0.5 / self.setup.rate;
            }
            work(&all)
        })
    }
}

/// Adds the sample that comes next, but for its reference.
fn join(joined: &mut Sample, next: &Sample) {
    joined.time = next.time;
    joined.dtheta += next.dtheta;
    joined.dvel += next.dvel;
    let read = [&next.temperature, &next.gyro_temperature, &next.dither];
    for (held, read) in
        [&mut joined.temperature, &mut joined.gyro_temperature, &mut joined.dither].into_iter().zip(read)
    {
        held.zip_apply(read, |held, read| {
            if !read.is_nan() {
                *held = read;
            }
        });
    }
}

/// A log, what one look at it tells, and what errors call it.
#[derive(Clone, Copy)]
pub(crate) struct Surveyed<'a> {
    pub(crate) log: Log<'a>,
    pub(crate) survey: Survey,
    pub(crate) which: Which,
}

impl Surveyed<'_> {
    /// An error in it.
    pub(crate) fn fault(&self, error: impl Into<SceneError>) -> Error {
        Error::of(self.which, error.into())
    }
}

/// What one look at a log tells before any filter runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Survey {
    /// Times of the first and of the last sample, s.
    pub(crate) span: (f64, f64),
    /// Whether any attitude is measured.
    pub(crate) attitude: bool,
    /// Whether the observed point stays where it is.
    pub(crate) fixed: bool,
    /// What the samples say by themselves.
    pub(crate) look: Look,
    /// By how much the reference is late, where that is too much to be linearised: in rows, and in s.
    pub(crate) late: (i64, f64),
    /// Readings of the reference.
    readings: usize,
    /// The same for two logs that measured the same.
    digest: u64,
}

impl Survey {
    /// Of no log at all.
    #[cfg(test)]
    pub(crate) fn nothing() -> Self {
        Self {
            span: (0.0, 1.0),
            attitude: false,
            fixed: false,
            look: Look::default(),
            late: (0, 0.0),
            readings: 0,
            digest: 0,
        }
    }

    pub(crate) fn of(log: &Log) -> Result<Self, ReadError> {
        let sigma = &log.setup.reference;
        let mut survey = Self {
            span: (f64::NAN, f64::NAN),
            attitude: false,
            fixed: true,
            look: Look::default(),
            late: (0, 0.0),
            readings: 0,
            digest: 0,
        };
        let mut digest = DefaultHasher::new();
        let mut origin = None;
        let mut timing = Timing::default();
        let mut rows = 0_u64;
        log.try_each::<ReadError>(|s| {
            if survey.span.0.is_nan() {
                survey.span.0 = s.time;
            }
            survey.span.1 = s.time;
            survey.look.push(s);
            timing.push(s);
            rows += 1;
            let reference = &s.reference;
            survey.attitude |= reference.attitude.is_some();
            let still = reference.velocity.is_none_or(|v| v.amax() < STILL * sigma.velocity);
            let there = reference.position.is_none_or(|p| {
                let from: &nalgebra::Vector3<f64> = origin.get_or_insert(p);
                (p - *from).amax() < STILL * sigma.position
            });
            survey.fixed &= still && there;
            survey.readings += usize::from(reference.is_read());
            for value in s.dtheta.iter().chain(&s.dvel) {
                digest.write_u64(value.to_bits());
            }
            Ok(())
        })?;
        survey.fixed &= !survey.attitude;
        survey.digest = digest.finish();
        let late = if survey.fixed { None } else { timing.late(log.setup) };
        if let Some(late) = late.filter(|late| late.abs() > LATE) {
            let interval = (survey.span.1 - survey.span.0) / rows.saturating_sub(1).max(1) as f64;
            let by = (late / interval).round();
            survey.late = (by as i64, by * interval);
        }
        Ok(survey)
    }

    /// Whether two logs are one and the same.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.digest == other.digest
    }

    /// The samples with the reference at the time that it shows.
    pub(crate) fn stamped<'a>(&self, log: &Log<'a>) -> Shifted<'a> {
        Shifted { samples: log.samples, rows: self.late.0 }
    }

    /// The setup to diagnose `log` with, one of so `many`: the reference is used more rarely than asked for where the log is so long that
    /// its updates could not all be remembered.
    pub(crate) fn setup<'a>(&self, log: &Log<'a>, many: usize) -> Setup<'a> {
        let seconds = self.span.1 - self.span.0;
        let updates = (seconds * log.setup.update_rate).min(self.readings as f64);
        let most = MOST_UPDATES / many.max(1) as f64;
        let update_rate = if updates > most { most / seconds } else { log.setup.update_rate };
        Setup { update_rate, ..*log.setup }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn samples(count: usize) -> Vec<Sample> {
        (0..count)
            .map(|i| Sample {
                time: 0.5 * i as f64,
                dtheta: Vector3::new(1e-6 * i as f64, 0.0, 0.0),
                dvel: Vector3::zeros(),
                temperature: Vector3::zeros(),
                gyro_temperature: Vector3::zeros(),
                dither: Vector3::zeros(),
                reference: sinscal::Reference {
                    velocity: Some(Vector3::zeros()),
                    ..sinscal::Reference::default()
                },
            })
            .collect()
    }

    #[test]
    fn a_long_log_is_used_more_rarely() {
        let scenario = rig::Scenario::default();
        let description = rig::Simulation::new(&scenario, 1).unwrap().description().clone();
        let setup = description.setup(&[]);
        let rate = |samples: &Vec<Sample>| {
            let log = Log { samples, setup: &setup };
            Survey::of(&log).unwrap().setup(&log, 1).update_rate
        };
        assert_eq!(rate(&samples(1000)), setup.update_rate);
        let long = 40_000.0 * 2.0;
        let used = rate(&samples(long as usize)) * 40_000.0;
        assert!((used / MOST_UPDATES - 1.0).abs() < 1e-3, "{used}");
    }

    #[test]
    fn only_the_same_measurements_are_the_same() {
        let scenario = rig::Scenario::default();
        let description = rig::Simulation::new(&scenario, 1).unwrap().description().clone();
        let setup = description.setup(&[]);
        let survey = |samples: &Vec<Sample>| Survey::of(&Log { samples, setup: &setup }).unwrap();
        let (one, mut other) = (samples(100), samples(100));
        assert!(survey(&one).is_same(&survey(&other)));
        other[50].dvel.z += 1e-12;
        assert!(!survey(&one).is_same(&survey(&other)));
        assert!(!survey(&one).is_same(&survey(&samples(99))));
    }

    #[test]
    fn joined_samples_lose_nothing_but_readings_that_are_not_due() {
        let scenario = rig::Scenario::default();
        let description = rig::Simulation::new(&scenario, 1).unwrap().description().clone();
        let setup = Setup { rate: 50.0, update_rate: 1.0, ..description.setup(&[]) };
        let mut samples: Vec<Sample> = samples(502);
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.time = 0.02 * i as f64;
            sample.dvel.z = 0.2;
            // at rest, then turning by 10 deg/s
            sample.dtheta.x = if i <= 250 { 0.0 } else { 0.0035 };
            sample.temperature.x = if i == 52 { 30.0 } else { f64::NAN };
        }
        let mut joined: Vec<Sample> = Vec::new();
        let log = Log { samples: &samples, setup: &setup };
        let mut keep = |sample: &Sample| {
            joined.push(*sample);
            Ok::<(), ReadError>(())
        };
        log.try_each_joined(&mut keep).unwrap();
        assert_eq!((joined[0].time, joined[0].reference.velocity), (0.0, samples[0].reference.velocity));
        let sum = |all: &[Sample]| all.iter().fold(Vector3::zeros(), |sum, s| sum + s.dtheta + s.dvel);
        let until = joined.last().unwrap().time;
        let used: Vec<Sample> = samples.iter().copied().filter(|s| s.time <= until).collect();
        assert!((sum(&joined) - sum(&used)).norm() < 1e-9 && used.len() > 495);
        assert!(joined.iter().all(|s| s.dtheta.norm() < JOINED_ANGLE + 0.0035));
        assert!(joined.iter().any(|s| s.temperature.x == 30.0 && s.time > samples[52].time));
        let due = joined.iter().filter(|s| s.reference.is_read()).count();
        assert!((10..=11).contains(&due), "{due}");
        let still = joined.iter().filter(|s| s.time <= 5.0).count();
        assert!(
            (9..=13).contains(&still) && (40..=60).contains(&(joined.len() - still)),
            "{still}, {joined:?}"
        );
    }

    #[test]
    fn an_error_ends_a_pass() {
        let scenario = rig::Scenario::default();
        let description = rig::Simulation::new(&scenario, 1).unwrap().description().clone();
        let setup = description.setup(&[]);
        let samples = samples(10);
        let mut seen = 0;
        let log = Log { samples: &samples, setup: &setup };
        let ended = log.try_each::<ReadError>(|_| {
            seen += 1;
            if seen == 3 { Err("three".into()) } else { Ok(()) }
        });
        assert_eq!((seen, ended.unwrap_err().to_string().as_str()), (3, "three"));
    }
}
