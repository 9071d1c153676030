//! A calibration as a certificate: what a laboratory hands out and signs.

use std::path::Path;

use miette::{Result, miette};
use reports::figures::{decimals, significant};
use reports::{Item, Report, Section, Table, Tone, number, parts, text};
use serde_json::Value;

use crate::navigate;
use crate::origin::Documented as _;

/// Coverage factor of expanded uncertainties.
const COVERAGE: f64 = 2.0;

/// Shares of a variance that are named.
const WORTH_A_WORD: f64 = 0.05;

/// What stands for a line to sign on.
const LINE: &str = "____________________";

/// The page.
pub(super) fn certificate(path: &Path) -> Result<String> {
    let (calibrated, document) = navigate::read::read(path)?;
    let known = calibrated.filter.parameters();
    let said = |field: &str| document[field].as_str();
    let verdict = said("verdict").unwrap_or("not stated");
    let (kind, meaning) = kind(&document);
    let mut rows = Vec::new();
    let mut left_out = Vec::new();
    for (index, (name, component, value)) in calibrated.values.iter().enumerate() {
        let info = known.iter().find(|info| info.block == *name && info.component == *component);
        let Some(info) = info else { continue };
        let Some(value) = value else {
            left_out.push(parts::name(info));
            continue;
        };
        let sigma = navigate::read::sigma(path, &document, index)?;
        let (value, sigma) = (value / info.sheet_scale, sigma / info.sheet_scale);
        let digits = decimals(sigma);
        rows.push(vec![
            text(parts::name(info)),
            number(format!("{value:.digits$}")),
            text(info.sheet_unit),
            number(format!("{sigma:.digits$}")),
            number(format!("{:.digits$}", COVERAGE * sigma)),
            text(made_of(&document["parameters"][index]).unwrap_or_else(|| kind.to_owned())),
        ]);
    }
    if rows.is_empty() {
        return Err(miette!("{}: nothing was estimated, so there is nothing to certify", path.display()));
    }
    let unit = said("log").map(Path::new).and_then(Path::file_stem).and_then(|stem| stem.to_str());
    let unit = unit.unwrap_or("not stated");
    let estimated = rows.len();
    let head = [
        "parameter",
        "value",
        "unit",
        "standard uncertainty u",
        "expanded uncertainty U = 2 u",
        "kind of u, or what it is made of",
    ];
    let caption = format!(
        "Values are errors of the unit: what its sensors read too much, by the equations of `sinscal effects`. {meaning} U holds \
         about 95 %."
    );
    let mut values: Vec<Item> = vec![Table::new(caption, &head, rows).into()];
    if !left_out.is_empty() {
        values.push(Item::text(format!("Not determined by this run: {}.", left_out.join(", "))));
    }
    let signed =
        ["Calibrated by", "Approved by"].map(|what| vec![text(what), text(LINE), text("Date"), text(LINE)]);
    let (title, tone) = match verdict {
        "fits" => ("its filter fits its log", Tone::Good),
        "does-not-fit" => ("its filter does not fit its log: the uncertainties are too small", Tone::Bad),
        "passes-disagree" => ("its passes disagree: the values are not settled", Tone::Bad),
        "no-power" => ("its log cannot tell whether the filter fits", Tone::Neutral),
        _ => ("no verdict is stated", Tone::Neutral),
    };
    let mut page = Report {
        title: "Calibration certificate".into(),
        verdict: format!("Unit {unit}: {estimated} parameters calibrated; {title}"),
        tone,
        facts: [
            ("unit", unit.to_owned()),
            ("filter", calibrated.filter.title()),
            ("verdict", verdict.to_owned()),
        ]
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .chain(document["duration_s"].as_f64().map(|s| ("duration".into(), format!("{s:.0} s"))))
        .collect(),
        sections: vec![
            Section::new("Values", values),
            Section::new("Conditions", vec![conditions(&document)]),
            Section::new("Signatures", vec![Table::new("", &["", "", "", ""], signed.to_vec()).into()]),
        ],
        origin: Vec::new(),
        attachments: Vec::new(),
    }
    .with_program()
    .with_file("calibration", path);
    if let Some(log) = said("log").map(Path::new) {
        page = match log.is_file() {
            true => page.with_file("log", log),
            false => page.with("log", format!("{}, which is not here to be summed", log.display())),
        };
    }
    page.page().map_err(|error| miette!("{error}"))
}

/// What the standard deviations of a calibration are: in a word, and in a sentence.
fn kind(document: &Value) -> (&'static str, &'static str) {
    let all = || document["parameters"].as_array().into_iter().flatten();
    let widened = |parameter: &Value| {
        let figure = |field: &str| parameter[field].as_f64();
        figure("sigma")
            .zip(figure("sigma_formal"))
            .is_some_and(|(sigma, formal)| sigma > formal * (1.0 + 1e-9))
    };
    let considered = document["considered"].as_array().is_some_and(|blocks| !blocks.is_empty());
    if considered || all().any(|parameter| parameter["budget"].is_object()) {
        ("A and B", "u combines what the filter says (A) with what is known of the chain of measurement (B).")
    } else if all().any(widened) {
        (
            "A, widened",
            "u is what the filter says of itself, widened to what the log shows of how its estimates repeat (type A).",
        )
    } else {
        ("A, formal", "u is what the filter says of itself, for the noise that was stated (type A).")
    }
}

/// What contributes most to the variance of a parameter, where its budget was asked for.
fn made_of(parameter: &Value) -> Option<String> {
    let sigma = parameter["sigma"].as_f64()?;
    let parts = parameter["budget"].as_object()?.iter();
    let shares = parts.filter_map(|(name, part)| Some((name, (part.as_f64()? / sigma).powi(2))));
    let mut shares: Vec<(&String, f64)> = shares.filter(|(_, share)| *share > WORTH_A_WORD).collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let said = shares.iter().map(|(name, share)| format!("{name} {:.0} %", 100.0 * share));
    Some(said.collect::<Vec<_>>().join(", "))
}

/// The run in figures.
fn conditions(document: &Value) -> Item {
    let mut rows: Vec<[String; 2]> = Vec::new();
    let mut put = |name: &str, value: Option<String>| rows.extend(value.map(|value| [name.into(), value]));
    let figure = |field: &str| document[field].as_f64();
    put("samples", document["samples"].as_u64().map(|n| n.to_string()));
    put("duration", figure("duration_s").map(|s| format!("{s:.1} s")));
    put(
        "temperature at which temperature effects vanish",
        figure("reference_temperature_c").map(|t| format!("{t} degC")),
    );
    put("updates by the reference", document["updates"].as_u64().map(|n| n.to_string()));
    put("of them refused as outliers", document["rejected"].as_u64().map(|n| n.to_string()));
    put("NIS per degree of freedom", figure("nis_per_dof").map(significant));
    put(
        "passes",
        document["passes"]
            .as_u64()
            .or(document["passes"].as_array().map(|p| p.len() as u64))
            .map(|n| n.to_string()),
    );
    for assumed in document["assumed"].as_array().into_iter().flatten() {
        put("assumed", assumed.as_str().map(str::to_owned));
    }
    let rows = rows.into_iter().map(|row| row.map(text).to_vec()).collect();
    Table::new("", &["condition", "value"], rows).into()
}
