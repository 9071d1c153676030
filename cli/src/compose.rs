//! `--with` and `--without`: what is added to a filter without compiling one, and what is left out.

use std::path::Path;
use std::sync::Arc;

use clap::Args;
use logs::suggest;
use miette::{Result, miette};
use runs::{AnyFilter, Error};
use serde_json::Value;

use crate::vocabulary::vocabulary;

/// Diagnoses are small; what is larger is some other file.
const LARGEST: u64 = 16 << 20;

/// What is changed about a filter.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Change {
    /// Effects that the filter is to have besides its own, separated by commas, or the diagnosis.json that found them
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    with: Vec<String>,
    /// Blocks that the filter is to do without, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    without: Vec<String>,
    /// Effects whose states the filter is to consider, separated by commas: they keep their priors, and what these make uncertain is in
    /// the sigmas of the others
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    consider: Vec<String>,
}

impl Change {
    /// Diagnoses that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.with.iter().filter(|entry| entry.ends_with(".json")).map(Path::new)
    }

    /// `base` with the change.
    pub(crate) fn of(&self, base: &Arc<dyn AnyFilter>) -> Result<Arc<dyn AnyFilter>> {
        let mut with: Vec<String> = Vec::new();
        for entry in &self.with {
            if entry.ends_with(".json") {
                with.extend(found(Path::new(entry))?);
            } else {
                with.push(entry.clone());
            }
        }
        let composed = compose(base.name(), &with, &self.without)?;
        considering(&composed, &names(&self.consider))
    }
}

/// `filter` with states of effects that are considered, by name.
pub(crate) fn considering(filter: &Arc<dyn AnyFilter>, considered: &[&str]) -> Result<Arc<dyn AnyFilter>> {
    let mut effects = Vec::new();
    for name in considered {
        effects.push(vocabulary().effect(name).map_err(|error| {
            let known = vocabulary().effects().iter().map(|effect| effect.name());
            miette!(help = suggest::hint(name, known), "--consider: {error}")
        })?);
    }
    runs::considering(filter, &effects).map_err(|error| miette!("--consider: {error}"))
}

/// The filter called `base` with effects added and blocks left out.
pub(crate) fn compose(base: &str, with: &[String], without: &[String]) -> Result<Arc<dyn AnyFilter>> {
    let composed = vocabulary().composed(base, &names(with), &names(without));
    composed.map_err(|error| match &error {
        Error::NoEffect { name } => {
            let known = vocabulary().effects().iter().map(|effect| effect.name());
            miette!(help = suggest::hint(name, known), "--with: {error}")
        }
        _ => miette!("{error}"),
    })
}

fn names(list: &[String]) -> Vec<&str> {
    list.iter().map(String::as_str).collect()
}

/// Names of the effects that a diagnosis has confirmed.
fn found(path: &Path) -> Result<Vec<String>> {
    base_of(path).map(|(_, found)| found)
}

/// The filter that a diagnosis was made with, and names of the effects that it has confirmed.
pub(crate) fn base_of(path: &Path) -> Result<(String, Vec<String>)> {
    let at = path.display();
    let what = "--with takes names of effects, or the diagnosis.json that `sinscal diagnose --out` writes";
    let unreadable = |error: std::io::Error| miette!("{at}: cannot be read: {error}");
    if std::fs::metadata(path).map_err(unreadable)?.len() > LARGEST {
        return Err(miette!(help = what, "{at}: is too large for a diagnosis"));
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    let document: Value = serde_json::from_slice(&bytes)
        .map_err(|error| miette!(help = what, "{at}: is not valid JSON: {error}"))?;
    let Some(verdict) = document["verdict"].as_str() else {
        return Err(miette!(help = what, "{at}, field `verdict`: a diagnosis was expected"));
    };
    let names: Option<Vec<String>> = document["effects"].as_array().map(|effects| {
        effects.iter().filter_map(|effect| effect["name"].as_str().map(str::to_owned)).collect()
    });
    match names {
        Some(names) if verdict == "effects-found" && !names.is_empty() => {
            Ok((document["base_filter"].as_str().unwrap_or_default().to_owned(), names))
        }
        _ => Err(miette!(
            help = "what is not confirmed can be tried by its name: --with EFFECT",
            "{at}: the diagnosis confirms no effect: its verdict is `{verdict}`"
        )),
    }
}
