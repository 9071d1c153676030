//! An effect of one's own is priced and named beside those of the catalogue.

use gap::{Candidates, Log, Options, Verdict, diagnose_with};
use hybrid_array::typenum::U64;
use rig::{DitherMode, Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{FORCE, Sample, Signals, Sins36P};

/// Accelerometers that read more the faster the unit turns: `d_f_i = k_i |omega|`.
#[derive(Debug)]
struct SpinSensitivity;

impl Block for SpinSensitivity {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for component in ["x", "y", "z"] {
            visit(StateInfo {
                block: "spin-sensitivity",
                component,
                unit: "m/s",
                prior_sigma: 1e-2,
                sheet_unit: "m/s",
                sheet_scale: 1.0,
            });
        }
    }

    fn input_jacobian<T: Real>(s: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(FORCE + i, i, s.rate.norm());
        }
    }
}

/// The catalogue and one more.
#[derive(Debug, StateBlocks)]
#[group]
struct Mine {
    known: Candidates,
    own: SpinSensitivity,
}

fn log(run: u64) -> (Vec<Sample>, rig::Description) {
    let mut scenario = Scenario::default().with_rate(20.0).unwrap().modelled_by::<Sins36P>();
    scenario.run = run;
    scenario.motion.still = 100.0;
    scenario.motion.dwell = 40.0;
    scenario.dither.mode = DitherMode::Off;
    let simulation = Simulation::new(&scenario, 4).unwrap();
    let description = simulation.description().clone();
    let mut samples: Vec<Sample> = simulation.collect();
    for s in &mut samples {
        s.dvel += nalgebra::Vector3::new(3e-3, -2e-3, 1e-3) * s.dtheta.norm();
    }
    (samples, description)
}

#[test]
fn own_effect_is_named() {
    let (a, b) = (log(0), log(1));
    let (first, second) = (a.1.setup(&[]), b.1.setup(&[]));
    let options = Options { rerun: false, ..Options::default() };
    let d = diagnose_with::<Sins36P, Mine, U64>(
        &Log { samples: &a.0, setup: &first },
        Some(&Log { samples: &b.0, setup: &second }),
        &options,
        &mut |_, _| {},
    )
    .unwrap();
    assert_eq!(d.verdict, Verdict::EffectsFound, "{}", d.sentence);
    assert_eq!(d.effects[0].name, "spin-sensitivity");
    assert!((d.effects[0].estimate[0] - 3e-3).abs() < 5.0 * d.effects[0].sigma[0], "{:?}", d.effects);
}
