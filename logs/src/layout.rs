//! Where the columns of the log format stand in one file: by their own names, by the column map, or as PSINS lays them out.

mod checks;
mod known;
mod mapped;
mod own;

use std::path::Path;

use super::axes::Axes;
use super::columns::{Group, NAMES};
use super::fault::{LogError, shown};
use super::map::{ColumnMap, Unit};
use super::names::{self, Name};
use super::written;

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

/// Which columns are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// All of them.
    Whole,
    /// All but those of the reference, which stand in a file of their own.
    Unit,
    /// Those of the reference.
    Reference,
}

/// What is asked of a file.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) map: &'a ColumnMap,
    pub(super) axes: &'a Axes,
    pub(super) part: Part,
    /// Whether times are made from the rate whatever the file says.
    pub(super) by_rate: bool,
    /// Names of the columns of a text without names.
    pub(super) columns: Option<&'a [String]>,
    /// Names of what measurements of the program's own read.
    pub(super) own: &'a [String],
}

/// Where the columns of the format stand in one file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    places: [Option<Place>; NAMES.len()],
    /// Names of what is not read.
    unused: Vec<String>,
    /// What was recognised without being said.
    pub(super) notes: Vec<String>,
}

/// Where one column of the format stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// Index of the variable in the file.
    pub(super) variable: usize,
    /// Which of its columns.
    pub(super) column: usize,
    pub(super) unit: Unit,
    /// What the file calls it, where that is not the name of the format.
    foreign: Option<String>,
}

/// A layout being found.
struct Search<'a> {
    path: &'a Path,
    variables: &'a [Variable],
    names: Vec<Name>,
    holds: Holds,
    asked: Asked<'a>,
    places: [Option<Place>; NAMES.len()],
    faults: Vec<LogError>,
    notes: Vec<String>,
}

impl Layout {
    /// Finds the columns among a file's variables; every fault is reported at once.
    pub(super) fn new(
        path: &Path,
        variables: &[Variable],
        holds: Holds,
        asked: Asked<'_>,
    ) -> Result<Self, LogError> {
        let places = [const { None }; NAMES.len()];
        let names = variables.iter().map(|variable| Name::new(&variable.name)).collect();
        let mut search =
            Search { path, variables, names, holds, asked, places, faults: Vec::new(), notes: Vec::new() };
        if asked.map.is_empty() && !search.known() {
            return Err(search.foreign());
        }
        for entry in asked.map.entries() {
            match asked.part {
                Part::Unit if entry.of_reference => {}
                Part::Reference if !entry.of_reference => {}
                _ => search.map(entry),
            }
        }
        search.own_names(asked.map.is_empty() && asked.part != Part::Reference);
        search.layouts();
        search.time();
        search.check();
        let used = |index: usize| search.places.iter().flatten().any(|place| place.variable == index);
        let unused = variables.iter().enumerate().filter(|(index, _)| !used(*index));
        let unused = unused.map(|(_, variable)| variable.name.clone()).collect();
        match LogError::all(search.faults) {
            Some(fault) => Err(fault),
            None => Ok(Self { places: search.places, unused, notes: search.notes }),
        }
    }

    /// Whether all columns of a group are there.
    pub(super) fn has(&self, group: Group) -> bool {
        self.places[group.slots()].iter().all(Option::is_some)
    }

    /// The unit of a slot, that of the format where it is not there.
    pub(super) fn unit(&self, slot: usize) -> Unit {
        self.places.get(slot).and_then(Option::as_ref).map_or(Unit::SAME, |place| place.unit)
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
        names::find(&self.names, name)
    }

    /// Whether anything about the file is known without a map.
    fn known(&self) -> bool {
        let mut names = self.names.iter().map(|name| name.stem().to_ascii_lowercase());
        names.any(|name| {
            NAMES.contains(&name.as_str()) || self.holds == Holds::Arrays && whole(&name).is_some()
        }) || self.psins_variable().is_some()
            || self.named_layouts().len() == 1
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
        let fits = |group: Group, unit: &str| written::unit(group, unit).is_ok_and(|unit| unit.per_interval);
        let fault = LogError::file(self.path, format!("none of its {first}"));
        if let [(beginning, layout), _, ..] = &self.named_layouts()[..] {
            let (gyro, accel) = (layout.gyro, layout.accel);
            return fault.help(format!(
                "there are several units; one of them is --map gyro={beginning}{gyro}:rad/s,accel={beginning}{accel}:m/s^2"
            ));
        }
        match names::suggested(&self.names, fits) {
            Some(map) => fault.suggest(map),
            None => fault.help(format!("{example}; valid names: {}", NAMES.join(", "))),
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

    fn place(&mut self, slot: usize, variable: usize, column: usize, unit: Unit, foreign: Option<String>) {
        let taken = |(of, place): &(usize, &Option<Place>)| {
            let same =
                place.as_ref().is_some_and(|place| (place.variable, place.column) == (variable, column));
            same && !(Group::of(*of).may_be_shared() && Group::of(slot).may_be_shared())
        };
        let other = self.places.iter().enumerate().find(taken).and_then(|(_, place)| place.as_ref());
        if let Some(place) = other {
            let name = place.foreign.as_deref().unwrap_or(&self.variables[variable].name);
            let problem = format!("is asked for twice: as `{name}`, and as `{}`", NAMES[slot]);
            self.faults.push(self.about(&self.variables[variable].name, problem));
        } else if self.places[slot].is_some() {
            self.faults.push(LogError::column(self.path, NAMES[slot], "stands there twice"));
        } else {
            self.places[slot] = Some(Place { variable, column, unit, foreign });
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
