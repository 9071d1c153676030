//! Where the missing effect shows: stretch by channel, and over time.

use crate::dictionary::TURNING;
use crate::linear::{Priced, Recorded, run};
use crate::open::{Open, vocabulary};
use crate::report::{Evidence, Place};
use crate::scene::Scene;

/// No more places than this are listed.
const PLACES: usize = 20;
/// Points of the evidence over time.
const POINTS: usize = 120;
/// Stretches shorter than this are joined to the one before, s.
const SHORTEST: f64 = 4.0;
/// More stretches of motion than this are no longer a map: equal ones are taken instead.
const STRETCHES: usize = 80;

/// Matched-filter gain of `named` by stretch and channel, the strongest first, and its growth.
pub(crate) fn locate(scene: &Scene, named: &[usize]) -> (Vec<Place>, Vec<Evidence>) {
    match scene.prices.posterior(named) {
        Some((mean, _)) if !named.is_empty() => {
            map(scene, &Recorded(&scene.columns(named)), mean.as_slice(), &stretches(scene))
                .unwrap_or_default()
        }
        _ => Default::default(),
    }
}

/// The same for a family of the dictionary. What is there for a stretch only shows there, whenever its trace is seen.
pub(crate) fn locate_family(scene: &Scene, open: &Open, family: usize) -> (Vec<Place>, Vec<Evidence>) {
    let dictionary = vocabulary(&scene.ran.recording, &[]);
    let Some((found, _)) = open.prices.posterior(&[family]) else { return Default::default() };
    let mut mean = vec![0.0; dictionary.own()];
    for (m, value) in open.prices.groups[family].members.iter().zip(found.iter()) {
        open.columns[*m].iter().for_each(|column| mean[*column] = *value);
    }
    let bounds = match open.burst(family) {
        Some(burst) => vec![(burst.stretch.start, burst.stretch.end)],
        None => stretches(scene),
    };
    map(scene, &dictionary, &mean, &bounds).unwrap_or_default()
}

fn map(
    scene: &Scene,
    priced: &dyn Priced,
    mean: &[f64],
    bounds: &[(f64, f64)],
) -> Option<(Vec<Place>, Vec<Evidence>)> {
    let recording = &scene.ran.recording;
    let nc = 1 + priced.count();
    let mut gains = vec![vec![0.0; recording.channels.len()]; bounds.len()];
    let mut evidence = Vec::new();
    let (mut total, mut at, mut stretch) = (0.0, 0, 0);
    let every = (recording.updates() / POINTS).max(1);
    run(recording, &recording.base(), priced, &scene.noise, &mut |whitened| {
        while stretch + 1 < bounds.len() && whitened.step.time > bounds[stretch].1 {
            stretch += 1;
        }
        for (row, channel) in whitened.rows.chunks_exact(nc).zip(&whitened.step.channel) {
            let shown: f64 = row[1..].iter().zip(mean.iter()).map(|(s, m)| s * m).sum();
            let gain = row[0] * shown - 0.5 * shown * shown;
            gains[stretch][*channel] += gain;
            total += gain;
        }
        if at % every == 0 {
            evidence.push(Evidence { time_s: whitened.step.time, gain: total });
        }
        at += 1;
    })?;
    let mut places = Vec::new();
    for (bound, gains) in bounds.iter().zip(&gains) {
        for (channel, gain) in gains.iter().enumerate() {
            if *gain > 0.5 {
                let channel = recording.channels[channel].clone();
                places.push(Place { start_s: bound.0, end_s: bound.1, channel, gain: *gain });
            }
        }
    }
    places.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    places.truncate(PLACES);
    Some((places, evidence))
}

/// Still and turning stretches of the log in turn.
fn stretches(scene: &Scene) -> Vec<(f64, f64)> {
    let recording = &scene.ran.recording;
    let (start, end) = recording.span();
    let mut bounds: Vec<(f64, f64, bool)> = Vec::new();
    for step in &recording.steps {
        let turning = step.motion.rate.norm() > TURNING;
        match bounds.last_mut() {
            Some(last) if last.2 == turning || last.1 - last.0 < SHORTEST => last.1 = step.time,
            Some(last) => {
                let from = last.1;
                bounds.push((from, step.time, turning));
            }
            None => bounds.push((start, step.time, turning)),
        }
    }
    if bounds.len() < 4 || bounds.len() > STRETCHES {
        let n = 24;
        let length = (end - start) / f64::from(n);
        return (0..n).map(|i| (start + length * f64::from(i), start + length * f64::from(i + 1))).collect();
    }
    bounds.into_iter().map(|b| (b.0, b.1)).collect()
}
