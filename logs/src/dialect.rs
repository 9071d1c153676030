//! How a table of text is written: what separates its fields, whether decimals have commas, in which line its names stand.

use super::columns::NAMES;
use super::names::{MARKS, Name};
use super::written;

/// What separates fields, in the order in which they are tried.
const SEPARATORS: [Separator; 5] = [
    Separator::Byte(b','),
    Separator::Byte(b';'),
    Separator::Byte(b'\t'),
    Separator::Byte(b'|'),
    Separator::Blanks,
];
/// Longest field that is a unit in a line of units.
const LONGEST_UNIT: usize = 16;

/// What separates the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Separator {
    Byte(u8),
    /// Any number of spaces and tabs.
    Blanks,
}

/// Splits lines into fields; separators within quotes separate nothing.
pub(super) struct Splitter {
    separator: Separator,
    reader: csv_core::Reader,
    fields: Vec<u8>,
    ends: Vec<usize>,
}

impl Splitter {
    pub(super) fn new(separator: Separator) -> Self {
        let mut builder = csv_core::ReaderBuilder::new();
        if let Separator::Byte(byte) = separator {
            builder.delimiter(byte);
        }
        Self { separator, reader: builder.build(), fields: Vec::new(), ends: Vec::new() }
    }

    /// Splits one line, without its end; the number of fields, or nothing where a quote does not end in the line.
    pub(super) fn split(&mut self, line: &str) -> Option<usize> {
        self.ends.clear();
        self.fields.clear();
        if self.separator == Separator::Blanks {
            for field in line.split_ascii_whitespace() {
                self.fields.extend_from_slice(field.as_bytes());
                self.ends.push(self.fields.len());
            }
            return Some(self.ends.len());
        }
        self.fields.resize(line.len() + 1, 0);
        self.ends.resize(line.len() + 2, 0);
        self.reader.reset();
        let (_, _, written, fields) =
            self.reader.read_record(line.as_bytes(), &mut self.fields, &mut self.ends);
        let (result, _, _, more) =
            self.reader.read_record(b"\n", &mut self.fields[written..], &mut self.ends[fields..]);
        self.ends.truncate(fields + more);
        matches!(result, csv_core::ReadRecordResult::Record).then_some(self.ends.len())
    }

    /// The fields of the line that was split, without spaces and quotes around them.
    pub(super) fn fields(&self) -> impl Iterator<Item = &str> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(start, end)| {
            unquoted(
                self.fields
                    .get(*start..*end)
                    .and_then(|field| std::str::from_utf8(field).ok())
                    .unwrap_or_default(),
            )
        })
    }
}

/// Spaces and quotes around a field carry no meaning: all fields are names or numbers.
pub(super) fn unquoted(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|field| field.strip_suffix('"')).unwrap_or(field)
}

/// How a table is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dialect {
    pub(super) separator: Separator,
    pub(super) decimal_comma: bool,
    /// Names of the columns, with the units of a line of units behind them; none where the file has none.
    pub(super) names: Option<Vec<String>>,
    /// Fields of a row.
    pub(super) width: usize,
    /// Every row ends with a separator.
    pub(super) trailing: bool,
    /// Lines, of those given, before the first row.
    pub(super) above: usize,
    /// The line of the names, of those given.
    pub(super) header: Option<usize>,
}

impl Dialect {
    /// Looks at the first lines of a file, empty ones left out.
    pub(super) fn of(lines: &[&str]) -> Self {
        let known = SEPARATORS.into_iter().find_map(|separator| Self::by_own_names(lines, separator));
        known.or_else(|| Self::by_numbers(lines)).unwrap_or_else(|| {
            let names = fields(lines.first().copied().unwrap_or_default(), Separator::Byte(b','));
            Self {
                separator: Separator::Byte(b','),
                decimal_comma: false,
                width: names.len(),
                names: Some(names),
                trailing: false,
                above: 1,
                header: Some(0),
            }
        })
    }

