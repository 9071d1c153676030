//! `sinscal demo`: the whole story on a simulated unit, without any file.

mod html;
mod story;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use clap::builder::PossibleValuesParser;
use gap::FoundEffect;
use miette::{IntoDiagnostic, Result};
use rig::Truth;
use sinscal::Parameter;

use self::story::Story;
use crate::origin::Documented as _;
use crate::output::{self, Files};
use reports::figures::{decimals, significant};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal demo
  sinscal demo --seed 3 --hide accel-temperature-scale --out runs/demo";

/// Draw a unit, hide an effect in it, find it with a filter that lacks it, and show what that is worth
///
/// Needs no files. The unit is simulated on a turntable, calibrated with a filter that lacks the hidden effect, diagnosed, the
/// finding put to a second run, and the unit navigated with both calibrations.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Which unit of the population is drawn
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// The effect that is hidden in the unit; `sinscal effects` describes them. The path of this demonstration cannot show all
    /// of them, and then the diagnosis says so
    #[arg(long, value_name = "EFFECT", default_value = "accel-delay",
          value_parser = PossibleValuesParser::new(story::hideable()))]
    hide: String,
    /// Write report.html, diagnosis.json, the declaration of the extended filter and figures to this folder
    #[arg(long, value_name = "DIR", default_value = "sinscal-demo")]
    out: PathBuf,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        output::check_folder(&self.out)?;
        let started = Instant::now();
        let story = Story::tell(self.seed, &self.hide)?;
        let mut files = Files::default();
        files.folder(&self.out)?;
        html::report(&story).write(&mut files, &self.out)?;
        let json = serde_json::to_string_pretty(&story.found).into_diagnostic()? + "\n";
        files.write(&self.out.join("diagnosis.json"), |file| file.write_all(json.as_bytes()))?;
        if let Some(source) = &story.found.source {
            let path = self.out.join("extended_filter.rs");
            files.write(&path, |file| file.write_all(source.as_bytes()))?;
        }
        files.commit()?;
        output::print(&text(&story, &self.out, started.elapsed().as_secs_f64()))
    }
}

/// What happened, in about ten lines. Writing to a string does not fail.
fn text(story: &Story, out: &Path, seconds: f64) -> String {
    let found = &story.found;
    let mut text = format!(
        "unit {} of the population, {}: {:.0} s at {:.0} Hz; again {}\n",
        story.seed,
        story::PATHS[0],
        story.first.duration(),
        story.first.description.rate,
        story::PATHS[1]
    );
    let _ = writeln!(text, "hidden: {}", hidden(story.hidden.info(), &story.truth));
    let _ = writeln!(text, "{}, which lacks it: {}", story.base, fit(&story.before, &story.truth));
    match found.r#where.first() {
        Some(place) => {
            let (from, to) = (place.start_s, place.end_s);
            let _ = writeln!(text, "it shows most in {} from {from:.0} to {to:.0} s", place.channel);
        }
        None => text.push_str("it does not show\n"),
    }
    for effect in &found.effects {
        let confirmed = match &effect.estimate_verify {
            Some(values) => format!("; on the second run {}", values_of(effect, values, None)),
            None => String::new(),
        };
        let value = values_of(effect, &effect.estimate, Some(&effect.sigma));
        let _ = writeln!(text, "found: {}, {value}{confirmed}", effect.name);
    }
    if found.effects.is_empty() {
        let _ = writeln!(text, "{}", found.sentence);
    }
    let mine = |name: &str| found.effects.iter().any(|effect| effect.name == name);
    if let (Some(rival), false) =
        (found.rivals.iter().find(|rival| !mine(&rival.name)), found.effects.is_empty())
    {
        let (its, ours) = (rival.gain_on_top, rival.chosen_on_top);
        let _ = writeln!(
            text,
            "nearest rival: {}, gains {its:.1} of log-likelihood on top of what was found, which gains {ours:.1} on top of it",
            rival.name
        );
    }
    if let Some(after) = &story.after {
        let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
        let _ = writeln!(text, "{} + {}: {}", story.base, names.join(" + "), fit(after, &story.truth));
    }
    let after =
        story.after.as_ref().map_or(String::new(), |after| format!(", {:.3} after", after.flight.largest()));
    let _ = writeln!(
        text,
        "free-inertial navigation, {:.0} h swinging: at most {:.3} nautical miles off before{after}",
        story.before.flight.hours(),
        story.before.flight.largest()
    );
    let _ = writeln!(text, "report: {} ({seconds:.0} s)", out.join("report.html").display());
    text
}

/// The hidden effect and its values.
fn hidden(effect: &'static sinscal::EffectInfo, truth: &Truth) -> String {
    let values = effect.components().iter().enumerate().map(|(i, component)| {
        format!("{component} = {}", signed(truth.value(effect.name(), i) / effect.sheet_scale))
    });
    format!("{}, {} {}", effect.name(), values.collect::<Vec<_>>().join(", "), effect.sheet_unit)
}

/// A number to about three figures, with its sign.
fn signed(number: f64) -> String {
    let sign = if number < 0.0 { "-" } else { "" };
    format!("{sign}{}", significant(number.abs()))
}

/// How well a filter fits, and how far it is off where the truth is known.
fn fit(fit: &story::Fit, truth: &Truth) -> String {
    format!(
        "NIS per degree of freedom {:.2}, largest error {:.1} sigma",
        fit.outcome.statistics.nis_per_dof(),
        largest_error(&fit.outcome.parameters, truth)
    )
}

/// Largest error by its sigma.
fn largest_error(parameters: &[Parameter], truth: &Truth) -> f64 {
    let error = |p: &Parameter| ((p.value - truth.of(&p.info)) / p.sigma).abs();
    study::statistics::largest(parameters.iter().map(error))
}

/// Values of an effect in data-sheet units.
fn values_of(effect: &FoundEffect, values: &[f64], sigmas: Option<&[f64]>) -> String {
    let (unit, scale) = (&effect.sheet_unit, effect.sheet_scale);
    let value = |i: usize| {
        let digits = decimals(effect.sigma[i] / scale);
        let sigma = sigmas.map_or(String::new(), |s| format!(" +- {:.digits$}", s[i] / scale));
        format!("{} = {:.digits$}{sigma}", effect.components[i], values[i] / scale)
    };
    let count = effect.components.len().min(values.len());
    format!("{} {unit}", (0..count).map(value).collect::<Vec<_>>().join(", "))
}
