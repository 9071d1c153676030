//! Pricing by itself: what every effect is worth to a filter, from one run.

use runs::AnyFilter;
use sinscal::AnyEffect;

use crate::error::{Error, Which};
use crate::linear::{Noise, Recorded, run};
use crate::log::Log;
use crate::noise;
use crate::prices::Prices;
use crate::recording::Recording;
use crate::run::{Machine, Runs};

/// The price of every candidate of a log, and of every set of them.
///
/// ```no_run
/// # fn with(log: &gap::Log) -> Result<(), gap::Error> {
/// let vocabulary = runs::Vocabulary::standard();
/// let filter = vocabulary.filter("36d-p").expect("a filter of the library");
/// let prices = gap::Pricing::of(&*filter, vocabulary.effects(), log, gap::Noise::STATED)?;
/// println!("the delay gains {:?}", prices.gain(&["accel-delay"]));
/// # Ok(())
/// # }
/// ```
pub struct Pricing {
    recording: Recording,
    noise: Noise,
    base: f64,
    prices: Prices,
}

impl Pricing {
    /// Prices those of `effects` that `filter` lacks, about one trajectory with all of them.
    ///
    /// # Errors
    /// When the filter diverges, or the effects cannot be added to it.
    pub fn of(
        filter: &dyn AnyFilter,
        effects: &[&'static dyn AnyEffect],
        log: &Log,
        noise: Noise,
    ) -> Result<Self, Error> {
        let machine = Runs::new(filter, effects)?;
        let ran = machine.run(log, &noise, &|_| 1.0).map_err(|e| Error::of(Which::FIRST, e))?;
        Ok(Self { recording: ran.recording, noise, base: ran.log_likelihood, prices: ran.prices })
    }

    /// Prices the catalogue again about the same trajectory, under another noise.
    ///
    /// # Errors
    /// When that noise leaves an innovation covariance that is not positive definite.
    pub fn reprice(&mut self, noise: Noise) -> Result<(), Error> {
        let (found, prices) =
            noise::price(&self.recording, &noise).ok_or(Error::Indefinite { log: Which::FIRST })?;
        (self.noise, self.base, self.prices) = (noise, found.log_likelihood, prices);
        Ok(())
    }

    /// Names of the effects, in the order of the catalogue.
    pub fn effects(&self) -> impl Iterator<Item = &str> {
        self.prices.groups.iter().map(|g| g.name.as_str())
    }

    /// Log-likelihood of the base filter.
    pub fn base(&self) -> f64 {
        self.base
    }

    fn groups(&self, effects: &[&str]) -> Option<Vec<usize>> {
        effects.iter().map(|e| self.prices.find(e)).collect()
    }

    /// What `effects` gain in log-likelihood; nothing when one is unknown. Exact for a linear filter.
    pub fn gain(&self, effects: &[&str]) -> Option<f64> {
        Some(self.prices.gain(&self.groups(effects)?))
    }

    /// The same by running the filter with `effects` in it, linearly about the same trajectory: what [`gain`](Self::gain)
    /// saves.
    pub fn gain_by_running(&self, effects: &[&str]) -> Option<f64> {
        let groups = self.groups(effects)?;
        let priced = self.recording.candidates();
        let mut columns = self.recording.base();
        columns.extend(self.prices.members(&groups).into_iter().map(|m| priced[m]));
        let found = run(&self.recording, &columns, &Recorded(&[]), &self.noise, &mut |_| {})?;
        Some(found.log_likelihood - self.base)
    }

    /// Estimates of `effects` and their standard deviations, component by component, SI.
    pub fn estimate(&self, effects: &[&str]) -> Option<Vec<(f64, f64)>> {
        let (mean, covariance) = self.prices.posterior(&self.groups(effects)?)?;
        Some((0..mean.len()).map(|i| (mean[i], covariance[(i, i)].sqrt())).collect())
    }
}
