//! Names as files write them: with a unit in brackets, behind a sign of comment, three of a triad with a common pattern.

use super::columns::Group;
use super::guess::{Source, Suggestion, Unit};
use super::written;

/// What a header begins with where it is a comment elsewhere.
pub(super) const MARKS: [char; 3] = ['#', '%', '/'];
/// What stands between the common part of three names and their component.
const JOINTS: [&str; 8] = ["_", ".", "", "/", " ", "[", "(", "-"];
/// Last parts of names that are times.
const TIMES: [&str; 8] = ["time", "t", "timestamp", "stamp", "times", "timestamps", "secs", "sec"];
/// And of the fraction of a second beside them.
const FRACTIONS: [&str; 5] = ["nsecs", "nsec", "nanosec", "nanosecs", "nanos"];

/// Components of vectors, in the order of the format, or of file axes where they go by another frame.
const VECTOR: &[[&str; 3]] = &[["x", "y", "z"], ["X", "Y", "Z"], ["0", "1", "2"], ["1", "2", "3"]];
const EAST: &[[&str; 3]] =
    &[["e", "n", "u"], ["E", "N", "U"], ["east", "north", "up"], ["East", "North", "Up"]];
const NORTH: &[[&str; 3]] =
    &[["n", "e", "d"], ["N", "E", "D"], ["north", "east", "down"], ["North", "East", "Down"]];
const ANGLES: &[[&str; 3]] =
    &[["roll", "pitch", "yaw"], ["Roll", "Pitch", "Yaw"], ["x", "y", "z"], ["X", "Y", "Z"]];
const PLANE: &[[&str; 2]] = &[["lat", "lon"], ["latitude", "longitude"], ["Lat", "Lon"], ["0", "1"]];
const NAMED: &[[&str; 4]] = &[["w", "x", "y", "z"], ["W", "X", "Y", "Z"]];
const COUNTED: &[[&str; 4]] = &[["0", "1", "2", "3"], ["1", "2", "3", "4"]];

/// A name with what is in it.
#[derive(Clone, Debug)]
pub(super) struct Name {
    /// As it stands in the file.
    raw: String,
    /// Without a sign of comment.
    plain: String,
    /// Without the unit too.
    stem: String,
    /// What stands in the brackets at its end, if that is no number.
    pub(super) unit: Option<String>,
}

impl Name {
    pub(super) fn new(raw: &str) -> Self {
        let plain = raw.trim_start_matches(MARKS).trim();
        // an array of a file in folders is called /wm, and is that name
        let plain = if plain.is_empty() { raw } else { plain };
        let bracket = [('[', ']'), ('(', ')'), ('{', '}')].into_iter().find_map(|(open, close)| {
            let (stem, unit) = plain.strip_suffix(close)?.rsplit_once(open)?;
            let selects = unit.chars().all(|c| c.is_ascii_digit() || " ,:".contains(c));
            (!selects && !stem.trim().is_empty()).then(|| (stem.trim().to_owned(), unit.trim().to_owned()))
        });
        // a bracket within a bracket belongs to the unit: (deg/(s))
        let (stem, unit) = bracket.map_or((plain.to_owned(), None), |(stem, unit)| (stem, Some(unit)));
        Self { raw: raw.to_owned(), plain: plain.to_owned(), stem, unit }
    }

    /// Without sign of comment and unit.
    pub(super) fn stem(&self) -> &str {
        &self.stem
    }

    /// Its last part, as `stamp` of `field.header.stamp`, in small letters.
    fn last(&self) -> String {
        self.stem.rsplit(['.', '/', ' ']).next().unwrap_or_default().to_ascii_lowercase()
    }

    /// Whether it is what times are called.
    pub(super) fn is_time(&self) -> bool {
        // a capital T is a temperature
        let unit = self.unit.as_ref().is_none_or(|unit| written::unit(Group::TIME, unit).is_ok());
        unit && !self.stem.ends_with('T') && TIMES.contains(&self.last().as_str())
    }

