//! Verdicts and their parts on prices made by hand: every number here can be worked out on paper.

mod decide;
mod noise;
mod open;
mod partial;
mod prices;
mod relaxing;
mod verify;

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};
use sinscal::StateInfo;

use crate::linear::Noise;
use crate::log::Survey;
use crate::prices::{Group, Prices};
use crate::recording::{CORE, Column, Recording, Start, Step};
use crate::run::Ran;
use crate::scene::{Scene, Wider};

/// p = 1e-6, about: what counts as significant.
const THRESHOLD: f64 = -14.0;
/// Updates of a log here.
const UPDATES: usize = 1000;

/// Effects of one component each, whose estimates without any prior would be `estimates` with information `lambda`; priors are 1.
fn prices(names: &[&str], lambda: DMatrix<f64>, estimates: &[f64]) -> Prices {
    let group = |(member, name): (usize, &&str)| Group { name: (*name).into(), members: vec![member] };
    Prices {
        b: &lambda * DVector::from_column_slice(estimates),
        sigma: vec![1.0; names.len()],
        groups: names.iter().enumerate().map(group).collect(),
        lambda,
    }
}

/// The same of effects that are seen apart from each other, each with a standard deviation of 0.1.
fn apart(names: &[&str], estimates: &[f64]) -> Prices {
    prices(names, DMatrix::identity(names.len(), names.len()) * 100.0, estimates)
}

/// A log of which the prices are all that is known, with half of everything in its first half.
fn scene(prices: Prices) -> Scene {
    let half = Prices { b: 0.5 * &prices.b, lambda: 0.5 * &prices.lambda, ..prices.clone() };
    let recording = Recording {
        columns: Vec::new(),
        starts: vec![beginning(0)],
        steps: (0..UPDATES).map(|k| step(k as f64, 0, 0)).collect(),
        relaxing: Vec::new(),
        channels: Vec::new(),
    };
    let ran = Ran { recording, log_likelihood: 0.0, prices: prices.clone(), estimate: Vec::new() };
    Scene {
        ran,
        wider: Wider::default(),
        surveys: vec![Survey::nothing()],
        noise: Noise::STATED,
        noise_hides: false,
        prices,
        half,
        parts: OnceLock::from(Vec::new()),
    }
}

/// A step of a second in which nothing moves and `measured` numbers are measured to be zero, with `parameters` columns.
fn step(time: f64, parameters: usize, measured: usize) -> Step {
    let width = CORE + parameters + 1;
    let mut rows = vec![0.0; CORE * width];
    (0..CORE).for_each(|i| rows[i * width + i] = 1.0);
    Step {
        time,
        elapsed: 1.0,
        rows,
        gyro_noise: [0.0; CORE * CORE],
        accel_noise: [0.0; CORE * CORE],
        h: vec![0.0; measured * (CORE + parameters)],
        z: vec![0.0; measured],
        r: vec![1.0; measured],
        channel: (0..measured).collect(),
        motion: sinscal::Motion::default(),
    }
}

/// A parameter of the base filter or a candidate, with a prior of 1.
fn column(block: &'static str, base: bool) -> Column {
    let info =
        StateInfo { block, component: "x", unit: "1", prior_sigma: 1.0, sheet_unit: "1", sheet_scale: 1.0 };
    Column { info, prior: 1.0, base }
}

/// A log that begins with the first step, with `parameters` columns.
fn beginning(parameters: usize) -> Start {
    Start { step: 0, core: [1.0; CORE], about: vec![0.0; parameters] }
}
