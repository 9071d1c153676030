//! A channel with what drives it: the part of its readings that goes with a temperature is taken out before noise is looked for.

use std::io;

use crate::record::{Recorded, Recorder};

/// Takes in the readings of a channel with a temperature, stretch by stretch.
#[derive(Debug)]
pub struct Channel {
    readings: Recorder,
    temperatures: Recorder,
    stretch: Stretch,
    /// Sums of squares and products of all stretches before, each about its own means.
    squares: f64,
    products: f64,
    /// Lowest and highest temperature.
    range: (f64, f64),
    lacking: bool,
}

/// Means and sums about them of the present stretch.
#[derive(Clone, Copy, Debug, Default)]
struct Stretch {
    count: f64,
    mean: [f64; 2],
    squares: f64,
    products: f64,
}

/// A channel that is complete.
#[derive(Debug)]
pub struct Finished {
    /// Its readings, without what goes with temperature.
    pub recorded: Recorded,
    /// What was taken out: change of the reading with temperature, u/K, and the span of temperatures, K. Nothing where they moved by less than
    /// was asked for.
    pub taken: Option<(f64, f64)>,
}

impl Channel {
    /// For readings that are so far apart, s.
    ///
    /// # Errors
    /// When there is no room for temporary files.
    pub fn new(interval: f64) -> io::Result<Self> {
        Ok(Self {
            readings: Recorder::new(interval)?,
            temperatures: Recorder::new(interval)?,
            stretch: Stretch::default(),
            squares: 0.0,
            products: 0.0,
            range: (f64::INFINITY, f64::NEG_INFINITY),
            lacking: false,
        })
    }

    /// Takes in a reading, u, with the temperature, if there is one; `begins` says that it does not follow the one before.
    ///
    /// # Errors
    /// When the temporary files are full.
    pub fn push(&mut self, begins: bool, reading: f64, temperature: Option<f64>) -> io::Result<()> {
        if begins {
            self.close();
            self.readings.interrupt();
            self.temperatures.interrupt();
        }
        self.readings.push(reading)?;
        let Some(temperature) = temperature.filter(|_| !self.lacking) else {
            self.lacking = true;
            return Ok(());
        };
        self.range = (self.range.0.min(temperature), self.range.1.max(temperature));
        let stretch = &mut self.stretch;
        stretch.count += 1.0;
        let off = [temperature - stretch.mean[0], reading - stretch.mean[1]];
        stretch.mean[0] += off[0] / stretch.count;
        stretch.mean[1] += off[1] / stretch.count;
        stretch.squares += off[0] * (temperature - stretch.mean[0]);
        stretch.products += off[0] * (reading - stretch.mean[1]);
        self.temperatures.push(temperature)
    }

    fn close(&mut self) {
        let stretch = std::mem::take(&mut self.stretch);
        self.squares += stretch.squares;
        self.products += stretch.products;
    }

    /// No more readings. Where the temperature moved by `least` kelvin or more, the straight line of the readings over it, with a constant of
    /// its own in each stretch, is taken out.
    ///
    /// # Errors
    /// When the temporary files cannot be read or written.
    pub fn finish(mut self, least: f64) -> io::Result<Finished> {
        self.close();
        let mut recorded = self.readings.finish()?;
        let span = self.range.1 - self.range.0;
        if self.lacking || !(span >= least) || self.squares == 0.0 {
            return Ok(Finished { recorded, taken: None });
        }
        let slope = self.products / self.squares;
        recorded.subtract(slope, &mut self.temperatures.finish()?)?;
        Ok(Finished { recorded, taken: Some((slope, span)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scales;

    /// Readings that go with temperature, in two stretches with constants of their own: what is left has the variances of the noise alone.
    #[test]
    fn what_goes_with_temperature_is_taken_out() -> io::Result<()> {
        let noise = |k: usize| ((k * k) as f64 * 0.37).sin();
        let warm = |k: usize| 20.0 + 15.0 * (1.0 - (-(k as f64) / 8000.0).exp());
        let (mut channel, mut alone) = (Channel::new(0.1)?, Recorder::new(0.1)?);
        for k in 0..20_000 {
            let begins = k == 12_000;
            let constant = if k < 12_000 { 3.0 } else { -50.0 };
            channel.push(begins, noise(k) + 2.0 * warm(k) + constant, Some(warm(k)))?;
            if begins {
                alone.interrupt();
            }
            alone.push(noise(k))?;
        }
        let Finished { mut recorded, taken } = channel.finish(1.0)?;
        let (slope, span) = taken.expect("a slope");
        assert!((slope - 2.0).abs() < 2e-3 && (span - 13.77).abs() < 0.01, "{slope} {span}");
        for (left, alone) in scales(&mut recorded)?.iter().zip(scales(&mut alone.finish()?)?).take(9) {
            assert!((left.variance / alone.variance - 1.0).abs() < 0.05, "{left:?} {alone:?}");
        }
        Ok(())
    }

    #[test]
    fn without_temperature_nothing_is_taken_out() -> io::Result<()> {
        for temperature in [None, Some(20.0)] {
            let mut channel = Channel::new(0.1)?;
            (0..100).try_for_each(|k| channel.push(false, f64::from(k), temperature))?;
            assert_eq!(channel.finish(1.0)?.taken, None);
        }
        Ok(())
    }
}
