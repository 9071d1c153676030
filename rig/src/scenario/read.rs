//! From the text of a scenario to SI units.

use sinscal::{EFFECTS, EffectInfo, Site};
use toml::de::DeTable;

use super::fault::{Fault, ScenarioError};
use super::reader::{Entry, Must, Reader, as_table};
use super::{
    DEFAULT_SCENARIO, DitherMode, DitherPlan, InitialPlan, MotionPlan, Path, Population, ReferencePlan,
    Scenario,
};
use crate::environment::{TemperaturePlan, TemperatureProfile};
use crate::motion::{Axis, Imperfections, Turn, Vibration};
use crate::noise::NoiseFigures;
use crate::{suggest, units};

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const DAY: f64 = 86_400.0;
const TEMPERATURES: Must = Must::LieWithin(-80.0, 150.0);

/// Parameters may be this many times their default prior.
const ABSURD: f64 = 1e6;

const SECTIONS: [&str; 11] = [
    "run",
    "imu",
    "site",
    "motion",
    "table",
    "reference",
    "initial",
    "gyro",
    "accelerometer",
    "temperature",
    "dither",
];

/// The scenario of the text, with the default one behind it.
pub(super) fn parse(text: &str) -> Result<Scenario, ScenarioError> {
    let not_toml = |text: &str, error: &toml::de::Error| {
        let fault = Fault::new("", format!("not valid TOML: {}", error.message()), "");
        let fault = match error.span() {
            Some(span) => fault.at(text, span),
            None => fault,
        };
        ScenarioError { faults: vec![fault] }
    };
    let user = DeTable::parse(text).map_err(|error| not_toml(text, &error))?;
    let fallback = DeTable::parse(DEFAULT_SCENARIO).map_err(|error| not_toml(DEFAULT_SCENARIO, &error))?;
    let mut reader = Reader::new(text, user.get_ref(), fallback.get_ref());
    let scenario = read(&mut reader);
    let mut faults = reader.faults;
    if let Some(scenario) = scenario.filter(|_| faults.is_empty()) {
        faults = super::check::check(&scenario);
        if faults.is_empty() {
            return Ok(scenario);
        }
        for fault in &mut faults {
            if let Some(span) = place(user.get_ref(), &fault.field) {
                *fault = fault.clone().at(text, span);
            }
        }
    }
    Err(ScenarioError { faults })
}

/// The default scenario. That it can be read is tested; the empty one of the other branch is never seen.
pub(super) fn default_scenario() -> Scenario {
    match parse("") {
        Ok(scenario) => scenario,
        Err(error) => unreachable!("the default scenario is sound: {error}"),
    }
}

/// Where a field stands in the text, or what it is nearest to.
fn place(root: &DeTable<'_>, field: &str) -> Option<std::ops::Range<usize>> {
    let mut names = field.split(['.', '[']);
    let mut value = root.get(names.next()?)?;
    for name in names {
        let inner = match name.strip_suffix(']') {
            Some(index) => value.get_ref().as_array().and_then(|list| list.get(index.parse::<usize>().ok()?)),
            None => as_table(value).and_then(|table| table.get(name)),
        };
        match inner {
            Some(inner) => value = inner,
            None => break,
        }
    }
    Some(value.span())
}

