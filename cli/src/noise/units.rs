//! What the processes of gyros and accelerometers are called and measured in, and the description that states them.

use std::fmt::Write;

use super::json::Read;
use ::noise::{Identified, Kind, Process, typical};
use logs::units::{DEG_PER_SQRT_HOUR, DEGREE, MICRO_G};

/// Seconds of an hour.
const HOUR: f64 = 3600.0;

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sensor {
    /// Angular rates, rad/s.
    Gyro,
    /// Specific forces, m/s^2.
    Accel,
}

/// A kind of process for one sensor.
pub(crate) struct Naming {
    /// In JSON.
    pub(crate) kind: &'static str,
    /// For people.
    pub(crate) title: &'static str,
    /// SI.
    pub(crate) unit: &'static str,
    /// That of data sheets, and what it is in SI.
    pub(crate) sheet: (&'static str, f64),
}

impl Sensor {
    pub(crate) const BOTH: [Self; 2] = [Self::Gyro, Self::Accel];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Gyro => "gyro",
            Self::Accel => "accel",
        }
    }

    /// Of a reading: its SI unit, and that of data sheets with its size.
    pub(crate) fn reading(self) -> (&'static str, (&'static str, f64)) {
        match self {
            Self::Gyro => ("rad/s", ("deg/h", DEGREE / HOUR)),
            Self::Accel => ("m/s^2", ("ug", MICRO_G)),
        }
    }

    pub(crate) fn naming(self, kind: Kind) -> Naming {
        let (kind, title) = match (kind, self) {
            (Kind::Quantisation, _) => ("quantisation", "quantisation"),
            (Kind::White, Self::Gyro) => ("white", "angle random walk (white noise)"),
            (Kind::White, Self::Accel) => ("white", "velocity random walk (white noise)"),
            (kind @ Kind::GaussMarkov { .. }, _) if kind.is_fast() => {
                ("gauss-markov", "filtered white noise (Gauss-Markov)")
            }
            (Kind::GaussMarkov { .. }, _) => ("gauss-markov", "bias wander (Gauss-Markov)"),
            (Kind::RandomWalk, Self::Gyro) => ("random-walk", "rate random walk"),
            (Kind::RandomWalk, Self::Accel) => ("random-walk", "acceleration random walk"),
            (Kind::Ramp, _) => ("ramp", "ramp"),
        };
        let (unit, sheet) = match (kind, self) {
            ("quantisation", Self::Gyro) => ("rad", ("arcsec", DEGREE / HOUR)),
            ("quantisation", Self::Accel) => ("m/s", ("mm/s", 1e-3)),
            ("white", Self::Gyro) => ("rad/sqrt(s)", ("deg/sqrt(h)", DEG_PER_SQRT_HOUR)),
            ("white", Self::Accel) => ("m/s/sqrt(s)", ("ug/sqrt(Hz)", MICRO_G)),
            ("random-walk", Self::Gyro) => ("rad/s/sqrt(s)", ("deg/h/sqrt(h)", DEGREE / HOUR / HOUR.sqrt())),
            ("random-walk", Self::Accel) => ("m/s^2/sqrt(s)", ("ug/sqrt(h)", MICRO_G / HOUR.sqrt())),
            ("ramp", Self::Gyro) => ("rad/s^2", ("deg/h/h", DEGREE / HOUR / HOUR)),
            ("ramp", Self::Accel) => ("m/s^3", ("ug/h", MICRO_G / HOUR)),
            _ => self.reading(),
        };
        Naming { kind, title, unit, sheet }
    }

    /// The kind of a name in JSON; that of Gauss and Markov with its time, s.
    pub(crate) fn kind(name: &str, time: f64) -> Option<Kind> {
        Some(match name {
            "quantisation" => Kind::Quantisation,
            "white" => Kind::White,
            "gauss-markov" => Kind::GaussMarkov { time },
            "random-walk" => Kind::RandomWalk,
            "ramp" => Kind::Ramp,
            _ => return None,
        })
    }
}

/// The table `[noise]` of a description, for all axes together.
pub(crate) fn stated(sensors: &[(Sensor, &[Identified])], source: &str) -> String {
    let mut text = format!(
        "# Noise of {}, measured by `sinscal noise`: the root of the mean square over three axes.\n\
         # `--noise FILE` reads it wherever a log is filtered; the table may also stand in a description.\n[noise]\n",
        source.replace(['\n', '\r'], " ")
    );
    for (sensor, axes) in sensors {
        let processes: Vec<Vec<Process>> = axes.iter().map(Identified::processes).collect();
        let found = typical(&processes);
        let of = |kind: &str| found.iter().find(|process| sensor.naming(process.kind).kind == kind);
        let sheet = |process: &Process| process.size / sensor.naming(process.kind).sheet.1;
        let fields = match sensor {
            Sensor::Gyro => [
                "gyro_arw_deg_sqrt_h",
                "gyro_bias_random_walk_deg_h_sqrt_h",
                "gyro_bias_instability_deg_h",
                "gyro_bias_correlation_s",
            ],
            Sensor::Accel => [
                "accel_vrw_ug_sqrt_hz",
                "accel_bias_random_walk_ug_sqrt_h",
                "accel_bias_instability_ug",
                "accel_bias_correlation_s",
            ],
        };
        let mut line = |field: &str, value: f64| {
            // writing to a string does not fail
            let _ = writeln!(text, "{field} = {value:.6e}");
        };
        line(
            fields[0],
            of("white").map_or_else(|| ::noise::most_white(axes), |white| white.size)
                / sensor.naming(Kind::White).sheet.1,
        );
        if let Some(walk) = of("random-walk") {
            line(fields[1], sheet(walk));
        }
        if let Some((markov, time)) =
            of("gauss-markov").and_then(|markov| Some((markov, markov.kind.time()?)))
        {
            line(fields[2], sheet(markov));
            line(fields[3], time);
        }
    }
    text
}

/// Kalibr's description of an IMU: one density and one random walk for all axes of a sensor.
pub(crate) fn kalibr((rate, sensors): &Read) -> String {
    let mut text = String::from(
        "# Kalibr's imu.yaml by `sinscal export`: continuous-time densities, the root of the mean square over three axes.\n\
         # The random walk is that of the bias, or what its Gauss-Markov process walks like at first. Kalibr's authors advise to multiply\n\
         # these figures by up to ten where a unit is moved, since vibration and scale errors look like noise to it.\n\
         rostopic: /imu0\n",
    );
    for (name, axes) in [("accelerometer", &sensors[1]), ("gyroscope", &sensors[0])] {
        let found = typical(axes);
        let white = found.iter().find(|process| process.kind == Kind::White);
        // independent walks add up by their squares
        let walks = found.iter().filter_map(Process::as_walk).map(|walk| walk.size);
        let unit = if name == "gyroscope" { "rad/s" } else { "m/s^2" };
        let (density, walk) = (white.map_or(0.0, |white| white.size), walks.fold(0.0, f64::hypot));
        // writing to a string does not fail
        let _ = writeln!(text, "{name}_noise_density: {density:e}  # {unit}/sqrt(Hz)");
        let none = if walk > 0.0 { "" } else { "; none was found" };
        let _ = writeln!(text, "{name}_random_walk: {walk:e}  # {unit}/s/sqrt(Hz){none}");
    }
    let _ = writeln!(text, "update_rate: {}", (rate * 1e6).round() / 1e6);
    text
}
