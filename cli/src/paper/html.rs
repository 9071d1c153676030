//! The report of the reproduction: figures and tables in the order of the paper's conclusions, then all of it in words.

use super::{Findings, figures, report, size_effect};
use crate::campaign::html as campaign;
use crate::observe::html as observe;
use crate::origin::Documented as _;
use reports::{Item, Report, Section, Tone};

pub(super) fn page(findings: &Findings, text: &str) -> Report {
    let analysis = &findings.observability;
    let summary = &findings.summary;
    let mut navigation = campaign::navigation(summary, &findings.units);
    navigation.title = "Table 3 and Fig. 15: navigation".into();
    navigation.items.push(figures::navigation(findings).into());
    let mut degrees = observe::degrees(analysis);
    degrees.title = "Figs. 4 and 5: observability of 43d-b".into();
    let convergence = figures::convergences(findings).into_iter().map(Item::from).collect();
    let delay = size_effect::delay_figures(&findings.delay_errors).into_iter().map(Item::from).collect();
    let dither = size_effect::figures().into_iter().map(Item::from).collect();
    let mut sections = vec![navigation, campaign::consistency(summary), degrees];
    sections.push(Section::new("Figs. 7 to 14: estimates of the first unit", convergence));
    sections.extend(summary.filters.last().map(campaign::parameters));
    sections.push(Section::new("Fig. 3: delay of the accelerometers", delay));
    sections.push(Section::new("Eq. 8 and 9: size effect of dither", dither));
    sections.push(Section::new("In words, with the paper's values", vec![Item::Code(text.to_owned())]));
    Report {
        title: "Xing, Yang and Cai, Sensors 22(1):278, 2022, on the simulated rig".into(),
        verdict: report::verdict(findings),
        tone: Tone::Neutral,
        facts: vec![
            ("units".into(), summary.units.to_string()),
            ("navigation".into(), format!("{} h", findings.plan.hours)),
            ("rank of 43d-b".into(), format!("{} of {}", analysis.rank, analysis.states.len())),
            ("first unit".into(), findings.first.result.unit.to_string()),
        ],
        sections,
        origin: Vec::new(),
        attachments: Vec::new(),
    }
    .with_program()
    .with("passes", findings.plan.passes.to_string())
    .with("alignment", format!("{} s", findings.plan.alignment))
}
