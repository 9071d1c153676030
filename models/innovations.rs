//! Residuals of a calibration run over time, with what the filter said of them beforehand.

use std::vec::Vec;

use calib_core::{Filter, Form, Matrix, Residuals, Shape, Vector, measurement_rows};

use crate::{Event, Observer, Point, Signals, Strapdown};

/// Remembers the innovation of every measured row at every update. Hand it to
/// [`Calibration::step_observed`](crate::Calibration::step_observed).
///
/// The innovation is `z - H x`, the residual without what the filter knew of it; its variance is that of `H P H' + R`. It holds
/// three numbers for each row and update.
pub struct Innovations<F: Filter<Dynamics = Strapdown>> {
    /// State and covariance before the update; the correction of the navigation is already taken out of the state.
    predicted: Option<(Vector<F, f64>, Matrix<F, f64>)>,
    channels: Vec<ChannelInnovations>,
}

/// The innovations of one row of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelInnovations {
    /// Name of the measurement, for instance `velocity`.
    pub group: &'static str,
    /// Component, for instance `e`.
    pub component: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Time (s), innovation and its predicted standard deviation (in the unit) at each update that measured it.
    pub points: Vec<[f64; 3]>,
}

impl ChannelInnovations {
    /// The innovations over their standard deviations.
    pub fn normalised(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(|[_, value, sigma]| value / sigma)
    }

    /// Part of them within `limit` standard deviations: 0.683, 0.954 and 0.997 for 1, 2 and 3 when the filter is right.
    pub fn inside(&self, limit: f64) -> f64 {
        self.normalised().filter(|value| value.abs() <= limit).count() as f64 / self.points.len() as f64
    }

    /// Root mean square of the normalised innovations; 1 when the filter is right.
    pub fn rms(&self) -> f64 {
        (self.normalised().map(|value| value * value).sum::<f64>() / self.points.len() as f64).sqrt()
    }

    /// Correlation between normalised innovations `lag` updates apart, about zero, which is their expected mean. White ones stay
    /// within `1.96 / sqrt(n)` of zero at 95 % of the lags.
    pub fn autocorrelation(&self, lag: usize) -> f64 {
        let values: Vec<f64> = self.normalised().collect();
        let power: f64 = values.iter().map(|value| value * value).sum();
        let product: f64 = values.iter().zip(values.iter().skip(lag)).map(|(a, b)| a * b).sum();
        product / power
    }
}

impl<F: Filter<Dynamics = Strapdown>> Default for Innovations<F> {
    fn default() -> Self {
        let mut channels = Vec::new();
        for info in F::MEASURES {
            channels.extend(info.components.iter().map(|component| ChannelInnovations {
                group: info.name,
                component,
                unit: info.unit,
                points: Vec::new(),
            }));
        }
        Self { predicted: None, channels }
    }
}

impl<F: Filter<Dynamics = Strapdown>> Innovations<F> {
    /// By row, in the order of the declaration; a row that was never measured has no points.
    pub fn finish(self) -> Vec<ChannelInnovations> {
        self.channels
    }
}

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for Innovations<F> {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        match event {
            Event::Moved(kalman) => self.predicted = Some((kalman.x().clone(), kalman.covariance())),
            Event::FedBack(correction) => {
                if let Some((x, _)) = &mut self.predicted {
                    for i in 0..F::Shape::STATES {
                        x[i] -= correction[i];
                    }
                }
            }
            Event::Measured { time, at, signals, residuals } => self.append(time, at, signals, residuals),
            _ => {}
        }
    }
}

impl<F: Filter<Dynamics = Strapdown>> Innovations<F> {
    /// Adds what an update finds.
    fn append(&mut self, time: f64, at: &Point<f64>, signals: &Signals<f64>, residuals: &Residuals<F, f64>) {
        // what the first sample measures has not been predicted
        let Some((x, covariance)) = self.predicted.take() else { return };
        let h = measurement_rows::<F, f64>(at, signals);
        for (row, channel) in self.channels.iter_mut().enumerate() {
            if !residuals.is_present(row) {
                continue;
            }
            let mut innovation = residuals.values()[row];
            let mut variance = residuals.variances()[row];
            for i in 0..F::Shape::STATES {
                if h[row][i] == 0.0 {
                    continue;
                }
                innovation -= h[row][i] * x[i];
                for j in 0..F::Shape::STATES {
                    variance += h[row][i] * covariance[i][j] * h[row][j];
                }
            }
            channel.points.push([time, innovation, variance.sqrt()]);
        }
    }
}
