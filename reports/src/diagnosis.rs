//! The report of a diagnosis: what is missing, where it shows, its rivals, and the gap before and after.

use gap::{Diagnosis, FoundEffect, FoundLaw, Horizontal, LogGap, Place, Rival, Verdict};

use super::{Cell, Interval, Item, Report, Section, Table, Tone, number, text};
use crate::draw::{Curve, Figure, Style};
use crate::figures::{decimals, significant};

/// What 95 % of normal numbers stay within.
const NORMAL_95: f64 = 1.96;

/// Everything about a diagnosis but its inputs, in the order a reviewer reads.
pub fn report(found: &Diagnosis, title: String) -> Report {
    let gap = found.gap.as_ref();
    let mut facts = Vec::new();
    if !found.effects.is_empty() {
        facts.push(("missing".into(), names(found).join(", ")));
    } else if let Some(law) = found.laws.first() {
        facts.push(("law of both logs".into(), law.equation.clone()));
    } else if found.verdict != Verdict::NothingMissing {
        let sets: Vec<String> = found.ambiguous.iter().map(|set| set.join(" + ")).collect();
        let candidates = match sets.len() {
            0 => "none".into(),
            1..=2 => sets.join(", "),
            many => format!("{many} sets of effects"),
        };
        facts.push(("candidates".into(), candidates));
    }
    if let Some(gap) = gap {
        let gained = gap.fit.log_likelihood_after - gap.fit.log_likelihood_before;
        facts.push(("log-likelihood gained".into(), tenths(gained)));
        let change = |gap: &LogGap| format!("{:.2} to {:.2} sigma", gap.rms_before, gap.rms_after);
        facts.push((format!("RMS of innovations, {}", found.called()), change(&gap.fit)));
        facts.extend(gap.verify.as_ref().map(|gap| ("RMS of innovations, second log".into(), change(gap))));
    }
    facts.push(("confirmed by a second log".into(), if found.verified { "yes" } else { "no" }.into()));
    let sections = [
        effects(found),
        laws(found),
        rivals(found),
        before_and_after(found),
        map(found),
        remarks(found),
        declaration(found).map(Section::folded),
    ];
    let report = Report {
        title,
        verdict: headline(found),
        tone: match found.verdict {
            Verdict::EffectsFound | Verdict::NothingMissing => Tone::Good,
            _ => Tone::Bad,
        },
        facts,
        sections: sections.into_iter().flatten().collect(),
        origin: Vec::new(),
        attachments: Vec::new(),
    };
    let noise = &found.noise_scale;
    report.with("filter", found.base_filter.clone()).with(
        "noise fitted",
        format!(
            "gyro {:.2}, accelerometer {:.2}, reference {:.2} times what is stated",
            noise.gyro, noise.accel, noise.reference
        ),
    )
}

fn names(found: &Diagnosis) -> Vec<&str> {
    found.effects.iter().map(|effect| effect.name.as_str()).collect()
}

/// The verdict in a short sentence, and in a second line all that the diagnosis says of it.
fn headline(found: &Diagnosis) -> String {
    let sentence = &found.sentence;
    let short = match found.verdict {
        Verdict::EffectsFound => {
            let names = names(found);
            let (verb, it) = if names.len() > 1 { ("are", "them") } else { ("is", "it") };
            let names = names.join(" and ");
            let confirmed =
                if found.verified { "and a second log confirms" } else { "but no second log confirms" };
            format!("{names} {verb} missing from {}, {confirmed} {it}", found.base_filter)
        }
        _ => {
            let end = [": ", "; ", ". "].into_iter().filter_map(|mark| sentence.find(mark)).min();
            sentence[..end.unwrap_or(sentence.len())].trim_end_matches('.').to_owned()
        }
    };
    let rest = sentence.strip_prefix(&short).unwrap_or(sentence);
    format!("{short}\n{}", rest.trim_start_matches([';', ':', '.', ' ']))
}

