//! Composites that are simulated: the right processes are named, and their intervals hold what was put in.

use chacha20::ChaCha8Rng;
use noise::{Fit, Interval, Kind, Process, Recorded, identify, intervals, scales, simulate};
use rand::SeedableRng;

/// Simulates and identifies a channel.
fn found(
    processes: &[Process],
    interval: f64,
    count: usize,
    seed: u64,
) -> (Fit, Vec<(Interval, Option<Interval>)>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut readings = Vec::with_capacity(count);
    simulate(processes, interval, count, &mut random, &mut |reading| readings.push(reading));
    let mut recorded = Recorded::of(&readings, interval).expect("a temporary file");
    let scales = scales(&mut recorded).expect("its contents");
    let fit = identify(&scales, count as u64);
    let bounds =
        intervals(&fit, &scales, &recorded.readings(), interval, 200, (1, seed)).expect("temporary files");
    (fit, bounds)
}

fn same_kind(a: &Process, b: &Process) -> bool {
    std::mem::discriminant(&a.kind) == std::mem::discriminant(&b.kind)
}

/// Of a hundred channels: how often the processes were those that were put in, and how often each size and time lay in its interval.
fn covered(processes: &[Process], interval: f64, count: usize) -> (usize, Vec<usize>) {
    let mut named = 0;
    let mut inside = vec![0; 2 * processes.len()];
    for seed in 0..100 {
        let (fit, bounds) = found(processes, interval, count, 1000 + seed);
        let right = fit.processes.len() == processes.len()
            && fit.processes.iter().zip(processes).all(|(a, b)| same_kind(a, b));
        named += usize::from(right);
        for (at, truth) in processes.iter().enumerate() {
            let Some(place) = fit.processes.iter().position(|process| same_kind(process, truth)) else {
                continue;
            };
            let (size, time) = bounds[place];
            inside[2 * at] += usize::from((size.0..=size.1).contains(&truth.size));
            let held =
                time.zip(truth.kind.time()).is_none_or(|((low, high), time)| (low..=high).contains(&time));
            inside[2 * at + 1] += usize::from(held);
        }
    }
    (named, inside)
}

/// Names are right in most of a hundred, intervals hold the truth in 95 of them.
fn check(processes: &[Process], interval: f64, count: usize) {
    let (named, inside) = covered(processes, interval, count);
    println!("{processes:?}: named {named} of 100, inside {inside:?}");
    assert!(named >= 85, "{processes:?}: named in {named} of 100");
    // of a hundred with probability 0.95 each, fewer than 90 happen once in a hundred
    assert!(inside.iter().all(|inside| *inside >= 90), "{processes:?}: inside {inside:?}");
}

#[test]
#[ignore = "half a minute"]
fn white_noise_and_a_walk() {
    let white = Process { kind: Kind::White, size: 1e-4 };
    let walk = Process { kind: Kind::RandomWalk, size: 4e-6 };
    check(&[white, walk], 0.05, 40_000);
}

#[test]
fn quantisation_white_noise_and_a_relaxing_bias() {
    let quantisation = Process { kind: Kind::Quantisation, size: 2e-5 };
    let white = Process { kind: Kind::White, size: 1e-4 };
    let markov = Process { kind: Kind::GaussMarkov { time: 50.0 }, size: 5e-5 };
    check(&[quantisation, white, markov], 0.05, 40_000);
}

#[test]
#[ignore = "half a minute"]
fn white_noise_and_a_ramp() {
    let white = Process { kind: Kind::White, size: 1e-4 };
    let ramp = Process { kind: Kind::Ramp, size: 1e-7 };
    check(&[white, ramp], 0.05, 40_000);
}

#[test]
#[ignore = "half a minute"]
fn white_noise_alone() {
    check(&[Process { kind: Kind::White, size: 1e-4 }], 0.05, 10_000);
}

/// Longer than what is simulated at one spacing.
#[test]
#[ignore = "a minute"]
fn long_channels() {
    let white = Process { kind: Kind::White, size: 1e-4 };
    let markov = Process { kind: Kind::GaussMarkov { time: 300.0 }, size: 3e-5 };
    check(&[white, markov], 0.05, 300_000);
}
