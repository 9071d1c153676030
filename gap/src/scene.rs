//! A log, or several of one unit as one, as the diagnosis sees it: run with everything in the filter, noise fitted, every effect priced.

use std::sync::OnceLock;

use crate::chain::gross;
use crate::error::{Error, Which};
use crate::excite::parts;
use crate::linear::{Noise, Recorded, run};
use crate::log::{Log, Survey, Surveyed};
use crate::noise;
use crate::prices::{BEYOND, Prices, groups_of};
use crate::run::{DELAY, Machine, Ran};

/// Below so many standard deviations an effect of its prior's size does not show.
pub(crate) const EXCITED: f64 = 3.0;

/// A log with fewer updates is too short to judge by.
const LEAST: usize = 100;

/// The filter is run with wider priors no more than so many times.
const WIDENINGS: usize = 2;

/// Factors on the priors of candidates that showed beyond them. An effect must not be pulled back by how large it was expected to
/// be: what is left of it would look like something unknown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wider(Vec<(&'static str, f64)>);

impl Wider {
    pub(crate) fn factor(&self, block: &str) -> f64 {
        self.0.iter().find(|w| w.0 == block).map_or(1.0, |w| w.1)
    }

    /// Widens the priors of blocks whose estimates are beyond them; whether there were any.
    fn widen(&mut self, ran: &Ran) -> bool {
        let before = self.clone();
        let mut any = false;
        for (column, estimate) in ran.recording.columns().iter().zip(&ran.estimate) {
            let block = column.info.block;
            // what is stated is wrong by no more than people are mistaken
            let is_widest = column.base || column.prior <= 0.0 || gross(block).is_some();
            if is_widest || estimate.abs() <= BEYOND * column.prior {
                continue;
            }
            any = true;
            // of several components the largest counts
            let factor = self.factor(block).max(before.factor(block) * estimate.abs() / column.prior);
            self.0.retain(|w| w.0 != block);
            self.0.push((block, factor));
        }
        any
    }
}

/// The scatter of the scores is judged between so many stretches, as that of a calibration is.
const STRETCHES: usize = 32;

/// Everything that the later stages ask of a log.
pub(crate) struct Scene {
    pub(crate) ran: Ran,
    /// Priors that were too narrow.
    pub(crate) wider: Wider,
    /// What one look at each log tells.
    pub(crate) surveys: Vec<Survey>,
    pub(crate) noise: Noise,
    /// Whether the noise is so much more than stated that it may hide anything.
    pub(crate) noise_hides: bool,
    pub(crate) prices: Prices,
    /// The same from the first half of the log alone.
    pub(crate) half: Prices,
    /// What each of so many stretches of it says of base parameters and candidates alike, once somebody asks.
    pub(crate) parts: OnceLock<Vec<Prices>>,
}

impl Scene {
    /// Of one or more logs.
    pub(crate) fn new(machine: &dyn Machine, logs: &[Surveyed]) -> Result<Self, Error> {
        // the Jacobian of a delay is the observed point's motion; of a fixed point that is nothing but noise
        let takes = |block: &str| match block {
            DELAY => logs.iter().all(|log| !log.survey.fixed),
            "reference-misalignment" => logs.iter().all(|log| log.survey.attitude),
            _ => true,
        };
        let mut wider = Wider::default();
        let indefinite = || Error::Indefinite { log: logs.first().map_or(Which::FIRST, |log| log.which) };
        let ran_with = |wider: &Wider| {
            let size = |block: &str| if takes(block) { wider.factor(block) } else { 0.0 };
            let mut runs = Vec::with_capacity(logs.len());
            for one in logs {
                let stamped = one.survey.stamped(&one.log);
                let log = Log { samples: &stamped, ..one.log };
                let ran = machine.run(&log, &Noise::STATED, &size).map_err(|error| one.fault(error))?;
                let updates = ran.recording.updates();
                if updates < LEAST {
                    return Err(Error::TooShort { log: one.which, updates });
                }
                runs.push(ran.with_delay(one.survey.late.1));
            }
            Ran::joined(runs, &Noise::STATED).ok_or_else(indefinite)
        };
        let mut ran = ran_with(&wider)?;
        for _ in 0..WIDENINGS {
            let mut more = wider.clone();
            if !more.widen(&ran) {
                break;
            }
            // a size that the filter does not survive is none to believe
            match ran_with(&more) {
                Err(Error::Diverged { .. } | Error::Indefinite { .. }) => break,
                again => (ran, wider) = (again?, more),
            }
        }
        let (noise, noise_hides) = noise::fit(&ran.recording);
        let recording = &ran.recording;
        let priced = recording.candidates();
        let sigma: Vec<f64> = priced.iter().map(|c| recording.columns()[*c].prior).collect();
        let nc = 1 + priced.len();
        let mut half = vec![0.0; nc * nc];
        let mut at = 0;
        let found = run(recording, &recording.base(), &Recorded(&priced), &noise, &mut |whitened| {
            if 2 * at < recording.updates() {
                for row in whitened.rows.chunks_exact(nc) {
                    for i in 0..nc {
                        for j in i..nc {
                            half[i * nc + j] += row[i] * row[j];
                        }
                    }
                }
            }
            at += 1;
        })
        .ok_or_else(indefinite)?;
        for i in 0..nc {
            for j in 0..i {
                half[i * nc + j] = half[j * nc + i];
            }
        }
        let groups = groups_of(recording.columns(), &priced);
        let prices = Prices::new(&found.gram, sigma.clone(), groups.clone());
        let half = Prices::new(&half, sigma, groups);
        let surveys = logs.iter().map(|log| log.survey).collect();
        Ok(Self { ran, wider, surveys, noise, noise_hides, prices, half, parts: OnceLock::new() })
    }

    /// What each of the stretches says of base parameters and candidates alike.
    pub(crate) fn parts(&self) -> &[Prices] {
        self.parts.get_or_init(|| parts(&self.ran.recording, &self.noise, STRETCHES))
    }

    /// Groups that the path excites.
    pub(crate) fn excited(&self) -> Vec<usize> {
        self.prices.all().into_iter().filter(|g| self.prices.excitation(*g).0 >= EXCITED).collect()
    }

    /// Columns of the recording that belong to some groups.
    pub(crate) fn columns(&self, groups: &[usize]) -> Vec<usize> {
        let priced = self.ran.recording.candidates();
        self.prices.members(groups).into_iter().map(|m| priced[m]).collect()
    }
}
