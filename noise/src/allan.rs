//! The overlapping Allan variance in octaves of the averaging time, over all stretches of a channel.

use std::io;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::TAIL;
use crate::edf::{PowerLaw, edf};
use crate::record::Recorded;

/// So many points are looked at in one go; averaging times of up to half of it share one reading of the file.
const WINDOW: usize = 1 << 16;
/// With fewer terms nothing is said of an averaging time.
const FEWEST: u64 = 1;

/// Allan's variance at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Readings that are averaged.
    pub m: u64,
    /// Averaging time, s.
    pub tau: f64,
    /// Number of differences of neighbouring averages, overlapping.
    pub terms: u64,
    /// Allan's variance, u^2.
    pub variance: f64,
    /// Which power law the variances about it show.
    pub law: PowerLaw,
    /// Equivalent degrees of freedom.
    pub edf: f64,
}

impl Scale {
    /// Allan deviation, u.
    pub fn deviation(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Between these lies the deviation of infinitely many readings in 95 of 100 cases, u.
    pub fn bounds(&self) -> (f64, f64) {
        let Ok(chi) = ChiSquared::new(self.edf) else { return (0.0, f64::INFINITY) };
        let bound = |probability: f64| (self.variance * self.edf / chi.inverse_cdf(probability)).sqrt();
        (bound(1.0 - TAIL), bound(TAIL))
    }
}

/// Sum of squared second differences of running sums, and their number.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    squares: f64,
    terms: u64,
}

impl Sum {
    /// Takes in the differences that begin at each point of `first`; `middle` and `last` are m and 2 m points on.
    fn add(&mut self, first: &[f64], middle: &[f64], last: &[f64]) {
        let squares = first.iter().zip(middle).zip(last).map(|((first, middle), last)| {
            let difference = last - 2.0 * middle + first;
            difference * difference
        });
        self.squares += squares.sum::<f64>();
        self.terms += first.len() as u64;
    }
}

/// Allan's variances at averaging times of 1, 2, 4, ... readings, up to half of the longest stretch.
///
/// # Errors
/// When the temporary file cannot be read.
pub fn scales(recorded: &mut Recorded) -> io::Result<Vec<Scale>> {
    let stretches = recorded.stretches().to_vec();
    let longest = stretches.iter().copied().max().unwrap_or(0);
    let octaves: Vec<u64> = (0..62).map(|j| 1 << j).take_while(|m| 2 * m + FEWEST <= longest).collect();
    let mut sums = vec![Sum::default(); octaves.len()];
    let mut begin = 0;
    for points in &stretches {
        near(recorded, begin, *points, &octaves, &mut sums)?;
        for (m, sum) in octaves.iter().zip(&mut sums).filter(|(m, _)| !is_near(**m)) {
            far(recorded, begin, *points, *m, sum)?;
        }
        begin += points;
    }
    let interval = recorded.interval();
    let mut scales: Vec<Scale> = octaves
        .iter()
        .zip(&sums)
        .map(|(m, sum)| {
            let tau = *m as f64 * interval;
            let variance = sum.squares / (2.0 * tau * tau * sum.terms as f64);
            Scale { m: *m, tau, terms: sum.terms, variance, law: PowerLaw::White, edf: 1.0 }
        })
        .collect();
    let logs: Vec<f64> = scales.iter().map(|scale| scale.variance.ln()).collect();
    let mut quantised = true;
    for (at, scale) in scales.iter_mut().enumerate() {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(logs.len() - 1));
        let octaves = (after - before).max(1) as f64 * std::f64::consts::LN_2;
        scale.law = PowerLaw::of_slope((logs[after] - logs[before]) / octaves);
        // Quantisation shows before anything else does. What falls as steeply later is the scatter of a few terms, or a vibration
        // between longer and shorter times: neither has the degrees of freedom of white phase noise, which are many.
        quantised &= scale.law == PowerLaw::WhitePhase;
        if scale.law == PowerLaw::WhitePhase && !quantised {
            scale.law = PowerLaw::White;
        }
        scale.edf = together(scale.law, &stretches, scale.m);
    }
    Ok(scales)
}

/// Degrees of freedom of a mean over stretches, each of which counts by its terms.
pub(crate) fn together(law: PowerLaw, stretches: &[u64], m: u64) -> f64 {
    let terms = |points: u64| points.saturating_sub(2 * m) as f64;
    let of_one = |points: &u64| terms(*points) * terms(*points) / edf(law, *points, m);
    let all: f64 = stretches.iter().map(|points| terms(*points)).sum();
    let parts: f64 = stretches.iter().filter(|points| terms(**points) > 0.0).map(of_one).sum();
    if parts > 0.0 { all * all / parts } else { 1.0 }
}

fn is_near(m: u64) -> bool {
    4 * m <= WINDOW as u64
}

