//! Columns that the map names.

use crate::axes::{self, Pointing};
use crate::columns::Group;
use crate::map::{Entry, Unit};
use crate::names::{self, Found};
use crate::{suggest, written};

use super::{LOOKED_AT, Search, Variable, columns, short};

impl<'a> Search<'a> {
    /// Places what one entry of the map names: a variable of exactly that name, one with a selection of its columns, one with an
    /// offset, or several with a common pattern.
    pub(super) fn map(&mut self, entry: &Entry) {
        if let Some((fraction, unit)) = &entry.fraction {
            return self.map_fraction(entry, fraction, *unit);
        }
        if let Some(variable) = self.find(&entry.written).filter(|_| entry.columns.is_some()) {
            // the brackets are part of the name
            let whole = Entry { columns: None, variable: entry.written.clone(), ..entry.clone() };
            return self.map_variable(&whole, variable, 0.0);
        }
        if let Some(variable) = self.find(&entry.variable) {
            return self.map_variable(entry, variable, 0.0);
        }
        if self.map_components(entry, &entry.variable, 0.0) {
            return;
        }
        if let Some((variable, zero)) = offset(&entry.variable) {
            if let Some(found) = self.find(variable) {
                return self.map_variable(entry, found, zero);
            }
            if self.map_components(entry, variable, zero) {
                return;
            }
        }
        let names = self.variables.iter().map(|variable| variable.name.as_str()).take(LOOKED_AT);
        let problem = format!("is not in the file, but --map {}={} asks for it", entry.name, entry.text);
        let help = suggest::hint(&entry.variable, names);
        self.faults.push(self.about(&entry.variable, problem).help(help));
        self.settle(entry.group, usize::MAX);
    }

    /// A time in two columns.
    fn map_fraction(&mut self, entry: &Entry, fraction: &str, unit: Unit) {
        if let Some(variable) = self.find(&format!("{}+{fraction}", entry.variable)) {
            return self.map_variable(entry, variable, 0.0);
        }
        let seconds = Entry { fraction: None, ..entry.clone() };
        self.map(&seconds);
        let part = Entry {
            group: Group::TIME_NANOS,
            written: fraction.to_owned(),
            variable: fraction.to_owned(),
            unit: Some(unit),
            ..seconds
        };
        self.map(&part);
    }

    /// Places the columns of one variable.
    fn map_variable(&mut self, entry: &Entry, variable: usize, zero: f64) {
        let names = entry.group.names();
        let variables: &'a [Variable] = self.variables;
        let width = match &variables[variable].width {
            Ok(width) => *width,
            Err(holds) => return self.unfit(entry.group, variable, holds),
        };
        let mut wanted = entry.columns.clone().unwrap_or_else(|| (0..width.min(names.len() + 1)).collect());
        let problem = match wanted.iter().max() {
            Some(most) if *most >= width => {
                format!("has {}, counted from 0: there is no [{most}]", columns(width))
            }
            _ if wanted.len() == 1 && entry.group.may_be_shared() => {
                wanted.resize(names.len(), wanted[0]);
                return self.place_columns(entry, variable, &wanted, width, zero);
            }
            _ if wanted.len() != names.len() => {
                format!(
                    "has {}, `{}` needs {} ({})",
                    columns(width),
                    entry.name,
                    names.len(),
                    names.join(", ")
                )
            }
            _ => {
                if entry.group == Group::REF_QUAT && self.asked.axes.quaternion_is_scalar_last() {
                    wanted.rotate_right(1);
                }
                return self.place_columns(entry, variable, &wanted, width, zero);
            }
        };
        let help = format!("which ones? For instance {}={}[0:{}]", entry.name, entry.variable, names.len());
        let help = (width >= names.len()).then_some(help);
        self.faults.push(self.about(&entry.variable, problem).help_if(help));
        self.settle(entry.group, variable);
    }

    fn place_columns(&mut self, entry: &Entry, variable: usize, wanted: &[usize], width: usize, zero: f64) {
        let Some(unit) = self.unit(entry, variable, zero) else { return };
        for (slot, column) in entry.group.slots().zip(wanted) {
            let text = if width > 1 && entry.columns.is_none() {
                format!("{}[{column}]", entry.text)
            } else {
                entry.text.clone()
            };
            self.place(slot, variable, *column, unit, Some(text));
        }
    }

