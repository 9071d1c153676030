//! A look as text for people.

use std::fmt::{self, Display, Formatter};

use nalgebra::Vector3;

use super::{Look, Rest};
use crate::units::DEGREE;

/// So many rests are listed.
const LISTED: usize = 40;

/// Three numbers side by side.
struct Triple([f64; 3], usize);

impl Display for Triple {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        let decimals = self.1;
        write!(f, "{x:>11.decimals$} {y:>11.decimals$} {z:>11.decimals$}")
    }
}

/// What rests read along the vertical.
struct Upright {
    /// Mean, least and most, m/s^2.
    gravity: [f64; 3],
    /// rad/s.
    rate: f64,
}

impl Upright {
    fn of(rests: &[Rest]) -> Option<Self> {
        let forces = || rests.iter().map(|rest| Vector3::from(rest.force));
        let count = rests.len() as f64;
        let rates = rests
            .iter()
            .zip(forces())
            .filter_map(|(rest, force)| Some(Vector3::from(rest.rate).dot(&force.try_normalize(1e-6)?)));
        let norms = || forces().map(|force| force.norm());
        let gravity = [
            norms().sum::<f64>() / count,
            norms().fold(f64::INFINITY, f64::min),
            norms().fold(0.0, f64::max),
        ];
        (!rests.is_empty()).then(|| Self { gravity, rate: rates.sum::<f64>() / count })
    }
}

impl Display for Look {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} rows, {:.3} s, {:.4} Hz, the steps scatter by {:.1e} s",
            self.samples, self.duration_s, self.rate_hz, self.jitter_s
        )?;
        for note in &self.read {
            writeln!(f, "  {note}")?;
        }
        if let Some([low, high]) = self.temperature_c {
            writeln!(f, "temperature {low:.1} to {high:.1} degC")?;
        }
        let still: f64 = self.rests.iter().map(|rest| rest.end_s - rest.start_s).sum();
        match self.rests.len() {
            0 => writeln!(f, "no rests")?,
            count => writeln!(f, "{count} rest{}, {still:.1} s in all:", if count == 1 { "" } else { "s" })?,
        }
        for rest in self.rests.iter().take(LISTED) {
            let (rows, force) =
                (format!("rows {} to {}", rest.first_row, rest.last_row), Triple(rest.force, 4));
            writeln!(f, "  {:>10.2} s to {:>10.2} s  {rows:24} {force} m/s^2", rest.start_s, rest.end_s)?;
        }
        if self.rests.len() > LISTED {
            writeln!(f, "  and {} more", self.rests.len() - LISTED)?;
        }
        let over = if self.rests.is_empty() { "over all" } else { "in the rests" };
        writeln!(f, "{:34} {:>11} {:>11} {:>11}", format!("mean {over}"), "x", "y", "z")?;
        let rate = self.mean_rate_rad_s.map(|rate| rate / DEGREE);
        writeln!(f, "{:34} {} deg/s", "  rate", Triple(rate, 5))?;
        writeln!(f, "{:34} {} deg/h", "", Triple(rate.map(|rate| rate * 3600.0), 2))?;
        writeln!(f, "{:34} {} m/s^2", "  specific force", Triple(self.mean_force_m_s2, 5))?;
        if let Some(Upright { gravity: [mean, low, high], rate }) = Upright::of(&self.rests) {
            writeln!(f, "{:34} {mean:>11.5} m/s^2, from {low:.5} to {high:.5}", "gravity in the rests")?;
            writeln!(
                f,
                "{:34} {:>11.2} deg/h; the Earth's is 15.04 sin(latitude), the rest is bias",
                "rate about the vertical there",
                rate / DEGREE * 3600.0
            )?;
        }
        if let Some(noise) = &self.noise {
            writeln!(f, "noise in the rests")?;
            writeln!(f, "{:34} {} deg/sqrt(h)", "  angle random walk", Triple(noise.gyro_arw_deg_sqrt_h, 5))?;
            writeln!(
                f,
                "{:34} {} ug/sqrt(Hz)",
                "  velocity random walk",
                Triple(noise.accel_vrw_ug_sqrt_hz, 2)
            )?;
        }
        if let Some(axes) = &self.likely_axes {
            writeln!(f, "likely axes: --axes {axes} (specific force points against z at rest)")?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        write!(f, "\nsuggested description (--write-description FILE):\n{}", self.description)
    }
}
