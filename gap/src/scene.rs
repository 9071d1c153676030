//! A log as the diagnosis sees it: run with everything in the filter, noise fitted, every effect priced.

use sinscal::Diverged;

use crate::linear::{Noise, Recorded, run};
use crate::noise;
use crate::prices::{BEYOND, Prices, groups_of};
use crate::run::{Log, Machine, Ran};

/// A reference that stays within so many of its standard deviations does not move.
const STILL: f64 = 10.0;
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
        for (column, (estimate, _)) in ran.recording.columns().iter().zip(&ran.estimate) {
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
    /// Whether the observed point stays where it is.
    pub(crate) fixed: bool,
    pub(crate) noise: Noise,
    /// Whether the noise is so much more than stated that it may hide anything.
    pub(crate) noise_hides: bool,
    pub(crate) prices: Prices,
    /// The same from the first half of the log alone.
    pub(crate) half: Prices,
}

impl Scene {
    pub(crate) fn new(machine: &dyn Machine, log: &Log) -> Result<Self, SceneError> {
        let attitude = log.samples.iter().any(|s| s.reference.attitude.is_some());
        let fixed = !attitude && is_fixed(log);
        // the Jacobian of a delay is the observed point's motion; of a fixed point that is nothing but noise
        let takes = |block: &str| match block {
            "reference-delay" => !fixed,
            "reference-misalignment" => attitude,
            _ => true,
        };
        let mut wider = Wider::default();
        let mut ran = machine.run(log, &|block| if takes(block) { 1.0 } else { 0.0 })?;
        for _ in 0..WIDENINGS {
            if !wider.widen(&ran) {
                break;
            }
            ran = machine.run(log, &|block| if takes(block) { wider.factor(block) } else { 0.0 })?;
        }
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
        Ok(Self { ran, wider, fixed, noise, noise_hides, prices, half })
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

/// Whether the observed point stays where it is.
fn is_fixed(log: &Log) -> bool {
    let sigma = &log.setup.reference;
    let mut first = None;
    log.samples.iter().all(|s| {
        let still = s.reference.velocity.is_none_or(|v| v.amax() < STILL * sigma.velocity);
        let there = s.reference.position.is_none_or(|p| {
            let from: &nalgebra::Vector3<f64> = first.get_or_insert(p);
            (p - *from).amax() < STILL * sigma.position
        });
        still && there
    })
}

/// Why a log cannot be diagnosed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SceneError {
    Diverged(Diverged),
    TooShort { updates: usize },
    Indefinite,
}

impl From<Diverged> for SceneError {
    fn from(diverged: Diverged) -> Self {
        Self::Diverged(diverged)
    }
}
