//! Noise processes: Allan's variance of each, and series of their sum.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// What kind of process a noise is of. The unit of a reading is u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Quantisation of the running sum, u s: its standard deviation, a digit over the square root of 12.
    Quantisation,
    /// White noise, u sqrt(s): the density (one-sided, u/sqrt(Hz)) over the square root of 2.
    White,
    /// Exponentially correlated noise: its standard deviation, u.
    GaussMarkov {
        /// Correlation time, s.
        time: f64,
    },
    /// Random walk of the reading, u/sqrt(s).
    RandomWalk,
    /// Steady change of the reading, u/s.
    Ramp,
}

/// A process of a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Process {
    /// What it is.
    pub kind: Kind,
    /// How large it is, in the unit of its kind.
    pub size: f64,
}

impl Process {
    /// Allan's variance at an averaging time of `tau` seconds, u^2, of readings that are means over their intervals (IEEE Std 952, annex C).
    pub fn variance(&self, tau: f64) -> f64 {
        self.size * self.size * self.kind.unit_variance(tau)
    }

    /// The random walk that a Gauss-Markov process is for times far below its correlation time.
    pub fn as_walk(&self) -> Option<Self> {
        match self.kind {
            Kind::GaussMarkov { time } => {
                Some(Self { kind: Kind::RandomWalk, size: self.size * (2.0 / time).sqrt() })
            }
            Kind::RandomWalk => Some(*self),
            _ => None,
        }
    }
}

/// A process that forgets within this time, s, is a filter in the unit, not a wander of its bias: over a second and more it is white.
const FAST: f64 = 1.0;

impl Process {
    /// The white noise that a Gauss-Markov process is for times far above its correlation time, where that is short.
    pub(crate) fn as_white(&self) -> Option<Self> {
        let time = self.kind.time().filter(|_| self.kind.is_fast())?;
        Some(Self { kind: Kind::White, size: self.size * (2.0 * time).sqrt() })
    }
}

impl Kind {
    /// Whether it is correlated, but forgets within a second: what an anti-aliasing filter makes of white noise.
    pub fn is_fast(self) -> bool {
        self.time().is_some_and(|time| time < FAST)
    }

    /// Correlation time, s, where there is one.
    pub fn time(self) -> Option<f64> {
        match self {
            Self::GaussMarkov { time } => Some(time),
            _ => None,
        }
    }

    /// Allan's variance of a process of size 1.
    pub(crate) fn unit_variance(self, tau: f64) -> f64 {
        match self {
            Self::Quantisation => 3.0 / (tau * tau),
            Self::White => 1.0 / tau,
            Self::GaussMarkov { time } => {
                let x = tau / time;
                relaxed(x) / (x * x)
            }
            Self::RandomWalk => tau / 3.0,
            Self::Ramp => 0.5 * tau * tau,
        }
    }

    /// Change of the logarithm of that with the logarithm of the correlation time.
    pub(crate) fn sensitivity(self, tau: f64) -> f64 {
        match self {
            Self::GaussMarkov { time } => {
                let x = tau / time;
                let faded = -(-x).exp_m1();
                2.0 - 2.0 * x * faded * faded / relaxed(x)
            }
            _ => 0.0,
        }
    }
}

/// 2 x - 3 + 4 exp(-x) - exp(-2 x), by its series where that is a difference of large numbers.
fn relaxed(x: f64) -> f64 {
    if x < 1e-2 {
        return x * x * x * (2.0 / 3.0 - x * (0.5 - x * (7.0 / 30.0 - x / 12.0)));
    }
    2.0 * x - 3.0 + 4.0 * (-x).exp() - (-2.0 * x).exp()
}

/// Allan's variance of a sum of processes.
pub fn composite(processes: &[Process], tau: f64) -> f64 {
    processes.iter().map(|process| process.variance(tau)).sum()
}

/// Hands over `count` readings of a sum of processes, u: means over intervals of so many seconds.
pub fn simulate(
    processes: &[Process],
    interval: f64,
    count: usize,
    random: &mut impl Rng,
    each: &mut dyn FnMut(f64),
) {
    let mut sources: Vec<Source> =
        processes.iter().map(|process| Source::new(*process, interval, random)).collect();
    for _ in 0..count {
        each(sources.iter_mut().map(|source| source.next(random)).sum());
    }
}

/// A process as it runs.
enum Source {
    White(f64),
    /// Size over the interval, and the rounding error of the sum before.
    Quantisation(f64, f64),
    /// Its state at the end of the interval before, what is left of that, the part of it in the mean, and the factors by which two normal numbers
    /// enter state and mean.
    Markov {
        state: f64,
        left: f64,
        mean: f64,
        factors: [f64; 3],
    },
    Walk(f64, f64),
    Ramp(f64, f64),
}