    /// Whether it is what the part of a second is called.
    pub(super) fn is_fraction(&self) -> bool {
        FRACTIONS.contains(&self.last().as_str())
    }
}

/// The name that is meant: exactly that, or but for a sign of comment, or but for the unit where only one is so.
pub(super) fn find(names: &[Name], wanted: &str) -> Option<usize> {
    let exact = names.iter().position(|name| name.raw == wanted);
    let exact = exact.or_else(|| names.iter().position(|name| name.plain == wanted));
    exact.or_else(|| {
        let mut of = names.iter().enumerate().filter(|(_, name)| name.stem == wanted);
        let (index, _) = of.next()?;
        of.next().is_none().then_some(index)
    })
}

/// The components of a group among names with a common pattern.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// One for each component, in the order that the group has in the file's frame.
    These(Vec<usize>),
    /// The same, by names that say north, east, down.
    North(Vec<usize>),
    /// The same, by names that say east, north, up.
    East(Vec<usize>),
    /// A quaternion by letters, w first.
    Scalar(Vec<usize>),
    /// More than one pattern begins so.
    Several(Vec<String>),
    Nothing,
}

/// Finds the components of a group: names that begin with `variable`, or the names in its braces.
pub(super) fn components(names: &[Name], variable: &str, group: Group) -> Found {
    if let Some(listed) = braces(variable) {
        let found: Option<Vec<usize>> = listed.iter().map(|name| find(names, name)).collect();
        return match found.filter(|found| found.len() == group.len) {
            Some(found) => Found::These(found),
            None => Found::Nothing,
        };
    }
    let earth = [Group::REF_VEL, Group::REF_POS, Group::REF_VEL_SIGMA, Group::REF_POS_SIGMA].contains(&group);
    match group.len {
        3 if group == Group::REF_EULER => pattern(names, variable, ANGLES, Found::These),
        3 if earth => [(EAST, Found::East as fn(_) -> _), (NORTH, Found::North), (VECTOR, Found::These)]
            .into_iter()
            .map(|(ends, kind)| pattern(names, variable, ends, kind))
            .find(|found| *found != Found::Nothing)
            .unwrap_or(Found::Nothing),
        3 => pattern(names, variable, VECTOR, Found::These),
        4 => match pattern(names, variable, NAMED, Found::Scalar) {
            Found::Nothing => pattern(names, variable, COUNTED, Found::These),
            found => found,
        },
        2 => pattern(names, variable, PLANE, Found::These),
        _ => Found::Nothing,
    }
}

/// The names that a pattern with braces stands for: `w_{x,y,z}`.
fn braces(text: &str) -> Option<Vec<String>> {
    let (before, rest) = text.split_once('{')?;
    let (list, after) = rest.split_once('}')?;
    Some(list.split(',').map(|item| format!("{before}{}{after}", item.trim())).collect())
}

fn pattern<const N: usize>(
    names: &[Name],
    variable: &str,
    ends: &[[&str; N]],
    kind: fn(Vec<usize>) -> Found,
) -> Found {
    for ends in ends {
        for joint in JOINTS {
            let beginning = format!("{variable}{joint}{}", ends[0]);
            // what follows the component is the same for all: nothing, a bracket, or more of the name
            let rests = names.iter().filter_map(|name| name.stem.strip_prefix(&beginning));
            let rests = rests.filter(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()));
            let mut found: Vec<(&str, Vec<usize>)> = Vec::new();
            for rest in rests {
                let of = |end: &&str| {
                    let wanted = format!("{variable}{joint}{end}{rest}");
                    names.iter().position(|name| name.stem == wanted)
                };
                if let Some(all) = ends.iter().map(of).collect()
                    && !found.iter().any(|(known, _)| *known == rest)
                {
                    found.push((rest, all));
                }
            }
            if let Some(only) = found.iter().position(|(rest, _)| ["", "]", ")"].contains(rest)) {
                return kind(found.swap_remove(only).1);
            }
            match found.len() {
                0 => {}
                1 => return kind(found.swap_remove(0).1),
                _ => {
                    let list = ends.join(",");
                    let shown = found.iter().map(|(rest, _)| format!("{variable}{joint}{{{list}}}{rest}"));
                    return Found::Several(shown.collect());
                }
            }
        }
        for joint in ["_", ".", " ", ""] {
            let of = |end: &&str| {
                let wanted = format!("{end}{joint}{variable}");
                names.iter().position(|name| name.stem == wanted)
            };
            if let Some(found) = ends.iter().map(of).collect() {
                return kind(found);
            }
        }
    }
    Found::Nothing
}

