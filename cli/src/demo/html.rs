//! The report of the demonstration.

use crate::origin::Documented as _;
use sinscal::StateInfo;

use super::story::{Fit, PATHS, Story};
use super::{fit, hidden, largest_error};
use reports::figures::significant;
use reports::{Item, Report, Section, Table, Tone, diagnosis, number, parts, text};

/// Everything that happened, in the order a reviewer reads.
pub(super) fn report(story: &Story) -> Report {
    let truth_of = |info: &StateInfo| story.truth.of(info);
    let truth: parts::Truth = Some(&truth_of);
    let mut page =
        diagnosis::report(&story.found, format!("Demonstration: {} hidden in a unit", story.hidden.name()));
    // of a hidden effect only its name is good news
    let named = story.found.effects.len() == 1 && story.found.effects[0].name == story.hidden.name();
    page.tone = if named { Tone::Good } else { Tone::Bad };
    let miles = |fit: &Fit| format!("{:.3}", fit.flight.largest());
    let navigation = match &story.after {
        Some(after) => format!("{} to {} nmi", miles(&story.before), miles(after)),
        None => format!("{} nmi", miles(&story.before)),
    };
    // the story has been told: its worth stands where a second log would be mentioned
    page.facts.pop();
    page.facts
        .push((format!("largest error in {:.0} h of navigation", story.before.flight.hours()), navigation));
    let mut sections = vec![what_happened(story)];
    sections.append(&mut page.sections);
    if !story.found.effects.is_empty() {
        sections.insert(2, diagnosis::against_truth(&story.found, &|name, i| story.truth.value(name, i)));
    }
    // remarks and source come when the story is told
    let told =
        sections.iter().position(|section| ["Remarks", "Declaration"].contains(&section.title.as_str()));
    let appendix = sections.split_off(told.unwrap_or(sections.len()));
    let last = story.after.as_ref().unwrap_or(&story.before);
    sections.push(side_by_side(story));
    let tracks = [("before", Some(&story.before)), ("after", story.after.as_ref())];
    let tracks = tracks.into_iter().filter_map(|(name, fit)| Some((name, fit?.flight.track.as_slice())));
    sections.push(parts::navigation(tracks));
    sections.push(parts::forest(&last.outcome.parameters, &|_| 0.0, truth).folded());
    sections.push(parts::numbers(&last.outcome.parameters, &|i| last.outcome.converged(i), truth).folded());
    let parameters = &last.outcome.parameters;
    let places: Vec<usize> = (0..parameters.len()).collect();
    sections.push(parts::convergence(parameters, &places, &last.outcome.history, truth));
    let mut residuals = |title: &str, prefix: &str, fit: &Fit| {
        let channels = fit.outcome.residuals.as_deref().unwrap_or_default();
        sections.push(parts::residuals(title, prefix, channels).folded());
    };
    match &story.after {
        Some(after) => {
            residuals("Residuals before", "before-", &story.before);
            residuals("Residuals after", "after-", after);
        }
        None => residuals("Residuals", "", &story.before),
    }
    sections.push(story.first.inputs().section());
    sections.extend(appendix);
    page.sections = sections;
    page.with_program()
        .with("seed", story.seed.to_string())
        .with("simulation", story.first.description.title.clone())
}

fn what_happened(story: &Story) -> Section {
    let found: Vec<&str> = story.found.effects.iter().map(|effect| effect.name.as_str()).collect();
    let found = if found.is_empty() { "nothing".to_owned() } else { found.join(" and ") };
    let mut lines = vec![
        format!(
            "Unit {} of the default population was drawn. Hidden in it: {}.",
            story.seed,
            hidden(story.hidden.info(), &story.truth)
        ),
        format!("It was simulated {}, and once more {}.", PATHS[0], PATHS[1]),
        format!(
            "{}, which lacks the effect, calibrated the first run: {}.",
            story.base,
            fit(&story.before, &story.truth)
        ),
        format!("The diagnosis was told neither what is hidden nor how large it is. It found: {found}."),
    ];
    if let Some(after) = &story.after {
        lines.push(format!(
            "The filter with what was found calibrated the first run again: {}.",
            fit(after, &story.truth)
        ));
    }
    lines.push(format!(
        "With each calibration the unit then navigated for {:.0} h while it swung.",
        story.before.flight.hours()
    ));
    Section::new("What happened", vec![Item::List(lines)])
}

/// The filters against each other and against the truth.
fn side_by_side(story: &Story) -> Section {
    let row = |name: &str, fit: &Fit| {
        vec![
            text(name),
            number(fit.outcome.parameters.len().to_string()),
            number(format!("{:.3}", fit.outcome.statistics.nis_per_dof())),
            number(format!("{:.1}", fit.outcome.statistics.log_likelihood)),
            number(significant(largest_error(&fit.outcome.parameters, &story.truth))),
            number(format!("{:.3}", fit.flight.largest())),
            number(format!("{:.3}", fit.flight.last())),
        ]
    };
    let mut rows = vec![row(story.base, &story.before)];
    if let Some(after) = &story.after {
        let names: Vec<&str> = story.found.effects.iter().map(|effect| effect.name.as_str()).collect();
        rows.push(row(&format!("{} + {}", story.base, names.join(" + ")), after));
    }
    let head = [
        "filter",
        "parameters",
        "NIS per degree of freedom",
        "log-likelihood",
        "largest error of a parameter, sigmas",
        "largest error of navigation, nmi",
        "at the end, nmi",
    ];
    Section::new("What the finding is worth", vec![Table::new("", &head, rows).into()])
}
