//! The motion of the unit and the table it stands on.

use super::{DAY, DEGREE};
use crate::motion::{Axis, Imperfections, Turn, Vibration};
use crate::scenario::fault::Fault;
use crate::scenario::reader::{Entry, Must, Reader, as_table};
use crate::scenario::{MotionPlan, Path};
use logs::units;

pub(super) fn motion(r: &mut Reader<'_>) -> Option<MotionPlan> {
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
    let listed = list.as_ref().map(|entry| turns(r, entry, rate, dwell));
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

fn turns<'t>(
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

pub(super) fn table(r: &mut Reader<'_>) -> Option<Imperfections> {
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