/// The effects found, with their values.
fn effects(found: &Diagnosis) -> Option<Section> {
    if found.effects.is_empty() {
        return None;
    }
    let mut head = vec!["effect", "estimate", "unit", "95 % interval"];
    if found.verified {
        head.push("on the second log");
    }
    let mut rows = Vec::new();
    for effect in &found.effects {
        rows.extend((0..effect.components.len()).map(|i| value(effect, i, found.verified)));
    }
    let mut items: Vec<Item> = vec![Table::new("", &head, rows).into()];
    for effect in &found.effects {
        if !effect.equation.is_empty() {
            items.push(Item::text(format!("{}: {}", effect.name, effect.description)));
            items.push(Item::Equation(effect.equation.clone()));
        }
    }
    Some(Section::new("What is missing", items))
}

/// What is in no library, as equations of what was measured.
fn laws(found: &Diagnosis) -> Option<Section> {
    if found.laws.is_empty() {
        return None;
    }
    let mut items: Vec<Item> = Vec::new();
    for law in &found.laws {
        let head = ["coefficient", "estimate", "unit", "95 % interval", "on the second log"];
        let rows = (0..law.components.len()).map(|i| coefficient(law, i)).collect();
        items.push(Item::text(format!("{}: how it goes, and not why", law.name)));
        items.push(Item::Equation(law.equation.clone()));
        items.push(Table::new("", &head, rows).into());
        if !law.beside.is_empty() {
            items.push(Item::text(format!("beside it: {}", law.beside.join(", "))));
        }
        if !law.rivals.is_empty() {
            items.push(Item::text(format!("the logs cannot tell it from {}", law.rivals.join(", "))));
        }
    }
    Some(Section::new("A law of both logs", items))
}

fn coefficient(law: &FoundLaw, i: usize) -> Vec<Cell> {
    let at = |values: &[f64]| values.get(i).map_or(String::new(), |value| format!("{value:.3e}"));
    let interval = match (law.estimate.get(i), law.sigma.get(i)) {
        (Some(value), Some(sigma)) => {
            format!("{:.3e} to {:.3e}", value - NORMAL_95 * sigma, value + NORMAL_95 * sigma)
        }
        _ => String::new(),
    };
    vec![
        text(format!("k_{}", law.components[i])),
        number(at(&law.estimate)),
        text(&law.unit),
        number(interval),
        number(at(&law.estimate_verify)),
    ]
}

fn value(effect: &FoundEffect, i: usize, verified: bool) -> Vec<Cell> {
    let (unit, scale) = (effect.sheet_unit.as_str(), effect.sheet_scale);
    let at = |values: &[f64]| values.get(i).map_or(f64::NAN, |value| value / scale);
    let (estimate, sigma) = (at(&effect.estimate), at(&effect.sigma));
    let digits = decimals(sigma);
    let figure = |value: f64| format!("{value:.digits$}");
    let (low, high) = (estimate - NORMAL_95 * sigma, estimate + NORMAL_95 * sigma);
    let mut row = vec![
        text(format!("{} {}", effect.name, effect.components[i])),
        number(figure(estimate)),
        text(unit),
        number(format!("{} to {}", figure(low), figure(high))),
    ];
    if verified {
        row.push(number(effect.estimate_verify.as_ref().map_or(String::new(), |values| figure(at(values)))));
    }
    row
}

