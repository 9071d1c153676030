//! Scenarios that are refused, and how.

use rig::{DEFAULT_SCENARIO, Scenario};
use sinscal::EFFECTS;

use crate::common::can_be_given;

/// The faults of a scenario, as people see them.
fn faults(text: &str) -> Vec<String> {
    match Scenario::parse(text) {
        Ok(_) => Vec::new(),
        Err(error) => error.faults.iter().map(ToString::to_string).collect(),
    }
}

/// Each has one fault, which says all of these.
const BAD: &[(&str, &[&str])] = &[
    ("[imu]\nrate = \"-50 Hz\"", &["line 2", "imu.rate", "-50 Hz", "more than 0", "100000 Hz"]),
    ("[imu]\nrate = 50", &["imu.rate", "an integer", "Hz, kHz"]),
    ("[imu]\nrate = \"50\"", &["imu.rate", "Hz, kHz"]),
    ("[imu]\nrate = \"fast\"", &["imu.rate", "a number, a space and its unit"]),
    ("[imu]\nrate = \"nan Hz\"", &["imu.rate", "more than 0"]),
    ("[imu]\nrate = \"inf Hz\"", &["imu.rate", "more than 0"]),
    ("[imu]\nrate = \"50 deg\"", &["imu.rate", "one of the units Hz, kHz"]),
    ("[imu]\nspeed = \"50 Hz\"", &["line 2", "imu.speed", "is not known", "accepted: rate"]),
    ("[gyros]\nrandom_walk = \"0 deg/sqrt(h)\"", &["line 1", "gyros", "accelerometer"]),
    ("imu = 3", &["imu", "is not a table"]),
    ("[imu\nrate", &["line 1", "not valid TOML"]),
    ("[site]\nlatitude = \"91 deg\"", &["site.latitude", "from -89.9 deg"]),
    ("[motion]\npath = \"spiral\"", &["motion.path", "eighteen-rotations, nineteen-positions, two-axis"]),
    ("[motion]\nstart = \"NEU\"", &["motion.start", "right-handed"]),
    ("[motion]\nrate = \"-10 deg/s\"", &["line 2", "motion.rate", "more than 0"]),
    ("[motion]\nrate = \"0 deg/s\"", &["motion.rate", "more than 0"]),
    ("[motion]\nrate = \"300 deg/s\"", &["line 2", "motion.rate", "300 deg/s", "motion.max_rate, 200 deg/s"]),
    ("[motion]\nacceleration = \"600 deg/s^2\"", &["motion.acceleration", "500 deg/s^2"]),
    ("[motion]\ndwell = \"0.05 s\"", &["motion.dwell", "at least motion.rounding, 0.1 s"]),
    ("[motion]\ndwell = \"-1 s\"", &["motion.dwell", "from 0"]),
    ("[motion]\nstill = \"0 s\"", &["motion.still", "at least half of motion.rounding"]),
    ("[motion]\npath = \"turns\"", &["motion.turns", "is missing"]),
    ("[motion]\nturns = [{ axis = \"x\", angle = \"90 deg\" }]", &["motion.turns", "path = \"turns\""]),
    ("[motion]\npath = \"turns\"\nturns = []", &["line 3", "motion.turns", "no list of turns"]),
    ("[motion]\npath = \"turns\"\nturns = [3]", &["motion.turns[0]", "is no turn"]),
    (
        "[motion]\npath = \"turns\"\nturns = [{ axis = \"w\", angle = \"90 deg\" }]",
        &["motion.turns[0].axis", "\"w\"", "x, y, z, east, north, up"],
    ),
    (
        "[motion]\npath = \"turns\"\nturns = [{ axis = \"x\" }]",
        &["motion.turns[0]", "lacks its angle", "rate and dwell optional"],
    ),
    (
        "[motion]\npath = \"turns\"\nturns = [{ axis = \"x\", angle = \"0 deg\" }]",
        &["motion.turns[0].angle", "anything but zero"],
    ),
    (
        "[motion]\npath = \"turns\"\nturns = [{ axis = \"x\", angle = \"9 deg\", rate = \"500 deg/s\" }]",
        &["line 3", "motion.turns[0].rate", "200 deg/s"],
    ),
    ("[motion]\npath = \"swing\"\nswing.frequency = \"4 Hz\"", &["motion.swing", "deg/s^2", "500"]),
    (
        "[motion.swing]\nfrequency = [\"1 Hz\", \"2 Hz\"]",
        &["motion.swing.frequency", "2 values", "list of 3"],
    ),
    ("[motion]\npath = \"still\"\nduration = \"0.001 s\"", &["motion.duration", "two samples"]),
    ("[reference]\nrate = \"3 Hz\"", &["imu.rate", "no whole multiple of reference.rate", "48 Hz or 51 Hz"]),
    ("[reference]\nkind = \"gps\"", &["reference.kind", "readings, fixed-point"]),
    ("[reference]\nattitude = \"yes\"", &["reference.attitude", "true, false"]),
    ("[temperature]\nprofile = \"ramps\"", &["temperature.points", "is missing"]),
    (
        "[temperature]\nprofile = \"ramps\"\npoints = [[\"5 s\", \"20 degC\"], [\"5 s\", \"30 degC\"]]",
        &["temperature.points[1]", "not later", "increasing"],
    ),
    ("[temperature]\nstart = \"200 degC\"", &["temperature.start", "from -80 degC to 150 degC"]),
    ("[dither]\nmode = \"on\"", &["dither.mode", "off, mean, full"]),
    ("[dither]\nmode = \"full\"\nsimulation_rate = \"4 kHz\"", &["dither.simulation_rate", "8000 Hz"]),
    (
        "[dither]\nmode = \"full\"\nsimulation_rate = \"16.01 kHz\"",
        &["dither.simulation_rate", "whole multiples"],
    ),
    ("[population]\ngyro-bais = \"1 deg/h\"", &["population.gyro-bais", "is not an effect", "gyro-bias"]),
    ("[population]\ngyro-bias = \"1 mm\"", &["population.gyro-bias", "rad/s, mrad/s, deg/s, deg/h"]),
    ("[population]\ngyro-bias = \"-1 deg/h\"", &["population.gyro-bias", "from 0"]),
    (
        "[population]\ngyro-bias = { sigma = \"1 deg/h\", average = \"1 deg/h\" }",
        &["gyro-bias.average", "mean, sigma"],
    ),
    ("[population]\naccel-misalignment = [\"1 mrad\"]", &["accel-misalignment", "1 values", "list of 6"]),
    ("[population]\ndither-size-effect = \"40 mm\"", &["dither-size-effect", "inner-lever-arm"]),
    (
        "[motion]\nrounding = \"1 us\"",
        &["line 2", "motion.rounding", "a tenth of the sampling interval, 0.002 s"],
    ),
    ("[motion]\nrate = \"1e-9 deg/s\"", &["line 1", "motion", "days", "up to 100 days"]),
    ("[population]\naccel-bias = \"1e30 g\"", &["accel-bias", "from 0 to 1019.71621298 g"]),
    ("[run]\nnumber = -1", &["run.number", "0, 1, 2"]),
    (
        "[motion]\npath = \"turns\"\nturns = [\n{ axis = \"x\", angle = \"9 deg\" },\n\
         { axis = \"x\", angle = \"9 deg\",\nrate = \"500 deg/s\" }]",
        &["line 6", "motion.turns[1].rate", "200 deg/s"],
    ),
    ("[table]\nvibration_acceleration = \"1 mg\"", &["table.vibration_frequency", "12.5 Hz"]),
];

