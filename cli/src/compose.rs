//! `--with` and `--without`: what is added to a filter without compiling one, and what is left out.

use std::path::Path;
use std::sync::Arc;

use clap::Args;
use logs::suggest;
use miette::{Result, miette};
use runs::{AnyFilter, Error};
use serde_json::Value;
use sinscal::Law;

use crate::vocabulary::vocabulary;

/// Diagnoses are small; what is larger is some other file.
const LARGEST: u64 = 16 << 20;

/// What is changed about a filter.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Change {
    /// Effects and laws that the filter is to have besides its own, separated by commas, or the diagnosis.json that found them
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
        self.beside(base.name(), Vec::new())
    }

    /// The filter called `base` with effects that were found, and the change.
    pub(crate) fn beside(&self, base: &str, mut with: Vec<String>) -> Result<Arc<dyn AnyFilter>> {
        for entry in &self.with {
            if entry.ends_with(".json") {
                with.extend(found(Path::new(entry))?);
            } else {
                with.push(entry.clone());
            }
        }
        let composed = compose(base, &with, &self.without)?;
        considering(&composed, &names(&self.consider))
    }
}

/// `filter` with states of effects that are considered, by name.
pub(crate) fn considering(filter: &Arc<dyn AnyFilter>, considered: &[&str]) -> Result<Arc<dyn AnyFilter>> {
    let mut effects = Vec::new();
    for name in considered {
        effects.push(
            vocabulary().effect(name).map_err(|error| miette!(help = meant(name), "--consider: {error}"))?,
        );
    }
    runs::considering(filter, &effects).map_err(|error| miette!("--consider: {error}"))
}

/// The filter called `base` with effects added and blocks left out.
pub(crate) fn compose(base: &str, with: &[String], without: &[String]) -> Result<Arc<dyn AnyFilter>> {
    let composed = vocabulary().composed(base, &names(with), &names(without));
    composed.map_err(|error| match &error {
        Error::NoEffect { name } => {
            miette!(help = meant(name), "--with: {error}")
        }
        _ => miette!("{error}"),
    })
}

/// What a name that nothing has may mean: an effect, or where it sounds like one a law.
fn meant(name: &str) -> String {
    let effects = vocabulary().effects().iter().map(|effect| effect.name().to_owned());
    let laws = [false, true].into_iter().filter(|_| name.contains("-by-")).flat_map(Law::all);
    let known: Vec<String> = effects.chain(laws.map(|law| law.name())).collect();
    suggest::hint(name, known.iter().map(String::as_str))
}

fn names(list: &[String]) -> Vec<&str> {
    list.iter().map(String::as_str).collect()
}

/// Names of the effects or laws that a diagnosis has confirmed.
fn found(path: &Path) -> Result<Vec<String>> {
    base_of(path).map(|(_, found)| found)
}

/// The filter that a diagnosis was made with, and names of the effects or laws that it has confirmed.
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
    let of = |list: &Value| -> Vec<String> {
        let named = |entry: &Value| entry["name"].as_str().map(str::to_owned);
        list.as_array().into_iter().flatten().filter_map(named).collect()
    };
    let (effects, laws) = (of(&document["effects"]), of(&document["laws"]));
    let beside = document["laws"].as_array().into_iter().flatten().flat_map(|law| {
        let beside = law["beside"].as_array().into_iter().flatten();
        beside.filter_map(Value::as_str).map(str::to_owned).collect::<Vec<_>>()
    });
    let names: Vec<String> = match verdict {
        "effects-found" => effects,
        // borne out by a second log, or they would not stand there
        "outside-library" => beside.chain(laws).collect(),
        _ => Vec::new(),
    };
    if names.is_empty() {
        return Err(miette!(
            help = "what is not confirmed can be tried by its name: --with EFFECT",
            "{at}: the diagnosis confirms no effect and no law: its verdict is `{verdict}`"
        ));
    }
    Ok((document["base_filter"].as_str().unwrap_or_default().to_owned(), names))
}
