//! The description that goes beside a log.

use std::fmt::Write;

use nalgebra::Vector3;
use sinscal::{BiasWander, InitialAttitude, ReferenceSigma, SensorNoise, Setup, Site};

/// Noise figures must be positive for a filter to work: what is noiseless is described by these.
const LEAST: ReferenceSigma = ReferenceSigma { velocity: 1e-6, position: 1e-6, attitude: 1e-7 };
const LEAST_ANGLE_WALK: f64 = 1e-10;
const LEAST_VELOCITY_WALK: f64 = 1e-8;
const LEAST_SIGMA: f64 = 1e-8;

/// What is said about a simulated log: `NAME.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Sampling rate, Hz.
    pub rate: f64,
    /// Where the table stands.
    pub site: Site,
    /// What is known of the attitude at the first row.
    pub initial: InitialAttitude,
    /// Standard deviations of one reading of the reference.
    pub reference: ReferenceSigma,
    /// Whether the log has columns of the reference.
    pub readings: bool,
    /// Whether it has the attitude.
    pub attitude: bool,
    /// Whether it has the amplitudes of the dither.
    pub dither: bool,
    /// How often the reference may be used, Hz: as often as it is read, or once a second where it is a fixed point.
    pub update_rate: f64,
    /// Random walks of the sensors.
    pub noise: SensorNoise,
    /// How their biases wander.
    pub wander: BiasWander,
    /// Where temperature effects vanish, degC.
    pub reference_temperature: f64,
    /// First guess of the outer lever arm, m.
    pub outer_lever: Vector3<f64>,
    /// A line about the log; begins with [`MARK`](Self::MARK).
    pub title: String,
}

impl Description {
    /// How the titles of simulated logs begin, and nobody else's.
    pub const MARK: &str = "Simulated: ";
}

impl Description {
    pub(crate) fn sound(mut self) -> Self {
        self.initial.level_sigma = self.initial.level_sigma.max(LEAST_SIGMA);
        self.initial.heading_sigma = self.initial.heading_sigma.max(LEAST_SIGMA);
        self.reference.velocity = self.reference.velocity.max(LEAST.velocity);
        self.reference.position = self.reference.position.max(LEAST.position);
        self.reference.attitude = self.reference.attitude.max(LEAST.attitude);
        self.noise.angle_random_walk = self.noise.angle_random_walk.max(LEAST_ANGLE_WALK);
        self.noise.velocity_random_walk = self.noise.velocity_random_walk.max(LEAST_VELOCITY_WALK);
        self
    }

