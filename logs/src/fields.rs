//! Reading a TOML document value by value, keeping every fault with its place.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{LogError, TOLD};
use crate::suggest;

/// A document being read, with the faults found so far.
pub(super) struct Document<'a> {
    path: &'a Path,
    text: Arc<str>,
    faults: Vec<LogError>,
}

/// One table of the document.
#[derive(Clone, Copy)]
pub(super) struct Section<'t> {
    name: &'static str,
    table: &'t DeTable<'t>,
    /// Where its header stands: the place of what is missing in it.
    span: (usize, usize),
}

/// The kind of a value with its article.
pub(super) fn kind(value: &DeValue<'_>) -> String {
    let kind = value.type_str();
    format!("{} {kind}", if kind.starts_with(['a', 'i']) { "an" } else { "a" })
}

/// What a number must be.
#[derive(Clone, Copy)]
pub(super) enum Must {
    /// Any number.
    BeFinite,
    /// Above zero.
    BePositive,
    /// Anything but zero.
    BeNonZero,
    /// Between two limits, both allowed.
    LieWithin(f64, f64),
    /// Above zero and up to a limit.
    BePositiveUpTo(f64),
}

impl Must {
    fn admits(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::BeFinite => true,
                Self::BePositive => value > 0.0,
                Self::BeNonZero => value != 0.0,
                Self::LieWithin(low, high) => (low..=high).contains(&value),
                Self::BePositiveUpTo(high) => value > 0.0 && value <= high,
            }
    }

    fn describe(self) -> String {
        match self {
            Self::BeFinite => "a finite number".into(),
            Self::BePositive => "a finite number above 0".into(),
            Self::BeNonZero => "a finite number other than 0".into(),
            Self::LieWithin(low, high) => format!("a number from {} to {}", short(low), short(high)),
            Self::BePositiveUpTo(high) => format!("a number above 0, at most {high}"),
        }
    }
}

/// A limit as people write it.
fn short(limit: f64) -> String {
    if limit != 0.0 && limit.abs() < 1e-3 { format!("{limit:e}") } else { limit.to_string() }
}

impl<'a> Document<'a> {
    pub(super) fn new(path: &'a Path, text: Arc<str>) -> Self {
        Self { path, text, faults: Vec::new() }
    }

    /// All faults as one error, if there are any.
    pub(super) fn finish(self) -> Result<(), LogError> {
        let full = self.is_full();
        let all = LogError::all(self.faults);
        let all =
            if full { all.map(|all| all.note("there may be more faults like these".into())) } else { all };
        all.map_or(Ok(()), Err)
    }

    /// Whether as many faults were found as are told: more are not looked for.
    pub(super) fn is_full(&self) -> bool {
        self.faults.len() >= TOLD
    }

    /// Notes a fault at `span`.
    pub(super) fn refuse(&mut self, span: Range<usize>, field: &str, problem: &str, help: Option<String>) {
        if self.is_full() {
            return;
        }
        let fault = LogError::text(self.path, &self.text, Some(span), Some(field), problem).help_if(help);
        self.faults.push(fault);
    }

    /// Notes that something is not there at all.
    pub(super) fn lack(&mut self, section: Option<Section<'_>>, field: &str, help: &str) {
        if self.is_full() {
            return;
        }
        let span = section.map(|section| section.span.0..section.span.1);
        let fault = LogError::text(self.path, &self.text, span, Some(field), "is missing").help(help);
        self.faults.push(fault);
    }

    /// Refuses names outside `known`.
    pub(super) fn only(&mut self, table: &DeTable<'_>, within: &str, known: &[&str]) {
        for key in table.keys() {
            if self.is_full() {
                break;
            }
            let name = key.get_ref().as_ref();
            if !known.contains(&name) {
                let field = if within.is_empty() { format!("[{name}]") } else { format!("{within}.{name}") };
                let hint = suggest::hint(name, known.iter().copied());
                self.refuse(key.span(), &field, "is not a name of the log format", Some(hint));
            }
        }
    }

