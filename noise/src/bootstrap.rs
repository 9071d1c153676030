//! How well each parameter of a composite is known: the composite is simulated and fitted again and again.

use std::io;

use chacha20::ChaCha8Rng;
use rand::SeedableRng;
use rayon::prelude::*;

use crate::TAIL;
use crate::allan::{Scale, scales, together};
use crate::fit::{Fit, refit};
use crate::model::{Process, simulate};
use crate::record::Recorder;

/// So many readings are simulated at one spacing. A longer channel is simulated at several: means of 16, 256, ... readings are a
/// series of the same processes, which shows the longer averaging times.
const SIMULATED: u64 = 1 << 15;
/// From one spacing to the next.
const COARSER: u64 = 16;
/// Averages of fewer readings of a coarser spacing are not taken from it: they overlap less than those of the channel.
const LEAST: u64 = 8;

/// A parameter's interval.
pub type Interval = (f64, f64);

/// Of each process the 95 % intervals of its size, and of its time where it has one.
///
/// A parametric bootstrap of `times` simulated channels with the stretches of `readings` readings, each fitted as the real one was. The
/// interval is that of the ratio of a fitted to a true value, which for a single variance is the one by chi-squared. Each simulation has a
/// stream of random numbers of its own, so that the result depends on `seed` and `stream` alone.
///
/// # Errors
/// When there is no room for temporary files.
pub fn intervals(
    fit: &Fit,
    scales: &[Scale],
    readings: &[u64],
    interval: f64,
    times: u64,
    (seed, stream): (u64, u64),
) -> io::Result<Vec<(Interval, Option<Interval>)>> {
    let plan = Plan::of(scales, readings);
    let refitted: io::Result<Vec<Vec<Process>>> = (0..times)
        .into_par_iter()
        .map(|run| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream((stream << 32) | run);
            let drawn = plan.draw(&fit.processes, scales, interval, &mut random)?;
            Ok(refit(&drawn, &fit.processes).processes)
        })
        .collect();
    let refitted = refitted?;
    let found = |at: usize, of: fn(&Process) -> Option<f64>| {
        let estimate = of(&fit.processes[at])?;
        let mut ratios: Vec<f64> = refitted
            .iter()
            .filter_map(|processes| of(processes.get(at)?))
            .map(|value| value / estimate)
            .collect();
        ratios.sort_by(f64::total_cmp);
        Some((estimate / quantile(&ratios, 1.0 - TAIL), estimate / quantile(&ratios, TAIL)))
    };
    let size = |process: &Process| Some(process.size);
    let intervals = (0..fit.processes.len()).map(|at| {
        (found(at, size).unwrap_or((0.0, f64::INFINITY)), found(at, |process| process.kind.time()))
    });
    Ok(intervals.collect())
}

/// A quantile of sorted numbers, between neighbours by a straight line.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part * sorted.len().saturating_sub(1) as f64;
    let below = place as usize;
    match (sorted.get(below), sorted.get(below + 1)) {
        (Some(low), Some(high)) => low + (place - below as f64) * (high - low),
        (Some(low), None) => *low,
        _ => f64::NAN,
    }
}

/// What is simulated at which spacing.
struct Plan {
    parts: Vec<Part>,
}

/// A spacing.
struct Part {
    /// In readings of the channel.
    spacing: u64,
    /// Length of each stretch, in this spacing.
    stretches: Vec<u64>,
    /// Which of the scales are taken from it, and by which their scatter is reduced: the channel is longer than what is simulated.
    scales: Vec<(usize, f64)>,
}

impl Plan {
    fn of(scales: &[Scale], readings: &[u64]) -> Self {
        let mut parts = Vec::new();
        let mut spacing = 1;
        let mut done = 0;
        while done < scales.len() {
            let whole: Vec<u64> = readings.iter().map(|readings| readings / spacing).collect();
            let all: u64 = whole.iter().sum();
            let last = all <= SIMULATED;
            // the next spacing takes over where its averages overlap enough
            let most = if last { u64::MAX } else { LEAST * COARSER * spacing };
            let mut room = SIMULATED;
            let stretches: Vec<u64> = whole
                .iter()
                .map(|length| {
                    let length = (*length).min(room);
                    room -= length;
                    length
                })
                .filter(|length| *length > 1)
                .collect();
            let points: Vec<u64> = stretches.iter().map(|length| length + 1).collect();
            let mut of_part = Vec::new();
            while let Some(scale) = scales.get(done).filter(|scale| scale.m < most) {
                let m = scale.m / spacing;
                let possible = points.iter().any(|points| *points > 2 * m);
                let scatter = (together(scale.law, &points, m) / scale.edf).sqrt();
                if possible {
                    of_part.push((done, scatter.min(1.0)));
                }
                done += 1;
            }
            parts.push(Part { spacing, stretches, scales: of_part });
            spacing *= COARSER;
        }
        Self { parts }
    }

    /// Allan variances of a simulated channel.
    fn draw(
        &self,
        processes: &[Process],
        of_channel: &[Scale],
        interval: f64,
        random: &mut ChaCha8Rng,
    ) -> io::Result<Vec<Scale>> {
        let mut drawn = Vec::with_capacity(of_channel.len());
        for part in &self.parts {
            let interval = interval * part.spacing as f64;
            let mut recorder = Recorder::new(interval)?;
            let mut fault = Ok(());
            for length in &part.stretches {
                recorder.interrupt();
                simulate(processes, interval, *length as usize, random, &mut |reading| {
                    if fault.is_ok() {
                        fault = recorder.push(reading);
                    }
                });
            }
            fault?;
            let simulated = scales(&mut recorder.finish()?)?;
            for (at, scatter) in &part.scales {
                let scale = of_channel[*at];
                let Some(found) = simulated.iter().find(|found| found.m * part.spacing == scale.m) else {
                    continue;
                };
                let expected = crate::composite(processes, scale.tau);
                drawn.push(Scale { variance: expected + scatter * (found.variance - expected), ..scale });
            }
        }
        Ok(drawn)
    }
}