    /// What a calibration of the log needs, with standard deviations that replace the priors of blocks.
    pub fn setup<'a>(&self, priors: &'a [(&'a str, f64)]) -> Setup<'a> {
        Setup {
            update_rate: self.update_rate,
            reference_temperature: self.reference_temperature,
            outer_lever: self.outer_lever,
            priors,
            wander: self.wander,
            ..Setup::new(self.rate, self.site, self.initial, self.reference, self.noise)
        }
    }

    /// The content of `NAME.toml`.
    pub fn to_toml(&self) -> String {
        // what was written as 118.8 deg is to read so again
        let tidy = |x: f64| format!("{x:.11e}").parse().unwrap_or(x);
        let degrees = |x: f64| tidy(x.to_degrees());
        let q = self.initial.attitude.quaternion();
        let micro_g = 9.80665e-6;
        let mut text = String::new();
        let mut line = |line: String| {
            // writing to a string cannot fail
            let _ = writeln!(text, "{line}");
        };
        line(format!("# {}", self.title.replace(['\n', '\r'], " ")));
        line("[imu]".into());
        line(format!("rate_hz = {:?}", self.rate));
        line("[site]".into());
        line(format!("latitude_deg = {:?}", degrees(self.site.latitude)));
        line(format!("longitude_deg = {:?}", degrees(self.site.longitude)));
        line(format!("height_m = {:?}", self.site.height));
        line("[initial]".into());
        line(format!("quaternion_wxyz = [{:?}, {:?}, {:?}, {:?}]", q.w, q.i, q.j, q.k));
        line(format!("level_sigma_deg = {:?}", degrees(self.initial.level_sigma)));
        line(format!("heading_sigma_deg = {:?}", degrees(self.initial.heading_sigma)));
        line("[reference]".into());
        line(format!("velocity_sigma_m_s = {:?}", self.reference.velocity));
        line(format!("position_sigma_m = {:?}", self.reference.position));
        if self.attitude {
            line(format!("attitude_sigma_deg = {:?}", degrees(self.reference.attitude)));
        }
        line("[noise]".into());
        line(format!("gyro_arw_deg_sqrt_h = {:?}", tidy(self.noise.angle_random_walk.to_degrees() * 60.0)));
        line(format!("accel_vrw_ug_sqrt_hz = {:?}", tidy(self.noise.velocity_random_walk / micro_g)));
        let of = |figure: f64, unit: f64| tidy(figure / unit);
        let rate = 1.0_f64.to_radians() / 3600.0;
        for (sensor, [walk, instability], unit) in
            [("gyro", ["deg_h_sqrt_h", "deg_h"], rate), ("accel", ["ug_sqrt_h", "ug"], micro_g)]
        {
            let i = usize::from(sensor == "accel");
            if let Some(figure) = self.wander.random_walk[i] {
                line(format!("{sensor}_bias_random_walk_{walk} = {:?}", of(figure, unit / 60.0)));
            }
            if let Some((sigma, time)) = self.wander.gauss_markov[i] {
                line(format!("{sensor}_bias_instability_{instability} = {:?}", of(sigma, unit)));
                line(format!("{sensor}_bias_correlation_s = {time:?}"));
            }
        }
        line("[temperature]".into());
        line(format!("reference_c = {:?}", self.reference_temperature));
        line("[outer_lever]".into());
        let l = self.outer_lever;
        line(format!("xyz_m = [{:?}, {:?}, {:?}]", l.x, l.y, l.z));
        text
    }
}

#[cfg(test)]
mod tests {
    use toml::de::DeTable;

    use crate::{Scenario, Simulation};

    #[test]
    fn text_is_toml_with_the_fields_of_the_log_format() {
        let scenario =
            Scenario::parse("[reference]\nattitude = true\n[gyro]\nrandom_walk = \"0 rad/sqrt(s)\"").unwrap();
        let simulation = Simulation::new(&scenario, 3).unwrap();
        let text = simulation.description().to_toml();
        let root = DeTable::parse(&text).unwrap();
        let number = |section: &str, key: &str| {
            let table = root.get_ref().get(section).and_then(|value| value.get_ref().as_table());
            let value = table.and_then(|table| table.get(key)).map(|value| value.get_ref().clone());
            value.and_then(|value| value.as_float()?.as_str().parse::<f64>().ok()).unwrap_or(f64::NAN)
        };
        let close = |a: f64, b: f64| (a - b).abs() < 1e-11 * b.abs();
        assert!(close(number("imu", "rate_hz"), 50.0), "{text}");
        assert!(close(number("site", "latitude_deg"), 32.06));
        assert!(close(number("initial", "level_sigma_deg"), 0.03));
        assert!(close(number("reference", "velocity_sigma_m_s"), 1e-3));
        assert!(close(number("reference", "attitude_sigma_deg"), 0.01));
        assert!(close(number("noise", "accel_vrw_ug_sqrt_hz"), 5.0));
        assert!(text.contains("latitude_deg = 32.06\nlongitude_deg = 118.8\n"), "{text}");
        // no noise is described by very little
        let walk = number("noise", "gyro_arw_deg_sqrt_h");
        assert!(walk > 0.0 && walk < 1e-6);
        assert!(close(number("temperature", "reference_c"), 25.0));
        assert!(text.contains("quaternion_wxyz = [") && text.contains("xyz_m = [0.0, 0.0, 0.0]"));
    }

    #[test]
    fn initial_attitude_errs_by_its_sigmas() {
        let scenario = Scenario::parse("[motion]\npath = \"still\"").unwrap();
        let (mut level, mut heading) = (0.0, 0.0);
        let n = 400;
        for seed in 0..n {
            let simulation = Simulation::new(&scenario, seed).unwrap();
            let initial = simulation.description().initial;
            // C_hat = (I - [phi x]) C
            let phi = -(initial.attitude * simulation.motion(0.0).0.attitude().inverse()).scaled_axis();
            level += (phi.x * phi.x + phi.y * phi.y) / (2.0 * initial.level_sigma.powi(2));
            heading += (phi.z / initial.heading_sigma).powi(2);
        }
        let n = n as f64;
        assert!((level / n - 1.0).abs() < 0.25 && (heading / n - 1.0).abs() < 0.35, "{level} {heading}");
    }
}
