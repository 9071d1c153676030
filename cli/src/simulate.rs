//! `sinscal simulate`: writes the log of a simulated unit.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use miette::{Result, miette};
use rig::{DEFAULT_SCENARIO, Description, Simulation, Truth};
use sinscal::Sample;

use crate::origin::Documented as _;
use crate::output::{self, Files, Sources};
use crate::table::{self, Cells, TableWriter};
use crate::vocabulary::vocabulary;
use crate::{say, scenario};
use reports::Inputs;
use reports::figures::significant;
use reports::{Report, Section, Table, Tone, number, text};

/// How the title of a simulated log's page begins.
const PAGE: &str = "Simulated log ";
/// Rows per piece of the written table.
const ROWS: usize = 32_768;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal simulate --out runs/unit-3 --seed 3
  sinscal simulate --print-scenario
  sinscal simulate --scenario mine.toml --rate 100 --out runs/mine";

/// Simulate a unit on its path and write the log, its description, the truth and a page that shows them
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Where the log goes: DIR/NAME becomes DIR/NAME.parquet, DIR/NAME.toml, DIR/NAME.truth.json and DIR/NAME.html
    #[arg(long, value_name = "DIR/NAME", required_unless_present = "print_scenario")]
    out: Option<PathBuf>,
    /// What is simulated; without it the default scenario
    #[arg(long, value_name = "FILE.toml")]
    scenario: Option<PathBuf>,
    /// Which unit of the scenario's population
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Sampling rate instead of the scenario's
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Print the default scenario with its comments, and do nothing else
    #[arg(long)]
    print_scenario: bool,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        if self.print_scenario {
            return output::print(DEFAULT_SCENARIO);
        }
        let Some(out) = &self.out else { return Err(miette!("--out DIR/NAME is missing")) };
        let (Some(folder), Some(name)) = (out.parent(), out.file_name().and_then(|name| name.to_str()))
        else {
            return Err(miette!("--out {}: DIR/NAME was expected", out.display()));
        };
        output::check_folder(folder)?;
        let path = |ending: &str| folder.join(format!("{name}{ending}"));
        let mut sources = Sources::default();
        self.scenario.iter().for_each(|scenario| sources.add(scenario));
        let mut files = Files::beside(sources);
        for (ending, is_ours) in OURS {
            let path = path(ending);
            if path.exists() {
                files.check(&path)?;
            }
            if path.is_file() && !is_ours(&path).unwrap_or(false) {
                return Err(miette!(
                    help = "name another place with --out, or take this file away",
                    "{}: `sinscal simulate` did not write this file, and does not write over it",
                    path.display()
                ));
            }
        }
        let mut scenario = scenario::load(self.scenario.as_deref())?;
        if let Some(rate) = self.rate {
            scenario = scenario.with_rate(rate).map_err(|error| scenario::refused(None, error.faults))?;
        }
        let simulation =
            Simulation::new(&scenario, self.seed).map_err(|error| scenario::refused(None, error.faults))?;

        let description = simulation.description().clone();
        let mut truth = simulation.truth().clone();
        let samples = simulation.samples();
        if !folder.as_os_str().is_empty() {
            files.folder(folder)?;
        }
        let mut inputs = Inputs::new();
        files.write(&path(".parquet"), |file| {
            truth = write_table(simulation, &description, &mut inputs, file)?;
            Ok(())
        })?;
        files.write(&path(".toml"), |file| file.write_all(description.to_toml().as_bytes()))?;
        files.write(&path(".truth.json"), |file| file.write_all(truth.to_json().as_bytes()))?;
        let verdict = format!("unit {}, {samples} samples in {:.0} s", self.seed, scenario.duration());
        let page = page(format!("{PAGE}{name}"), verdict, &truth, &inputs).with_program();
        page.with("seed", self.seed.to_string())
            .with_scenario(self.scenario.as_deref())
            .write_page(&mut files, &path(".html"))?;
        files.commit()?;
        say::remark(&format!(
            "{}: {samples} samples of unit {}, {:.0} s",
            path(".parquet").display(),
            self.seed,
            scenario.duration()
        ));
        Ok(())
    }
}

/// Whether a file is one that `simulate` wrote.
type IsOurs = fn(&Path) -> io::Result<bool>;

/// The files of a simulated log, and what says that a file by such a name is one.
const OURS: [(&str, IsOurs); 4] = [
    (".toml", |path| Ok(part(path, false)?.starts_with(format!("# {}", Description::MARK).as_bytes()))),
    (".parquet", |path| Ok(holds(&part(path, true)?, Description::MARK))),
    (".truth.json", |path| {
        let truth: BTreeMap<String, Vec<f64>> = serde_json::from_slice(&part(path, false)?)?;
        Ok(truth.keys().all(|name| vocabulary().effect(name).is_ok()))
    }),
    (".html", |path| Ok(holds(&part(path, false)?, PAGE))),
];

