//! A log as the diagnosis sees it: run with everything in the filter, noise fitted, every effect priced.

use crate::error::SceneError;
use crate::linear::{Noise, Recorded, run};
use crate::log::{Log, Survey};
use crate::noise;
use crate::prices::{BEYOND, Prices, groups_of};
use crate::run::{Machine, Ran};

/// Below so many standard deviations an effect of its prior's size does not show.
pub(crate) const EXCITED: f64 = 3.0;

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
            if column.base || column.prior <= 0.0 || estimate.abs() <= BEYOND * column.prior {
                continue;
            }
            any = true;
            let block = column.info.block;
            // of several components the largest counts
            let factor = self.factor(block).max(before.factor(block) * estimate.abs() / column.prior);
            self.0.retain(|w| w.0 != block);
            self.0.push((block, factor));
        }
        any
    }
}

/// Everything that the later stages ask of a log.
pub(crate) struct Scene {
    pub(crate) ran: Ran,
    /// Priors that were too narrow.
    pub(crate) wider: Wider,
    pub(crate) survey: Survey,
    pub(crate) noise: Noise,
    /// Whether the noise is so much more than stated that it may hide anything.
    pub(crate) noise_hides: bool,
    pub(crate) prices: Prices,
    /// The same from the first half of the log alone.
    pub(crate) half: Prices,
}

impl Scene {
    pub(crate) fn new(machine: &dyn Machine, log: &Log, survey: &Survey) -> Result<Self, SceneError> {
        // the Jacobian of a delay is the observed point's motion; of a fixed point that is nothing but noise
        let takes = |block: &str| match block {
            "reference-delay" => !survey.fixed,
            "reference-misalignment" => survey.attitude,
            _ => true,
        };
        let mut wider = Wider::default();
        let mut widened = 0;
        let ran = loop {
            let size = |block: &str| if takes(block) { wider.factor(block) } else { 0.0 };
            let ran = machine.run(log, &Noise::STATED, &size)?;
            if widened == WIDENINGS || !wider.widen(&ran) {
                break ran;
            }
            widened += 1;
        };
        if ran.recording.updates() < 100 {
            return Err(SceneError::TooShort { updates: ran.recording.updates() });
        }
        let (noise, noise_hides) = noise::fit(&ran.recording);
        let recording = &ran.recording;
        let priced = recording.candidates();
        let sigma: Vec<f64> = priced.iter().map(|c| recording.columns()[*c].prior).collect();
        let nc = 1 + priced.len();
        let middle = recording.updates() / 2;
        let mut half = vec![0.0; nc * nc];
        let mut at = 0;
        let found = run(recording, &recording.base(), &Recorded(&priced), &noise, &mut |whitened| {
            if at < middle {
                for row in whitened.rows.chunks_exact(nc) {
                    for i in 0..nc {
                        for j in 0..nc {
                            half[i * nc + j] += row[i] * row[j];
                        }
                    }
                }
            }
            at += 1;
        })
        .ok_or(SceneError::Indefinite)?;
        let groups = groups_of(recording.columns(), &priced);
        let prices = Prices::new(&found.gram, sigma.clone(), groups.clone());
        let half = Prices::new(&half, sigma, groups);
        Ok(Self { ran, wider, survey: *survey, noise, noise_hides, prices, half })
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
