//! How a log is read: what the command line and the description say about it, the command line first.

use std::path::PathBuf;

use sinscal::EffectInfo;

use super::axes::Axes;
use super::increments::Values;
use super::map::ColumnMap;
use super::stamps::Stamps;

/// How a log is read.
#[derive(Clone, Debug, Default)]
pub struct Reading {
    /// Which variables of the file are the columns of the format.
    pub map: ColumnMap,
    /// Which way its axes point.
    pub axes: Axes,
    /// What its stamps are worth; without, they are trusted as far as they can be.
    pub stamps: Option<Stamps>,
    /// Names of the columns of a text without names.
    pub columns: Option<Vec<String>>,
    /// Gaps of up to so many seconds are filled with interpolated rows.
    pub bridge: Option<f64>,
    /// File whose table `[noise]` goes before that of the description.
    pub noise: Option<PathBuf>,
    /// Columns that measurements of the program's own read, in the order of [`Reference::own`](sinscal::Reference::own), SI.
    pub own: Vec<String>,
    /// Effects of the program's own, of which the description may state priors.
    pub effects: Vec<&'static EffectInfo>,
    /// What its rates are.
    pub values: Option<Values>,
}

impl Reading {
    /// What `self` says, and what it leaves open from `other`. Of two maps the first goes before.
    pub fn or(&self, other: &Self) -> Self {
        Self {
            map: if self.map.is_empty() { other.map.clone() } else { self.map.clone() },
            axes: self.axes.clone().or(&other.axes),
            stamps: self.stamps.or(other.stamps),
            columns: self.columns.clone().or_else(|| other.columns.clone()),
            bridge: self.bridge.or(other.bridge),
            noise: self.noise.clone().or_else(|| other.noise.clone()),
            effects: if self.effects.is_empty() { other.effects.clone() } else { self.effects.clone() },
            own: if self.own.is_empty() { other.own.clone() } else { self.own.clone() },
            values: self.values.or(other.values),
        }
    }
}

/// Reads names of columns with commas between.
///
/// # Errors
/// When there is none.
pub fn column_names(text: &str) -> Result<Vec<String>, String> {
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_owned()).collect();
    if names.iter().all(String::is_empty) {
        return Err("names with commas between were expected, such as t,wx,wy,wz,ax,ay,az".into());
    }
    Ok(names)
}