fn read(r: &mut Reader<'_>) -> Option<Scenario> {
    let known: Vec<&str> = SECTIONS.into_iter().chain(["population"]).collect();
    r.sections(&known);
    let run = r.section("run", &["number"]);
    let run = r.whole_number(&run, "number");
    let imu = r.section("imu", &["rate"]);
    let rate = r.quantity(&imu, "rate", units::FREQUENCY, Must::BePositive(1e5));
    let site = read_site(r);
    let motion = read_motion(r);
    let table = read_table(r);
    let reference = read_reference(r);
    let initial = read_initial(r);
    let gyro =
        read_noise(r, "gyro", [units::ANGLE_WALK, units::ANGULAR_RATE, units::RATE_WALK, units::ANGLE]);
    let walks = [units::VELOCITY_WALK, units::FORCE, units::FORCE_WALK, units::VELOCITY];
    let accelerometer = read_noise(r, "accelerometer", walks);
    let temperature = read_temperature(r);
    let dither = read_dither(r);
    let population = read_population(r);
    Some(Scenario {
        run: run?,
        rate: rate?,
        site: site?,
        motion: motion?,
        table: table?,
        reference: reference?,
        initial: initial?,
        gyro: gyro?,
        accelerometer: accelerometer?,
        temperature: temperature?,
        dither: dither?,
        population,
    })
}

fn read_site(r: &mut Reader<'_>) -> Option<Site> {
    let s = r.section("site", &["latitude", "longitude", "height"]);
    // the east component of the curvature needs a meridian
    let latitude = r.quantity(&s, "latitude", units::ANGLE, Must::LieWithin(-89.9 * DEGREE, 89.9 * DEGREE));
    let longitude =
        r.quantity(&s, "longitude", units::ANGLE, Must::LieWithin(-180.0 * DEGREE, 360.0 * DEGREE));
    let height = r.quantity(&s, "height", units::LENGTH, Must::LieWithin(-1000.0, 20_000.0));
    Some(Site { latitude: latitude?, longitude: longitude?, height: height? })
}

fn read_motion(r: &mut Reader<'_>) -> Option<MotionPlan> {
    const KEYS: [&str; 12] = [
        "path",
        "start",
        "still",
        "rate",
        "acceleration",
        "rounding",
        "dwell",
        "max_rate",
        "max_acceleration",
        "duration",
        "turns",
        "swing",
    ];
    const PATHS: [&str; 6] =
        ["eighteen-rotations", "nineteen-positions", "two-axis", "turns", "swing", "still"];
    let s = r.section("motion", &KEYS);
    let path = r.word(&s, "path", &PATHS);
    let start = r.entry(&s, "start").and_then(|entry| {
        let letters: Option<[u8; 3]> =
            entry.value.get_ref().as_str().and_then(|letters| letters.as_bytes().try_into().ok());
        let start = letters.and_then(|letters| sinscal::path::attitude(&letters));
        if start.is_none() {
            let accepted =
                "three of N E D S W U that are right-handed, where x, y, z point, for instance \"NED\"";
            r.refuse(&entry, "is no attitude", accepted);
        }
        start
    });
    let still = r.quantity(&s, "still", units::TIME, Must::NotBeNegative(30.0 * DAY));
    let rate = r.quantity(&s, "rate", units::ANGULAR_RATE, Must::BePositive(100.0));
    let acceleration = r.quantity(&s, "acceleration", units::ANGULAR_ACCELERATION, Must::BePositive(1e4));
    let rounding = r.quantity(&s, "rounding", units::TIME, Must::BePositive(60.0));
    let dwell = r.quantity(&s, "dwell", units::TIME, Must::NotBeNegative(30.0 * DAY));
    let max_rate = r.quantity(&s, "max_rate", units::ANGULAR_RATE, Must::BePositive(100.0));
    let max_acceleration =
        r.quantity(&s, "max_acceleration", units::ANGULAR_ACCELERATION, Must::BePositive(1e4));
    let duration = r.quantity(&s, "duration", units::TIME, Must::BePositive(30.0 * DAY));

    let swing = r.within(&s, "swing", Some(&["amplitude", "frequency", "phase"]));
    let amplitude = r.three(&swing, "amplitude", units::ANGLE, Must::NotBeNegative(180.0 * DEGREE));
    let frequency = r.three(&swing, "frequency", units::FREQUENCY, Must::NotBeNegative(1e3));
    let phase = r.three(&swing, "phase", units::ANGLE, Must::BeFinite);

    let list = r.entry(&s, "turns");
    let listed = list.as_ref().map(|entry| read_turns(r, entry, rate, dwell));
    let path = match (path.and_then(|i| PATHS.get(i).copied())?, list) {
        ("turns", Some(_)) => Path::Turns(listed??),
        ("turns", None) => {
            let accepted = "turns = [{ axis = \"y\", angle = \"90 deg\" }]";
            r.faults.push(Fault::new("motion.turns", "is missing, path = \"turns\" needs it", accepted));
            return None;
        }
        (_, Some(entry)) => {
            r.refuse(&entry, "is given, but the path is another", "turns with path = \"turns\"");
            return None;
        }
        ("nineteen-positions", None) => Path::NineteenPositions,
        ("two-axis", None) => Path::TwoAxis,
        ("swing", None) => Path::Swing { amplitude: amplitude?, frequency: frequency?, phase: phase? },
        ("still", None) => Path::Still,
        _ => Path::EighteenRotations,
    };
    Some(MotionPlan {
        path,
        start: start?,
        still: still?,
        rate: rate?,
        acceleration: acceleration?,
        rounding: rounding?,
        dwell: dwell?,
        max_rate: max_rate?,
        max_acceleration: max_acceleration?,
        duration: duration?,
    })
}

