//! A reference that fails now and then does not bend the parameters.

use nalgebra::{UnitQuaternion, Vector3};
use rig::{Scenario, Simulation};
use sinscal::{Calibration, Sample, Sins43B, Statistics};

/// Estimate, sigma and truth of every parameter after two passes, and the sums of the second.
fn calibrate(simulation: &Simulation, log: &[Sample]) -> (Vec<(f64, f64, f64)>, Statistics) {
    let mut calibration = Calibration::<Sins43B>::new(&simulation.description().setup(&[]));
    for pass in 0..2 {
        if pass > 0 {
            calibration.begin_pass();
        }
        for sample in log {
            calibration.step(sample).unwrap();
        }
    }
    let mut found = Vec::new();
    calibration.parameters(&mut |p| found.push((p.value, p.sigma, simulation.truth().of(&p.info))));
    (found, *calibration.statistics())
}

/// Changes the readings of the reference from `from` to `to` seconds.
fn spoil(log: &mut [Sample], from: f64, to: f64, mut change: impl FnMut(&mut Sample)) {
    for sample in log.iter_mut().filter(|sample| (from..to).contains(&sample.time)) {
        if sample.reference.velocity.is_some() {
            change(sample);
        }
    }
}

/// The default unit on a quick path, in which a complete filter errs by less than 3 sigma, and its log.
fn sound() -> (Simulation, Vec<Sample>) {
    let scenario = Scenario::parse("[motion]\nstill = \"120 s\"\ndwell = \"60 s\"").unwrap();
    let simulation = Simulation::new(&scenario, 2).unwrap();
    let log = simulation.clone().collect();
    (simulation, log)
}

#[test]
fn bursts_jumps_stuck_and_missing_readings_do_not_bias() {
    let (simulation, clean) = sound();
    let (expected, statistics) = calibrate(&simulation, &clean);
    let nothing = (statistics.rejected, statistics.repeated, statistics.reopened);
    assert_eq!(nothing, (0, 0, 0), "a sound log is used whole");

    let mut log = clean.clone();
    let mut sign = 1.0;
    let mut flip = || {
        sign = -sign;
        sign
    };
    // bursts, one of a sign that changes, one that does not, while the unit turns and while it rests
    spoil(&mut log, 200.0, 230.0, |s| {
        s.reference.velocity = s.reference.velocity.map(|v| v.add_scalar(0.4 * flip()))
    });
    spoil(&mut log, 505.0, 520.0, |s| {
        s.reference.velocity = s.reference.velocity.map(|v| v + Vector3::x() * 0.05)
    });
    spoil(&mut log, 640.0, 660.0, |s| {
        s.reference.position = s.reference.position.map(|p| p - Vector3::z() * 0.2)
    });
    // single readings that are wild
    for second in [150.0, 333.0, 334.0, 777.0] {
        spoil(&mut log, second - 0.5, second + 0.5, |s| {
            s.reference.velocity = Some(Vector3::repeat(80.0 + second))
        });
    }
    // stuck at its last readings
    let mut held = None;
    spoil(&mut log, 700.0, 760.0, |s| s.reference = *held.get_or_insert(s.reference));
    // missing
    spoil(&mut log, 850.0, 930.0, |s| s.reference = Default::default());
    // the reference's origin moves for good
    spoil(&mut log, 1000.0, 1e9, |s| {
        s.reference.position = s.reference.position.map(|p| p + Vector3::new(0.1, 0.0, 0.0))
    });

    let (found, statistics) = calibrate(&simulation, &log);
    // at 1 Hz: the bursts, the single readings, and the jump until the gate opens to it
    assert!((69..69 + 80).contains(&statistics.rejected), "{statistics:?}");
    assert_eq!(statistics.repeated, 2 * 59, "{statistics:?}");
    assert_eq!(statistics.reopened, 1, "{statistics:?}");
    assert!((statistics.nis_per_dof() - 1.0).abs() < 0.1, "{statistics:?}");
    for (i, ((value, sigma, truth), (clean, clean_sigma, _))) in found.iter().zip(&expected).enumerate() {
        let (error, moved) = ((value - truth) / sigma, (value - clean) / sigma);
        assert!(error.abs() < 3.0, "parameter {i}: {error} sigma from the truth, {moved} from the clean log");
        // readings that are lost make estimates move by the square root of the lost information
        assert!(
            moved.abs() < 1.5 * (1.0 - (clean_sigma / sigma).powi(2)).sqrt().max(0.2),
            "parameter {i}: {moved}"
        );
    }
}

/// Without the right model innovations are large all the time, and are what the data say: once the gate knows what is usual
/// for the filter, nothing is refused.
#[test]
fn a_filter_that_lacks_an_effect_keeps_its_data() {
    let (simulation, log) = sound();
    let mut calibration = Calibration::<sinscal::Sins36P>::new(&simulation.description().setup(&[]));
    let mut rejected = Vec::new();
    for _ in 0..2 {
        for sample in &log {
            calibration.step(sample).unwrap();
        }
        assert!(calibration.statistics().nis_per_dof() > 5.0, "{:?}", calibration.statistics());
        rejected.push(calibration.statistics().rejected);
        calibration.begin_pass();
    }
    assert!(rejected[0] < log.len() / 50 / 10 && rejected[1] == 0, "{rejected:?}");
}

/// An initial attitude that is wrong beyond its sigma is refused for a while, then the gate opens.
#[test]
fn the_gate_never_shuts_for_good() {
    let (simulation, log) = sound();
    let mut setup = simulation.description().setup(&[]);
    setup.initial.attitude =
        UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.02, 0.0)) * setup.initial.attitude;
    let mut calibration = Calibration::<Sins43B>::new(&setup);
    for sample in &log {
        calibration.step(sample).unwrap();
    }
    let statistics = calibration.statistics();
    assert!(statistics.rejected > 0 && statistics.updates > log.len() / 50 / 2, "{statistics:?}");
}