#[test]
fn bad_scenarios_are_refused_with_field_line_and_what_is_accepted() {
    for (text, words) in BAD {
        let faults = faults(text);
        assert_eq!(faults.len(), 1, "{text}\n{faults:#?}");
        for word in *words {
            assert!(faults[0].contains(word), "{text}\n{}\nlacks {word}", faults[0]);
        }
    }
}

#[test]
fn every_fault_is_reported_at_once() {
    let text = "[imu]\nrate = \"0 Hz\"\n[site]\nheight = 3\n[population]\nmagic = \"1 m\"\n";
    assert_eq!(faults(text).len(), 3);
}

#[test]
fn spans_point_at_the_value() {
    let text = "[imu]\nrate = \"50 Hz\"\n[motion]\nrate = \"300 deg/s\"\n";
    let error = Scenario::parse(text).unwrap_err();
    let span = error.faults[0].span.clone().unwrap();
    assert_eq!(&text[span], "\"300 deg/s\"");
}

#[test]
fn a_rate_that_does_not_divide_is_refused() {
    let error = Scenario::default().with_rate(33.3).unwrap_err().to_string();
    assert!(error.contains("imu.rate is 33.3 Hz") && error.contains("33 Hz or 34 Hz"), "{error}");
    assert!(Scenario::default().with_rate(-1.0).unwrap_err().to_string().contains("from 1 to 100000 Hz"));
    assert!(Scenario::default().with_rate(f64::NAN).is_err());
}

