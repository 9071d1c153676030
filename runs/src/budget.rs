//! What a standard deviation is made of.

use crate::Outcome;

/// The uncertainty budget of a parameter: standard uncertainties, SI, whose root sum of squares is the parameter's sigma.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Budget {
    /// Place of the parameter in the outcome.
    pub parameter: usize,
    /// White noise of sensors and reference, and what was known before.
    pub noise: f64,
    /// The biases' wander, where the filter has it.
    pub wander: f64,
    /// What each considered effect adds, in the order of the filter: its standard uncertainty times the sensitivity of the estimate, and
    /// its share of the noise that is there because readings must not be leaned on where it could spoil them.
    pub influences: Vec<(&'static str, f64)>,
    /// What another pass would move.
    pub linearisation: f64,
    /// Stretches of the log that differ by more than their noise allows.
    pub repeatability: f64,
    /// Degrees of freedom behind the noise, and behind the repeatability.
    pub(crate) freedom: (f64, f64),
}

impl Budget {
    /// Combined standard uncertainty.
    pub fn combined(&self) -> f64 {
        let own = [self.noise, self.wander, self.linearisation, self.repeatability];
        let influences = self.influences.iter().map(|(_, part)| *part);
        own.into_iter().chain(influences).fold(0.0, f64::hypot)
    }

    /// Effective degrees of freedom by Welch and Satterthwaite (JCGM 100:2008, G.4.1): those of the noise and of the repeatability; what is
    /// stated, not observed, has as many as one likes.
    pub fn degrees_of_freedom(&self) -> f64 {
        let term = |part: f64, freedom: f64| if part > 0.0 { part.powi(4) / freedom } else { 0.0 };
        self.combined().powi(4)
            / (term(self.noise, self.freedom.0) + term(self.repeatability, self.freedom.1))
    }

    /// Leaves to the noise what it is where nothing is considered, `alone`, and shares what it is more among the influences, as they are: a
    /// filter that may not trust the readings that an influence spoils leans on worse ones, and lets in their noise.
    pub(crate) fn blame(&mut self, alone: f64) {
        let more = self.noise.powi(2) - alone.powi(2);
        let spoilt: f64 = self.influences.iter().map(|(_, part)| part * part).sum();
        if more > 0.0 && spoilt > 0.0 {
            let grows = (1.0 + more / spoilt).sqrt();
            self.influences.iter_mut().for_each(|(_, part)| *part *= grows);
            self.noise = alone;
        }
    }

    /// Takes in the variance by which stretches of the log differ beyond their noise, with its degrees of freedom: what the influences allow
    /// of it is in them already.
    pub(crate) fn scatter(&mut self, variance: f64, freedom: f64) {
        let allowed: f64 = self.influences.iter().map(|(_, part)| part * part).sum();
        self.repeatability = (variance - allowed).max(0.0).sqrt();
        self.freedom.1 = freedom;
    }

    /// The largest of the influences.
    pub fn largest(&self) -> Option<(&'static str, f64)> {
        self.influences.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a })
    }
}

/// The budget of each parameter that is not considered, of a pass of a filter that considers the blocks called `considered`.
///
/// A considered state keeps its prior, and errors of others depend on it linearly: with p its error and S their sensitivity, the
/// covariance of both is `S var(p)`, and what p adds to the variance of the estimate is `S^2 var(p)`, the square of the covariance over the
/// variance. The states of the priors are independent, so that their parts add up.
pub(crate) fn budget(outcome: &Outcome, considered: &[&str]) -> Vec<Budget> {
    let p = &outcome.covariance;
    let is_considered = |i: usize| considered.contains(&outcome.parameters[i].info.block);
    let all = 0..outcome.parameters.len();
    let readings = outcome.statistics.degrees_of_freedom.saturating_sub(outcome.parameters.len());
    all.clone()
        .filter(|i| !is_considered(*i))
        .map(|i| {
            let mut influences: Vec<(&'static str, f64)> = Vec::new();
            let mut rest = p[i][i];
            for j in all.clone().filter(|j| is_considered(*j)) {
                let part = if p[j][j] > 0.0 { p[i][j] * p[i][j] / p[j][j] } else { 0.0 };
                rest -= part;
                let name = outcome.parameters[j].info.block;
                match influences.last_mut().filter(|(last, _)| *last == name) {
                    Some((_, sum)) => *sum += part,
                    None => influences.push((name, part)),
                }
            }
            influences.iter_mut().for_each(|(_, part)| *part = part.sqrt());
            Budget {
                parameter: i,
                noise: rest.max(0.0).sqrt(),
                influences,
                freedom: (readings.max(1) as f64, f64::INFINITY),
                ..Budget::default()
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_let_in_for_an_influence_counts_to_it() {
        let influences = vec![("clock-scale", 3.0), ("site-gravity", 4.0)];
        let before = Budget { noise: 13.0, influences, ..Budget::default() };
        let mut after = before.clone();
        after.blame(5.0);
        assert!((after.combined() - before.combined()).abs() < 1e-12);
        assert_eq!(after.noise, 5.0);
        assert!((after.influences[0].1 / after.influences[1].1 - 0.75).abs() < 1e-12);
        // what is less noise than without is left alone
        let mut less = before.clone();
        less.blame(14.0);
        assert_eq!(less, before);
    }

    #[test]
    fn scatter_that_influences_allow_is_counted_once() {
        let influences = vec![("clock-scale", 3.0), ("site-gravity", 4.0)];
        let before = Budget { noise: 1.0, influences, freedom: (100.0, f64::INFINITY), ..Budget::default() };
        let mut within = before.clone();
        within.scatter(24.0, 5.0);
        assert_eq!((within.repeatability, within.combined()), (0.0, before.combined()));
        let mut beyond = before.clone();
        beyond.scatter(25.0 + 144.0, 5.0);
        assert!((beyond.repeatability - 12.0).abs() < 1e-12);
        // 1 + 9 + 16 + 144, of which 1 has a hundred degrees of freedom and 144 have five
        assert!((beyond.combined().powi(2) - 170.0).abs() < 1e-9);
        let expected = 170.0_f64.powi(2) / (1.0 / 100.0 + 144.0_f64.powi(2) / 5.0);
        assert!((beyond.degrees_of_freedom() / expected - 1.0).abs() < 1e-12);
    }
}
