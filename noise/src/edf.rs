//! Equivalent degrees of freedom of an overlapping Allan variance.
//!
//! The formulas are those of Howe, Allan and Barnes (1981), as W. J. Riley, "Handbook of Frequency Stability Analysis", NIST Special
//! Publication 1065 (2008), section 5.4, gives them: good to some per cent, for the power laws of clocks, in whose words a
//! sensor's reading is a frequency. Quantisation is white phase noise, white noise is white frequency noise.

/// Which power law a spectrum follows about one averaging time; where Allan's variance goes with the power of it that is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerLaw {
    /// -2, white phase noise: quantisation.
    WhitePhase,
    /// -1, white noise.
    White,
    /// 0, flicker noise: bias instability.
    Flicker,
    /// +1, random walk; also what rises more steeply.
    RandomWalk,
}

impl PowerLaw {
    /// By the slope of the logarithm of Allan's variance.
    pub(crate) fn of_slope(slope: f64) -> Self {
        match slope {
            slope if slope < -1.5 => Self::WhitePhase,
            slope if slope < -0.5 => Self::White,
            slope if slope < 0.5 => Self::Flicker,
            _ => Self::RandomWalk,
        }
    }
}

/// Equivalent degrees of freedom of the overlapping Allan variance of `points` running sums (one more than readings) at an averaging
/// time of `m` readings; at least one.
pub fn edf(law: PowerLaw, points: u64, m: u64) -> f64 {
    let (n, m) = (points as f64, m as f64);
    let edf = match law {
        PowerLaw::WhitePhase => (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m)),
        PowerLaw::White => {
            let squared = 4.0 * m * m;
            (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * squared / (squared + 5.0)
        }
        PowerLaw::Flicker if m == 1.0 => 2.0 * (n - 2.0) * (n - 2.0) / (2.3 * n - 4.9),
        PowerLaw::Flicker => 5.0 * n * n / (4.0 * m * (n + 3.0 * m)),
        PowerLaw::RandomWalk => {
            let whole = (n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m;
            (n - 2.0) / m * whole / ((n - 3.0) * (n - 3.0))
        }
    };
    if edf.is_finite() { edf.max(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By `allantools.ci.edf_simple`, and for flicker noise at one reading by the table itself, whose square allantools 2024.6 lacks.
    #[test]
    fn the_formulas_are_those_of_the_handbook() {
        for (law, points, m, expected) in [
            (PowerLaw::WhitePhase, 1001, 8, 496.963_746_223_564_95),
            (PowerLaw::White, 1001, 8, 181.950_279_605_452),
            (PowerLaw::Flicker, 1001, 8, 152.744_054_878_048_8),
            (PowerLaw::RandomWalk, 1001, 8, 122.399_074_702_511_23),
            (PowerLaw::Flicker, 1001, 1, 2.0 * 999.0 * 999.0 / (2.3 * 1001.0 - 4.9)),
        ] {
            let found = edf(law, points, m);
            assert!((found / expected - 1.0).abs() < 1e-12, "{law:?}: {found}");
        }
        // as long as half of all: there is one term, and it has one
        assert_eq!(edf(PowerLaw::WhitePhase, 9, 4), 1.0);
    }
}
