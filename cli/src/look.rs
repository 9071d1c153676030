//! `sinscal look`: what a log holds, before anything is calibrated.

use std::path::{Path, PathBuf};

use clap::Args;
use logs::Look;
use logs::units::DEGREE;
use miette::{Result, miette};
use reports::{Cell, Inputs, Item, Report, Section, Table, Tone, number, text};

use crate::arguments::Columns;
use crate::origin::Documented as _;
use crate::output::{self, Files, Target};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal look runs/unit-3
  sinscal look walk.csv --map gyro=w:rad/s,accel=a:g,time=t --write-description walk.toml
  sinscal look data.txt --columns t,wx,wy,wz,ax,ay,az --map gyro=w:deg/s,accel=a:g,time=t:ms

It needs no description; where one lies beside the log it is heeded. With --out: look.json, look.txt and report.html.";

/// Show what a log holds: how it is read, rate, gaps, rests, noise, clipping, likely axes, and the description it suggests
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The log: path of its table, with or without ending
    log: PathBuf,
    #[command(flatten)]
    columns: Columns,
    /// Write the results as JSON; `-` writes them to standard output instead of the text
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write look.json, look.txt and report.html to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the suggested description to this file, which must not be there yet
    #[arg(long, value_name = "FILE")]
    write_description: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = Target::new(self.json.as_deref(), self.out.as_deref())?;
        target.reads_named(&self.log)?;
        if let Some(path) = &self.write_description {
            output::check_file(path)?;
            if path.exists() {
                return Err(miette!(
                    "{}: is there already: what a person wrote is not replaced",
                    path.display()
                ));
            }
        }
        let mut inputs = Inputs::new();
        let look = logs::look(&self.log, &self.columns.reading(), &mut |sample| inputs.push(sample))?;
        let json = serde_json::to_string_pretty(&look).map_err(|error| miette!("{error}"))? + "\n";
        let rests = look.rests.len();
        let verdict = match look.warnings.len() {
            0 => format!("{rests} rests, nothing odd"),
            1 => format!("{rests} rests, one warning"),
            more => format!("{rests} rests, {more} warnings"),
        };
        target.write("look", &json, &look.to_string(), &verdict, |files, folder| {
            page(&self.log, &look, &verdict, inputs.section()).write(files, folder)
        })?;
        if let Some(path) = &self.write_description {
            let mut files = Files::default();
            files.write(path, |file| file.write_all(look.description.as_bytes()))?;
            files.commit_new()?;
        }
        Ok(())
    }
}

/// A section of points, where there are any.
fn said(title: &str, points: Vec<String>) -> Option<Section> {
    (!points.is_empty()).then(|| Section::new(title, vec![Item::List(points)]))
}

/// What was found as a page.
fn page(log: &Path, look: &Look, verdict: &str, inputs: Section) -> Report {
    let three = |values: [f64; 3], size: f64, decimals: usize| {
        values.map(|value| number(format!("{:.decimals$}", value / size))).to_vec()
    };
    let row = |name: &str, values: Vec<Cell>, unit: &str| {
        [text(name)].into_iter().chain(values).chain([text(unit)]).collect::<Vec<_>>()
    };
    let mut figures = vec![
        row("mean rate", three(look.mean_rate_rad_s, DEGREE / 3600.0, 2), "deg/h"),
        row("mean specific force", three(look.mean_force_m_s2, 1.0, 5), "m/s^2"),
    ];
    if let Some(noise) = &look.noise {
        figures.push(row("angle random walk", three(noise.gyro_arw_deg_sqrt_h, 1.0, 5), "deg/sqrt(h)"));
        figures.push(row("velocity random walk", three(noise.accel_vrw_ug_sqrt_hz, 1.0, 2), "ug/sqrt(Hz)"));
    }
    let rests = look.rests.iter().map(|rest| {
        let mut cells = vec![number(format!("{:.2}", rest.start_s)), number(format!("{:.2}", rest.end_s))];
        cells.push(text(format!("{} to {}", rest.first_row, rest.last_row)));
        cells.extend(three(rest.force, 1.0, 4));
        cells.extend(three(rest.rate, DEGREE / 3600.0, 1));
        cells
    });
    let over = if look.rests.is_empty() { "Over all rows" } else { "In the rests" };
    let head = ["from s", "to s", "rows", "force x", "y", "z, m/s^2", "rate x", "y", "z, deg/h"];
    let mut found = look.read.clone();
    found.extend(look.likely_axes.iter().map(|axes| format!("likely axes: --axes {axes}")));
    let tone = if look.warnings.is_empty() { Tone::Good } else { Tone::Bad };
    Report {
        title: format!("A look at {}", log.display()),
        verdict: verdict.to_owned(),
        tone,
        facts: vec![
            ("rows".into(), look.samples.to_string()),
            ("length".into(), format!("{:.3} s", look.duration_s)),
            ("rate".into(), format!("{:.4} Hz", look.rate_hz)),
        ],
        sections: [
            said("What is odd", look.warnings.clone()),
            said("How it was read", found),
            Some(Section::new(over, vec![Table::new("", &["", "x", "y", "z", "unit"], figures).into()])),
            (rests.len() > 0)
                .then(|| Section::new("Rests", vec![Table::new("", &head, rests.collect()).into()])),
            Some(inputs),
        ]
        .into_iter()
        .flatten()
        .collect(),
        origin: Vec::new(),
        attachments: vec![("suggested description".into(), look.description.clone())],
    }
    .with_program()
}