    /// By a line that holds two names of the format.
    fn by_own_names(lines: &[&str], separator: Separator) -> Option<Self> {
        let own = |name: &String| NAMES.contains(&Name::new(name).stem().to_ascii_lowercase().as_str());
        let header = lines.iter().position(|line| {
            let names = fields(unmarked(line), separator);
            names.iter().filter(|name| own(name)).count() > 1
        })?;
        Some(Self::below(lines, separator, header, fields(unmarked(lines[header]), separator), false))
    }

    /// By the lines of numbers: as many fields as most of them, with the separator that makes most numbers of them.
    fn by_numbers(lines: &[&str]) -> Option<Self> {
        let scored = SEPARATORS.into_iter().filter_map(|separator| {
            let rows: Vec<Row> = lines.iter().map(|line| Row::of(line, separator)).collect();
            let width =
                |row: &Row| rows.iter().filter(|other| other.numeric() && other.fields == row.fields).count();
            let usual = rows.iter().filter(|row| row.numeric()).max_by_key(|row| (width(row), row.fields))?;
            let score: usize =
                rows.iter().filter(|row| row.fields == usual.fields).map(|row| row.numbers).sum();
            let first = rows.iter().position(|row| row.numeric() && row.fields == usual.fields)?;
            Some((score, separator, usual.fields, first, rows))
        });
        // the first of equals
        let (_, separator, width, first, rows) =
            scored.fold(None, |best: Option<(usize, _, _, _, _)>, other| match best {
                Some(best) if best.0 >= other.0 => Some(best),
                _ => Some(other),
            })?;
        let trailing =
            rows.iter().filter(|row| row.numeric() && row.fields == width).all(|row| row.ends_empty)
                && width > 1;
        let wanted = if trailing { width - 1 } else { width };
        let header = (0..first).rev().filter(|at| !rows[*at].numeric()).find_map(|at| {
            let names = header_fields(unmarked(lines[at]), separator, wanted);
            (names.len() == wanted).then_some((at, names))
        });
        let Some((mut at, mut names)) = header else {
            let decimal_comma = decimal_comma(lines, separator);
            return Some(Self {
                separator,
                decimal_comma,
                names: None,
                width: wanted,
                trailing,
                above: first,
                header: None,
            });
        };
        if is_of_units(&names) && at > 0 {
            let above = header_fields(unmarked(lines[at - 1]), separator, wanted);
            if above.len() == wanted && !rows[at - 1].numeric() {
                (at, names) = (at - 1, above);
            }
        }
        Some(Self::below(lines, separator, at, names, trailing))
    }

    /// What follows from the line of the names.
    fn below(
        lines: &[&str],
        separator: Separator,
        header: usize,
        mut names: Vec<String>,
        trailing: bool,
    ) -> Self {
        let mut above = header + 1;
        if let Some(next) = lines.get(above) {
            let units = fields(unmarked(next), separator);
            let units: Vec<String> = units.into_iter().take(names.len()).collect();
            if units.len() == names.len() && !Row::of(next, separator).numeric() && is_of_units(&units) {
                for (name, unit) in names.iter_mut().zip(&units) {
                    let unit = unit.trim_matches(['[', ']', '(', ')']);
                    if !unit.is_empty() && unit != "-" && Name::new(name).unit.is_none() {
                        *name = format!("{name} [{unit}]");
                    }
                }
                above += 1;
            }
        }
        let decimal_comma = decimal_comma(lines.get(above..).unwrap_or_default(), separator);
        let width = names.len();
        Self { separator, decimal_comma, names: Some(names), width, trailing, above, header: Some(header) }
    }
}

/// A line as numbers.
struct Row {
    fields: usize,
    numbers: usize,
    empty: usize,
    ends_empty: bool,
}

impl Row {
    fn of(line: &str, separator: Separator) -> Self {
        let fields = fields(line, separator);
        let comma = separator != Separator::Byte(b',');
        Self {
            fields: fields.len(),
            numbers: fields.iter().filter(|field| number(field, comma).is_some()).count(),
            empty: fields.iter().filter(|field| field.is_empty()).count(),
            ends_empty: fields.last().is_some_and(String::is_empty),
        }
    }

