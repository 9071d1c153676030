//! Whole jobs on one log in memory, the default path at 25 Hz: simulating it, calibrating with it, pricing every effect on it.
//!
//! `cargo bench --bench whole`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gap::{Noise, Pricing};
use rig::{Scenario, Simulation};
use sinscal::{Calibration, Sample, Sins36P};

fn jobs(c: &mut Criterion) {
    let scenario = Scenario::parse("[imu]\nrate = \"25 Hz\"").expect("a scenario");
    let simulate = || Simulation::new(&scenario, 1).expect("a log");
    let description = simulate().description().clone();
    let setup = description.setup(&[]);
    let samples: Vec<Sample> = simulate().collect();
    let mut group = c.benchmark_group("whole");
    group.sample_size(10).throughput(Throughput::Elements(samples.len() as u64));
    group.bench_function("simulation", |b| b.iter(|| simulate().map(|sample| sample.dvel.z).sum::<f64>()));
    group.bench_function("a pass, 36d-p", |b| {
        b.iter(|| {
            let mut run = Box::new(Calibration::<Sins36P>::new(&setup));
            for sample in &samples {
                run.step(sample).expect("does not diverge");
            }
            black_box(run.statistics().nis)
        });
    });
    group.bench_function("pricing, 36d-p", |b| {
        let log = gap::Log { samples: &samples, setup: &setup };
        b.iter(|| black_box(Pricing::of::<Sins36P>(&log, Noise::STATED).expect("a sound log").base()));
    });
    group.finish();
}

criterion_group!(benches, jobs);
criterion_main!(benches);
