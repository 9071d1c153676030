//! A channel from its readings to what is known of its noise, and what several channels have in common.

use std::io;

use crate::allan::{Scale, scales};
use crate::bootstrap::{Interval, intervals};
use crate::channel::Finished;
use crate::fit::identify;
use crate::model::{Kind, Process, composite};

/// So many channels are simulated for the intervals.
const SIMULATIONS: u64 = 200;

/// A process that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// The process.
    pub process: Process,
    /// 95 % interval of its size.
    pub size: Interval,
    /// The same of its correlation time, s, where it has one.
    pub time: Option<Interval>,
}

/// The noise of a channel.
#[derive(Clone, Debug)]
pub struct Identified {
    /// Allan's variances.
    pub scales: Vec<Scale>,
    /// The processes whose sum explains them.
    pub components: Vec<Component>,
    /// What was taken out before, as in [`Finished::taken`].
    pub taken: Option<(f64, f64)>,
}

impl Finished {
    /// Finds the noise processes of the channel; `seed` and `stream` say which random numbers the intervals are made with.
    ///
    /// # Errors
    /// When temporary files cannot be read or written.
    pub fn identify(mut self, seed: u64, stream: u64) -> io::Result<Identified> {
        let scales = scales(&mut self.recorded)?;
        let readings = self.recorded.readings();
        let fit = identify(&scales, readings.iter().sum());
        let interval = self.recorded.interval();
        let bounds = intervals(&fit, &scales, &readings, interval, SIMULATIONS, (seed, stream))?;
        let components = fit.processes.into_iter().zip(bounds);
        let components =
            components.map(|(process, (size, time))| Component { process, size, time }).collect();
        Ok(Identified { scales, components, taken: self.taken })
    }
}

impl Identified {
    /// The processes alone.
    pub fn processes(&self) -> Vec<Process> {
        self.components.iter().map(|component| component.process).collect()
    }

    /// Allan deviation of their sum at an averaging time, u.
    pub fn explained(&self, tau: f64) -> f64 {
        composite(&self.processes(), tau).sqrt()
    }

    /// The lowest Allan deviation, u, and its averaging time, s: what is called bias instability, where the curve has a floor.
    pub fn floor(&self) -> Option<(f64, f64)> {
        let known = self.scales.iter().filter(|scale| scale.edf > 2.0);
        known.min_by(|a, b| a.variance.total_cmp(&b.variance)).map(|scale| (scale.deviation(), scale.tau))
    }
}

/// One noise for several channels: of each kind the root of the mean square of the sizes, a channel without it counting as zero. Of
/// Gauss-Markov processes the largest of each channel, at the geometric mean of their times; those that forget within a second are white.
pub fn typical(channels: &[Vec<Process>]) -> Vec<Process> {
    let mut kinds: Vec<Vec<Process>> = Vec::new();
    for channel in channels {
        let mut markov: Option<Process> = None;
        let fast: f64 = channel.iter().filter_map(Process::as_white).map(|white| white.size.powi(2)).sum();
        let slow = || channel.iter().filter(|process| !process.kind.is_fast());
        for process in slow() {
            if process.kind.time().is_some() {
                markov = markov.filter(|largest| largest.size > process.size).or(Some(*process));
            }
        }
        let white = slow().filter(|process| process.kind == Kind::White).map(|white| white.size.powi(2));
        let white = white.sum::<f64>() + fast;
        let white = (white > 0.0).then(|| Process { kind: Kind::White, size: white.sqrt() });
        let plain = slow().filter(|process| process.kind.time().is_none() && process.kind != Kind::White);
        for process in white.into_iter().chain(plain.copied()).chain(markov) {
            let same = |other: &&mut Vec<Process>| {
                std::mem::discriminant(&other[0].kind) == std::mem::discriminant(&process.kind)
            };
            match kinds.iter_mut().find(same) {
                Some(others) => others.push(process),
                None => kinds.push(vec![process]),
            }
        }
    }
    let one = |of: Vec<Process>| {
        let squares: f64 = of.iter().map(|process| process.size * process.size).sum();
        let logs: f64 = of.iter().filter_map(|process| process.kind.time()).map(f64::ln).sum();
        let kind = match of[0].kind {
            Kind::GaussMarkov { .. } => Kind::GaussMarkov { time: (logs / of.len() as f64).exp() },
            kind => kind,
        };
        Process { kind, size: (squares / channels.len() as f64).sqrt() }
    };
    kinds.into_iter().map(one).collect()
}

/// The white noise that several channels could have at most, where none was found in them: what their lowest curve is at each averaging
/// time, u sqrt(s).
pub fn most_white(channels: &[Identified]) -> f64 {
    let of = |channel: &Identified| {
        let white = channel.scales.iter().map(|scale| scale.variance * scale.tau);
        white.filter(|white| *white > 0.0).fold(f64::INFINITY, f64::min)
    };
    let all: f64 = channels.iter().map(of).sum();
    (all / channels.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_have_one_noise_together() {
        let white = |size| Process { kind: Kind::White, size };
        let markov = |size, time| Process { kind: Kind::GaussMarkov { time }, size };
        let found = typical(&[
            vec![white(3.0), markov(1.0, 5.0), markov(2.0, 10.0)],
            vec![white(4.0), markov(1.0, 40.0)],
        ]);
        assert_eq!(found[0], white(12.5_f64.sqrt()));
        let Kind::GaussMarkov { time } = found[1].kind else { panic!("{found:?}") };
        assert!((time - 20.0).abs() < 1e-12 && (found[1].size - 2.5_f64.sqrt()).abs() < 1e-15);
        // filtered within a fiftieth of a second: 2 sigma^2 tau more of white noise
        let filtered = typical(&[vec![white(3.0), markov(20.0, 0.02)]]);
        assert_eq!(filtered.len(), 1);
        assert!(filtered[0].kind == Kind::White && (filtered[0].size - 5.0).abs() < 1e-12, "{filtered:?}");
        let walk = markov(2.0, 8.0).as_walk().expect("a walk");
        assert_eq!(walk, Process { kind: Kind::RandomWalk, size: 1.0 });
    }
}