fn read_turns<'t>(
    r: &mut Reader<'t>,
    list: &Entry<'t>,
    rate: Option<f64>,
    dwell: Option<f64>,
) -> Option<Vec<Turn>> {
    let accepted = "a list of { axis, angle, rate, dwell }, rate and dwell optional";
    let Some(items) = list.value.get_ref().as_array().filter(|items| !items.is_empty()) else {
        r.refuse(list, "is no list of turns", accepted);
        return None;
    };
    let mut turns = Vec::with_capacity(items.len());
    for (i, value) in items.iter().enumerate() {
        let field = format!("{}[{i}]", list.field);
        let item = Entry { field: field.clone(), value };
        let Some(table) = as_table(value) else {
            r.refuse(&item, "is no turn", accepted);
            continue;
        };
        r.only(table, &field, &["axis", "angle", "rate", "dwell"]);
        let entry = |key: &str| table.get(key).map(|value| Entry { field: format!("{field}.{key}"), value });
        for key in ["axis", "angle"] {
            if !table.contains_key(key) {
                r.refuse(&item, &format!("lacks its {key}"), accepted);
            }
        }
        let axis =
            entry("axis").and_then(|e| r.choice(&e, &Axis::NAMES)).and_then(|i| Axis::of(Axis::NAMES[i]));
        let angle = entry("angle").and_then(|e| r.value(&e, units::ANGLE, Must::BeNonZero));
        let rate = entry("rate").map_or(rate, |e| r.value(&e, units::ANGULAR_RATE, Must::BePositive(100.0)));
        let dwell =
            entry("dwell").map_or(dwell, |e| r.value(&e, units::TIME, Must::NotBeNegative(30.0 * DAY)));
        if let (Some(axis), Some(angle), Some(rate), Some(dwell)) = (axis, angle, rate, dwell) {
            turns.push(Turn { axis, angle, rate, dwell });
        }
    }
    (turns.len() == items.len()).then_some(turns)
}

fn read_table(r: &mut Reader<'_>) -> Option<Imperfections> {
    let keys = [
        "non_orthogonality",
        "wobble",
        "encoder_noise",
        "vibration_frequency",
        "vibration_acceleration",
        "vibration_tilt",
    ];
    let s = r.section("table", &keys);
    let angle = Must::LieWithin(-0.1, 0.1);
    let non_orthogonality = r.three(&s, "non_orthogonality", units::ANGLE, angle);
    let wobble = r.three(&s, "wobble", units::ANGLE, angle);
    let encoder_noise = r.quantity(&s, "encoder_noise", units::ANGLE, Must::NotBeNegative(0.1));
    let frequency = r.three(&s, "vibration_frequency", units::FREQUENCY, Must::BePositive(1e4));
    let acceleration = r.three(&s, "vibration_acceleration", units::FORCE, Must::NotBeNegative(100.0));
    let tilt = r.three(&s, "vibration_tilt", units::ANGLE, Must::NotBeNegative(0.1));
    Some(Imperfections {
        non_orthogonality: non_orthogonality?,
        wobble: wobble?,
        encoder_noise: encoder_noise?,
        vibration: Vibration { frequency: frequency?, acceleration: acceleration?, tilt: tilt? },
    })
}

