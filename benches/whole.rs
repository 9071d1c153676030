//! Whole jobs on one log in memory, the default path at 25 Hz: simulating it, a pass over it with each of the
//! filters, pricing every effect on it.
//!
//! `cargo bench --bench whole`; `-- --least` prints the least of some repetitions instead of statistics.

#[path = "case/bench.rs"]
mod bench;

use bench::Bench;
use gap::{Noise, Pricing};
use rig::{Scenario, Simulation};
use runs::Vocabulary;
use sinscal::{Calibration, Filter, FilterVisitor, Sample, Setup, Strapdown};

/// A pass with one filter.
struct Pass<'a, 'b> {
    bench: &'a mut Bench,
    name: &'b str,
    setup: &'b Setup<'b>,
    samples: &'b [Sample],
}

impl FilterVisitor for Pass<'_, '_> {
    type Output = ();

    fn visit<F: Filter<Dynamics = Strapdown>>(self) {
        let pass = |(): &mut ()| {
            let mut run = Box::new(Calibration::<F>::new(self.setup).expect("a sound setup"));
            for sample in self.samples {
                run.step(sample).expect("does not diverge");
            }
            run.statistics().nis
        };
        self.bench.run(&format!("a pass with {}", self.name), 1, || (), pass);
    }
}

fn main() {
    let mut bench = Bench::from_arguments();
    let scenario = Scenario::parse("[imu]\nrate = \"25 Hz\"").expect("a scenario");
    let simulate = || Simulation::new(&scenario, 1).expect("a log");
    let description = simulate().description().clone();
    let setup = description.setup(&[]);
    let samples: Vec<Sample> = simulate().collect();
    println!("{} samples", samples.len());
    bench.run("simulation", 1, || (), |()| simulate().map(|sample| sample.dvel.z).sum::<f64>());
    for filter in sinscal::FILTERS.iter().filter(|filter| filter.name.ends_with(['b', 'p'])) {
        let pass = Pass { bench: &mut bench, name: filter.name, setup: &setup, samples: &samples };
        sinscal::visit_filter(filter.name, pass);
    }
    let log = gap::Log { samples: &samples, setup: &setup };
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").expect("a filter of the library");
    let price = |(): &mut ()| {
        Pricing::of(&*filter, vocabulary.effects(), &log, Noise::STATED).expect("a sound log").base()
    };
    bench.run("pricing with 36d-p", 1, || (), price);
    bench.finish();
}
