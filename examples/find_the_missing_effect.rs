//! For an engineer whose filter does not fit, and who wants to know why: the effects of the catalogue are tried, and with
//! them one of your own that nobody has modelled yet.
//!
//! ```sh
//! cargo run --release --example find_the_missing_effect
//! ```

use gap::{Diagnosis, Log, Options, diagnose};
use nalgebra::Vector3;
use rig::{DitherMode, Scenario, Simulation};
use runs::Vocabulary;
use sinscal::prelude::*;
use sinscal::{Effect, EffectInfo, FORCE, Kind, Sample, Signals, Sins36P, StateInfo};

/// Accelerometers that read more the faster the unit turns, whatever the sense: `d_f_i = k_i |omega|`.
#[derive(Debug)]
struct SpinSensitivity;

impl Effect for SpinSensitivity {
    const EFFECT: EffectInfo =
        EffectInfo::new("spin-sensitivity", Kind::Force, &["x", "y", "z"], "m/s", 1e-2)
            .model("d_f_i = k_i |omega|", "accelerometers that read more the faster the unit turns")
            .sheet("mm/s", 1e-3);
}

impl Block for SpinSensitivity {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "spin-sensitivity";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Self::EFFECT.states(visit);
    }

    fn input_jacobian<T: Real>(signals: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(FORCE + i, i, signals.rate.norm());
        }
    }
}

/// A run of a simulated unit that has what `Sins36P` knows, and the new effect. Yours comes from a file.
fn run(number: u64) -> Result<(Vec<Sample>, rig::Description), rig::ScenarioError> {
    let mut scenario = Scenario::default().with_rate(25.0)?.modelled_by::<Sins36P>();
    scenario.run = number;
    scenario.motion.still = 100.0;
    scenario.motion.dwell = 60.0;
    scenario.dither.mode = DitherMode::Off;
    let simulation = Simulation::new(&scenario, 4)?;
    let description = simulation.description().clone();
    let mut samples: Vec<Sample> = simulation.collect();
    for sample in &mut samples {
        sample.dvel += Vector3::new(3e-3, -2e-3, 1e-3) * sample.dtheta.norm();
    }
    Ok((samples, description))
}

/// Two runs of the unit, diagnosed.
pub(crate) fn find(options: &Options) -> Result<Diagnosis, Box<dyn std::error::Error>> {
    let (first, second) = (run(0)?, run(1)?);
    let (here, there) = (first.1.setup(&[]), second.1.setup(&[]));
    let vocabulary = Vocabulary::standard().with_effect::<SpinSensitivity>();
    let filter = vocabulary.filter("36d-p")?;
    Ok(diagnose(
        &*filter,
        vocabulary.effects(),
        &[Log { samples: &first.0, setup: &here }],
        Some(&Log { samples: &second.0, setup: &there }),
        options,
        &mut |stage, done| eprintln!("{:3.0} % {stage}", 100.0 * done),
    )?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let found = find(&Options::default())?;
    println!("{}", found.sentence);
    for effect in &found.effects {
        println!("{}: {:?} {} from this run", effect.name, effect.estimate, effect.unit);
        println!("{}: {:?} from the second", effect.name, effect.estimate_verify);
    }
    if let Some(gap) = &found.gap {
        println!(
            "innovations, root mean square: {:.2} before, {:.2} after",
            gap.fit.rms_before, gap.fit.rms_after
        );
    }
    if let Some(source) = &found.source {
        println!("\n{source}");
    }
    Ok(())
}
