//! Site, clock, thermometers and pick-offs that are a little off, and are considered: filters know how wrong they are.

use nalgebra::{DMatrix, DVector};
use rig::{Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{Calibration, Filter, Setup, Sins43B, Sizes, Strapdown, Tracked35};

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

/// `tracked-35d` on a table whose axes may not be square.
#[derive(StateBlocks)]
#[filter(name = "tracked-35d-considering")]
struct OnTable {
    #[base]
    sins: Tracked35,
    #[consider]
    table: TableOrthogonality,
}

/// The same, estimating it.
#[derive(StateBlocks)]
#[filter(name = "tracked-35d-estimating")]
struct OfTable {
    #[base]
    sins: Tracked35,
    table: TableOrthogonality,
}

/// An effect and its standard deviation, SI and as a scenario has it.
type Off = (&'static str, f64, &'static str);

/// What may be off for a unit on a table.
const OFF: [Off; 8] = [
    ("clock-scale", 2e-5, "20 ppm"),
    ("site-latitude", 3e-4, "3e-4 rad"),
    ("site-height", 20.0, "20 m"),
    ("site-gravity", 3e-4, "30 mGal"),
    ("thermometer-lag", 40.0, "40 s"),
    ("thermometer-scale", 0.03, "3 %"),
    ("thermometer-offset", 1.0, "1 K"),
    ("dither-scale", 0.05, "5 %"),
];

/// Of units of `base` for which some of what may be off is, and a filter `C` that knows: mean squares of the errors of what is estimated, in
/// standard deviations, NEES of each degree of freedom, and how much larger the largest sigma is than without considering.
fn consider<B, C>(
    base: &str,
    may_be: &[Off],
    off: &[Off],
    units: u64,
) -> Result<(Vec<f64>, f64, f64), Box<dyn std::error::Error>>
where
    B: Filter<Dynamics = Strapdown, Shape: Sizes>,
    C: Filter<Dynamics = Strapdown, Shape: Sizes>,
{
    let mut scenario = Scenario::parse(base)?.with_rate(10.0)?.modelled_by::<B>();
    (scenario.motion.still, scenario.motion.dwell) = (60.0, 30.0);
    let kept: Vec<&str> = {
        let mut names = Vec::new();
        B::states(&mut |info| names.push(info.block));
        names
    };
    let one = |(name, _, size): &Off| format!("{name} = \"{size}\"\n");
    let drawn = Scenario::parse(&format!("[population]\n{}", off.iter().map(one).collect::<String>()))?;
    scenario.population.extend(drawn.population);
    // what is not off is exact
    let size = |name: &str| off.iter().find(|(other, _, _)| *other == name).map_or(0.0, |(_, size, _)| *size);
    let priors: Vec<(&str, f64)> = may_be.iter().map(|(name, _, _)| (*name, size(name))).collect();
    let (mut squares, mut nees, mut larger) = (Vec::new(), 0.0, 0.0_f64);
    for seed in 1..=units {
        let mut simulation = Simulation::new(&scenario, seed)?;
        let description = simulation.description().clone();
        let samples: Vec<_> = simulation.by_ref().collect();
        let run = |priors: &[(&str, f64)]| -> Result<_, Box<dyn std::error::Error>> {
            let setup: Setup = description.setup(priors);
            let mut run = Box::new(Calibration::<C>::new(&setup)?);
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
        let exact: Vec<(&str, f64)> = may_be.iter().map(|(name, _, _)| (*name, 0.0)).collect();
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
    let (squares, nees, larger) = consider::<Sins43B, Considering>("", &OFF, &OFF, 2)?;
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
        let (squares, nees, larger) = consider::<Sins43B, Considering>("", &OFF, &[off], 10)?;
        let worst = squares.iter().fold(0.0_f64, |worst, square| worst.max(*square));
        println!("{off:?}: NEES {nees:.3}, worst {worst:.2}, sigmas larger by up to {larger:.1}");
        assert!((0.7..1.3).contains(&nees), "{off:?}: {nees}");
    }
    Ok(())
}

/// A unit whose attitude a table reports: what tracked units may have wrong, but nothing that the table shows as well.
const TABLE: &str = "[reference]\nattitude = true\n[population]\ngyro-scale = \"500 ppm\"\ngyro-misalignment = \"1 mrad\"\n\
    gyro-bias = \"1 deg/h\"\naccel-scale = \"500 ppm\"\naccel-misalignment = \"1 mrad\"\naccel-bias = \"1 mg\"\n\
    reference-misalignment = \"2 mrad\"\nreference-tilt = \"0.2 mrad\"\n[gyro]\nrandom_walk = \"0.05 deg/sqrt(h)\"\n\
    quantum = \"0 arcsec\"\n[accelerometer]\nrandom_walk = \"50 ug/sqrt(Hz)\"";

#[test]
fn a_table_that_is_not_square_is_considered_or_found() -> Result<(), Box<dyn std::error::Error>> {
    let off = [("table-orthogonality", 4e-3, "4 mrad")];
    let (_, nees, _) = consider::<Tracked35, Tracked35>(TABLE, &off, &off, 4)?;
    assert!(nees > 100.0, "it does not matter: {nees}");
    let (squares, nees, _) = consider::<Tracked35, OnTable>(TABLE, &off, &off, 4)?;
    println!("considered: NEES {nees:.3}, {squares:.1?}");
    // 104 squares: 0.61 to 1.50 in 999 cases of 1000
    assert!((0.61..1.50).contains(&nees), "{nees}");
    let (squares, nees, _) = consider::<OfTable, OfTable>(TABLE, &off, &off, 4)?;
    println!("estimated: NEES {nees:.3}, {squares:.1?}");
    assert!((0.61..1.50).contains(&nees), "{nees}");
    Ok(())
}