fn read_reference(r: &mut Reader<'_>) -> Option<ReferencePlan> {
    let keys = ["kind", "rate", "velocity_sigma", "position_sigma", "attitude", "attitude_sigma"];
    let s = r.section("reference", &keys);
    let kind = r.word(&s, "kind", &["readings", "fixed-point"]);
    let rate = r.quantity(&s, "rate", units::FREQUENCY, Must::BePositive(1e5));
    let velocity_sigma = r.quantity(&s, "velocity_sigma", units::VELOCITY, Must::NotBeNegative(100.0));
    let position_sigma = r.quantity(&s, "position_sigma", units::LENGTH, Must::NotBeNegative(1000.0));
    let attitude = r.switch(&s, "attitude");
    let attitude_sigma = r.quantity(&s, "attitude_sigma", units::ANGLE, Must::NotBeNegative(1.0));
    Some(ReferencePlan {
        readings: kind? == 0,
        rate: rate?,
        velocity_sigma: velocity_sigma?,
        position_sigma: position_sigma?,
        attitude: attitude?,
        attitude_sigma: attitude_sigma?,
    })
}

fn read_initial(r: &mut Reader<'_>) -> Option<InitialPlan> {
    let s = r.section("initial", &["level_sigma", "heading_sigma", "outer_lever"]);
    let level_sigma = r.quantity(&s, "level_sigma", units::ANGLE, Must::NotBeNegative(0.2));
    let heading_sigma = r.quantity(&s, "heading_sigma", units::ANGLE, Must::NotBeNegative(0.2));
    let outer_lever = r.three(&s, "outer_lever", units::LENGTH, Must::LieWithin(-100.0, 100.0));
    Some(InitialPlan { level_sigma: level_sigma?, heading_sigma: heading_sigma?, outer_lever: outer_lever? })
}

fn read_noise(r: &mut Reader<'_>, name: &str, of: [units::Units; 4]) -> Option<NoiseFigures> {
    let keys = ["random_walk", "bias_instability", "bias_correlation", "bias_random_walk", "quantum"];
    let s = r.section(name, &keys);
    let most = Must::NotBeNegative(10.0);
    let white = r.quantity(&s, "random_walk", of[0], most);
    let instability = r.quantity(&s, "bias_instability", of[1], most);
    let correlation = r.quantity(&s, "bias_correlation", units::TIME, Must::BePositive(365.0 * DAY));
    let walk = r.quantity(&s, "bias_random_walk", of[2], most);
    let quantum = r.quantity(&s, "quantum", of[3], most);
    Some(NoiseFigures {
        white: white?,
        instability: instability?,
        correlation: correlation?,
        walk: walk?,
        quantum: quantum?,
    })
}

