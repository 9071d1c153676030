//! How a campaign scales: the same units on one thread and on two, each a unit simulated at 25 Hz and calibrated
//! with 36d-p.
//!
//! `cargo bench --bench campaign`; `-- --least` prints the least of some rounds, in which both take turns, and
//! their ratio.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion};
use rig::Scenario;
use runs::Vocabulary;
use study::{Plan, UnitResult};

const UNITS: u64 = 4;

/// The campaign on so many threads; each takes the next unit when it has finished one.
fn campaign(plan: &Plan, threads: usize) -> Vec<UnitResult> {
    let (next, done) = (AtomicU64::new(0), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let unit = next.fetch_add(1, Ordering::Relaxed);
            if unit >= UNITS {
                return;
            }
            let result = plan.unit(unit).expect("a sound plan");
            done.lock().expect("no thread has panicked").push(result);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(work);
        }
    });
    let mut results = done.into_inner().expect("no thread has panicked");
    results.sort_by_key(|result| result.unit);
    results
}

fn main() {
    let plan = Plan {
        scenario: Scenario::parse("[imu]\nrate = \"25 Hz\"").expect("a scenario"),
        filters: vec![Vocabulary::standard().filter("36d-p").expect("a filter of the library")],
        passes: 1,
        hours: 0.0,
        alignment: 0.0,
        motion: Plan::paper_swing().expect("the rig's own defaults"),
    };
    assert_eq!(campaign(&plan, 1), campaign(&plan, 2), "results depend on the number of threads");
    if std::env::args().any(|argument| argument == "--least") {
        let mut least = [Duration::MAX; 2];
        for _ in 0..40 {
            for threads in [1, 2] {
                let begin = Instant::now();
                campaign(&plan, threads);
                least[threads - 1] = least[threads - 1].min(begin.elapsed());
            }
        }
        let [one, two] = least.map(|time| time.as_secs_f64());
        println!(
            "{UNITS} units: {one:.3} s on one thread, {two:.3} s on two, {:.2} times as fast",
            one / two
        );
        return;
    }
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("campaign");
    group.sample_size(10);
    for threads in [1, 2] {
        group.bench_function(BenchmarkId::new("threads", threads), |b| b.iter(|| campaign(&plan, threads)));
    }
    group.finish();
    criterion.final_summary();
}
