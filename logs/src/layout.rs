//! Where the columns of the log format stand in one file: by their own names, by the column map, or as PSINS lays them out.

use std::path::Path;

use crate::suggest;

use super::columns::{Batch, Group, NAMES};
use super::fault::{LogError, shown};
use super::map::{ColumnMap, Entry, Unit};

/// A step longer than this many sampling intervals is a gap.
pub(super) const LONGEST_STEP: f64 = 1.5;
/// The seven columns `[wm vm t]` of PSINS.
const PSINS: (&str, usize) = ("imu", 7);
/// So many names of a foreign file are told.
const TOLD: usize = 20;
/// So many are compared with a name that is not there.
const LOOKED_AT: usize = 100;

/// What a file calls by one name: a column of a table, or an array of one or more columns.
pub(super) struct Variable {
    pub(super) name: String,
    /// Number of columns, or what it holds instead of numbers.
    pub(super) width: Result<usize, String>,
}

/// What kind of file the variables are of.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Holds {
    /// The columns of one table: every one is meant.
    Columns,
    /// Arrays: whatever was at hand when the file was written.
    Arrays,
}

/// Where the columns of the format stand in one file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    places: [Option<Place>; NAMES.len()],
    /// Names of what is not read.
    unused: Vec<String>,
}

/// Where one column of the format stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// Index of the variable in the file.
    pub(super) variable: usize,
    /// Which of its columns.
    pub(super) column: usize,
    unit: Unit,
    /// What the file calls it, where that is not the name of the format.
    foreign: Option<String>,
}

/// A layout being found.
struct Search<'a> {
    path: &'a Path,
    variables: &'a [Variable],
    holds: Holds,
    places: [Option<Place>; NAMES.len()],
    faults: Vec<LogError>,
}

impl Layout {
    /// Finds the columns among a file's variables; every fault is reported at once.
    pub(super) fn new(
        path: &Path,
        variables: &[Variable],
        holds: Holds,
        map: &ColumnMap,
    ) -> Result<Self, LogError> {
        let places = [const { None }; NAMES.len()];
        let mut search = Search { path, variables, holds, places, faults: Vec::new() };
        if map.is_empty() && !search.known() {
            return Err(search.foreign());
        }
        for entry in map.entries() {
            search.map(entry);
        }
        search.own_names(map.is_empty());
        search.psins();
        search.check();
        let used = |index: usize| search.places.iter().flatten().any(|place| place.variable == index);
        let unused = variables.iter().enumerate().filter(|(index, _)| !used(*index));
        let unused = unused.map(|(_, variable)| variable.name.clone()).collect();
        match LogError::all(search.faults) {
            Some(fault) => Err(fault),
            None => Ok(Self { places: search.places, unused }),
        }
    }

    /// Whether all columns of a group are there.
    pub(super) fn has(&self, group: Group) -> bool {
        self.places[group.slots()].iter().all(Option::is_some)
    }

    /// What is in the file and not read.
    pub(super) fn unused(&self) -> Option<String> {
        let told = self.unused.iter().take(TOLD).map(|name| format!("`{}`", short(name)));
        let told = told.collect::<Vec<_>>().join(", ");
        match self.unused.len() {
            0 => None,
            more if more > TOLD => Some(format!("{told} and {} more", more - TOLD)),
            _ => Some(told),
        }
    }

    /// Slot and place of every column that is there.
    pub(super) fn columns(&self) -> impl Iterator<Item = (usize, &Place)> {
        self.places.iter().enumerate().filter_map(|(slot, place)| Some((slot, place.as_ref()?)))
    }

    /// Puts what was read into the units of the format. `last` is the time of the row before the batch.
    pub(super) fn convert(&self, batch: &mut Batch, interval: f64, last: Option<f64>) {
        let foreign = |(_, place): &(usize, &Place)| place.unit != Unit::SAME;
        for (slot, place) in self.columns().filter(foreign) {
            batch.column_mut(slot).iter_mut().for_each(|value| *value *= place.unit.scale);
        }
        for (slot, _) in self.columns().filter(foreign).filter(|(_, place)| place.unit.per_interval) {
            let mut before = last;
            let (times, values) = batch.times_and(slot);
            for (time, value) in times.iter().zip(values) {
                let step = before.replace(*time).map_or(interval, |before| time - before);
                // the first row, and the row after a gap, last one interval
                let usual = step > 0.0 && step <= LONGEST_STEP * interval;
                *value *= if usual { step } else { interval };
            }
        }
    }

