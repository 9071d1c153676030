//! Columns that go by the names of the format.

use crate::columns::{Group, NAMES};
use crate::fault::LogError;
use crate::map::Unit;
use crate::{suggest, written};

use super::{Holds, Part, Search, Variable, columns, short, whole};

impl<'a> Search<'a> {
    /// Places what goes by the names of the format, with a unit behind it or without.
    pub(super) fn own_names(&mut self, all_are_meant: bool) {
        let variables: &'a [Variable] = self.variables;
        for (index, variable) in variables.iter().enumerate() {
            let name = self.names[index].stem().to_owned();
            let own = || self.asked.own.iter().position(|own| *own == name || *own == variable.name);
            let slot =
                NAMES.iter().position(|known| *known == name).or_else(|| own().map(|k| Group::own(k).first));
            let group = match slot {
                Some(first) => Some(Group { first, len: 1 }),
                None => whole(&name).filter(|group| self.holds == Holds::Arrays || group.may_be_shared()),
            };
            let group = group.filter(|group| match self.asked.part {
                Part::Whole => true,
                Part::Unit => !group.is_of_reference(),
                Part::Reference => {
                    group.is_of_reference() || *group == Group::TIME || *group == Group::TIME_NANOS
                }
            });
            let taken = group.is_some_and(|group| {
                self.places[group.slots()].iter().flatten().any(|place| place.foreign.is_some())
            });
            match (group, &variable.width) {
                // what the map says goes before
                (Some(_), Ok(_)) if taken => {}
                (Some(group), Ok(width)) if *width == group.len || *width == 1 && group.may_be_shared() => {
                    let unit = match self.own_unit(group, index) {
                        Ok(unit) => unit,
                        Err(()) => continue,
                    };
                    for (column, slot) in group.slots().enumerate() {
                        self.place(slot, index, column.min(width - 1), unit, None);
                    }
                    if *width < group.len {
                        self.notes.push(format!("`{}` serves {}", short(&name), group.names().join(", ")));
                    }
                }
                (Some(group), Ok(width)) => {
                    let problem = format!("has {}, {} were expected", columns(*width), group.len);
                    self.faults.push(self.about(&name, problem));
                    self.settle(group, index);
                }
                (Some(group), Err(holds)) => self.unfit(group, index, holds),
                (None, _) if self.holds == Holds::Columns && all_are_meant && slot.is_none() => {
                    self.faults.push(self.unknown(index, &variable.name));
                }
                (None, _) => {}
            }
        }
    }

    /// The unit behind a name of the format, or that of the format.
    fn own_unit(&mut self, group: Group, index: usize) -> Result<Unit, ()> {
        let Some(said) = self.names[index].unit.clone() else { return Ok(Unit::of_format(group.first)) };
        written::unit(group, &said).map_err(|error| {
            let fault = self.about(&self.variables[index].name, error);
            self.faults.push(fault);
            self.settle(group, index);
        })
    }

    /// The fault that a column of a table is none of the format.
    fn unknown(&self, index: usize, name: &str) -> LogError {
        if name.is_empty() {
            let problem = format!("{}: column {} has no name", self.path.display(), index + 1);
            let help = "a column of row numbers, or a comma at the end of the lines? Leave it out";
            return LogError::message(problem).help(help);
        }
        let hint = suggest::hint(self.names[index].stem(), NAMES);
        LogError::column(self.path, &short(name), "is not a column of the log format").help(hint)
    }
}