    /// The table `[name]`, if it is there.
    pub(super) fn section<'t>(
        &mut self,
        root: &'t DeTable<'t>,
        name: &'static str,
        known: Option<&[&str]>,
    ) -> Option<Section<'t>> {
        let (key, value) = root.get_key_value(name)?;
        let span = (key.span().start, key.span().end);
        let DeValue::Table(table) = value.get_ref() else {
            let problem = format!("is {}, a table was expected", kind(value.get_ref()));
            self.refuse(value.span(), name, &problem, Some(format!("write [{name}]")));
            return None;
        };
        if let Some(known) = known {
            self.only(table, name, known);
        }
        Some(Section { name, table, span })
    }

    /// A number that need not be there.
    pub(super) fn optional(&mut self, section: Section<'_>, key: &str, must: Must) -> Option<f64> {
        let value = section.table.get(key)?;
        self.number(value, &section.field(key), must)
    }

    /// A number that must be there; `help` says what it is.
    pub(super) fn required(
        &mut self,
        section: Section<'_>,
        key: &str,
        must: Must,
        help: &str,
    ) -> Option<f64> {
        if !section.table.contains_key(key) {
            self.lack(Some(section), &section.field(key), help);
        }
        self.optional(section, key, must)
    }

    /// A text that need not be there, and what `read` makes of it.
    pub(super) fn word<T>(
        &mut self,
        section: Section<'_>,
        key: &str,
        read: impl FnOnce(&str) -> Result<T, String>,
    ) -> Option<T> {
        let value = section.table.get(key)?;
        let field = section.field(key);
        match value.get_ref() {
            DeValue::String(text) => match read(text) {
                Ok(read) => Some(read),
                Err(problem) => {
                    self.refuse(value.span(), &field, &problem, None);
                    None
                }
            },
            other => {
                let problem = format!("is {}, a text in quotes was expected", kind(other));
                self.refuse(value.span(), &field, &problem, None);
                None
            }
        }
    }

    /// A list of any numbers that need not be there.
    pub(super) fn numbers(&mut self, section: Section<'_>, key: &str) -> Option<Vec<f64>> {
        let value = section.table.get(key)?;
        let field = section.field(key);
        match value.get_ref() {
            DeValue::Array(items) => {
                items.iter().map(|item| self.number(item, &field, Must::BeFinite)).collect()
            }
            other => {
                let problem = format!("is {}, a list of numbers was expected", kind(other));
                self.refuse(value.span(), &field, &problem, None);
                None
            }
        }
    }

    /// A list of exactly `N` numbers that need not be there.
    pub(super) fn list<const N: usize>(
        &mut self,
        section: Section<'_>,
        key: &str,
        must: Must,
    ) -> Option<[f64; N]> {
        let value = section.table.get(key)?;
        let field = section.field(key);
        let items = match value.get_ref() {
            DeValue::Array(items) if items.len() == N => items,
            DeValue::Array(items) => {
                let entries = if items.len() == 1 { "entry" } else { "entries" };
                let problem = format!("has {} {entries}, {N} numbers were expected", items.len());
                self.refuse(value.span(), &field, &problem, None);
                return None;
            }
            other => {
                let problem = format!("is {}, a list of {N} numbers was expected", kind(other));
                self.refuse(value.span(), &field, &problem, None);
                return None;
            }
        };
        let mut numbers = [0.0; N];
        let mut sound = true;
        for (number, item) in numbers.iter_mut().zip(items.iter()) {
            match self.number(item, &field, must) {
                Some(value) => *number = value,
                None => sound = false,
            }
        }
        sound.then_some(numbers)
    }

    /// A number, checked.
    pub(super) fn number(&mut self, value: &Spanned<DeValue<'_>>, field: &str, must: Must) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) => {
                i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|integer| integer as f64)
            }
            other => {
                let problem = format!("is {}, {} was expected", kind(other), must.describe());
                let help = "a number stands without quotes and without a unit: its unit is in the name";
                let text = matches!(other, DeValue::String(_)).then(|| help.to_owned());
                self.refuse(value.span(), field, &problem, text);
                return None;
            }
        };
        match number {
            Some(number) if must.admits(number) => Some(number),
            Some(number) => {
                let problem = format!("is {number}, {} was expected", must.describe());
                self.refuse(value.span(), field, &problem, None);
                None
            }
            None => {
                let problem = format!("has too many digits, {} was expected", must.describe());
                self.refuse(value.span(), field, &problem, None);
                None
            }
        }
    }
}

impl<'t> Section<'t> {
    /// `section.key`, as messages write it.
    pub(super) fn field(&self, key: &str) -> String {
        format!("{}.{key}", self.name)
    }

    /// The table itself.
    pub(super) fn table(&self) -> &'t DeTable<'t> {
        self.table
    }

    /// Where the value of `key` stands.
    pub(super) fn span_of(&self, key: &str) -> Option<Range<usize>> {
        self.table.get(key).map(Spanned::span)
    }
}
