//! What pricing the catalogue costs beside a plain pass of the filter over the same log.

use std::time::Instant;

use gap::{Log, Noise, Pricing};
use rig::{Scenario, Simulation};
use runs::Vocabulary;
use sinscal::{Calibration, Sample, Sins36P};

/// Prints the figures of docs/DIAGNOSIS.md; half a minute.
#[test]
#[ignore = "a stop-watch: run with --release -- --ignored --nocapture on a machine that does nothing else"]
fn pricing_beside_one_pass() {
    let simulation = Simulation::new(&Scenario::default(), 1).unwrap();
    let description = simulation.description().clone();
    let setup = description.setup(&[]);
    let samples: Vec<Sample> = simulation.collect();
    let log = Log { samples: &samples, setup: &setup };
    let least = |work: &mut dyn FnMut()| {
        let timed = (0..5).map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        });
        timed.fold(f64::INFINITY, f64::min)
    };
    let pass = least(&mut || {
        let mut calibration = Calibration::<Sins36P>::new(&setup).expect("a sound setup");
        for sample in &samples {
            calibration.step(sample).unwrap();
        }
    });
    let vocabulary = Vocabulary::standard();
    let filter = vocabulary.filter("36d-p").expect("a filter of the library");
    let whole =
        least(&mut || assert!(Pricing::of(&*filter, vocabulary.effects(), &log, Noise::STATED).is_ok()));
    let mut prices = Pricing::of(&*filter, vocabulary.effects(), &log, Noise::STATED).unwrap();
    let pricing = least(&mut || prices.reprice(Noise::STATED).unwrap());
    let print = |what: &str, seconds: f64| println!("{what:58} {seconds:7.3} s {:6.2}", seconds / pass);
    println!("{} samples, {} effects; the last column in passes", samples.len(), prices.effects().count());
    print("one pass of 36d-p", pass);
    print("pricing from the record of a pass", pricing);
    print("recording with every effect's columns, and pricing", whole);
}