/// The gap before and after, on both logs.
fn before_and_after(found: &Diagnosis) -> Option<Section> {
    let gap = found.gap.as_ref()?;
    let mut rows = Vec::new();
    for (log, gap) in [(found.called(), Some(&gap.fit)), ("second log", gap.verify.as_ref())] {
        let Some(gap) = gap else { continue };
        let unit = if gap.free_run_of == "position" { "m" } else { "m/s" };
        let prediction = format!("{} predicted over {:.0} s, RMS error", gap.free_run_of, gap.horizon_s);
        let navigated = gap.horizontal.map(|horizontal| {
            let what = "free-inertial with the first log's values, largest horizontal error".to_owned();
            (what, "m", horizontal.before_m, horizontal.after_m)
        });
        let lines = [
            ("innovations, RMS".to_owned(), "sigma", gap.rms_before, gap.rms_after),
            (prediction, unit, gap.free_run_before, gap.free_run_after),
        ];
        for (what, unit, before, after) in lines.into_iter().chain(navigated) {
            let largest = before.max(after);
            let bar = |value: f64| Cell::Bar(value / largest, format!("{} {unit}", significant(value)));
            rows.push(vec![text(log), text(what), bar(before), bar(after)]);
        }
        rows.push(vec![
            text(log),
            text(format!("log-likelihood (its gain was priced as {:+.1})", gap.log_likelihood_gain_priced)),
            text(format!("{:.1}", gap.log_likelihood_before)),
            text(format!("{:.1}", gap.log_likelihood_after)),
        ]);
    }
    let caption = "Both filters really run, closed loop, on the fitted noise. A filter that lacks nothing has an RMS of 1.";
    let table = Table::new(caption, &["log", "gap", "before", "after"], rows).drawn_as("before-and-after");
    let mut items = vec![table.into()];
    for (log, gap) in [(found.called(), Some(&gap.fit)), ("the second log", gap.verify.as_ref())] {
        let worse = gap.and_then(|gap| gap.horizontal).filter(|error| error.after_m > error.before_m);
        items.extend(worse.map(|error| Item::text(worse_off(log, &error))));
    }
    Some(Section::new("Before and after", items))
}

/// Why navigation may be worse though the residuals are better.
fn worse_off(log: &str, error: &Horizontal) -> String {
    format!(
        "On {log} free-inertial navigation errs more with what was found: {} m instead of {} m. It is one draw: errors of the \
         alignment and the noise of the gyros grow with time and may have cancelled others before. It takes no part in the verdict, \
         which rests on the innovations.",
        significant(error.after_m),
        significant(error.before_m)
    )
}

/// Where it shows: stretches by channels, and how the evidence grew.
fn map(found: &Diagnosis) -> Option<Section> {
    if found.r#where.is_empty() {
        return None;
    }
    let largest = found.r#where.iter().map(|place| place.gain).fold(0.0, f64::max);
    let mut channels: Vec<&str> = found.r#where.iter().map(|place| place.channel.as_str()).collect();
    channels.sort_unstable();
    channels.dedup();
    let mut stretches: Vec<&Place> = found.r#where.iter().collect();
    stretches.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    stretches.dedup_by_key(|place| place.start_s);
    let row = |stretch: &&Place| {
        let mut row = vec![text(format!("{:.0} to {:.0} s", stretch.start_s, stretch.end_s))];
        row.extend(channels.iter().map(|channel| {
            let here = |place: &&Place| place.start_s == stretch.start_s && place.channel == *channel;
            match found.r#where.iter().find(here) {
                Some(place) => Cell::Heat(place.gain / largest, format!("{:.1}", place.gain)),
                None => Cell::Heat(0.0, String::new()),
            }
        }));
        row
    };
    let mut head = vec!["stretch"];
    head.extend(&channels);
    let caption = "Log-likelihood that the missing effect gains by stretch of the log and channel of the reference; the strongest.";
    let table = Table::new(caption, &head, stretches.iter().map(row).collect()).drawn_as("where");
    let mut items: Vec<Item> = vec![table.into()];
    if !found.evidence.is_empty() {
        let points = found.evidence.iter().map(|evidence| (evidence.time_s, evidence.gain)).collect();
        items.push(
            Figure {
                file: "evidence".into(),
                title: "How the evidence grew".into(),
                axes: ["time, s", "log-likelihood gained"],
                curves: vec![Curve::new("gain so far", Style::Full, points)],
            }
            .into(),
        );
    }
    Some(Section::new("Where it shows", items))
}

/// A number to a tenth, its zero without a sign.
pub fn tenths(number: f64) -> String {
    let text = format!("{number:.1}");
    if text == "-0.0" { "0.0".into() } else { text }
}