    /// Adds to a fault what the file calls the columns it is about.
    pub(super) fn explain(&self, fault: LogError) -> LogError {
        let named = |slot: &usize| fault.column_names().is_some_and(|names| names.contains(NAMES[*slot]));
        let notes = self.columns().filter(|(slot, _)| named(slot)).filter_map(|(slot, place)| {
            place.foreign.as_ref().map(|foreign| format!("`{}` is {foreign} of the file", NAMES[slot]))
        });
        let notes: Vec<String> = notes.collect();
        if notes.is_empty() { fault } else { fault.note(notes.join(", ")) }
    }
}

impl<'a> Search<'a> {
    fn has(&self, group: Group) -> bool {
        self.places[group.slots()].iter().all(Option::is_some)
    }

    fn any(&self, group: Group) -> bool {
        self.places[group.slots()].iter().any(Option::is_some)
    }

    /// A fault of a variable, called what it is in such a file.
    fn about(&self, name: &str, problem: String) -> LogError {
        match self.holds {
            Holds::Columns => LogError::column(self.path, &short(name), problem),
            Holds::Arrays => LogError::variable(self.path, &short(name), problem),
        }
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|variable| variable.name == name)
    }

    /// Whether anything about the file is known without a map.
    fn known(&self) -> bool {
        let mut names = self.variables.iter().map(|variable| variable.name.to_ascii_lowercase());
        names.any(|name| {
            NAMES.contains(&name.as_str()) || self.holds == Holds::Arrays && whole(&name).is_some()
        }) || self.psins_variable().is_some()
    }

    /// The fault that nothing is known of the file.
    fn foreign(&self) -> LogError {
        let (first, example) = match (self.variables.first(), self.holds) {
            (None, _) => return LogError::file(self.path, "holds nothing that could be a column"),
            (Some(first), Holds::Columns) => (
                format!("columns is one of the log format; the first is `{}`", short(&first.name)),
                "--map gyro=w:rad/s,accel=f:m/s^2,time=t names the columns of a foreign file; or the names of the columns \
                 come first of all",
            ),
            (Some(_), Holds::Arrays) => {
                let told = self.variables.iter().take(TOLD).map(|variable| match &variable.width {
                    Ok(width) => format!("`{}` ({})", short(&variable.name), columns(*width)),
                    Err(holds) => format!("`{}` ({holds})", short(&variable.name)),
                });
                let told: Vec<String> = told.collect();
                (
                    format!("variables is one of the log format; it holds {}", told.join(", ")),
                    "--map gyro=wm,accel=vm,time=t says which are; seven columns called imu are taken as [wm vm t] of PSINS",
                )
            }
        };
        let help = format!("{example}; valid names: {}", NAMES.join(", "));
        LogError::file(self.path, format!("none of its {first}")).help(help)
    }

    /// Places what one entry of the map names.
    fn map(&mut self, entry: &Entry) {
        let names = entry.group.names();
        let Some(variable) = self.find(&entry.variable) else {
            return self.map_components(entry);
        };
        let variables: &'a [Variable] = self.variables;
        let width = match &variables[variable].width {
            Ok(width) => *width,
            Err(holds) => return self.unfit(entry.group, variable, holds),
        };
        let wanted = entry.columns.clone().unwrap_or_else(|| (0..width.min(names.len() + 1)).collect());
        let problem = match wanted.iter().max() {
            Some(most) if *most >= width => {
                format!("has {}, counted from 0: there is no [{most}]", columns(width))
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
                for (slot, column) in entry.group.slots().zip(wanted) {
                    let text = if width > 1 && entry.columns.is_none() {
                        format!("{}[{column}]", entry.text)
                    } else {
                        entry.text.clone()
                    };
                    self.place(slot, variable, column, entry.unit, Some(text));
                }
                return;
            }
        };
        let help = format!("which ones? For instance {}={}[0:{}]", entry.name, entry.variable, names.len());
        let help = (width >= names.len()).then_some(help);
        self.faults.push(self.about(&entry.variable, problem).help_if(help));
        self.settle(entry.group, variable);
    }

    /// A triad as three variables with a common beginning: `gyro=w` is `w_x`, `w_y`, `w_z`, or `w.x`, or `wx`, or `wX`.
    fn map_components(&mut self, entry: &Entry) {
        let ends = entry.group.names().iter().filter_map(|name| name.rsplit('_').next());
        let ends: Vec<&str> = ends.collect();
        let single = |index: &usize| self.variables[*index].width == Ok(1);
        let found = ["_", ".", "", "/"].iter().find_map(|joint| {
            let find = |end: &str| self.find(&format!("{}{joint}{end}", entry.variable)).filter(single);
            let all = |change: fn(&str) -> String| -> Option<Vec<usize>> {
                ends.iter().map(|end| find(&change(end))).collect()
            };
            all(str::to_owned).or_else(|| all(str::to_ascii_uppercase))
        });
        match found.filter(|_| entry.group.len > 1 && entry.columns.is_none()) {
            Some(found) => {
                for (slot, variable) in entry.group.slots().zip(found) {
                    let text = self.variables[variable].name.clone();
                    self.place(slot, variable, 0, entry.unit, Some(text));
                }
            }
            None => {
                let names = self.variables.iter().map(|variable| variable.name.as_str()).take(LOOKED_AT);
                let problem =
                    format!("is not in the file, but --map {}={} asks for it", entry.name, entry.text);
                let help = suggest::hint(&entry.variable, names);
                self.faults.push(self.about(&entry.variable, problem).help(help));
                self.settle(entry.group, usize::MAX);
            }
        }
    }

    /// The fault that a variable holds no numbers.
    fn unfit(&mut self, group: Group, variable: usize, holds: &str) {
        let problem = format!("holds {holds}, numbers were expected");
        let help = "write it as float64; times are seconds, as numbers";
        self.faults.push(self.about(&self.variables[variable].name, problem).help(help));
        self.settle(group, variable);
    }

    /// Takes a group as found after a fault, by a map: that it is missing, or there twice, would be the same fault again.
    fn settle(&mut self, group: Group, variable: usize) {
        for place in self.places[group.slots()].iter_mut().filter(|place| place.is_none()) {
            let foreign = Some(String::new());
            *place = Some(Place { variable, column: usize::MAX, unit: Unit::SAME, foreign });
        }
    }

    /// Places what goes by the names of the format.
    fn own_names(&mut self, all_are_meant: bool) {
        let variables: &'a [Variable] = self.variables;
        for (index, variable) in variables.iter().enumerate() {
            let name = variable.name.as_str();
            let slot = NAMES.iter().position(|known| *known == name);
            let group = match slot {
                Some(first) => Some(Group { first, len: 1 }),
                None => whole(name).filter(|_| self.holds == Holds::Arrays),
            };
            match (group, &variable.width) {
                (Some(group), Ok(width)) if *width == group.len => {
                    let mapped =
                        self.places[group.slots()].iter().flatten().any(|place| place.foreign.is_some());
                    // what the map says goes before
                    if !mapped {
                        for (column, slot) in group.slots().enumerate() {
                            self.place(slot, index, column, Unit::SAME, None);
                        }
                    }
                }
                (Some(group), Ok(width)) => {
                    let problem = format!("has {}, {} were expected", columns(*width), group.len);
                    self.faults.push(self.about(name, problem));
                    self.settle(group, index);
                }
                (Some(group), Err(holds)) => self.unfit(group, index, holds),
                (None, _) if self.holds == Holds::Columns && all_are_meant => {
                    self.faults.push(self.unknown(index, name));
                }
                (None, _) => {}
            }
        }
    }

    /// The fault that a column of a table is none of the format.
    fn unknown(&self, index: usize, name: &str) -> LogError {
        if name.is_empty() {
            let problem = format!("{}: column {} has no name", self.path.display(), index + 1);
            let help = "a column of row numbers, or a comma at the end of the lines? Leave it out";
            return LogError::message(problem).help(help);
        }
        let hint = suggest::hint(name, NAMES);
        LogError::column(self.path, &short(name), "is not a column of the log format").help(hint)
    }

    /// The array that is laid out as PSINS does: the one called so, or the only one.
    fn psins_variable(&self) -> Option<usize> {
        let named = self.find(PSINS.0);
        let only = (self.variables.len() == 1).then_some(0);
        let seven = |index: &usize| self.variables[*index].width == Ok(PSINS.1);
        named.or(only).filter(seven).filter(|_| self.holds == Holds::Arrays)
    }

    /// Fills what is missing from the layout of PSINS.
    fn psins(&mut self) {
        let Some(variable) = self.psins_variable() else { return };
        for (first, group, instead) in [
            (0, Group::DTHETA, Some(Group::GYRO_PULSE)),
            (3, Group::DVEL, Some(Group::ACCEL_PULSE)),
            (6, Group::TIME, None),
        ] {
            if self.any(group) || instead.is_some_and(|group| self.any(group)) {
                continue;
            }
            for (column, slot) in (first..).zip(group.slots()) {
                let text = format!("{}[{column}]", self.variables[variable].name);
                self.place(slot, variable, column, Unit::SAME, Some(text));
            }
        }
    }

    fn place(&mut self, slot: usize, variable: usize, column: usize, unit: Unit, foreign: Option<String>) {
        let taken = |place: &&Place| (place.variable, place.column) == (variable, column);
        if let Some(place) = self.places.iter().flatten().find(taken) {
            let name = place.foreign.as_deref().unwrap_or(&self.variables[variable].name);
            let problem = format!("is asked for twice: as `{name}`, and as `{}`", NAMES[slot]);
            self.faults.push(self.about(&self.variables[variable].name, problem));
        } else if self.places[slot].is_some() {
            self.faults.push(LogError::column(self.path, NAMES[slot], "stands there twice"));
        } else {
            self.places[slot] = Some(Place { variable, column, unit, foreign });
        }
    }

    /// What must be there, and together.
    fn check(&mut self) {
        let path = self.path;
        if !self.any(Group::TIME) {
            let fault = LogError::column(path, "time_s", "is missing").help("the end of each interval, s");
            self.faults.push(fault);
        }
        for (increments, pulses) in [(Group::DTHETA, Group::GYRO_PULSE), (Group::DVEL, Group::ACCEL_PULSE)] {
            let (first, alternative) = (increments.names()[0], pulses.names()[0]);
            match (self.any(increments), self.any(pulses)) {
                (true, true) => {
                    let problem =
                        format!("stands beside `{alternative}`: increments or pulse counts, not both");
                    self.faults.push(LogError::column(path, first, problem));
                }
                (false, false) => {
                    let missing = increments.names().join(", ");
                    let help = format!(
                        "expected {missing} (or {} with the scales in [imu])",
                        pulses.names().join(", ")
                    );
                    self.faults.push(LogError::column(path, first, "is missing").help(help));
                }
                _ => {}
            }
        }
        for group in Group::ALL {
            if !self.any(group) || self.has(group) {
                continue;
            }
            let (there, missing): (Vec<usize>, Vec<usize>) =
                group.slots().partition(|slot| self.places[*slot].is_some());
            let names =
                |slots: &[usize]| slots.iter().map(|slot| NAMES[*slot]).collect::<Vec<_>>().join("`, `");
            let problem = format!("is missing beside `{}`", names(&there));
            let help = format!("{} come together or not at all", group.names().join(", "));
            self.faults.push(LogError::column(path, &names(&missing), problem).help(help));
        }
    }
}

/// The group whose columns an array of this name holds side by side: `dtheta` is `dtheta_x`, `dtheta_y`, `dtheta_z`.
fn whole(name: &str) -> Option<Group> {
    let of = |group: &Group| group.names()[0].rsplit_once('_').map(|(start, _)| start);
    Group::ALL.into_iter().find(|group| group.len > 1 && of(group) == Some(name))
}

/// A name as it is shown.
fn short(name: &str) -> String {
    shown(name, 64)
}

/// A number of columns in words.
fn columns(number: usize) -> String {
    format!("{number} column{}", if number == 1 { "" } else { "s" })
}
