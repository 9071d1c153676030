//! Sentences for people.

use std::fmt::Write;

use crate::name::MARGIN;
use crate::report::{Diagnosis, FoundEffect, Rival, Verdict};

/// Component `i` of an effect in the unit of data sheets, to two digits of its standard deviation, and that where it is asked for.
fn value(found: &FoundEffect, i: usize, value: f64, spread: bool) -> String {
    let (unit, scale) = (&found.sheet_unit, found.sheet_scale);
    let (v, s) = (value / scale, found.sigma[i] / scale);
    let digits =
        if s > 0.0 && s.is_finite() { (1.0 - s.log10().floor()).clamp(0.0, 9.0) as usize } else { 3 };
    let component = match found.components[i].as_str() {
        "" => "value",
        component => component,
    };
    let spread = if spread { format!(" +- {s:.digits$}") } else { String::new() };
    format!("{component} = {v:.digits$}{spread} {unit}")
}

/// One effect with its equation and its values.
pub(crate) fn describe(found: &FoundEffect) -> String {
    let mut text = found.name.clone();
    if !found.equation.is_empty() {
        let _ = write!(text, ", {}", found.equation.trim_end_matches('.'));
    }
    let values: Vec<String> =
        (0..found.estimate.len()).map(|i| value(found, i, found.estimate[i], true)).collect();
    let _ = write!(text, ": {}", values.join(", "));
    text
}

/// Its values in the second log.
pub(crate) fn there(found: &FoundEffect) -> Option<String> {
    let values = found.estimate_verify.as_ref()?.iter().enumerate();
    Some(values.map(|(i, v)| value(found, i, *v, false)).collect::<Vec<_>>().join(", "))
}

/// e to the power of `ln`, as people write it.
pub(crate) fn power(ln: f64) -> String {
    let log10 = ln / core::f64::consts::LN_10;
    if log10.abs() < 4.0 { format!("{:.3}", ln.exp()) } else { format!("1e{log10:.0}") }
}

/// The verdict in a sentence; `same` says that the second log is the first one again.
pub(crate) fn sentence(d: &Diagnosis, gain: f64, reason: Option<&str>, same: bool) -> String {
    let because = reason.map_or(String::new(), |r| format!(": {r}"));
    match d.verdict {
        Verdict::NothingMissing => {
            let mut text = format!("Nothing is missing from {}: no known effect", d.base_filter);
            text += " and no combination of what was measured explains more than chance would.";
            if !d.not_excited.is_empty() {
                let _ = write!(text, " This path cannot show {}.", d.not_excited.join(", "));
            }
            text
        }
        Verdict::EffectsFound => found(d, gain, same),
        Verdict::OutsideLibrary => {
            let with =
                d.correlates_with.first().map_or(String::new(), |c| format!("; it correlates with {c}"));
            format!(
                "Something is missing from {}, and none of the known effects explains it{because}{with}.",
                d.base_filter
            )
        }
        Verdict::Ambiguous => {
            let sets: Vec<String> = d.ambiguous.iter().map(|s| s.join(" + ")).collect();
            let (verb, what) =
                if sets.len() > 1 { ("explain", "equally well") } else { ("explains", "but not alone") };
            format!(
                "Something is missing from {}; {} {verb} it {what}{because}.",
                d.base_filter,
                sets.join(" or ")
            )
        }
        Verdict::NotConfirmed => match d.ambiguous.first() {
            Some(set) => {
                format!("{} would explain this log, but is not confirmed{because}.", set.join(" + "))
            }
            None => format!("Nothing can be said{because}."),
        },
    }
}

const ALONE: &str = "on the second half of the run (no second run was given)";
const AGAIN: &str = "on the second half of the run (the second run is the first one again)";

fn found(d: &Diagnosis, gain: f64, same: bool) -> String {
    let named: Vec<String> = d.effects.iter().map(describe).collect();
    let mut text = format!("Missing: {}.", named.join("; and "));
    let least = d.effects.iter().map(|e| e.log_e_verify).fold(f64::INFINITY, f64::min);
    let (here, there) =
        if d.verified { ("here", "on the second run") } else { ("here", if same { AGAIN } else { ALONE }) };
    let _ = write!(
        text,
        " Log-likelihood gain {gain:.0} {here}, e-value {}{} {there}",
        power(least),
        if d.effects.len() > 1 { " or more for each" } else { "" }
    );
    let names = |name: &str| d.effects.iter().any(|e| e.name == name);
    let others = d.rivals.iter().filter(|r| !names(&r.name) && r.gain_alone > 1.0);
    if let Some(rival) = others.max_by(|a, b| a.gain_alone.total_cmp(&b.gain_alone)) {
        let found = if d.effects.len() > 1 { "what was found" } else { d.effects[0].name.as_str() };
        text += &nearest(rival, found);
    }
    text.push('.');
    text
}

/// The rival that explains most by itself, and why it was not named.
fn nearest(rival: &Rival, found: &str) -> String {
    let Rival { name, gain_alone, gain_on_top, chosen_on_top, .. } = rival;
    let adds = |gain: f64| if gain > 1.0 { format!("{gain:.0} more") } else { "nothing".into() };
    let (more, less) = (adds(*chosen_on_top), adds(*gain_on_top));
    let judged = if *chosen_on_top < MARGIN {
        format!("it can stand for {found}, but with more unknowns and no better")
    } else if *gain_on_top < MARGIN {
        format!("rejected: with it in the filter {found} gains {more}, the other way round it gains {less}")
    } else {
        format!("it cannot stand for {found}, which gains {more} beside it; beside {found} it gains {less}")
    };
    format!(". Nearest rival: {name}, which gains {gain_alone:.0} by itself; {judged}")
}

/// What the next run should do so that two effects part.
pub(crate) fn advice(effect_name: &str, other: &str) -> Option<String> {
    let is = |name: &str| effect_name == name || other == name;
    let text = if is("dither-size-effect") && is("accel-bias") {
        "let the dither amplitude change during the run (another setting, or a warm-up): constant, it is an accelerometer bias"
    } else if effect_name.contains("temperature") && other.contains("drift")
        || effect_name.contains("drift") && other.contains("temperature")
    {
        "run another thermal profile: a temperature that rises and falls again parts temperature from time"
    } else if effect_name.contains("temperature") {
        "change the temperature during the run, so that it does not stay near one value"
    } else if is("accel-cubic") || is("accel-scale-asymmetry") || is("accel-cross-coupling") {
        "add positions at 45 deg, where the forces along the axes have other sizes than 0 and 1 g"
    } else if effect_name.starts_with("gyro-rate") || effect_name.starts_with("gyro-scale-asymmetry") {
        "turn at several rates and in both senses, and not back by the same angle"
    } else if is("inner-lever-arm-tangential") || is("inner-lever-arm") {
        "turn fast, with strong angular accelerations, about more than one axis"
    } else if is("reference-delay") {
        "let the observed point move: a reference that stands still has no delay to show"
    } else {
        return None;
    };
    Some(format!("{effect_name} against {other}: {text}"))
}
