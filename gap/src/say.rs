//! Sentences for people.

use std::fmt::Write;

use sinscal::Site;

use crate::chain::told_wrongly;
use crate::name::MARGIN;
use crate::report::{Diagnosis, FoundEffect, FoundLaw, Rival, Verdict};

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

/// No verdict is longer than this; what else there is to say follows in notes.
const LONGEST: usize = 240;

/// The first of several ways to say it that is short enough, or the last one, cut.
fn short(ways: impl IntoIterator<Item = String>) -> String {
    let mut last = String::new();
    for way in ways {
        if way.chars().count() <= LONGEST {
            return way;
        }
        last = way;
    }
    last.chars().take(LONGEST - 3).collect::<String>() + "..."
}

/// The verdict in a line; `same` says that the second log is the first one again.
pub(crate) fn sentence(d: &Diagnosis, reason: Option<&str>, same: bool) -> String {
    let because = reason.map_or(String::new(), |r| format!(": {r}"));
    let base = &d.base_filter;
    let sets = |from: usize| d.ambiguous.iter().skip(from).map(|s| s.join(" + ")).collect::<Vec<_>>();
    match d.verdict {
        Verdict::NothingMissing => format!(
            "Nothing is missing from {base}: no known effect and no combination of what was measured explains more than chance would."
        ),
        Verdict::EffectsFound => found(d, same),
        Verdict::OutsideLibrary => {
            let said = format!("Something is missing from {base}, and none of the known effects explains it");
            let with = match (d.laws.first(), d.correlates_with.first()) {
                (Some(law), _) => format!("; both logs follow {}", law.equation),
                (None, Some(family)) => format!("; it goes with {family}"),
                (None, None) => String::new(),
            };
            short([format!("{said}{because}{with}."), format!("{said}{with}."), format!("{said}.")])
        }
        Verdict::Ambiguous => {
            let said = format!("Something is missing from {base}; ");
            let all = sets(0);
            let first = all.first().cloned().unwrap_or_default();
            short([
                format!("{said}{} explain it equally well{because}.", all.join(" or ")),
                format!("{said}{} explain it equally well.", all.join(" or ")),
                format!(
                    "{said}{first} and {} other sets of effects explain it equally well.",
                    all.len().max(1) - 1
                ),
            ])
        }
        Verdict::NotConfirmed => match sets(0).first() {
            Some(set) => {
                let said = format!("{set} would explain {}, but is not confirmed", d.called());
                short([format!("{said}{because}."), format!("{said}.")])
            }
            None => short([format!("Nothing can be said{because}.")]),
        },
    }
}

/// The values of an effect by themselves, as a verdict has them.
fn values(found: &FoundEffect) -> String {
    let number = |i: usize| value(found, i, found.estimate[i], false);
    let plain: Vec<String> = (0..found.estimate.len())
        .map(|i| number(i).split(' ').nth(2).unwrap_or_default().to_owned())
        .collect();
    match plain.as_slice() {
        [one] => format!("{one} {}", found.sheet_unit),
        all => format!("({}) {}", all.join(", "), found.sheet_unit),
    }
}

fn found(d: &Diagnosis, same: bool) -> String {
    let least = power(d.effects.iter().map(|e| e.log_e_verify).fold(f64::INFINITY, f64::min));
    let evidence = match (d.verified, same) {
        (true, _) => format!("e-value {least} on the second run"),
        (false, false) => format!("e-value {least} on the second half (no second run was given)"),
        (false, true) => format!("e-value {least} on the second half (the second run is the first again)"),
    };
    let remains = d.remainder.as_ref().map_or(String::new(), |r| format!("; {} % remains", share(r.share)));
    let named: Vec<&str> = d.effects.iter().map(|effect| effect.name.as_str()).collect();
    let whole: Vec<String> = d.effects.iter().map(|e| format!("{} {}", e.name, values(e))).collect();
    short([
        format!("Missing: {}; {evidence}{remains}.", whole.join(", ")),
        format!("Missing: {}; {evidence}{remains}.", named.join(", ")),
        format!("Missing: {}.", named.join(", ")),
    ])
}

