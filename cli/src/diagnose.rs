//! `sinscal diagnose`: finds the effect that a filter lacks.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use gap::menu::Menu;
use gap::{Diagnosis, LogGap, Options, Verdict, Which};
use miette::{IntoDiagnostic, Report, Result, miette};
use runs::AnyFilter;
use sinscal::{Coarse, Setup, SiteShown};

use crate::arguments::{self, Columns, Results};
use crate::compose::Change;
use crate::origin::{Documented as _, inputs};
use crate::setup::Beginning;
use crate::source::{Source, unreadable};
use crate::vocabulary::vocabulary;
use crate::{say, self_test, setup};
use logs::Log;
use logs::units::DEGREE;
use reports::diagnosis::{self, tenths};

/// Name of the Rust file with the extended filter.
const DECLARATION: &str = "extended_filter.rs";

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal diagnose runs/unit-3 --filter 36d-p --out findings
  sinscal diagnose runs/unit-3 --filter 36d-p --verify runs/unit-3-again
  sinscal diagnose runs/monday runs/tuesday runs/friday --filter 36d-p
  sinscal diagnose --self-test 20 --seed 9000

With --out: report.html, diagnosis.json, diagnosis.txt, extended_filter.rs (the filter with what was found) and the figures.";

/// Find the effect that a filter lacks: where it shows, which it is, and whether adding it closes the gap
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// One log or several of one unit, whose evidence adds: path of table or description, with or without ending
    #[arg(value_name = "LOG", required_unless_present = "self_test")]
    logs: Vec<PathBuf>,
    #[command(flatten)]
    columns: Columns,
    /// The filter to begin with; `sinscal filters` describes them
    #[arg(long, value_name = "NAME", ignore_case = true, required_unless_present = "self_test",
          value_parser = arguments::filter())]
    filter: Option<Arc<dyn AnyFilter>>,
    #[command(flatten)]
    change: Change,
    #[command(flatten)]
    beginning: Beginning,
    /// A second log of the same unit, on another path or day, to confirm what the first one shows
    #[arg(long, value_name = "LOG2")]
    verify: Option<PathBuf>,
    /// Hide something in N simulated units, diagnose each, and print how often that went right
    #[arg(long, value_name = "N", conflicts_with_all = ["logs", "filter", "verify"],
          value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    self_test: Option<u64>,
    /// Of the simulated thresholds; of a self-test, that of its first unit
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    results: Results,
}

/// Refuses to look for what the coarse stage takes out of the samples.
fn lacks_nothing_coarse(log: &Log, filter: &dyn AnyFilter) -> Result<()> {
    let blocks = filter.blocks();
    let lacks = |name: &&&str| blocks.iter().all(|leaf| leaf.name != **name);
    match Coarse::EFFECTS.iter().find(lacks).filter(|_| log.coarse().is_some()) {
        Some(name) => Err(miette!(
            help = "a filter that has it can be diagnosed with the coarse stage, and this one without it, within the priors",
            "{}: the coarse stage takes {name} out of the samples, which {} lacks",
            log.table().display(),
            filter.title()
        )),
        None => Ok(()),
    }
}