fn read_temperature(r: &mut Reader<'_>) -> Option<TemperaturePlan> {
    let keys = [
        "reference",
        "profile",
        "start",
        "rise",
        "time_constant",
        "points",
        "accelerometer_offset",
        "gyro_offset",
        "sensor_lag",
        "thermometer_lag",
        "thermometer_noise",
        "rate",
    ];
    let s = r.section("temperature", &keys);
    let reference = r.quantity(&s, "reference", units::TEMPERATURE, TEMPERATURES);
    let profile = r.word(&s, "profile", &["constant", "warm-up", "ramps"]);
    let start = r.quantity(&s, "start", units::TEMPERATURE, TEMPERATURES);
    let rise = r.quantity(&s, "rise", units::DIFFERENCE, Must::LieWithin(-100.0, 100.0));
    let time_constant = r.quantity(&s, "time_constant", units::TIME, Must::BePositive(30.0 * DAY));
    let points = r.entry(&s, "points").map(|entry| read_points(r, &entry));
    let offset = Must::LieWithin(-50.0, 50.0);
    let accelerometer_offset = r.three(&s, "accelerometer_offset", units::DIFFERENCE, offset);
    let gyro_offset = r.three(&s, "gyro_offset", units::DIFFERENCE, offset);
    let lag = Must::NotBeNegative(DAY);
    let sensor_lag = r.quantity(&s, "sensor_lag", units::TIME, lag);
    let thermometer_lag = r.quantity(&s, "thermometer_lag", units::TIME, lag);
    let thermometer_noise = r.quantity(&s, "thermometer_noise", units::DIFFERENCE, Must::NotBeNegative(50.0));
    let rate = r.quantity(&s, "rate", units::FREQUENCY, Must::BePositive(1e5));
    let profile = match (profile?, points) {
        (0, _) => TemperatureProfile::Constant(start?),
        (1, _) => TemperatureProfile::WarmUp { start: start?, rise: rise?, time_constant: time_constant? },
        (_, Some(points)) => TemperatureProfile::Ramps(points?),
        (_, None) => {
            let accepted = "points = [[\"0 s\", \"20 degC\"], [\"1800 s\", \"45 degC\"]]";
            r.faults.push(Fault::new(
                "temperature.points",
                "is missing, profile = \"ramps\" needs it",
                accepted,
            ));
            return None;
        }
    };
    Some(TemperaturePlan {
        reference: reference?,
        profile,
        accelerometer_offset: accelerometer_offset?,
        gyro_offset: gyro_offset?,
        sensor_lag: sensor_lag?,
        thermometer_lag: thermometer_lag?,
        thermometer_noise: thermometer_noise?,
        rate: rate?,
    })
}

fn read_points<'t>(r: &mut Reader<'t>, list: &Entry<'t>) -> Option<Vec<(f64, f64)>> {
    let accepted = "a list of [time, temperature] with increasing times";
    let items = list.value.get_ref().as_array().filter(|items| !items.is_empty());
    let Some(items) = items else {
        r.refuse(list, "is no list of points", accepted);
        return None;
    };
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(items.len());
    for (i, value) in items.iter().enumerate() {
        let item = Entry { field: format!("{}[{i}]", list.field), value };
        let pair: Option<Vec<_>> = value.get_ref().as_array().map(|pair| pair.iter().collect());
        let Some(&[time, temperature]) = pair.as_deref() else {
            r.refuse(&item, "is no pair of time and temperature", accepted);
            continue;
        };
        let field = item.field.clone();
        let time = Entry { field: field.clone(), value: time };
        let temperature = Entry { field, value: temperature };
        let time = r.value(&time, units::TIME, Must::LieWithin(-30.0 * DAY, 30.0 * DAY));
        let temperature = r.value(&temperature, units::TEMPERATURE, TEMPERATURES);
        if let (Some(time), Some(temperature)) = (time, temperature) {
            if points.last().is_some_and(|(before, _)| *before >= time) {
                r.refuse(&item, "is not later than the point before it", accepted);
            }
            points.push((time, temperature));
        }
    }
    (points.len() == items.len()).then_some(points)
}