/// A map that the names suggest: of triads whose units or names are those of gyros and accelerometers, and a time.
pub(super) fn suggested(names: &[Name], fits: impl Fn(Group, &str) -> bool) -> Option<Suggestion> {
    let triads: Vec<(String, Option<&str>)> = names
        .iter()
        .filter_map(|name| {
            let ends = |end: &&str| name.stem.ends_with(*end);
            let end = ["[0]", "_0", "_x", ".x", " x", " X", "_X", "x", "X"].iter().find(|end| ends(end))?;
            let variable = name.stem.strip_suffix(*end)?;
            let variable = if variable.is_empty() { return None } else { variable };
            let found = matches!(components(names, variable, Group::DTHETA), Found::These(_));
            found.then(|| (variable.to_owned(), name.unit.as_deref()))
        })
        .collect();
    let of = |group: Group, words: [&str; 5], short: &[&str]| {
        let by_unit = triads.iter().find(|(_, unit)| unit.is_some_and(|unit| fits(group, unit)));
        by_unit.or_else(|| {
            triads.iter().find(|(name, _)| {
                let name = name.to_ascii_lowercase();
                words.iter().any(|word| name.contains(word)) || short.contains(&name.as_str())
            })
        })
    };
    let gyro = of(
        Group::DTHETA,
        ["gyr", "angular_vel", "angvel", "omega", "rotation_rate"],
        &["w", "g", "g_", "w_"],
    )?;
    let accel = of(Group::DVEL, ["acc", "linear_acc", "force", "fib", "fsens"], &["a", "f", "a_", "f_"])?;
    let named = |(name, unit): &(String, Option<&str>), usual: &str| Source {
        name: name.clone(),
        unit: if unit.is_some() { Unit::Named } else { Unit::Usual(usual.to_owned()) },
    };
    let time = names.iter().find(|name| name.is_time()).map(|time| {
        let fraction = names.iter().find(|name| name.is_fraction() && time.last().starts_with("sec"));
        match fraction {
            Some(fraction) => {
                Source { name: format!("{}+{}", time.plain, fraction.plain), unit: Unit::Named }
            }
            None => named(&(time.plain.clone(), time.unit.as_deref()), "s"),
        }
    });
    Some(Suggestion { gyro: named(gyro, "rad/s"), accel: named(accel, "m/s^2"), time })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(raw: &[&str]) -> Vec<Name> {
        raw.iter().map(|raw| Name::new(raw)).collect()
    }

    #[test]
    fn units_and_signs_of_comment_are_no_part_of_a_name() {
        for (raw, stem, unit) in [
            ("#timestamp [ns]", "timestamp", Some("ns")),
            ("w_RS_S_x [rad s^-1]", "w_RS_S_x", Some("rad s^-1")),
            ("Gyroscope X (deg/s)", "Gyroscope X", Some("deg/s")),
            ("Gx[deg/s]", "Gx", Some("deg/s")),
            ("gyro_rad[0]", "gyro_rad[0]", None),
            ("%time", "time", None),
            ("[s]", "[s]", None),
            ("#", "#", None),
        ] {
            let name = Name::new(raw);
            assert_eq!((name.stem(), name.unit.as_deref()), (stem, unit), "{raw}");
        }
    }

    #[test]
    fn exact_names_go_before_patterns() {
        let names = names(&["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]", "#t [ns]", "a (g)", "a (m/s^2)"]);
        assert_eq!(find(&names, "gyro_rad[1]"), Some(1));
        assert_eq!([find(&names, "#t [ns]"), find(&names, "t [ns]"), find(&names, "t")], [Some(3); 3]);
        // two are called a
        assert_eq!((find(&names, "a"), find(&names, "a (g)")), (None, Some(4)));
    }

    #[test]
    fn patterns_of_three() {
        for raw in [
            &["w_x", "w_y", "w_z"][..],
            &["w.x", "w.y", "w.z"],
            &["wX", "wY", "wZ"],
            &["w X (deg/s)", "w Y (deg/s)", "w Z (deg/s)"],
            &["w[0]", "w[1]", "w[2]"],
            &["w_0", "w_1", "w_2"],
            &["w1", "w2", "w3"],
            &["w_x_raw", "w_y_raw", "w_z_raw"],
            &["x_w", "y_w", "z_w"],
            &["wx[rad/s]", "wy[rad/s]", "wz[rad/s]"],
        ] {
            assert_eq!(components(&names(raw), "w", Group::DTHETA), Found::These(vec![0, 1, 2]), "{raw:?}");
        }
        let two = names(&["w_x_raw", "w_y_raw", "w_z_raw", "w_x_cal", "w_y_cal", "w_z_cal"]);
        let Found::Several(patterns) = components(&two, "w", Group::DTHETA) else { panic!("one") };
        assert_eq!(patterns, ["w_{x,y,z}_raw", "w_{x,y,z}_cal"]);
        assert_eq!(components(&two, "w_{x,y,z}_cal", Group::DTHETA), Found::These(vec![3, 4, 5]));
        assert_eq!(components(&names(&["wax", "way", "waz"]), "w", Group::DTHETA), Found::Nothing);
    }

    #[test]
    fn names_of_directions_say_the_frame() {
        let ned = names(&["v_e", "v_n", "v_d"]);
        assert_eq!(components(&ned, "v", Group::REF_VEL), Found::North(vec![1, 0, 2]));
        let enu = names(&["p_e", "p_n", "p_u"]);
        assert_eq!(components(&enu, "p", Group::REF_POS), Found::East(vec![0, 1, 2]));
        let quat = names(&["q.x", "q.y", "q.z", "q.w"]);
        assert_eq!(components(&quat, "q", Group::REF_QUAT), Found::Scalar(vec![3, 0, 1, 2]));
    }

    #[test]
    fn a_map_is_suggested_by_units_or_words() {
        let fits = |group: Group, unit: &str| {
            super::super::written::unit(group, unit).is_ok_and(|unit| unit.per_interval)
        };
        let euroc = names(&[
            "#timestamp [ns]",
            "w_RS_S_x [rad s^-1]",
            "w_RS_S_y [rad s^-1]",
            "w_RS_S_z [rad s^-1]",
            "a_RS_S_x [m s^-2]",
            "a_RS_S_y [m s^-2]",
            "a_RS_S_z [m s^-2]",
        ]);
        assert_eq!(
            suggested(&euroc, fits).map(|map| map.argument()).as_deref(),
            Some("--map 'gyro=w_RS_S,accel=a_RS_S,time=timestamp [ns]'")
        );
        let px4 = names(&[
            "timestamp",
            "gyro_rad[0]",
            "gyro_rad[1]",
            "gyro_rad[2]",
            "accelerometer_m_s2[0]",
            "accelerometer_m_s2[1]",
            "accelerometer_m_s2[2]",
        ]);
        assert_eq!(
            suggested(&px4, fits).map(|map| map.argument()).as_deref(),
            Some("--map gyro=gyro_rad:rad/s,accel=accelerometer_m_s2:m/s^2,time=timestamp:s")
        );
        assert!(suggested(&names(&["a", "b"]), fits).is_none());
    }
}
