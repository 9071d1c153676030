//! Whether a scenario can be simulated: what concerns more than one field.

use std::f64::consts::TAU;

use sinscal::{AnyEffect, FORCE, Kind, Point, Signals};

use super::{DitherMode, Fault, Path, Scenario};

/// Slower sampling than this shows nothing of a turn, Hz.
const SLOWEST: f64 = 1.0;
/// Longest motion, s.
const LONGEST: f64 = 100.0 * 86_400.0;
/// The rounding of turns lasts at least this many samples.
const ROUNDING: f64 = 0.1;
/// Simulation of dither at its own rate is at least this fast, Hz.
const DITHER_RATE: f64 = 8e3;

pub(super) fn check(scenario: &Scenario) -> Vec<Fault> {
    let mut faults = Vec::new();
    check_rates(scenario, &mut faults);
    check_motion(scenario, &mut faults);
    check_populations(scenario, &mut faults);
    if faults.is_empty() {
        let duration = scenario.duration();
        if scenario.samples() < 2 {
            faults.push(Fault::new("motion.duration", "is shorter than two samples", "more"));
        }
        if duration > LONGEST || duration.is_nan() {
            let problem = format!("takes {:.3e} days", duration / 86_400.0);
            faults.push(Fault::new("motion", problem, "up to 100 days"));
        }
    }
    faults
}

/// How many times `part` goes into `whole`, when it does.
pub(crate) fn ratio(whole: f64, part: f64) -> Option<u64> {
    let ratio = whole / part;
    let round = ratio.round();
    ((ratio - round).abs() < 1e-9 * round && (1.0..1e9).contains(&round)).then_some(round as u64)
}

fn check_rates(scenario: &Scenario, faults: &mut Vec<Fault>) {
    let rate = scenario.rate;
    if !(SLOWEST..=1e5).contains(&rate) {
        let accepted = format!("from {SLOWEST} to 100000 Hz");
        faults.push(Fault::new("imu.rate", format!("is {rate} Hz"), accepted));
        return;
    }
    let dither = &scenario.dither;
    let parts = [
        ("reference.rate", scenario.reference.rate, scenario.reference.readings),
        ("temperature.rate", scenario.temperature.rate, true),
        ("dither.rate", dither.rate, dither.mode != DitherMode::Off),
    ];
    for (field, part, used) in parts {
        if used && ratio(rate, part).is_none() {
            let problem = format!("is {rate} Hz, which is no whole multiple of {field}, {part} Hz");
            let below = (rate / part).floor().max(1.0) * part;
            let accepted =
                format!("whole multiples of {part} Hz, for instance {below} Hz or {} Hz", below + part);
            faults.push(Fault::new("imu.rate", problem, accepted));
        }
    }
    if dither.mode == DitherMode::Full {
        let high = dither.simulation_rate;
        let fastest = 8.0 * dither.frequency.max();
        if high < DITHER_RATE || high < fastest || ratio(high, rate).is_none() {
            let problem = format!("is {high} Hz");
            let accepted = format!(
                "whole multiples of imu.rate, {rate} Hz, of at least {} Hz (8 kHz, and 8 samples in a period of the dither)",
                DITHER_RATE.max(fastest)
            );
            faults.push(Fault::new("dither.simulation_rate", problem, accepted));
        }
        if dither.frequency.min() <= 10.0 * dither.frequency_noise {
            let accepted = "more than ten times dither.frequency_noise";
            faults.push(Fault::new("dither.frequency", "is not far enough from zero", accepted));
        }
    }
    let vibration = &scenario.table.vibration;
    let vibrates = (vibration.acceleration + vibration.tilt).max() > 0.0;
    if vibrates && vibration.frequency.max() > 0.25 * rate {
        let accepted = format!("up to a quarter of the sampling rate, {} Hz", 0.25 * rate);
        faults.push(Fault::new("table.vibration_frequency", "is too fast for the samples", accepted));
    }
}