    /// Whether at least half of its fields, and two, are numbers.
    fn numeric(&self) -> bool {
        self.numbers >= 2 && 2 * self.numbers >= self.fields - self.empty
    }
}

/// A field as a number, with a decimal comma where that may be.
pub(super) fn number(field: &str, comma: bool) -> Option<f64> {
    if let Ok(number) = field.parse::<f64>() {
        return Some(number);
    }
    let (whole, part) = field.split_once(',').filter(|_| comma)?;
    let digits = |text: &str| text.ends_with(|c: char| c.is_ascii_digit());
    if !digits(whole) || !part.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    format!("{whole}.{part}").parse().ok()
}

/// Whether the numbers of rows have decimal commas: some have a comma, and none a point.
fn decimal_comma(lines: &[&str], separator: Separator) -> bool {
    let mut commas = false;
    for line in lines.iter().filter(|_| separator != Separator::Byte(b',')) {
        for field in fields(line, separator) {
            match (number(&field, true), field.parse::<f64>()) {
                (Some(_), Err(_)) => commas = true,
                (Some(_), Ok(_)) if field.contains('.') => return false,
                _ => {}
            }
        }
    }
    commas
}

fn fields(line: &str, separator: Separator) -> Vec<String> {
    let mut splitter = Splitter::new(separator);
    splitter.split(line);
    splitter.fields().map(str::to_owned).collect()
}

/// The fields of a header; between blanks a unit in brackets belongs to the name before it.
fn header_fields(line: &str, separator: Separator, wanted: usize) -> Vec<String> {
    let mut names = fields(line, separator);
    if separator == Separator::Blanks && names.len() > wanted {
        let mut joined: Vec<String> = Vec::new();
        let mut open = false;
        for name in names {
            let begins = name.starts_with(['[', '(']);
            match joined.last_mut().filter(|_| open || begins) {
                Some(last) => *last = format!("{last} {name}"),
                None => joined.push(name.clone()),
            }
            open = (open || name.contains(['[', '('])) && !name.ends_with([']', ')']);
        }
        names = joined;
        if names.len() > wanted {
            // names with single blanks in them, and more between
            names = line
                .split(['\t'])
                .flat_map(|part| part.split("  "))
                .map(str::trim)
                .filter(|name| !name.is_empty())
                .map(str::to_owned)
                .collect();
        }
    }
    // a separator at the end of the line
    while names.len() > wanted && names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    names
}

/// A line without a sign of comment before its names. A mark that belongs to the first name stays with it.
fn unmarked(line: &str) -> &str {
    let rest = line.trim_start_matches('\u{feff}').trim_start();
    let bare = rest.trim_start_matches('"').trim_start_matches(MARKS);
    // `# time wx`: the mark stands alone; `#time,wx`: it is known to belong to no name either, but is kept to be found by
    if rest.starts_with(MARKS) && bare.starts_with(char::is_whitespace) { bare.trim_start() } else { rest }
}

