//! `--map`: which variables of a file are the columns of the log format, and in which units they are.
//!
//! One entry is `NAME=[-]VARIABLE[COLUMNS][:UNIT]`. NAME is a column of the format or a triad of them (`gyro` is `dtheta_x`,
//! `dtheta_y`, `dtheta_z`). COLUMNS counts from 0 and its end does not count, as in Python: `imu[0:3]`, `q[3,0,1,2]`. A minus
//! turns the sign. In a unit of a rate, increments are the rate times the time since the row before. `NAME-32768` takes an offset off
//! counts, `secs+nsecs` is a time in two columns, `Gyroscope {X,Y,Z}` is three names.

use std::str::FromStr;

use crate::{suggest, units};

use super::columns::{Group, NAMES};
use super::written;

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

    /// As it was written.
    pub(super) fn text(&self) -> String {
        let entries = self.entries().map(|entry| format!("{}={}", entry.name, entry.text));
        entries.collect::<Vec<_>>().join(",")
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
    /// Whether it is about the reference, which may stand in a file of its own.
    pub(super) of_reference: bool,
    /// Left side.
    pub(super) name: String,
    /// Right side.
    pub(super) text: String,
    /// The variable as it was written, with what may be a selection of its columns.
    pub(super) written: String,
    /// The same without the selection.
    pub(super) variable: String,
    /// Which columns of the variable; all of them if not said.
    pub(super) columns: Option<Vec<usize>>,
    /// Sign.
    pub(super) sign: f64,
    /// The unit where it is said.
    pub(super) unit: Option<Unit>,
    /// A second column of a time, with its unit.
    pub(super) fraction: Option<(String, Unit)>,
}

/// How numbers of a file become those of the format: `(value - zero) * scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// Factor.
    pub(super) scale: f64,
    /// What the file says where there is nothing.
    pub(super) zero: f64,
    /// Times the interval too: the file holds rates, the format increments.
    pub(super) per_interval: bool,
}

impl Unit {
    /// That of the format.
    pub(super) const SAME: Self = Self { scale: 1.0, zero: 0.0, per_interval: false };

    /// That of the columns of the format that go by their own names: angles of the reference are degrees there.
    pub(super) fn of_format(slot: usize) -> Self {
        let angles = [Group::REF_LATLON, Group::REF_HEADING, Group::REF_EULER, Group::REF_ATT_SIGMA];
        let scale = match slot {
            _ if slot == Group::TIME_NANOS.first => 1e-9,
            _ if angles.into_iter().any(|group| group.slots().contains(&slot)) => units::DEGREE,
            _ => 1.0,
        };
        Self { scale, ..Self::SAME }
    }
}