    /// The unit that an entry gives, or the name of the variable; a fault where they contradict each other.
    fn unit(&mut self, entry: &Entry, variable: usize, zero: f64) -> Option<Unit> {
        let said = self.names[variable].unit.clone();
        let read = said.as_ref().map(|said| written::unit(entry.group, said));
        let same = |a: &Unit, b: &Unit| {
            (a.scale / b.scale - 1.0).abs() < 1e-12 && a.zero == b.zero && a.per_interval == b.per_interval
        };
        let unit = match (entry.unit, read) {
            (Some(unit), Some(Ok(read))) if !same(&unit, &read) => {
                let said = said.unwrap_or_default();
                let help = format!(
                    "leave the unit out of --map where the name is right; where it is wrong, name the columns anew by --columns: {}={}",
                    entry.name, entry.text
                );
                let problem = format!(
                    "says {}, but --map {}={} says another unit",
                    short(&said),
                    entry.name,
                    entry.text
                );
                self.faults.push(self.about(&self.variables[variable].name, problem).help(help));
                self.settle(entry.group, variable);
                return None;
            }
            (Some(unit), _) => unit,
            (None, Some(Ok(read))) => {
                let note = format!(
                    "`{}` is read in {}, as its name says",
                    entry.name,
                    short(&said.unwrap_or_default())
                );
                if !self.notes.contains(&note) {
                    self.notes.push(note);
                }
                read
            }
            (None, Some(Err(error))) if error.starts_with("counts") => {
                self.faults.push(self.about(&self.variables[variable].name, format!("holds {error}")));
                self.settle(entry.group, variable);
                return None;
            }
            (None, _) => Unit { zero: 0.0, ..Unit::of_format(entry.group.first) },
        };
        Some(Unit { scale: unit.scale * entry.sign, zero: unit.zero + zero, ..unit })
    }

    /// A group as several variables with a common pattern: `gyro=w` is `w_x`, `w_y`, `w_z`, or `w.x`, `wX`, `w[0]`. Whether they
    /// are there.
    fn map_components(&mut self, entry: &Entry, variable: &str, zero: f64) -> bool {
        if entry.group.len == 1 || entry.columns.is_some() {
            return false;
        }
        let found = names::components(&self.names, variable, entry.group);
        let frame = |right: &str| format!("--axes reference={right} says so");
        let contradiction = match &found {
            Found::North(_) if self.asked.axes.reference() != axes::ned() => {
                Some(("are those of north, east, down", frame("ned")))
            }
            Found::East(_)
                if self.asked.axes.names_reference() && self.asked.axes.reference() != Pointing::OURS =>
            {
                Some(("are those of east, north, up", frame("enu")))
            }
            _ => None,
        };
        if let Some((problem, help)) = contradiction {
            let problem = format!("its names {problem}, and the axes of the reference are said to be others");
            self.faults.push(self.about(variable, problem).help(help));
            self.settle(entry.group, usize::MAX);
            return true;
        }
        let found = match found {
            Found::Nothing => return false,
            Found::Several(patterns) => {
                let help =
                    format!("say which: {}={}", entry.name, patterns.join(&format!(", or {}=", entry.name)));
                self.faults.push(self.about(variable, "may be several".into()).help(help));
                self.settle(entry.group, usize::MAX);
                return true;
            }
            Found::These(mut found) => {
                if entry.group == Group::REF_QUAT && self.asked.axes.quaternion_is_scalar_last() {
                    found.rotate_right(1);
                }
                found
            }
            Found::North(found) | Found::East(found) | Found::Scalar(found) => found,
        };
        let variables: &'a [Variable] = self.variables;
        for (slot, index) in entry.group.slots().zip(found) {
            let one = Entry { group: Group { first: slot, len: 1 }, ..entry.clone() };
            match &variables[index].width {
                Ok(1) => {
                    let Some(unit) = self.unit(&one, index, zero) else { return true };
                    let text = variables[index].name.clone();
                    self.place(slot, index, 0, unit, Some(text));
                }
                Ok(width) => {
                    let problem = format!("has {}, 1 was expected", columns(*width));
                    self.faults.push(self.about(&variables[index].name, problem));
                    self.settle(entry.group, index);
                }
                Err(holds) => self.unfit(entry.group, index, holds),
            }
        }
        true
    }
}

/// A name with an offset behind it, as in `gx-32768`.
fn offset(text: &str) -> Option<(&str, f64)> {
    let at = text.rfind(['-', '+']).filter(|at| *at > 0)?;
    let zero: f64 = text[at..].trim().parse().ok()?;
    Some((text[..at].trim(), -zero))
}