fn check_motion(scenario: &Scenario, faults: &mut Vec<Fault>) {
    let motion = &scenario.motion;
    let degrees = |x: f64| (x.to_degrees() * 1e6).round() / 1e6;
    let (most, hardest) = (motion.max_rate, motion.max_acceleration);
    if let Some(turns) = motion.turns() {
        if motion.acceleration > hardest {
            let problem = format!("is {} deg/s^2", degrees(motion.acceleration));
            let accepted = format!("up to motion.max_acceleration, {} deg/s^2", degrees(hardest));
            faults.push(Fault::new("motion.acceleration", problem, accepted));
        }
        if motion.rounding * scenario.rate < ROUNDING {
            let accepted =
                format!("at least a tenth of the sampling interval, {} s", ROUNDING / scenario.rate);
            faults.push(Fault::new("motion.rounding", format!("is {} s", motion.rounding), accepted));
        }
        if motion.still < 0.5 * motion.rounding {
            let accepted = format!("at least half of motion.rounding, {} s", 0.5 * motion.rounding);
            faults.push(Fault::new("motion.still", format!("is {} s", motion.still), accepted));
        }
        let listed = matches!(motion.path, Path::Turns(_));
        for (i, turn) in turns.iter().enumerate() {
            let field =
                |key: &str| if listed { format!("motion.turns[{i}].{key}") } else { format!("motion.{key}") };
            if turn.rate > most || turn.rate <= 0.0 {
                let problem = format!("is {} deg/s", degrees(turn.rate));
                let accepted = format!("more than 0, up to motion.max_rate, {} deg/s", degrees(most));
                faults.push(Fault::new(field("rate"), problem, accepted));
            }
            if turn.dwell < motion.rounding {
                let problem = format!("is {} s", turn.dwell);
                let accepted = format!(
                    "at least motion.rounding, {} s: turns must not run into each other",
                    motion.rounding
                );
                faults.push(Fault::new(field("dwell"), problem, accepted));
            }
            if turn.angle == 0.0 || turn.angle.abs() > 100.0 * TAU {
                let problem = format!("is {} deg", degrees(turn.angle));
                faults.push(Fault::new(field("angle"), problem, "up to 100 revolutions either way, not 0"));
            }
            if !listed && !faults.is_empty() {
                break;
            }
        }
    }
    if let Path::Swing { amplitude, frequency, .. } = &motion.path {
        for i in 0..3 {
            let w = TAU * frequency[i];
            if amplitude[i] * w > most || amplitude[i] * w * w > hardest {
                let problem = format!(
                    "asks for {:.1} deg/s and {:.1} deg/s^2 about {}",
                    degrees(amplitude[i] * w),
                    degrees(amplitude[i] * w * w),
                    ["x", "y", "z"][i]
                );
                let accepted = format!(
                    "up to motion.max_rate, {} deg/s, and motion.max_acceleration, {} deg/s^2",
                    degrees(most),
                    degrees(hardest)
                );
                faults.push(Fault::new("motion.swing", problem, accepted));
                break;
            }
            if frequency[i] > 0.1 * scenario.rate {
                let accepted = format!("up to a tenth of the sampling rate, {} Hz", 0.1 * scenario.rate);
                let problem = format!("is {} Hz about {}", frequency[i], ["x", "y", "z"][i]);
                faults.push(Fault::new("motion.swing.frequency", problem, accepted));
                break;
            }
        }
    }
}

fn check_populations(scenario: &Scenario, faults: &mut Vec<Fault>) {
    for population in &scenario.population {
        let name = population.effect.name();
        let n = population.effect.dim();
        if population.mean.len() != n || population.sigma.len() != n {
            let accepted = format!("{n} means and {n} sigmas");
            faults.push(Fault::new(
                format!("population.{name}"),
                "has another number of components",
                accepted,
            ));
        }
        if !acts_as_its_kind(population.effect) {
            faults.push(Fault::new(
                format!("population.{name}"),
                "has a Jacobian of another kind than it says",
                "the rows that its `Kind` names: rates 0 to 2, forces 3 to 5, or channels of the measurement alone",
            ));
        }
    }
}

/// Whether the entries of an effect's Jacobians are where its kind says: others would be left out of the simulation.
fn acts_as_its_kind(effect: &dyn AnyEffect) -> bool {
    let kind = effect.info().kind();
    let mut right = true;
    effect.input_jacobian(&Signals::default(), &mut |input, _, _| {
        right &= if input < FORCE { kind.of_gyros() } else { kind.of_accelerometers() };
    });
    effect.measurement_jacobian(&Point::default(), &mut |_, _, _| right &= kind == Kind::Measurement);
    right
}
