//! How benchmarks are timed: by criterion, or as the least of many short repetitions.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;

/// How long `--least` goes on with one thing.
const LONG: Duration = Duration::from_secs(2);
/// And how often it repeats it at least.
const ROUNDS: u32 = 10;

/// Times routines: with criterion, or with `--least` on its own, which a busy machine disturbs little.
pub(crate) struct Bench {
    criterion: Option<Criterion>,
}

impl Bench {
    /// As the command line says.
    pub(crate) fn from_arguments() -> Self {
        let least = std::env::args().any(|argument| argument == "--least");
        Self { criterion: (!least).then(|| Criterion::default().configure_from_args().sample_size(20)) }
    }

    /// What one call of `routine` takes: so many of them in a row on what `start` makes, again and again. Only the
    /// calls count.
    pub(crate) fn run<P, R>(
        &mut self,
        name: &str,
        times: u32,
        mut start: impl FnMut() -> P,
        mut routine: impl FnMut(&mut P) -> R,
    ) {
        let mut round = || {
            let mut p = start();
            let begin = Instant::now();
            for _ in 0..times {
                black_box(routine(black_box(&mut p)));
            }
            begin.elapsed()
        };
        if let Some(criterion) = &mut self.criterion {
            criterion.bench_function(name, |b| {
                b.iter_custom(|calls| {
                    let rounds = calls.div_ceil(times.into());
                    let all: Duration = (0..rounds).map(|_| round()).sum();
                    all.mul_f64(calls as f64 / (rounds * u64::from(times)) as f64)
                });
            });
            return;
        }
        let (mut least, mut rounds, begin) = (Duration::MAX, 0, Instant::now());
        while rounds < ROUNDS || begin.elapsed() < LONG {
            least = least.min(round());
            rounds += 1;
        }
        println!("{name:40} {:10.3} us", least.as_secs_f64() * 1e6 / f64::from(times));
    }

    /// The last word of criterion.
    pub(crate) fn finish(self) {
        if let Some(criterion) = self.criterion {
            criterion.final_summary();
        }
    }
}
