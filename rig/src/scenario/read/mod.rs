//! From the text of a scenario to SI units.

mod motion;
mod population;
mod surroundings;

use sinscal::{AnyEffect, Site};
use toml::de::DeTable;

use super::fault::{Fault, ScenarioError, told};
use super::reader::{Must, Reader, as_table};
use super::{DEFAULT_SCENARIO, InitialPlan, ReferencePlan, Scenario};
use crate::noise::NoiseFigures;
use logs::units;

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const DAY: f64 = 86_400.0;

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
pub(super) fn parse(text: &str, own: &[&'static dyn AnyEffect]) -> Result<Scenario, ScenarioError> {
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
    let scenario = read(&mut reader, own);
    let mut faults = told(reader.faults);
    if let Some(scenario) = scenario.filter(|_| faults.is_empty()) {
        faults = told(super::check::check(&scenario));
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
    match parse("", &[]) {
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

fn read(r: &mut Reader<'_>, own: &[&'static dyn AnyEffect]) -> Option<Scenario> {
    let known: Vec<&str> = SECTIONS.into_iter().chain(["population"]).collect();
    r.sections(&known);
    let run = r.section("run", &["number"]);
    let run = r.whole_number(&run, "number");
    let imu = r.section("imu", &["rate"]);
    let rate = r.quantity(&imu, "rate", units::FREQUENCY, Must::BePositive(1e5));
    let site = read_site(r);
    let motion = motion::motion(r);
    let table = motion::table(r);
    let reference = read_reference(r);
    let initial = read_initial(r);
    let gyro =
        read_noise(r, "gyro", [units::ANGLE_WALK, units::ANGULAR_RATE, units::RATE_WALK, units::ANGLE]);
    let walks = [units::VELOCITY_WALK, units::FORCE, units::FORCE_WALK, units::VELOCITY];
    let accelerometer = read_noise(r, "accelerometer", walks);
    let temperature = surroundings::temperature(r);
    let dither = surroundings::dither(r);
    let population = population::population(r, own);
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

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn default_scenario_is_sound() {
        let scenario = default_scenario();
        assert_eq!(scenario.rate, 50.0);
        assert_eq!(scenario.samples(), 188_250);
        assert_eq!(scenario, parse(DEFAULT_SCENARIO, &[]).unwrap());
        assert_eq!(scenario.motion.turns().map(|turns| turns.len()), Some(18));
        assert_eq!(scenario.dither.amplitude, Vector3::repeat(0.08));
    }
}