/// Whether a line holds units and nothing else.
fn is_of_units(fields: &[String]) -> bool {
    let bare = |field: &String| field.trim_matches(['[', ']', '(', ')']).to_owned();
    let said: Vec<String> =
        fields.iter().map(bare).filter(|field| !field.is_empty() && field != "-").collect();
    let short = said.iter().all(|field| field.chars().count() <= LONGEST_UNIT);
    let known = said.iter().filter(|field| written::is_unit(field)).count();
    short && known > 1 && 2 * known >= said.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Dialect {
        Dialect::of(&text.lines().filter(|line| !line.trim().is_empty()).collect::<Vec<_>>())
    }

    fn names(text: &str) -> Vec<String> {
        of(text).names.expect("names")
    }

    #[test]
    fn what_separates_fields_is_found() {
        for (separator, joint) in [
            (Separator::Byte(b','), ","),
            (Separator::Byte(b','), ", "),
            (Separator::Byte(b';'), ";"),
            (Separator::Byte(b'\t'), "\t"),
            (Separator::Byte(b'|'), "|"),
            (Separator::Blanks, "   "),
        ] {
            let text = "t#wx#wy\n1.5#2#3\n2.5#-3e-1#4\n".replace('#', joint);
            let dialect = of(&text);
            assert_eq!(
                (dialect.separator, dialect.above, dialect.decimal_comma),
                (separator, 1, false),
                "{joint:?}"
            );
            assert_eq!(dialect.names.expect("names"), ["t", "wx", "wy"], "{joint:?}");
        }
        for joint in [";", "\t", " "] {
            let dialect = of(&"t#wx#wy\n0,5#2,25#-3,1\n1,5#1,0#4,5\n".replace('#', joint));
            assert!(dialect.decimal_comma && dialect.width == 3, "{joint:?}");
        }
    }

    #[test]
    fn the_names_are_the_last_line_of_names_before_the_numbers() {
        let preamble = "Fs,200\nType,0\nStarted,36.5\n\na_x,a_y,a_z\n1,2,3\n4,5,6\n";
        let dialect = of(preamble);
        assert_eq!((dialect.above, dialect.header), (4, Some(3)));
        assert_eq!(names(preamble), ["a_x", "a_y", "a_z"]);
        assert_eq!(names("# made by a logger\n# time wx wy\n0 1 2\n1 2 3\n"), ["time", "wx", "wy"]);
        assert_eq!(names("#t [ns],w_x [rad s^-1]\n14,0.1\n15,0.2\n"), ["#t [ns]", "w_x [rad s^-1]"]);
        assert_eq!(names("%time,field.x\n14,0.1\n15,0.2\n"), ["%time", "field.x"]);
        assert_eq!(names("# t [s]  w x [rad s^-1]\n1 2\n3 4\n"), ["t [s]", "w x [rad s^-1]"]);
        assert_eq!(names("t [s]  wx [rad s^-1]\n1 2\n3 4\n"), ["t [s]", "wx [rad s^-1]"]);
        // text beside numbers, and a quoted field with a separator in it
        assert_eq!(names("t,frame,x,y\n1,imu,2,3\n2,imu,3,4\n").len(), 4);
        assert_eq!(names("t,\"rate, x\",y\n1,2,3\n2,3,4\n"), ["t", "rate, x", "y"]);
        assert_eq!(of("1,2,3\n4,5,6\n").names, None);
    }

    #[test]
    fn a_line_of_units_belongs_to_the_names() {
        assert_eq!(names("t,wx,fx\ns,deg/s,m/s^2\n1,2,3\n4,5,6\n"), ["t [s]", "wx [deg/s]", "fx [m/s^2]"]);
        assert_eq!(names("t\twx\n[ms]\t[rad/s]\n1\t2\n4\t5\n"), ["t [ms]", "wx [rad/s]"]);
        assert_eq!(of("t,wx,fx\ns,deg/s,m/s^2\n1,2,3\n4,5,6\n").above, 2);
        // names are no units
        assert_eq!(names("a,b\nt,wx\n1,2\n4,5\n"), ["t", "wx"]);
    }

    #[test]
    fn a_separator_at_the_end_of_every_row_is_no_column() {
        let dialect = of("t,wx,wy,\n1,2,3,\n4,5,6,\n");
        assert!(dialect.trailing && dialect.width == 3);
        assert!(!of("t,wx,wy\n1,2,3\n4,5,\n").trailing);
    }

    #[test]
    fn quotes_that_do_not_end_are_noticed() {
        let mut splitter = Splitter::new(Separator::Byte(b','));
        assert_eq!(splitter.split("a,\"b,c"), None);
        assert_eq!(splitter.split("a,\"b,c\",d"), Some(3));
        assert_eq!(splitter.fields().collect::<Vec<_>>(), ["a", "b,c", "d"]);
    }
}