/// What went wrong with a log.
fn fault(log: &Log, error: gap::Error) -> miette::Report {
    match error {
        gap::Error::Unreadable { source, .. } => unreadable(log, source),
        error => miette!("{}: {error}", log.table().display()),
    }
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        let filter = match &self.filter {
            Some(filter) if !self.logs.is_empty() => self.change.of(filter)?,
            // the parser of the command line lets nothing else through
            _ => return self_test::run(self.self_test.unwrap_or(1), self.seed, target),
        };
        let open = |log: &Path| arguments::open_for(log, &self.columns, &*filter, self.beginning);
        let logs = self.logs.iter().map(|log| open(log)).collect::<Result<Vec<_>>>()?;
        let second = self.verify.as_deref().map(open).transpose()?;
        logs.iter().chain(&second).try_for_each(|log| lacks_nothing_coarse(log, &*filter))?;
        let filter = arguments::wandering(&filter, &logs[0])?;
        let filter = &*filter;
        self.change.files().try_for_each(|path| target.reads(path))?;
        logs.iter().chain(&second).try_for_each(|log| target.reads_log(log))?;
        let setup = |log| Ok::<_, Report>(setup::of(log, setup::initial(log)?));
        let setups = logs.iter().chain(&second).map(setup).collect::<Result<Vec<_>>>()?;
        let samples: Vec<Source> = logs.iter().chain(&second).map(Source::silent).collect();
        let taken = samples.iter().zip(&setups).map(|(samples, setup)| gap::Log { samples, setup });
        let mut taken: Vec<gap::Log> = taken.collect();
        let verify = taken.split_off(logs.len()).pop();
        for ((log, samples), setup) in logs.iter().zip(&samples).zip(&setups) {
            elsewhere(log, samples, setup)?;
        }
        let bar = say::progress_bar(100, "diagnosing");
        let options = Options { seed: self.seed, ..Options::default() };
        let effects = vocabulary().effects();
        let found = gap::diagnose(filter, effects, &taken, verify.as_ref(), &options, &mut |stage, done| {
            bar.set_message(stage);
            bar.set_position((100.0 * done) as u64);
        });
        bar.finish_and_clear();
        let mut found = found.map_err(|error| {
            let log = match error.which() {
                Some(Which::Verification) => second.as_ref(),
                Some(Which::Log(place)) => logs.get(place),
                _ => None,
            };
            fault(log.unwrap_or(&logs[0]), error)
        })?;
        if matches!(found.verdict, Verdict::Ambiguous | Verdict::NotConfirmed) {
            plan(filter, &mut found)?;
        }
        if let (Some(folder), Some(_)) = (&self.results.out, &found.source) {
            found.declaration = Some(folder.join(DECLARATION).display().to_string());
        }
        let is_found = found.verdict == Verdict::EffectsFound || !found.laws.is_empty();
        let next = self.results.out.as_deref().filter(|_| is_found).map(|out| {
            let from = out.join("diagnosis.json");
            let (from, name) = (from.display(), filter.name());
            format!(
                "  sinscal calibrate LOG --filter {name} --with {from}\n  sinscal new my-unit --from {from}"
            )
        });
        let json = serde_json::to_string_pretty(&found).into_diagnostic()? + "\n";
        target.write("diagnosis", &json, &text(&found, next.as_deref()), &found.sentence, |files, folder| {
            if let Some(source) = &found.source {
                files.write(&folder.join(DECLARATION), |file| file.write_all(source.as_bytes()))?;
            }
            let tables: Vec<String> = logs.iter().map(|log| log.table().display().to_string()).collect();
            let title = format!("What {} lacks on {}", filter.title(), tables.join(" and "));
            let mut page = diagnosis::report(&found, title);
            page.sections.push(inputs(&logs[0])?.section());
            page = page.with_program().with("seed", self.seed.to_string());
            page = logs.iter().chain(&second).fold(page, |page, log| page.with_log(log));
            page.write(files, folder)
        })
    }
}

/// Refuses a log that was taken somewhere else: what an Earth rate of another direction leaves looks like errors of the unit.
fn elsewhere(log: &Log, samples: &Source<'_>, setup: &Setup<'_>) -> Result<()> {
    let shown = runs::site_shown(samples, setup).map_err(|error| unreadable(log, error))?;
    match shown.filter(|shown| shown.is_elsewhere(&setup.site)) {
        Some(SiteShown { latitude: (latitude, sigma), positions, .. }) => Err(miette!(
            help = "mend latitude_deg in [site] first: an Earth rate of another direction looks like errors of the unit",
            "{}: its rests in {positions} positions show a latitude of {:.3} +- {:.3} deg, {:.3} is stated",
            log.table().display(),
            latitude / DEGREE,
            sigma / DEGREE,
            setup.site.latitude / DEGREE
        )),
        None => Ok(()),
    }
}

/// Where the log does not decide, the run that would: simulated, so it is worth its seconds only then.
fn plan(filter: &dyn AnyFilter, found: &mut Diagnosis) -> Result<()> {
    if filter.measures() != ["velocity", "position"] {
        return Ok(());
    }
    let menu = Menu::new(filter, vocabulary().effects()).into_diagnostic()?;
    let undecided = found.undecided();
    found.next_run.splice(0..0, undecided.iter().filter_map(|(effect, other)| menu.sentence(effect, other)));
    Ok(())
}

