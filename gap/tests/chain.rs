//! What a log states wrongly is a mistake in the log, and no error of the unit.

use gap::{Diagnosis, Log, Options, Verdict, diagnose};
use rig::scenario::Path;
use rig::{Scenario, Simulation};
use runs::Vocabulary;
use sinscal::{Sample, Sins43B};

/// Two runs of a unit that 43d-b models, with the amplitudes of the dither told so many times, at a site stated so much too far north, rad.
fn told(times: f64, north: f64) -> Diagnosis {
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
    let (mut here, mut there) = (first.1.setup(&[]), second.1.setup(&[]));
    here.site.latitude += north;
    there.site.latitude += north;
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
        let d = told(times, 0.0);
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
    let sound = told(1.0, 0.0);
    assert_eq!(sound.verdict, Verdict::NothingMissing, "{}", sound.sentence);
    // nothing that the unit does shows gravity, its height or its clock beside the scale of the accelerometers
    let hides =
        |name: &str| sound.indistinguishable.iter().any(|pair| pair[0] == name && pair[1] == "accel-scale");
    assert!(
        ["site-gravity", "site-height", "clock-scale"].into_iter().all(hides),
        "{:?}",
        sound.indistinguishable
    );
}

#[test]
fn a_latitude_that_is_stated_wrongly_is_shown_by_the_unit() {
    let north = 0.1_f64.to_radians();
    let d = told(1.0, north);
    let names: Vec<&str> = d.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(
        (d.verdict, names.as_slice()),
        (Verdict::EffectsFound, &["site-latitude"][..]),
        "{}",
        d.sentence
    );
    let found = &d.effects[0];
    let (value, sigma) = (found.estimate[0], found.sigma[0]);
    assert!((value + north).abs() < 4.0 * sigma && sigma < 0.2 * north, "{value} +- {sigma}");
    assert!(d.notes.iter().any(|note| note.contains("states a latitude of 32.160 deg")), "{:?}", d.notes);
}
