//! Innovations of a filter that is right about its unit: as large as it says, and white.

use rig::{Scenario, Simulation};
use sinscal::{Calibration, Innovations, Sins43B};

#[test]
fn a_right_filter_has_white_innovations_of_the_size_it_says() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = Scenario::default().with_rate(10.0)?.modelled_by::<Sins43B>();
    let simulation = Simulation::new(&scenario, 1)?;
    let description = simulation.description().clone();
    let mut run = Box::new(Calibration::<Sins43B>::new(&description.setup(&[])).expect("a sound setup"));
    let mut innovations = Innovations::default();
    let mut first_pass = Innovations::default();
    let samples: Vec<_> = simulation.collect();
    for sample in &samples {
        run.step_observed(sample, &mut first_pass)?;
    }
    run.begin_pass();
    for sample in &samples {
        run.step_observed(sample, &mut innovations)?;
    }
    let updates = run.statistics().updates;
    for channels in [first_pass.finish(), innovations.finish()] {
        assert_eq!(channels.len(), 6);
        for channel in channels {
            let name = format!("{} {}", channel.group, channel.component);
            // all but the first update were predicted
            assert!(
                (updates - 1..=updates).contains(&channel.points.len()),
                "{name}: {}",
                channel.points.len()
            );
            // 3800 independent normal numbers: four standard deviations of each statistic
            assert!((channel.rms() - 1.0).abs() < 0.05, "{name}: rms {}", channel.rms());
            assert!(
                (channel.inside(1.0) - 0.6827).abs() < 0.03,
                "{name}: {} in 1 sigma",
                channel.inside(1.0)
            );
            assert!(
                (channel.inside(3.0) - 0.9973).abs() < 0.004,
                "{name}: {} in 3 sigma",
                channel.inside(3.0)
            );
            for lag in 1..=20 {
                let correlation = channel.autocorrelation(lag);
                assert!(correlation.abs() < 0.07, "{name}: {correlation} at lag {lag}");
            }
        }
    }
    Ok(())
}

/// The normalised innovations of a filter that lacks something are too large.
#[test]
fn a_wrong_filter_does_not() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = Scenario::default().with_rate(10.0)?;
    let simulation = Simulation::new(&scenario, 1)?;
    let description = simulation.description().clone();
    let mut run =
        Box::new(Calibration::<sinscal::Sins36P>::new(&description.setup(&[])).expect("a sound setup"));
    let mut innovations = Some(Innovations::default());
    for sample in simulation {
        run.step_observed(&sample, &mut innovations)?;
    }
    let channels = innovations.map_or(Vec::new(), Innovations::finish);
    assert!(channels.iter().any(|channel| channel.rms() > 1.5));
    assert!(channels.iter().any(|channel| channel.autocorrelation(1) > 0.2));
    Ok(())
}