/// The finding for people: the sentence, then the evidence.
fn text(found: &Diagnosis, next: Option<&str>) -> String {
    let mut text = say::folded(&format!("{}\n", found.sentence), 0);
    // Writing to a string does not fail.
    for note in &found.notes {
        text += &say::folded(&format!("- {note}\n"), 2);
    }
    let noise = &found.noise_scale;
    let _ = writeln!(
        text,
        "\nnoise against the description: gyro {:.2}, accelerometer {:.2}, reference {:.2}",
        noise.gyro, noise.accel, noise.reference
    );
    if let Some(gap) = &found.gap {
        before_and_after(found.called(), &gap.fit, &mut text);
        if let Some(verify) = &gap.verify {
            before_and_after("the second log", verify, &mut text);
        }
    }
    if !found.rivals.is_empty() {
        text.push_str("\nlog-likelihood that each effect gains by itself and on top of what was found, and what was found on top of it:\n");
        let _ = writeln!(
            text,
            "\n{:28} {:>12} {:>12} {:>12} {:>12} {:>12}",
            "effect", "by itself", "on top", "found adds", "-log10 p", "then"
        );
        let mut rivals: Vec<_> = found.rivals.iter().collect();
        rivals.sort_by(|a, b| b.gain_alone.total_cmp(&a.gain_alone));
        // what was found has no place on top of itself
        let is_found = |name: &str| found.effects.iter().any(|effect| effect.name == name);
        for rival in rivals.into_iter().take(8) {
            let other = |number: f64| if is_found(&rival.name) { "-".into() } else { tenths(number) };
            let _ = writeln!(
                text,
                "{:28} {:>12} {:>12} {:>12} {:>12} {:>12}",
                rival.name,
                tenths(rival.gain_alone),
                other(rival.gain_on_top),
                other(rival.chosen_on_top),
                tenths(-rival.log10_p_before),
                other(-rival.log10_p_after)
            );
        }
    }
    if !found.r#where.is_empty() {
        let _ = writeln!(text, "\n{:>10} {:>10}  {:10} {:>10}", "from s", "to s", "channel", "gain");
        for place in found.r#where.iter().take(8) {
            let _ = writeln!(
                text,
                "{:10.1} {:10.1}  {:10} {:10.1}",
                place.start_s, place.end_s, place.channel, place.gain
            );
        }
    }
    next_runs(found, &mut text);
    if let Some(source) = &found.source {
        let _ = writeln!(text, "\nthe filter with what was found:\n\n{source}");
    }
    if let Some(next) = next {
        let _ = writeln!(text, "next, on another log of the unit:\n{next}");
    }
    text
}

/// The gap on one log, without and with what was found.
fn before_and_after(log: &str, gap: &LogGap, text: &mut String) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "\n{log:54} {:>12} {:>12}", "before", "after");
    let mut line = |what: String, before: f64, after: f64, digits: usize| {
        let _ = writeln!(text, "{what:54} {before:>12.digits$} {after:>12.digits$}");
    };
    line("normalised innovations, root mean square".into(), gap.rms_before, gap.rms_after, 2);
    line("log-likelihood".into(), gap.log_likelihood_before, gap.log_likelihood_after, 0);
    let unit = if gap.free_run_of == "velocity" { "m/s" } else { "m" };
    let predicted =
        format!("{} predicted over {:.0} s without updates, {unit}", gap.free_run_of, gap.horizon_s);
    line(predicted, gap.free_run_before, gap.free_run_after, 5);
    if let Some(horizontal) = &gap.horizontal {
        let what = "free-inertial with the first log's values: horizontal, m";
        line(what.into(), horizontal.before_m, horizontal.after_m, 0);
    }
}

/// What the next run should do: one line for each way to run, with the pairs that it would tell apart.
fn next_runs(found: &Diagnosis, text: &mut String) {
    let mut ways: Vec<(&str, Vec<&str>)> = Vec::new();
    for line in &found.next_run {
        let (pair, way) = line.split_once(": ").unwrap_or(("", line));
        match ways.iter_mut().find(|(known, _)| *known == way) {
            Some((_, pairs)) => pairs.push(pair),
            None => ways.push((way, vec![pair])),
        }
    }
    if !ways.is_empty() {
        text.push_str("\nwhat another run could tell apart:\n");
    }
    for (way, pairs) in ways {
        let _ = writeln!(text, "- {way} ({})", pairs.join("; "));
    }
}
