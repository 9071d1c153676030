//! What the unit stands in and shakes with: temperature and dither.

use super::DAY;
use crate::environment::{TemperaturePlan, TemperatureProfile};
use crate::scenario::fault::Fault;
use crate::scenario::reader::{Entry, Must, Reader};
use crate::scenario::{DitherMode, DitherPlan};
use logs::units;

const TEMPERATURES: Must = Must::LieWithin(-80.0, 150.0);

pub(super) fn temperature(r: &mut Reader<'_>) -> Option<TemperaturePlan> {
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
    let points = r.entry(&s, "points").map(|entry| points(r, &entry));
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

fn points<'t>(r: &mut Reader<'t>, list: &Entry<'t>) -> Option<Vec<(f64, f64)>> {
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

pub(super) fn dither(r: &mut Reader<'_>) -> Option<DitherPlan> {
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
