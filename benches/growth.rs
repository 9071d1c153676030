//! How cost grows: with states, with measurements, over the declared filters, over a whole log.
//!
//! `cargo bench --bench growth`.

#[path = "case/wave.rs"]
mod wave;

use std::hint::black_box;

use calib_core::{Conventional, Dim, Form, Shape, Ud};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rig::{Scenario, Simulation};
use sinscal::{Calibration, Filter, FilterVisitor, Sample, Sins43B, Strapdown};
use wave::Wave;

/// A cycle of shape `S`.
fn cycle<S: Shape, C: Form>(c: &mut Criterion, form: &str, group: &str, by: usize) {
    let wave = Wave::<S>::new();
    let start = (wave.start::<C>(), S::vector(0.0));
    c.benchmark_group(group).bench_function(BenchmarkId::new(form, by), |b| {
        b.iter_batched_ref(
            || start.clone(),
            |(cov, x)| black_box(wave.cycle::<C>(cov, x)),
            BatchSize::SmallInput,
        );
    });
}

fn states(c: &mut Criterion) {
    macro_rules! sizes {
        ($($n:literal),*) => {$(
            cycle::<Dim<$n, 9, 6>, Conventional>(c, "conventional", "states", $n);
            cycle::<Dim<$n, 9, 6>, Ud>(c, "ud", "states", $n);
        )*};
    }
    sizes!(15, 21, 30, 36, 43, 60, 90);
}

fn measurements(c: &mut Criterion) {
    macro_rules! rows {
        ($($m:literal),*) => {$(
            cycle::<Dim<43, 9, $m>, Conventional>(c, "conventional", "measurements", $m);
            cycle::<Dim<43, 9, $m>, Ud>(c, "ud", "measurements", $m);
        )*};
    }
    rows!(1, 3, 6, 9);
}

/// A pass over a log in memory with the filter of a name.
struct Pass<'a, 'b> {
    c: &'a mut Criterion,
    name: &'b str,
    description: &'b rig::Description,
    samples: &'b [Sample],
}

impl FilterVisitor for Pass<'_, '_> {
    type Output = ();

    fn visit<F: Filter<Dynamics = Strapdown>>(self) {
        let mut group = self.c.benchmark_group("pass");
        group.sample_size(10).throughput(Throughput::Elements(self.samples.len() as u64));
        group.bench_function(self.name, |b| {
            b.iter(|| {
                let mut run = Box::new(Calibration::<F>::new(&self.description.setup(&[])));
                for sample in self.samples {
                    run.step(sample).expect("does not diverge");
                }
                black_box(run.statistics().nis)
            });
        });
    }
}

/// All the work on each sample and each update, without reading: the default path at 200 Hz, its first 600 s.
fn passes(c: &mut Criterion) {
    let scenario = Scenario::parse("[imu]\nrate = \"200 Hz\"").expect("a scenario");
    let log = Simulation::new(&scenario, 1).expect("a log");
    let description = log.description().clone();
    let samples: Vec<Sample> = log.take(120_000).collect();
    for filter in sinscal::FILTERS.iter().filter(|filter| filter.name.ends_with(['b', 'p'])) {
        let pass = Pass { c, name: filter.name, description: &description, samples: &samples };
        sinscal::visit_filter(filter.name, pass);
    }
    // the same samples without reference: navigation, compensation and accumulation alone
    let mut group = c.benchmark_group("navigation step");
    group.sample_size(10).throughput(Throughput::Elements(samples.len() as u64));
    group.bench_function("43d-b", |b| {
        b.iter(|| {
            let mut run = Box::new(Calibration::<Sins43B>::new(&description.setup(&[])));
            for sample in &samples {
                run.step(&Sample { reference: Default::default(), ..*sample }).expect("does not diverge");
            }
            black_box(run.position())
        });
    });
    group.finish();
}

criterion_group!(benches, states, measurements, passes);
criterion_main!(benches);