/// Short averaging times: one reading of the stretch serves all of them.
fn near(
    recorded: &mut Recorded,
    begin: u64,
    points: u64,
    octaves: &[u64],
    sums: &mut [Sum],
) -> io::Result<()> {
    let reach = octaves.iter().filter(|m| is_near(**m)).map(|m| 2 * m).max().unwrap_or(0);
    let step = WINDOW as u64 - reach;
    let mut window = vec![0.0; WINDOW.min(points as usize)];
    let mut start = 0;
    while start < points {
        let length = (points - start).min(WINDOW as u64) as usize;
        recorded.read(begin + start, &mut window[..length])?;
        for (m, sum) in octaves.iter().zip(sums.iter_mut()).filter(|(m, _)| is_near(**m)) {
            let m = *m as usize;
            let firsts = length.saturating_sub(2 * m).min(step as usize);
            sum.add(&window[..firsts], &window[m.min(length)..], &window[(2 * m).min(length)..length]);
        }
        start += step;
    }
    Ok(())
}

/// A long averaging time: three places of the stretch are read side by side.
fn far(recorded: &mut Recorded, begin: u64, points: u64, m: u64, sum: &mut Sum) -> io::Result<()> {
    let mut windows = [const { Vec::new() }; 3];
    let firsts = points.saturating_sub(2 * m);
    let mut start = 0;
    while start < firsts {
        let length = (firsts - start).min(WINDOW as u64) as usize;
        for (of, window) in windows.iter_mut().enumerate() {
            window.resize(length, 0.0);
            recorded.read(begin + start + of as u64 * m, window)?;
        }
        sum.add(&windows[0], &windows[1], &windows[2]);
        start += length as u64;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recorder;

    /// What `numpy.random.default_rng` is not needed for: numbers anybody can make.
    fn series(count: usize) -> Vec<f64> {
        (0..count).map(|k| ((k * k) as f64 * 0.1).sin() + 1e-4 * k as f64).collect()
    }

    /// By the definition, term by term.
    fn plainly(readings: &[f64], m: usize) -> (f64, u64) {
        let mean = |from: usize| readings[from..from + m].iter().sum::<f64>() / m as f64;
        let terms = readings.len() + 1 - 2 * m;
        let sum: f64 = (0..terms).map(|k| (mean(k + m) - mean(k)).powi(2)).sum();
        (sum / (2.0 * terms as f64), terms as u64)
    }

    #[test]
    fn it_is_what_the_definition_says() -> io::Result<()> {
        let readings = series(5000);
        for scale in scales(&mut Recorded::of(&readings, 0.01)?)? {
            let (variance, terms) = plainly(&readings, scale.m as usize);
            assert_eq!(scale.terms, terms);
            assert!((scale.variance / variance - 1.0).abs() < 1e-10, "{scale:?} {variance}");
        }
        Ok(())
    }

    /// Longer than a window, and with averaging times beyond it: the same sums in one piece.
    #[test]
    fn windows_leave_no_seam() -> io::Result<()> {
        let readings = series(5 * WINDOW / 2 + 17);
        let mut sums = vec![0.0];
        for reading in &readings {
            sums.push(sums[sums.len() - 1] + (reading - readings[0]) * 0.01);
        }
        let scales = scales(&mut Recorded::of(&readings, 0.01)?)?;
        assert!(scales.iter().any(|scale| !is_near(scale.m)));
        for scale in scales {
            let m = scale.m as usize;
            let terms = sums.len() - 2 * m;
            let sum: f64 = (0..terms).map(|k| (sums[k + 2 * m] - 2.0 * sums[k + m] + sums[k]).powi(2)).sum();
            let variance = sum / (2.0 * scale.tau * scale.tau * terms as f64);
            assert_eq!(scale.terms, terms as u64);
            assert!((scale.variance / variance - 1.0).abs() < 1e-10, "{scale:?} {variance}");
        }
        Ok(())
    }

    /// Stretches are averaged by their terms, and what lies between them does not count.
    #[test]
    fn stretches_are_taken_together() -> io::Result<()> {
        let (one, other) = (series(700), series(300));
        let mut recorder = Recorder::new(1.0)?;
        one.iter().try_for_each(|reading| recorder.push(*reading))?;
        recorder.interrupt();
        other.iter().try_for_each(|reading| recorder.push(reading + 1e3))?;
        for scale in scales(&mut recorder.finish()?)?.iter().take(7) {
            let m = scale.m as usize;
            let ((a, n), (b, k)) = (plainly(&one, m), plainly(&other, m));
            let both = (a * n as f64 + b * k as f64) / (n + k) as f64;
            assert!((scale.variance / both - 1.0).abs() < 1e-9, "{scale:?} {both}");
            assert!(scale.edf < edf(scale.law, 1001, scale.m) && scale.edf > edf(scale.law, 701, scale.m));
        }
        Ok(())
    }

    /// Bounds of a chi-squared distribution of ten degrees of freedom: 3.247 and 20.483 in any table.
    #[test]
    fn bounds_are_those_of_chi_squared() {
        let scale = Scale { m: 1, tau: 1.0, terms: 11, variance: 1.0, law: PowerLaw::White, edf: 10.0 };
        let (low, high) = scale.bounds();
        assert!((low * low - 10.0 / 20.4832).abs() < 1e-5 && (high * high - 10.0 / 3.24697).abs() < 1e-5);
    }
}
