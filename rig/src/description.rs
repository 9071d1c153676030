//! The description that goes beside a log.

use std::fmt::Write;

use nalgebra::Vector3;
use sinscal::{InitialAttitude, ReferenceSigma, SensorNoise, Setup, Site};

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
    /// Random walks of the sensors.
    pub noise: SensorNoise,
    /// Where temperature effects vanish, degC.
    pub reference_temperature: f64,
    /// First guess of the outer lever arm, m.
    pub outer_lever: Vector3<f64>,
    /// A line about the log.
    pub title: String,
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

    /// What a calibration of the log needs; the reference is used at most `update_rate` times a second.
    pub fn setup<'a>(&self, update_rate: f64, priors: &'a [(&'a str, f64)]) -> Setup<'a> {
        Setup {
            rate: self.rate,
            site: self.site,
            initial: self.initial,
            reference: self.reference,
            update_rate,
            noise: self.noise,
            reference_temperature: self.reference_temperature,
            outer_lever: self.outer_lever,
            priors,
        }
    }

    /// The content of `NAME.toml`.
    pub fn to_toml(&self) -> String {
        let degrees = f64::to_degrees;
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
        line(format!("gyro_arw_deg_sqrt_h = {:?}", degrees(self.noise.angle_random_walk) * 60.0));
        line(format!("accel_vrw_ug_sqrt_hz = {:?}", self.noise.velocity_random_walk / micro_g));
        line("[temperature]".into());
        line(format!("reference_c = {:?}", self.reference_temperature));
        line("[outer_lever]".into());
        let l = self.outer_lever;
        line(format!("xyz_m = [{:?}, {:?}, {:?}]", l.x, l.y, l.z));
        text
    }
}