/// A part in percent.
fn share(part: f64) -> String {
    let percent = 100.0 * part;
    if percent < 1.0 { format!("{percent:.2}") } else { format!("{percent:.1}") }
}

/// What stands behind a verdict, in notes: equations and values, what was gained, what remains, and the nearest rival.
pub(crate) fn details(d: &Diagnosis, gain: f64, site: &Site) -> Vec<String> {
    let mut notes: Vec<String> = d.effects.iter().map(describe).collect();
    notes.extend(d.effects.iter().filter_map(|found| told_wrongly(found, site)));
    notes.extend(d.laws.iter().map(law));
    if d.effects.is_empty() {
        return notes;
    }
    let all = if d.effects.len() > 1 { "what was found" } else { d.effects[0].name.as_str() };
    let mut text = format!("{all} gains {gain:.0} in log-likelihood here");
    if let Some(remainder) = &d.remainder {
        let with =
            remainder.families.first().map_or(String::new(), |family| format!(" and goes with {family}"));
        let (explained, rest) = (share(1.0 - remainder.share), share(remainder.share));
        let _ = write!(text, ", {explained} % of the gap; {rest} % remains unexplained{with}");
    }
    let names = |name: &str| d.effects.iter().any(|e| e.name == name);
    let others = d.rivals.iter().filter(|r| !names(&r.name) && r.gain_alone > 1.0);
    if let Some(rival) = others.max_by(|a, b| a.gain_alone.total_cmp(&b.gain_alone)) {
        text += &nearest(rival, all);
    }
    notes.push(text);
    notes
}

/// A law with its coefficients, and what the logs cannot tell from it.
fn law(law: &FoundLaw) -> String {
    let coefficient =
        |i: usize| format!("{} = {:.3e} +- {:.1e}", law.components[i], law.estimate[i], law.sigma[i]);
    let all: Vec<String> = (0..law.estimate.len()).map(coefficient).collect();
    let mut text = format!(
        "as a law, and not as a cause: {}, {} ({}), which gains {:.0} in log-likelihood here and has the e-value {} on the second log",
        law.equation,
        all.join(", "),
        law.unit,
        law.log_likelihood_gain,
        power(law.log_e_verify)
    );
    if !law.rivals.is_empty() {
        let _ = write!(text, "; the logs cannot tell it from {}", law.rivals.join(" or "));
    }
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
    format!("; nearest rival: {name}, which gains {gain_alone:.0} by itself; {judged}")
}

/// What the path cannot tell apart, a sentence for each effect that others hide behind.
pub(crate) fn hidden(pairs: &[Vec<String>]) -> Vec<String> {
    let mut behind: Vec<(&str, Vec<&str>)> = Vec::new();
    for (effect, other) in pairs.iter().filter_map(|pair| Some((pair.first()?, pair.get(1)?))) {
        match behind.iter_mut().find(|(name, _)| name == other) {
            Some((_, effects)) => effects.push(effect),
            None => behind.push((other, vec![effect])),
        }
    }
    let sentence = |(other, effects): (&str, Vec<&str>)| {
        let all = match effects.as_slice() {
            [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
            one => one.concat(),
        };
        format!("on this path {all} cannot be told apart from {other}")
    };
    behind.into_iter().map(sentence).collect()
}

/// What the next run should do so that two effects part.
pub(crate) fn advice(effect_name: &str, other: &str) -> Option<String> {
    let is = |name: &str| effect_name == name || other == name;
    let text = if is("dither-size-effect") && is("accel-bias") {
        "let the dither amplitude change during the run (another setting, or a warm-up): constant, it is an accelerometer bias"
    } else if is("thermometer-lag") {
        "hold the temperature for an hour, in several attitudes: while it changes, a late thermometer looks like other errors"
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
    } else if is("dither-scale") {
        "look up how the dither is told: amplitudes are expected, not root mean squares and not values from peak to peak"
    } else if is("inner-lever-arm-tangential") || is("inner-lever-arm") {
        "turn fast, with strong angular accelerations, about more than one axis"
    } else if is("reference-delay") {
        "let the observed point move: a reference that stands still has no delay to show"
    } else {
        return None;
    };
    Some(format!("{effect_name} against {other}: {text}"))
}
