//! `--map`: which variables of a file are the columns of the log format, and in which units they are.
//!
//! One entry is `NAME=[-]VARIABLE[COLUMNS][:UNIT]`. NAME is a column of the format or a triad of them (`gyro` is `dtheta_x`,
//! `dtheta_y`, `dtheta_z`). COLUMNS counts from 0 and its end does not count, as in Python: `imu[0:3]`, `q[3,0,1,2]`. A minus
//! turns the sign. In a unit of a rate, increments are the rate times the time since the row before.

use std::str::FromStr;

use crate::{suggest, units};

use super::columns::{Group, NAMES};

/// No selection of columns is longer.
const MOST_COLUMNS: usize = 16;

/// Which variables of a file are the columns of the log format.
#[derive(Clone, Debug, Default)]
pub struct ColumnMap {
    maps: Vec<Map>,
}

/// One map after the other.
impl FromIterator<ColumnMap> for ColumnMap {
    fn from_iter<I: IntoIterator<Item = ColumnMap>>(maps: I) -> Self {
        Self { maps: maps.into_iter().flat_map(|map| map.maps).collect() }
    }
}

impl ColumnMap {
    /// Its entries, in the order given.
    pub(super) fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.maps.iter().flat_map(|map| &map.0)
    }

    /// Whether nothing is mapped.
    pub(super) fn is_empty(&self) -> bool {
        self.maps.is_empty()
    }
}

impl FromStr for ColumnMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(Self { maps: vec![parse(text)?] })
    }
}

/// What one `--map` says.
#[derive(Clone, Debug, PartialEq)]
struct Map(Vec<Entry>);

/// Where one column or triad comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    /// The slots it fills.
    pub(super) group: Group,
    /// Left side.
    pub(super) name: String,
    /// Right side.
    pub(super) text: String,
    pub(super) variable: String,
    /// Which columns of the variable; all of them if not said.
    pub(super) columns: Option<Vec<usize>>,
    pub(super) unit: Unit,
}

/// How numbers of a file become those of the format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// Factor.
    pub(super) scale: f64,
    /// Times the interval too: the file holds rates, the format increments.
    pub(super) per_interval: bool,
}

impl Unit {
    /// That of the format.
    pub(super) const SAME: Self = Self { scale: 1.0, per_interval: false };
}

/// Short names of groups, and those of groups whose columns are named otherwise.
const SHORT: [(&str, Group); 13] = [
    ("time", Group::TIME),
    ("gyro", Group::DTHETA),
    ("dtheta", Group::DTHETA),
    ("accel", Group::DVEL),
    ("dvel", Group::DVEL),
    ("gyro_pulse", Group::GYRO_PULSE),
    ("accel_pulse", Group::ACCEL_PULSE),
    ("temp", Group::TEMP),
    ("temp_gyro", Group::TEMP_GYRO),
    ("dither", Group::DITHER),
    ("ref_vel", Group::REF_VEL),
    ("ref_pos", Group::REF_POS),
    ("ref_quat", Group::REF_QUAT),
];

/// What may be written to the left of `=`.
fn left(name: &str) -> Option<Group> {
    let short = SHORT.iter().find(|(short, _)| *short == name).map(|(_, group)| *group);
    short.or_else(|| NAMES.iter().position(|known| *known == name).map(|first| Group { first, len: 1 }))
}

fn parse(text: &str) -> Result<Map, String> {
    let entries = split(text).into_iter().filter(|entry| !entry.trim().is_empty());
    let entries = entries.map(Entry::from_str).collect::<Result<Vec<_>, _>>()?;
    if entries.is_empty() {
        return Err("something like gyro=wm,accel=vm,time=t was expected".into());
    }
    Ok(Map(entries))
}

/// At the commas outside of brackets.
fn split(text: &str) -> Vec<&str> {
    let mut inside = false;
    text.split(|c| {
        match c {
            '[' => inside = true,
            ']' => inside = false,
            _ => {}
        }
        c == ',' && !inside
    })
    .collect()
}

impl FromStr for Entry {
    type Err = String;

    fn from_str(entry: &str) -> Result<Self, String> {
        let Some((name, text)) = entry.split_once('=') else {
            return Err(format!(
                "`{}` has no `=`: NAME=VARIABLE was expected, such as gyro=wm",
                entry.trim()
            ));
        };
        let (name, text) = (name.trim(), text.trim());
        let Some(group) = left(name) else {
            let known = SHORT.iter().map(|(short, _)| *short).chain(NAMES);
            return Err(format!("`{name}` is not a name of the log format: {}", suggest::hint(name, known)));
        };
        let (sign, rest) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
        let (rest, unit) = match rest.rsplit_once(':') {
            // the colon of a range of columns
            Some((_, end)) if end.ends_with(']') => (rest, Unit::SAME),
            Some((rest, unit)) => (rest, scale(group, unit.trim()).map_err(|e| format!("{name}: {e}"))?),
            None => (rest, Unit::SAME),
        };
        let (variable, columns) = columns(rest.trim());
        if variable.is_empty() {
            return Err(format!("`{name}` has no variable: NAME=VARIABLE was expected, such as gyro=wm"));
        }
        if let Some(columns) = columns.as_ref().filter(|columns| columns.len() != group.len) {
            return Err(format!(
                "{text} is {} of the columns of `{variable}`, {name} needs {} ({}); they count from 0, and the end of \
                 a range does not count: {variable}[0:{}]",
                columns.len(),
                group.len,
                group.names().join(", "),
                group.len
            ));
        }
        Ok(Self {
            group,
            name: name.to_owned(),
            text: text.to_owned(),
            variable: variable.to_owned(),
            columns,
            unit: Unit { scale: sign * unit.scale, ..unit },
        })
    }
}

