//! A pass as the linear system that it is, step by step.

use core::ops::Range;

use calib_core::{
    Array, CoreVector, Filter, Form, Relaxation, Residuals, Shape, Transition, measurement_rows,
};
use sinscal::{Event, Gate, Observer, Point, Signals, Statistics, Strapdown};

use crate::channels::Channels;
use crate::compiled::Selection;

/// Leading states of a strapdown filter: attitude, velocity, position.
pub(crate) const CORE: usize = 9;

/// Is told a pass in which the parameters are taken as known: how the leading states move, and what is measured. Columns are the
/// leading states, then the parameters that take part, in the order of the selection.
pub trait Trace {
    /// The pass begins.
    fn begin(&mut self, begun: &Traced) {
        let _ = begun;
    }
    /// The leading states moved over an interval.
    fn moved(&mut self, step: &Moved);
    /// These were added to the variances of the leading states.
    fn widened(&mut self, variances: &[f64; CORE]);
    /// Something was measured.
    fn measured(&mut self, measured: &Measured);
    /// These corrections were taken out of the leading states.
    fn fed_back(&mut self, correction: &[f64; CORE]);
}

/// How the leading states moved.
#[derive(Clone, Debug)]
pub struct Moved {
    /// Length of the interval, s.
    pub elapsed: f64,
    /// `[Phi Psi]`, row after row.
    pub rows: Vec<f64>,
    /// Covariance of what the gyros' random walk added, row after row.
    pub gyro_noise: [f64; CORE * CORE],
    /// The same of the accelerometers.
    pub accel_noise: [f64; CORE * CORE],
}

/// What was measured.
pub struct Measured<'a> {
    /// Time of the sample, s.
    pub time: f64,
    /// What the sensors said.
    pub signals: &'a Signals<f64>,
    /// The scalar measurements.
    pub rows: &'a [Row],
}

/// One scalar measurement.
#[derive(Clone, Debug)]
pub struct Row {
    /// What it is of, by [`Channels`].
    pub channel: usize,
    /// Its row of the measurement matrix.
    pub h: Vec<f64>,
    /// The residual, `computed - reference`.
    pub z: f64,
    /// Its variance.
    pub r: f64,
}

/// What a traced pass began with, and what came of it.
#[derive(Clone, Debug)]
pub struct Traced {
    /// How the readings of the reference were spread.
    pub gate: Gate,
    /// Sums over its updates.
    pub statistics: Statistics,
    /// Prior standard deviations of the leading states.
    pub start: [f64; CORE],
    /// Parameters that are not constant, by their place in the selection.
    pub relaxing: Vec<(usize, Relaxation<f64>)>,
    /// Names of what [`Row::channel`] counts.
    pub channels: Vec<String>,
}

impl<T: Trace + ?Sized> Trace for &mut T {
    fn begin(&mut self, begun: &Traced) {
        (**self).begin(begun);
    }

    fn moved(&mut self, step: &Moved) {
        (**self).moved(step);
    }

    fn widened(&mut self, variances: &[f64; CORE]) {
        (**self).widened(variances);
    }

    fn measured(&mut self, measured: &Measured) {
        (**self).measured(measured);
    }

    fn fed_back(&mut self, correction: &[f64; CORE]) {
        (**self).fed_back(correction);
    }
}

/// Tells a pass of filter `F`.
pub(crate) struct Tracer<F, T> {
    selection: Selection,
    pub(crate) to: T,
    rows: Vec<Row>,
    channels: Channels,
    of: core::marker::PhantomData<fn() -> F>,
}

impl<F: Filter<Dynamics = Strapdown>, T: Trace> Tracer<F, T> {
    pub(crate) fn new(selection: &Selection, to: T) -> Self {
        Self {
            selection: selection.clone(),
            to,
            rows: Vec::new(),
            channels: Channels::of(F::MEASURES),
            of: core::marker::PhantomData,
        }
    }

    /// The columns of a row that take part.
    fn columns(&self, row: &[f64], into: &mut Vec<f64>) {
        into.extend_from_slice(&row[..CORE]);
        into.extend(self.selection.states.iter().map(|state| row[*state]));
    }

    fn moved(&mut self, transition: &Transition<F, f64>, density: &CoreVector<F, f64>) {
        let mut rows = Vec::with_capacity(CORE * (CORE + self.selection.states.len()));
        for i in 0..CORE {
            self.columns(transition.rows()[i].as_slice(), &mut rows);
        }
        let noise = |of: Range<usize>| {
            let mut d = F::Shape::core_vector(0.0);
            for i in of {
                d[i] = density[i];
            }
            let q = transition.noise(&d);
            let mut flat = [0.0; CORE * CORE];
            for i in 0..CORE {
                flat[i * CORE..(i + 1) * CORE].copy_from_slice(q[i].as_slice());
            }
            flat
        };
        self.to.moved(&Moved {
            elapsed: transition.elapsed(),
            rows,
            gyro_noise: noise(0..3),
            accel_noise: noise(3..6),
        });
    }

    fn measured(
        &mut self,
        time: f64,
        at: &Point<f64>,
        signals: &Signals<f64>,
        residuals: &Residuals<F, f64>,
    ) {
        let matrix = measurement_rows::<F, f64>(at, signals);
        self.rows.clear();
        for &(channel, row) in &self.channels.rows {
            if residuals.is_present(row) {
                let mut h = Vec::with_capacity(CORE + self.selection.states.len());
                self.columns(matrix[row].as_slice(), &mut h);
                self.rows.push(Row { channel, h, z: residuals.values()[row], r: residuals.variances()[row] });
            }
        }
        self.to.measured(&Measured { time, signals, rows: &self.rows });
    }
}

fn leading(of: &[f64]) -> [f64; CORE] {
    core::array::from_fn(|i| of[i])
}

impl<F: Filter<Dynamics = Strapdown>, T: Trace> Observer<F> for Tracer<F, T> {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        match event {
            Event::Predicted { transition, density } => self.moved(transition, density),
            Event::Widened(variances) => self.to.widened(&leading(variances.as_slice())),
            Event::Measured { time, at, signals, residuals } => self.measured(time, at, signals, residuals),
            Event::FedBack(correction) => self.to.fed_back(&leading(correction.as_slice())),
            _ => {}
        }
    }
}
