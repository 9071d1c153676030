//! Measures what docs/PERFORMANCE.md tells, and writes its tables and plots anew.
//!
//! `cargo run --manifest-path benches/report/Cargo.toml` runs all parts, about a quarter of an hour on an idle
//! machine; `... -- cycle log` runs these two. A part fills what stands between the comments with its name in the
//! text, and is left as it is where a tool is missing or a command fails.

mod clocks;
mod parts;
mod plots;
mod run;

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use run::{Error, Place};

/// What a part has measured: Markdown, and the name of the comments it goes between.
type Section = (&'static str, String);
/// A part: its name, and what it runs.
type Part = (&'static str, fn(&Place) -> Result<Vec<Section>, Error>);

const PARTS: [Part; 12] = [
    ("machine", parts::machine),
    ("cycle", parts::cycle),
    ("growth", parts::growth),
    ("clocks", clocks::clocks),
    ("instructions", parts::instructions),
    ("stack", parts::stack),
    ("whole", parts::whole),
    ("campaign", parts::campaign),
    ("log", parts::log),
    ("single", parts::single),
    ("compile", parts::compile),
    ("build", parts::build),
];

/// Puts `content` between the comments `name` and `end`.
fn fill(text: &str, name: &str, content: &str) -> Option<String> {
    let begin = format!("<!-- {name} -->\n");
    let from = text.find(&begin)? + begin.len();
    let to = from + text[from..].find("<!-- end -->")?;
    Some(format!("{}\n{}\n\n{}", &text[..from], content.trim_end(), &text[to..]))
}

/// Writes what a part has found into the text.
fn write(document: &Path, sections: &[Section]) -> Result<(), Error> {
    let mut text = std::fs::read_to_string(document)?;
    for (name, content) in sections {
        text = fill(&text, name, content).ok_or(format!("{} has no part {name}", document.display()))?;
    }
    run::replace(document, &text)
}

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let known = PARTS.map(|(name, _)| name);
    if let Some(odd) = wanted.iter().find(|name| !known.contains(&name.as_str())) {
        eprintln!("no part is called {odd}: {}", known.join(", "));
        return ExitCode::from(2);
    }
    let place = Place::new();
    let mut status = ExitCode::SUCCESS;
    for (name, part) in PARTS {
        if !wanted.is_empty() && !wanted.iter().any(|wanted| wanted == name) {
            continue;
        }
        let begin = Instant::now();
        match part(&place).and_then(|sections| write(&place.document(), &sections)) {
            Ok(()) => println!("{name}: {:.0} s", begin.elapsed().as_secs_f64()),
            Err(Error::Missing(tool)) => println!("{name}: left as it is, there is no {tool}"),
            Err(Error::Failed(why)) => {
                println!("{name}: left as it is, {why}");
                status = ExitCode::FAILURE;
            }
        }
    }
    status
}