#[test]
fn what_is_not_said_is_as_in_the_default_scenario() {
    let scenario = Scenario::parse("[imu]\nrate = \"100 Hz\"").unwrap();
    assert_eq!(scenario, Scenario::default().with_rate(100.0).unwrap());
    assert_eq!(Scenario::parse(DEFAULT_SCENARIO).unwrap(), Scenario::default());
}

#[test]
fn the_alternatives_shown_in_comments_work() {
    // uncommented, one by one
    let turns = "[motion]\npath = \"turns\"\nturns = [\n  { axis = \"y\", angle = \"90 deg\" },\n  \
                 { axis = \"east\", angle = \"-180 deg\", rate = \"30 deg/s\", dwell = \"60 s\" },\n]";
    let scenario = Scenario::parse(turns).unwrap();
    // 300 + 9.5 + 180 + 7.5 + 60
    assert!((scenario.duration() - 557.0).abs() < 1e-9);
    let ramps = "[temperature]\nprofile = \"ramps\"\n\
                 points = [[\"0 s\", \"20 degC\"], [\"1800 s\", \"45 degC\"], [\"3600 s\", \"10 degC\"]]";
    assert!(Scenario::parse(ramps).is_ok());
    let population = "[population]\n\"accel-delay\" = { mean = \"0.5 ms\", sigma = \"0.1 ms\" }\n\
                      \"gyro-bias\" = { mean = [\"0.1 deg/h\", \"0 deg/h\", \"-0.2 deg/h\"], sigma = \"0 deg/h\" }";
    let truth = Scenario::parse(population).unwrap().unit(1);
    assert_eq!(truth.effects().len(), 2);
    assert!((truth.value("gyro-bias", 2) + 0.2_f64.to_radians() / 3600.0).abs() < 1e-18);
}

#[test]
fn every_effect_can_be_given() {
    let given = || EFFECTS.iter().filter(|effect| can_be_given(effect.name()));
    let mut text = String::from("[population]\n");
    for effect in given() {
        text += &format!("{} = \"1 {}\"\n", effect.name(), effect.sheet_unit);
    }
    let truth = Scenario::parse(&text).unwrap().unit(1);
    // and the dither's own
    assert_eq!(truth.effects().len(), given().count() + 1);
    assert_eq!(truth.vector("dither-size-effect"), truth.vector("inner-lever-arm"));
}

#[test]
fn damaged_text_is_refused_and_never_a_panic() {
    for end in 0..DEFAULT_SCENARIO.len() {
        let _ = DEFAULT_SCENARIO.get(..end).map(Scenario::parse);
    }
    for value in [
        "\"\"",
        "[]",
        "{}",
        "1979-05-27",
        "\"1e999 s\"",
        "\"0 s\"",
        "true",
        "\"-1 Hz\"",
        "[[1], [2]]",
        "\"1 deg\"",
    ] {
        for line in DEFAULT_SCENARIO.lines().filter(|line| line.contains(" = ") && !line.starts_with('#')) {
            let key = line.split(" = ").next().unwrap_or_default();
            let damaged = DEFAULT_SCENARIO.replacen(line, &format!("{key} = {value}"), 1);
            if let Ok(scenario) = Scenario::parse(&damaged) {
                assert!(rig::Simulation::new(&scenario, 1).is_ok(), "{key} = {value}");
            }
        }
    }
}
