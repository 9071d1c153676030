//! Amplitudes of the dither that are told wrongly are a mistake in the log, and no lever arm.

use gap::{Diagnosis, Log, Options, Verdict, diagnose};
use rig::scenario::Path;
use rig::{Scenario, Simulation};
use runs::Vocabulary;
use sinscal::{Sample, Sins43B};

/// Two runs of a unit that 43d-b models, with the amplitudes told so many times.
fn told(times: f64) -> Diagnosis {
    let log = |run: u64| {
        let mut scenario = Scenario::default().with_rate(20.0).unwrap().modelled_by::<Sins43B>();
        scenario.run = run;
        scenario.motion.still = 150.0;
        scenario.motion.dwell = 80.0;
        if run == 1 {
            scenario.motion.path = Path::NineteenPositions;
        }
        let simulation = Simulation::new(&scenario, 71).unwrap();
        let description = simulation.description().clone();
        let mut samples: Vec<Sample> = simulation.collect();
        samples.iter_mut().for_each(|sample| sample.dither *= times);
        (samples, description)
    };
    let (first, second) = (log(0), log(1));
    let (here, there) = (first.1.setup(&[]), second.1.setup(&[]));
    let options = Options { rerun: false, ..Options::default() };
    let vocabulary = Vocabulary::standard();
    diagnose(
        &*vocabulary.filter("43d-b").unwrap(),
        vocabulary.effects(),
        &[Log { samples: &first.0, setup: &here }],
        Some(&Log { samples: &second.0, setup: &there }),
        &options,
        &mut |_, _| {},
    )
    .unwrap()
}

#[test]
fn root_mean_squares_and_peaks_to_peak_are_told_as_such() {
    for (times, looks) in [(core::f64::consts::FRAC_1_SQRT_2, "root mean squares"), (2.0, "peak to peak")] {
        let d = told(times);
        let names: Vec<&str> = d.effects.iter().map(|effect| effect.name.as_str()).collect();
        match d.verdict {
            Verdict::EffectsFound => {
                assert_eq!(names, ["dither-scale"], "{}", d.sentence);
                assert!(d.notes.iter().any(|note| note.contains(looks)), "{:?}", d.notes);
                for (scale, sigma) in d.effects[0].estimate.iter().zip(&d.effects[0].sigma) {
                    assert!((scale - (times - 1.0)).abs() < 4.0 * sigma, "{times}: {scale} +- {sigma}");
                }
            }
            // the same as arms that are shifted together
            Verdict::Ambiguous => {
                let sets: Vec<String> = d.ambiguous.iter().map(|set| set.join(" ")).collect();
                assert!(sets.iter().any(|set| set == "dither-scale"), "{sets:?}");
            }
            _ => panic!("{}", d.sentence),
        }
    }
    assert_eq!(told(1.0).verdict, Verdict::NothingMissing);
}