/// A variable and its columns, `imu[0:3]`; brackets that hold no numbers belong to its name, as in `gyr_x [deg/s]`.
fn columns(text: &str) -> (&str, Option<Vec<usize>>) {
    let Some((variable, list)) = text.strip_suffix(']').and_then(|text| text.rsplit_once('[')) else {
        return (text, None);
    };
    let mut columns = Vec::new();
    for item in list.split(',') {
        let (start, end) = match item.split_once(':') {
            Some((start, end)) => (start.trim().parse(), end.trim().parse()),
            None => (item.trim().parse(), item.trim().parse().map(|index: usize| index.saturating_add(1))),
        };
        let (Ok(start), Ok(end)) = (start, end) else { return (text, None) };
        columns.extend((start..end).take(MOST_COLUMNS));
    }
    (variable.trim(), Some(columns))
}

/// Reads a unit of a group's columns.
fn scale(group: Group, unit: &str) -> Result<Unit, String> {
    let within = |of: Group| of.slots().contains(&group.first);
    // what the format holds, and what becomes that over an interval
    let (own, rates): (units::Units, units::Units) = if within(Group::TIME) {
        (units::TIME, &[])
    } else if within(Group::DTHETA) {
        (units::ANGLE, units::ANGULAR_RATE)
    } else if within(Group::DVEL) {
        (units::VELOCITY, units::FORCE)
    } else if within(Group::DITHER) {
        (units::ANGULAR_RATE, &[])
    } else if within(Group::TEMP) || within(Group::TEMP_GYRO) {
        (units::TEMPERATURE, &[])
    } else if within(Group::REF_VEL) {
        (units::VELOCITY, &[])
    } else if within(Group::REF_POS) {
        (units::LENGTH, &[])
    } else {
        (&[("1", 1.0)], &[])
    };
    let of = |units: units::Units| units.iter().find(|(name, _)| *name == unit).map(|(_, size)| *size);
    match (of(own), of(rates)) {
        (Some(scale), _) => Ok(Unit { scale, per_interval: false }),
        (None, Some(scale)) => Ok(Unit { scale, per_interval: true }),
        (None, None) => {
            let names = own.iter().chain(rates).map(|(name, _)| *name);
            let near = suggest::nearest(unit, names.clone()).map(|near| format!("did you mean `{near}`? "));
            let all = names.collect::<Vec<_>>().join(", ");
            Err(format!("`{unit}` is not a unit of it; {}accepted: {all}", near.unwrap_or_default()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> Result<Entry, String> {
        parse(text).map(|map| map.0.into_iter().next_back().expect("an entry"))
    }

    #[test]
    fn entries_are_read() {
        let map = parse("gyro=imu[0:3], ref_quat=q[3,0,1,2],time=t:ms").expect("a map");
        assert_eq!(map.0.len(), 3);
        assert_eq!((map.0[0].group, map.0[0].columns.as_deref()), (Group::DTHETA, Some(&[0, 1, 2][..])));
        assert_eq!(map.0[1].columns.as_deref(), Some(&[3, 0, 1, 2][..]));
        assert_eq!(map.0[2].unit, Unit { scale: 1e-3, per_interval: false });
        let turned = one("dtheta_z=-wm[2]:deg/s").expect("an entry");
        assert_eq!(turned.unit, Unit { scale: -std::f64::consts::PI / 180.0, per_interval: true });
        assert_eq!((turned.variable.as_str(), turned.columns), ("wm", Some(vec![2])));
        assert_eq!(turned.group, Group { first: 3, len: 1 });
        let named = one("dtheta_x=gyr x [deg/s]:deg/s").expect("an entry");
        assert_eq!((named.variable.as_str(), named.columns), ("gyr x [deg/s]", None));
        assert!(one("accel=a:m/s").is_ok_and(|entry| entry.unit == Unit::SAME));
        assert!(
            one("accel=a:g").is_ok_and(|entry| entry.unit == Unit { scale: 9.80665, per_interval: true })
        );
    }

    #[test]
    fn mistakes_are_named() {
        for (text, part) in [
            ("", "gyro=wm,accel=vm,time=t was expected"),
            ("gyro", "`gyro` has no `=`"),
            ("gyro=", "`gyro` has no variable"),
            ("gyr=wm", "did you mean `gyro`?"),
            ("dtheta_zz=wm", "did you mean `dtheta_z`?"),
            ("gyro=wm:deg/sec", "did you mean `deg/s`?"),
            ("time=t:m", "accepted: s, ms, us, ns, min, h, days"),
            ("gyro_pulse=n:rad", "accepted: 1"),
            ("gyro=imu[1:3]", "imu[1:3] is 2 of the columns of `imu`, gyro needs 3"),
            ("gyro=imu[0]", "imu[0:3]"),
            ("gyro=imu[0:99999999999]", "is 16 of the columns"),
            ("time=imu[6:7:8]", ""),
        ] {
            match one(text) {
                Err(error) => assert!(error.contains(part), "{text}: {error}"),
                Ok(entry) => assert!(part.is_empty() && entry.columns.is_none(), "{text}: {entry:?}"),
            }
        }
    }
}
