//! What a calibration holds: the checked values, with their sigmas and where they come from.

use std::path::Path;

use miette::{Result, miette};
use serde_json::Value;
use sinscal::EffectInfo;

use crate::navigate;
use crate::origin;
use crate::vocabulary::vocabulary;

/// A calibration to be written in another form.
pub(super) struct Calibration {
    pub(super) filter: String,
    /// Lines on where it comes from.
    pub(super) source: Vec<String>,
    /// Temperature at which the temperature effects vanish, degC, where the calibration says so.
    pub(super) reference_temperature: Option<f64>,
    /// Whether dither acts on the accelerometers in this filter.
    pub(super) dither: bool,
    /// Sizes of pulses that the coarse stage found: name, unit, x y z.
    pub(super) pulses: Vec<(&'static str, &'static str, [f64; 3])>,
    /// Effects of which something was estimated.
    pub(super) effects: Vec<(&'static EffectInfo, Vec<Estimate>)>,
}

/// One estimated parameter, SI.
pub(super) struct Estimate {
    pub(super) component: String,
    pub(super) value: f64,
    pub(super) sigma: f64,
}

impl Calibration {
    /// The estimate of one parameter.
    pub(super) fn value(&self, effect: &str, component: &str) -> Option<f64> {
        let (_, estimates) = self.effects.iter().find(|(info, _)| info.name() == effect)?;
        estimates.iter().find(|estimate| estimate.component == component).map(|estimate| estimate.value)
    }
}

/// Reads and checks the calibration in `path`.
pub(super) fn read(path: &Path) -> Result<Calibration> {
    let at = path.display();
    let (calibrated, document) = navigate::read::read(path)?;
    let mut effects: Vec<(&'static EffectInfo, Vec<Estimate>)> = Vec::new();
    for (index, (name, component, value)) in calibrated.values.into_iter().enumerate() {
        let Some(value) = value else { continue };
        let sigma = navigate::read::sigma(path, &document, index)?;
        let Ok(effect) = vocabulary().effect(&name) else {
            return Err(miette!(
                help = "register it with the program: `.effect::<...>()`",
                "{at}: `{name}` has no equation that could be written: it is a block of this program, and no effect"
            ));
        };
        let effect = effect.info();
        let estimate = Estimate { component, value, sigma };
        match effects.iter_mut().find(|(info, _)| info.name() == name) {
            Some((_, estimates)) => estimates.push(estimate),
            None => effects.push((effect, vec![estimate])),
        }
    }
    if effects.is_empty() {
        return Err(miette!("{at}: nothing was estimated, so there is nothing to write"));
    }
    Ok(Calibration {
        filter: calibrated.filter.title(),
        source: source(path, &calibrated.filter.title(), &document)?,
        reference_temperature: calibrated.reference_temperature,
        dither: calibrated.filter.needs_dither(),
        pulses: [("gyro-pulse", "rad", "gyro_rad_per_pulse"), ("accel-pulse", "m/s", "accel_m_s_per_pulse")]
            .into_iter()
            .filter_map(|(name, unit, field)| {
                let sizes = document["coarse"][field].as_array()?;
                let sizes: Vec<f64> = sizes.iter().filter_map(Value::as_f64).collect();
                Some((name, unit, sizes.try_into().ok()?))
            })
            .collect(),
        effects,
    })
}

/// Whether a character ends a line somewhere, or turns the direction of a text.
fn ends_line(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Where it comes from, in lines without any character that ends a comment.
fn source(path: &Path, filter: &str, document: &Value) -> Result<Vec<String>> {
    let clean = |text: &str| -> String {
        let kept = text.chars().map(|c| if ends_line(c) || "*\\".contains(c) { '?' } else { c });
        kept.take(300).collect()
    };
    let sum = origin::sha256(path).map_err(|error| miette!("{}: cannot be read: {error}", path.display()))?;
    let mut lines = vec![format!("{}, SHA-256 {sum}", clean(&path.display().to_string()))];
    let mut run = format!("filter {filter}");
    if let Some(log) = document["log"].as_str() {
        run += &format!(", log {}", clean(log));
    }
    lines.push(run);
    if let (Some(duration), Some(nis)) = (document["duration_s"].as_f64(), document["nis_per_dof"].as_f64()) {
        lines.push(format!("{duration:.0} s of data, NIS per degree of freedom {nis:.2}"));
    }
    Ok(lines)
}
