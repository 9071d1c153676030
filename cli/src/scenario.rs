//! Scenario files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use miette::{Diagnostic, LabeledSpan, NamedSource, Report, Result, SourceCode, miette};
use rig::{Fault, Scenario};

use crate::vocabulary::vocabulary;

/// Scenarios are small; what is larger is some other file.
const LARGEST: u64 = 1 << 20;

/// Texts with longer lines are not shown around a fault.
const LONGEST_QUOTED: usize = 500;

/// The scenario in a file, or the default one.
pub(crate) fn load(path: Option<&Path>) -> Result<Scenario> {
    let Some(path) = path else { return Ok(Scenario::default()) };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes))
        .map_err(|error| miette!("{}: cannot be read: {error}", path.display()))?;
    if bytes.len() as u64 > LARGEST {
        return Err(miette!("{}: is larger than 1 MiB: this is not a scenario", path.display()));
    }
    let text = String::from_utf8(bytes)
        .map_err(|_| miette!("{}: is not text, a TOML scenario in UTF-8 was expected", path.display()))?;
    Scenario::parse_with(&text, &vocabulary().own_effects())
        .map_err(|error| refused(Some((path, &text)), error.faults))
}

/// All that is wrong with a scenario, with a caret where it stands in a file.
pub(crate) fn refused(file: Option<(&Path, &str)>, faults: Vec<Fault>) -> Report {
    // the column of a far place has no room in an excerpt
    let quoted = file.filter(|(_, text)| text.lines().all(|line| line.len() <= LONGEST_QUOTED));
    let name = file.map(|(path, _)| path.display().to_string());
    let mut faults = faults.into_iter().map(|fault| {
        let place = name.as_ref().map(|name| format!("{name}: ")).unwrap_or_default();
        Refused {
            message: format!("{place}{fault}"),
            span: fault.span.clone(),
            text: quoted.map(|(path, text)| NamedSource::new(path.display().to_string(), text.to_owned())),
            others: Vec::new(),
        }
    });
    match faults.next() {
        Some(mut first) => {
            first.others = faults.collect();
            first.into()
        }
        None => miette!("the scenario cannot be simulated"),
    }
}

/// One fault, with those found beside it.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
struct Refused {
    message: String,
    span: Option<std::ops::Range<usize>>,
    text: Option<NamedSource<String>>,
    others: Vec<Refused>,
}

impl Diagnostic for Refused {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.text.as_ref().filter(|_| self.span.is_some()).map(|text| text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.span.clone()?;
        Some(Box::new(std::iter::once(LabeledSpan::new(None, span.start, span.len()))))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.others.iter().map(|other| other as &dyn Diagnostic)))
    }
}