/// So much of a file is looked at, bytes: a truth is smaller, and a table's title stands within its last kilobyte.
const PART: u64 = 1 << 16;

/// The beginning of a file, or its end.
fn part(path: &Path, end: bool) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    if end {
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(PART)))?;
    }
    let mut bytes = Vec::new();
    file.take(PART).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn holds(bytes: &[u8], mark: &str) -> bool {
    bytes.windows(mark.len()).any(|window| window == mark.as_bytes())
}

/// The unit and what it was put through.
fn page(title: String, verdict: String, truth: &Truth, inputs: &Inputs) -> Report {
    let mut rows = Vec::new();
    for (name, values) in truth.effects() {
        let Ok(effect) = vocabulary().effect(name).map(|effect| effect.info()) else { continue };
        for (component, value) in effect.components().iter().zip(values) {
            let sign = if *value < 0.0 { "-" } else { "" };
            let figure = number(format!("{sign}{}", significant(value.abs() / effect.sheet_scale)));
            rows.push(vec![text(format!("{name} {component}")), figure, text(effect.sheet_unit)]);
        }
    }
    let table = Table::new("", &["parameter", "true value", "unit"], rows);
    Report {
        title,
        verdict,
        tone: Tone::Neutral,
        facts: Vec::new(),
        sections: vec![Section::new("The true unit", vec![table.into()]), inputs.section()],
        origin: Vec::new(),
        attachments: Vec::new(),
    }
}

/// One column: its name and what of a sample stands in it.
type Column = (String, Box<dyn Fn(&Sample) -> f64>);

/// The columns that a log of this description has.
fn columns(description: &Description) -> Vec<Column> {
    let mut columns: Vec<Column> = vec![("time_s".into(), Box::new(|s| s.time))];
    let mut vector = |name: &str, axes: [&str; 3], of: fn(&Sample) -> [f64; 3]| {
        for (i, axis) in axes.into_iter().enumerate() {
            columns.push((format!("{name}_{axis}"), Box::new(move |s| of(s)[i])));
        }
    };
    let (body, level) = (["x", "y", "z"], ["e", "n", "u"]);
    vector("dtheta", body, |s| s.dtheta.into());
    vector("dvel", body, |s| s.dvel.into());
    vector("temp", body, |s| s.temperature.into());
    vector("temp_gyro", body, |s| s.gyro_temperature.into());
    if description.dither {
        vector("dither", body, |s| s.dither.into());
    }
    if description.readings {
        vector("ref_vel", level, |s| s.reference.velocity.map_or([f64::NAN; 3], Into::into));
        vector("ref_pos", level, |s| s.reference.position.map_or([f64::NAN; 3], Into::into));
    }
    if description.attitude {
        for (i, part) in ["w", "x", "y", "z"].into_iter().enumerate() {
            let of = move |s: &Sample| s.reference.attitude.map_or(f64::NAN, |q| [q.w, q.i, q.j, q.k][i]);
            columns.push((format!("ref_quat_{part}"), Box::new(of)));
        }
    }
    columns
}

/// Writes the samples as they are simulated: a batch is all that is held. Returns the truth at the end.
fn write_table(
    simulation: Simulation,
    description: &Description,
    inputs: &mut Inputs,
    file: &mut (dyn Write + Send),
) -> io::Result<Truth> {
    let columns = columns(description);
    let cells = |piece: &[Sample]| -> Vec<table::Column> {
        let cells = |of: &dyn Fn(&Sample) -> f64| Cells::Numbers(piece.iter().map(of).collect());
        columns.iter().map(|(name, of)| (name.clone(), cells(of))).collect()
    };
    let mut writer = TableWriter::new(file, &cells(&[]), &description.title)?;
    let bar = say::progress_bar(simulation.samples(), "simulating");
    let mut samples = simulation;
    loop {
        let piece: Vec<Sample> = samples.by_ref().take(ROWS).collect();
        if piece.is_empty() {
            break;
        }
        piece.iter().for_each(|sample| inputs.push(sample));
        writer.write(&cells(&piece))?;
        bar.inc(piece.len() as u64);
    }
    bar.finish_and_clear();
    writer.finish()?;
    Ok(samples.truth().clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_follow_the_description() {
        let simulation = Simulation::new(&rig::Scenario::default(), 1).expect("the default scenario");
        let names: Vec<String> =
            columns(simulation.description()).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names.len(), 1 + 3 * 5 + 6);
        assert_eq!(names[0], "time_s");
        assert!(!names.iter().any(|name| name.starts_with("ref_quat")));
    }
}