/// Short names of groups, and those of groups whose columns are named otherwise.
const SHORT: [(&str, Group); 27] = [
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
    ("ref_time", Group::TIME),
    ("ref_lat", Group { first: 32, len: 1 }),
    ("ref_lon", Group { first: 33, len: 1 }),
    ("ref_height", Group::REF_HEIGHT),
    ("ref_heading", Group::REF_HEADING),
    ("ref_euler", Group::REF_EULER),
    ("ref_roll", Group { first: 36, len: 1 }),
    ("ref_pitch", Group { first: 37, len: 1 }),
    ("ref_yaw", Group { first: 38, len: 1 }),
    ("ref_vel_sigma", Group::REF_VEL_SIGMA),
    ("ref_pos_sigma", Group::REF_POS_SIGMA),
    ("ref_att_sigma", Group::REF_ATT_SIGMA),
    ("ref_fix", Group::REF_FIX),
    ("ref_rate", Group::REF_RATE),
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

/// At the commas outside of brackets, braces and quotes.
fn split(text: &str) -> Vec<&str> {
    let (mut inside, mut quoted) = (0_i32, false);
    text.split(|c| {
        match c {
            '"' => quoted = !quoted,
            '[' | '{' => inside += 1,
            ']' | '}' => inside -= 1,
            _ => {}
        }
        c == ',' && inside <= 0 && !quoted
    })
    .collect()
}

/// A variable and its unit; nothing said is the first unit that fits.
fn with_unit<'a>(group: Group, name: &str, text: &'a str) -> Result<(&'a str, Option<Unit>), String> {
    match text.rsplit_once(':') {
        // the colon of a range of columns
        Some((_, end)) if end.ends_with(']') => Ok((text.trim(), None)),
        Some((rest, unit)) => {
            let unit = written::unit(group, unit.trim()).map_err(|error| format!("{name}: {error}"))?;
            Ok((rest.trim(), Some(unit)))
        }
        None => Ok((text.trim(), None)),
    }
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
        let (rest, fraction) = match rest.split_once('+').filter(|_| group == Group::TIME) {
            Some((seconds, fraction)) => {
                let (fraction, unit) = with_unit(Group::TIME, name, fraction)?;
                let unit = unit.unwrap_or(Unit::of_format(Group::TIME_NANOS.first));
                (seconds, Some((unquoted(fraction).to_owned(), unit)))
            }
            None => (rest, None),
        };
        let (written, unit) = with_unit(group, name, rest)?;
        let written = unquoted(written);
        let (variable, columns) = columns(written);
        if variable.is_empty() {
            return Err(format!("`{name}` has no variable: NAME=VARIABLE was expected, such as gyro=wm"));
        }
        let fits =
            |columns: &Vec<usize>| columns.len() == group.len || columns.len() == 1 && group.may_be_shared();
        if let Some(columns) = columns.as_ref().filter(|columns| !fits(columns)) {
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
            of_reference: name.starts_with("ref_"),
            name: name.to_owned(),
            text: text.to_owned(),
            written: written.to_owned(),
            variable: variable.to_owned(),
            columns,
            sign,
            unit,
            fraction,
        })
    }
}

/// Quotes around a name keep its commas.
fn unquoted(text: &str) -> &str {
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
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
        assert_eq!(map.0[2].unit, Some(Unit { scale: 1e-3, ..Unit::SAME }));
        let turned = one("dtheta_z=-wm[2]:deg/s").expect("an entry");
        let degrees = Unit { scale: std::f64::consts::PI / 180.0, zero: 0.0, per_interval: true };
        assert_eq!((turned.sign, turned.unit), (-1.0, Some(degrees)));
        assert_eq!((turned.variable.as_str(), turned.columns), ("wm", Some(vec![2])));
        assert_eq!(turned.group, Group { first: 3, len: 1 });
        let named = one("dtheta_x=gyr x [deg/s]:deg/s").expect("an entry");
        assert_eq!((named.variable.as_str(), named.columns), ("gyr x [deg/s]", None));
        assert!(one("accel=a:m/s").is_ok_and(|entry| entry.unit == Some(Unit::SAME)));
        let g = one("accel=a:g").expect("an entry").unit.expect("a unit");
        assert!((g.scale - 9.80665).abs() < 1e-15 && g.per_interval);
        let two = one("time=secs+nsecs").expect("an entry");
        assert_eq!(two.fraction, Some(("nsecs".into(), Unit { scale: 1e-9, ..Unit::SAME })));
        let pattern = one("gyro=Gyroscope {X,Y,Z} (deg/s):deg/s").expect("an entry");
        assert_eq!(pattern.variable, "Gyroscope {X,Y,Z} (deg/s)");
        let quoted = one("dtheta_x=\"rate, x\":rad/s").expect("an entry");
        assert_eq!(quoted.variable, "rate, x");
        assert!(one("ref_lat=lat:1e-7 deg").is_ok_and(|entry| entry.of_reference));
    }

    #[test]
    fn mistakes_are_named() {
        for (text, part) in [
            ("", "gyro=wm,accel=vm,time=t was expected"),
            ("gyro", "`gyro` has no `=`"),
            ("gyro=", "`gyro` has no variable"),
            ("gyr=wm", "did you mean `gyro`?"),
            ("dtheta_zz=wm", "did you mean `dtheta_z`?"),
            ("gyro=wm:deg/sek", "did you mean `deg/s`?"),
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