fn normal(random: &mut impl Rng) -> f64 {
    StandardNormal.sample(random)
}

impl Source {
    fn new(process: Process, interval: f64, random: &mut impl Rng) -> Self {
        let size = process.size;
        match process.kind {
            Kind::White => Self::White(size / interval.sqrt()),
            Kind::Quantisation => {
                let size = size / interval;
                Self::Quantisation(size, size * normal(random))
            }
            Kind::GaussMarkov { time } => {
                let x = interval / time;
                let left = (-x).exp();
                let faded = -(-x).exp_m1();
                // covariance of what comes to the state and to the mean, by its root
                let to_state = (-(-2.0 * x).exp_m1()).sqrt();
                let both = faded * faded / x;
                let to_mean = relaxed(x) / (x * x);
                let shared = both / to_state;
                let own = (to_mean - shared * shared).max(0.0).sqrt();
                let factors = [to_state, shared, own].map(|factor| factor * size);
                Self::Markov { state: size * normal(random), left, mean: faded / x, factors }
            }
            Kind::RandomWalk => Self::Walk(size * interval.sqrt(), 0.0),
            Kind::Ramp => Self::Ramp(size * interval, 0.0),
        }
    }

    fn next(&mut self, random: &mut impl Rng) -> f64 {
        match self {
            Self::White(size) => *size * normal(random),
            Self::Quantisation(size, before) => {
                let after = *size * normal(random);
                after - std::mem::replace(before, after)
            }
            Self::Markov { state, left, mean, factors: [to_state, shared, own] } => {
                let (a, b) = (normal(random), normal(random));
                let reading = *mean * *state + *shared * a + *own * b;
                *state = *left * *state + *to_state * a;
                reading
            }
            Self::Walk(size, state) => {
                let (a, b) = (normal(random), normal(random));
                let reading = *state + *size * (0.5 * a + b / 12_f64.sqrt());
                *state += *size * a;
                reading
            }
            Self::Ramp(step, state) => {
                *state += *step;
                *state
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use chacha20::ChaCha8Rng;
    use rand::SeedableRng;

    use super::*;
    use crate::{Recorded, scales};

    #[test]
    fn a_fast_one_is_white_and_a_slow_one_walks() {
        let fast = Process { kind: Kind::GaussMarkov { time: 1e-4 }, size: 3.0 };
        let slow = Process { kind: Kind::GaussMarkov { time: 1e6 }, size: 3.0 };
        // density 2 sigma^2 T, at both ends
        assert!((fast.variance(1.0) / (2.0 * 9.0 * 1e-4) - 1.0).abs() < 2e-4);
        assert!((slow.variance(1.0) / (2.0 * 9.0 / 1e6 / 3.0) - 1.0).abs() < 1e-5);
        // the series goes over into the formula
        assert!((relaxed(0.01) / relaxed(0.01 - 1e-12) - 1.0).abs() < 1e-8);
        // its largest deviation is 0.437 q sqrt(T) at 1.89 T, with sigma^2 = q^2 T / 2 (IEEE Std 952, C.1.1.4)
        let peak = Process { kind: Kind::GaussMarkov { time: 1.0 }, size: 1.0 };
        assert!((peak.variance(1.89).sqrt() - 0.437 * 2_f64.sqrt()).abs() < 7e-4);
        for tau in [1e-3, 0.3, 40.0] {
            let log = |time: f64| Kind::GaussMarkov { time }.unit_variance(tau).ln();
            let numeric = (log(1.0001) - log(0.9999)) / (1.0001_f64.ln() - 0.9999_f64.ln());
            let exact = Kind::GaussMarkov { time: 1.0 }.sensitivity(tau);
            assert!((numeric - exact).abs() < 1e-4, "{tau}: {numeric} {exact}");
        }
    }

    /// A simulated process has the variances that the formula says, within five standard deviations of their mean.
    #[test]
    fn what_is_simulated_has_its_variances() -> std::io::Result<()> {
        for kind in
            [Kind::Quantisation, Kind::White, Kind::GaussMarkov { time: 0.5 }, Kind::RandomWalk, Kind::Ramp]
        {
            let process = Process { kind, size: 2.0 };
            let mut readings = Vec::new();
            let mut random = ChaCha8Rng::seed_from_u64(5);
            simulate(&[process], 0.1, 20_000, &mut random, &mut |reading| readings.push(reading));
            for scale in scales(&mut Recorded::of(&readings, 0.1)?)?.iter().take(9) {
                let off = scale.variance / process.variance(scale.tau) - 1.0;
                let most = if kind == Kind::Ramp { 1e-9 } else { 5.0 * (2.0 / scale.edf).sqrt() };
                assert!(off.abs() < most, "{kind:?} {scale:?}: off by {off}");
            }
        }
        Ok(())
    }
}
