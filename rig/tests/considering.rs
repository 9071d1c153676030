//! Site, clock, thermometers and pick-offs that are a little off, and are considered: filters know how wrong they are.

use nalgebra::{DMatrix, DVector};
use rig::{Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{Calibration, Setup, Sins43B};

/// `43d-b` that takes what is not the unit's for what it may be.
#[derive(StateBlocks)]
#[filter(name = "43d-b-considering")]
struct Considering {
    #[base]
    sins: Sins43B,
    #[consider]
    clock: ClockScale,
    #[consider]
    latitude: SiteLatitude,
    #[consider]
    height: SiteHeight,
    #[consider]
    gravity: SiteGravity,
    #[consider]
    lag: ThermometerLag,
    #[consider]
    scale: ThermometerScale,
    #[consider]
    offset: ThermometerOffset,
    #[consider]
    dither: DitherScale,
}

/// Effects and standard deviations, SI and as a scenario has them.
const OFF: [(&str, f64, &str); 8] = [
    ("clock-scale", 2e-5, "20 ppm"),
    ("site-latitude", 3e-4, "3e-4 rad"),
    ("site-height", 20.0, "20 m"),
    ("site-gravity", 3e-4, "30 mGal"),
    ("thermometer-lag", 40.0, "40 s"),
    ("thermometer-scale", 0.03, "3 %"),
    ("thermometer-offset", 1.0, "1 K"),
    ("dither-scale", 0.05, "5 %"),
];

/// Mean squares of the errors of what is estimated, in standard deviations, NEES of each degree of freedom, and how much larger the largest
/// sigma is than without considering.
fn consider(
    off: &[(&'static str, f64, &str)],
    units: u64,
) -> Result<(Vec<f64>, f64, f64), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::default().with_rate(10.0)?.modelled_by::<Sins43B>();
    (scenario.motion.still, scenario.motion.dwell) = (60.0, 30.0);
    let kept: Vec<&str> = {
        let mut names = Vec::new();
        Sins43B::states(&mut |info| names.push(info.block));
        names
    };
    let one = |(name, _, size): &(&str, f64, &str)| format!("{name} = \"{size}\"\n");
    let drawn = Scenario::parse(&format!("[population]\n{}", off.iter().map(one).collect::<String>()))?;
    scenario.population.extend(drawn.population);
    // what is not off is exact
    let size = |name: &str| off.iter().find(|(other, _, _)| *other == name).map_or(0.0, |(_, size, _)| *size);
    let priors: Vec<(&str, f64)> = OFF.iter().map(|(name, _, _)| (*name, size(name))).collect();
    let (mut squares, mut nees, mut larger) = (Vec::new(), 0.0, 0.0_f64);
    for seed in 1..=units {
        let mut simulation = Simulation::new(&scenario, seed)?;
        let description = simulation.description().clone();
        let samples: Vec<_> = simulation.by_ref().collect();
        let run = |priors: &[(&str, f64)]| -> Result<_, Box<dyn std::error::Error>> {
            let setup: Setup = description.setup(priors);
            let mut run = Box::new(Calibration::<Considering>::new(&setup)?);
            for pass in 0..3 {
                if pass > 0 {
                    run.begin_pass();
                }
                for sample in &samples {
                    run.step(sample)?;
                }
            }
            let (mut errors, mut sigmas) = (Vec::new(), Vec::new());
            run.parameters(&mut |p| {
                if kept.contains(&p.info.block) {
                    errors.push((p.value - simulation.truth().of(&p.info)) / p.sigma);
                    sigmas.push(p.sigma);
                }
            });
            Ok((errors, sigmas, run.covariance()))
        };
        let exact: Vec<(&str, f64)> = OFF.iter().map(|(name, _, _)| (*name, 0.0)).collect();
        let (errors, sigmas, p) = run(&priors)?;
        if seed == 1 {
            let alone = run(&exact)?.1;
            larger = sigmas.iter().zip(alone).map(|(with, without)| with / without).fold(0.0, f64::max);
        }
        let n = errors.len();
        let correlation = DMatrix::from_fn(n, n, |i, j| p[9 + i][9 + j] / (sigmas[i] * sigmas[j]));
        let error = DVector::from_vec(errors);
        nees += error.dot(&correlation.cholesky().ok_or("no covariance")?.solve(&error)) / n as f64;
        squares.resize(n, 0.0);
        squares.iter_mut().zip(error.iter()).for_each(|(sum, e)| *sum += e * e / units as f64);
    }
    Ok((squares, nees / units as f64, larger))
}

#[test]
fn errors_are_as_large_as_stated_where_the_chain_is_off() -> Result<(), Box<dyn std::error::Error>> {
    let (squares, nees, larger) = consider(&OFF, 2)?;
    println!("NEES {nees:.3} of each degree of freedom, sigmas larger by up to {larger:.1}, {squares:.1?}");
    // 68 squares: 0.53 to 1.65 in 999 cases of 1000
    assert!((0.53..1.65).contains(&nees), "{nees}");
    // two squares: below 11 in 999 cases of 1000, with 34 parameters
    assert!(squares.iter().all(|square| *square < 11.0), "{squares:?}");
    assert!(larger > 3.0, "nothing was off: {larger}");
    Ok(())
}

#[test]
#[ignore = "minutes"]
fn each_alone_is_known() -> Result<(), Box<dyn std::error::Error>> {
    for off in OFF {
        let (squares, nees, larger) = consider(&[off], 10)?;
        let worst = squares.iter().fold(0.0_f64, |worst, square| worst.max(*square));
        println!("{off:?}: NEES {nees:.3}, worst {worst:.2}, sigmas larger by up to {larger:.1}");
        assert!((0.7..1.3).contains(&nees), "{off:?}: {nees}");
    }
    Ok(())
}