/// Every candidate against what was chosen.
fn rivals(found: &Diagnosis) -> Option<Section> {
    if found.rivals.is_empty() {
        return None;
    }
    let mut rivals: Vec<&Rival> = found.rivals.iter().collect();
    rivals.sort_by(|a, b| b.gain_alone.total_cmp(&a.gain_alone));
    let largest = rivals.first().map_or(1.0, |rival| rival.gain_alone).max(f64::MIN_POSITIVE);
    let chosen = |rival: &Rival| found.effects.iter().any(|effect| effect.name == rival.name);
    let row = |rival: &&Rival| {
        let member = chosen(rival);
        vec![
            text(if member { format!("{} (chosen)", rival.name) } else { rival.name.clone() }),
            Cell::Bar(rival.gain_alone / largest, tenths(rival.gain_alone)),
            number(tenths(rival.gain_on_top)),
            number(if member { "\u{2013}".into() } else { tenths(rival.chosen_on_top) }),
            number(tenths(-rival.log10_p_before)),
            number(if member { "\u{2013}".into() } else { tenths(-rival.log10_p_after) }),
            number(significant(rival.excitation)),
        ]
    };
    let head = [
        "effect",
        "gain alone",
        "gain on top of the chosen",
        "the chosen on top of it",
        "-log10 p before",
        "-log10 p after",
        "excitation",
    ];
    let caption = "Gains in log-likelihood. Excitation: the standard deviations that an effect of its prior's size would show.";
    let table = Table::new(caption, &head, rivals.iter().map(row).collect()).drawn_as("rivals");
    Some(Section::new("Rivals", vec![table.into()]))
}

/// What else there is to know.
fn remarks(found: &Diagnosis) -> Option<Section> {
    let mut items = Vec::new();
    let mut list = |title: &str, lines: Vec<String>| {
        if !lines.is_empty() {
            items.push(Item::text(title));
            items.push(Item::List(lines));
        }
    };
    list("Notes:", found.notes.clone());
    let sets = found.ambiguous.iter().map(|set| set.join(" + ")).collect();
    list("Sets that explain the data, but are not confirmed:", sets);
    list("This path cannot show:", found.not_excited.clone());
    list("What another run could tell apart:", found.next_run.clone());
    (!items.is_empty()).then(|| Section::new("Remarks", items))
}

fn declaration(found: &Diagnosis) -> Option<Section> {
    let source = found.source.as_ref()?;
    let words = Item::text("The filter with what was found, ready to be compiled:");
    Some(Section::new("Declaration", vec![words, Item::Code(source.clone())]))
}

/// The true values of hidden effects beside what was found.
pub fn against_truth(found: &Diagnosis, truth: &dyn Fn(&str, usize) -> f64) -> Section {
    let mut rows = Vec::new();
    for effect in &found.effects {
        for (i, component) in effect.components.iter().enumerate() {
            let (estimate, sigma) = (effect.estimate[i], effect.sigma[i]);
            let true_value = truth(&effect.name, i);
            let error = (estimate - true_value) / sigma;
            let digits = decimals(sigma / effect.sheet_scale);
            let figure = |value: f64| number(format!("{:.digits$}", value / effect.sheet_scale));
            rows.push(vec![
                text(format!("{} {component}", effect.name)),
                figure(estimate),
                figure(true_value),
                text(effect.sheet_unit.clone()),
                number(format!("{error:+.2}")),
                Cell::Interval(Interval {
                    prior: (0.5 - NORMAL_95 / 8.0, 0.5 + NORMAL_95 / 8.0),
                    interval: (0.5 + error / 8.0, 0.5 + error / 8.0),
                    estimate: 0.5 + error / 8.0,
                    truth: None,
                    mark: Some(0.5),
                    text: format!("error of {error:+.2} sigma"),
                }),
            ]);
        }
    }
    let head = ["effect", "found", "hidden", "unit", "error by sigma", "-4 to +4 sigmas; grey holds 95 %"];
    Section::new("Against the truth", vec![Table::new("", &head, rows).into()])
}