fn read_dither(r: &mut Reader<'_>) -> Option<DitherPlan> {
    let keys = [
        "mode",
        "amplitude",
        "spread",
        "change",
        "period",
        "reading_noise",
        "rate",
        "frequency",
        "modulation",
        "frequency_noise",
        "simulation_rate",
    ];
    let s = r.section("dither", &keys);
    let mode = r.word(&s, "mode", &["off", "mean", "full"]);
    let amplitude = r.three(&s, "amplitude", units::ANGULAR_RATE, Must::NotBeNegative(4.0));
    let share = Must::NotBeNegative(0.9);
    let spread = r.quantity(&s, "spread", units::RATIO, share);
    let change = r.quantity(&s, "change", units::RATIO, share);
    let period = r.quantity(&s, "period", units::TIME, Must::BePositive(30.0 * DAY));
    let reading_noise = r.quantity(&s, "reading_noise", units::ANGULAR_RATE, Must::NotBeNegative(1.0));
    let rate = r.quantity(&s, "rate", units::FREQUENCY, Must::BePositive(1e5));
    let frequency = r.three(&s, "frequency", units::FREQUENCY, Must::BePositive(1e5));
    let modulation = r.quantity(&s, "modulation", units::RATIO, share);
    let frequency_noise = r.quantity(&s, "frequency_noise", units::FREQUENCY, Must::NotBeNegative(100.0));
    let simulation_rate = r.quantity(&s, "simulation_rate", units::FREQUENCY, Must::BePositive(1e6));
    let mode = match mode? {
        0 => DitherMode::Off,
        1 => DitherMode::Mean,
        _ => DitherMode::Full,
    };
    Some(DitherPlan {
        mode,
        amplitude: amplitude?,
        spread: spread?,
        change: change?,
        period: period?,
        reading_noise: reading_noise?,
        rate: rate?,
        frequency: frequency?,
        modulation: modulation?,
        frequency_noise: frequency_noise?,
        simulation_rate: simulation_rate?,
    })
}

fn read_population(r: &mut Reader<'_>) -> Vec<Population> {
    let mut populations = Vec::new();
    for (name, entry) in r.whole("population") {
        let Some(effect) = sinscal::effect(name) else {
            r.refuse(
                &entry,
                "is not an effect",
                suggest::accepted(name, EFFECTS.iter().map(EffectInfo::name)),
            );
            continue;
        };
        if name == "dither-size-effect" {
            let accepted = "[dither] mode = \"mean\" or \"full\" and a population of inner-lever-arm";
            r.refuse(&entry, "follows from the dither and the inner lever arms", accepted);
            continue;
        }
        let units = units::of_parameters(effect.unit());
        let n = effect.components().len();
        // beyond this nothing of the signal is left
        let most = ABSURD * effect.prior_sigma;
        let (mean, sigma) = match as_table(entry.value) {
            None => (Some(vec![0.0; n]), r.list(&entry, n, units, Must::NotBeNegative(most))),
            Some(table) => {
                r.only(table, &entry.field, &["mean", "sigma"]);
                let part = |key: &str| {
                    table.get(key).map(|value| Entry { field: format!("{}.{key}", entry.field), value })
                };
                let zero = || Some(vec![0.0; n]);
                let mean = part("mean")
                    .map_or_else(zero, |part| r.list(&part, n, units, Must::LieWithin(-most, most)));
                let sigma = part("sigma")
                    .map_or_else(zero, |part| r.list(&part, n, units, Must::NotBeNegative(most)));
                (mean, sigma)
            }
        };
        if let (Some(mean), Some(sigma)) = (mean, sigma) {
            populations.push(Population { effect, mean, sigma });
        }
    }
    // in the order of the catalogue, whatever the order in the file
    populations.sort_by_key(|population| {
        EFFECTS.iter().position(|effect| effect.name() == population.effect.name())
    });
    populations
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn default_scenario_is_sound() {
        let scenario = default_scenario();
        assert_eq!(scenario.rate, 50.0);
        assert_eq!(scenario.samples(), 188_250);
        assert_eq!(scenario, parse(DEFAULT_SCENARIO).unwrap());
        assert_eq!(scenario.motion.turns().map(|turns| turns.len()), Some(18));
        assert_eq!(scenario.dither.amplitude, Vector3::repeat(0.08));
    }
}
