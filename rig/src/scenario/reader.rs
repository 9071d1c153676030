//! Reads a scenario value by value over the default one, keeping every fault with its place.

use nalgebra::Vector3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{Fault, TOLD};
use logs::suggest;
use logs::units::{self, Units};

/// A scenario being read.
pub(super) struct Reader<'t> {
    text: &'t str,
    user: &'t DeTable<'t>,
    fallback: &'t DeTable<'t>,
    pub(super) faults: Vec<Fault>,
}

/// One table of the scenario and what stands for the keys it lacks.
#[derive(Clone)]
pub(super) struct Section<'t> {
    pub(super) name: String,
    pub(super) user: Option<&'t DeTable<'t>>,
    fallback: Option<&'t DeTable<'t>>,
}

/// A value and the field it stands in.
#[derive(Clone)]
pub(super) struct Entry<'t> {
    pub(super) field: String,
    pub(super) value: &'t Spanned<DeValue<'t>>,
}

/// What a quantity must be, in SI units.
#[derive(Clone, Copy)]
pub(super) enum Must {
    /// Any finite number.
    BeFinite,
    /// Anything finite but zero.
    BeNonZero,
    /// Above zero and up to a limit.
    BePositive(f64),
    /// From zero to a limit.
    NotBeNegative(f64),
    /// Between two limits, both included.
    LieWithin(f64, f64),
}

impl Must {
    fn admits(self, x: f64) -> bool {
        x.is_finite()
            && match self {
                Self::BeFinite => true,
                Self::BeNonZero => x != 0.0,
                Self::BePositive(most) => x > 0.0 && x <= most,
                Self::NotBeNegative(most) => (0.0..=most).contains(&x),
                Self::LieWithin(low, high) => (low..=high).contains(&x),
            }
    }

    /// In the unit of the refused text `like`.
    fn describe(self, units: Units, like: &str) -> String {
        let write = |x| units::write(x, units, like);
        match self {
            Self::BeFinite => "a finite number".into(),
            Self::BeNonZero => "anything but zero".into(),
            Self::BePositive(most) => format!("more than 0, at most {}", write(most)),
            Self::NotBeNegative(most) => format!("from 0 to {}", write(most)),
            Self::LieWithin(low, high) => format!("from {} to {}", write(low), write(high)),
        }
    }
}

impl<'t> Reader<'t> {
    pub(super) fn new(text: &'t str, user: &'t DeTable<'t>, fallback: &'t DeTable<'t>) -> Self {
        Self { text, user, fallback, faults: Vec::new() }
    }

    /// Whether as many faults were found as are told: more are not looked for.
    pub(super) fn is_full(&self) -> bool {
        self.faults.len() >= TOLD
    }

    /// Notes a fault of a value.
    pub(super) fn refuse(&mut self, entry: &Entry<'_>, problem: &str, accepted: impl Into<String>) {
        if self.is_full() {
            return;
        }
        let fault = Fault::new(&*entry.field, problem, accepted).at(self.text, entry.value.span());
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
                let field = if within.is_empty() { name.to_owned() } else { format!("{within}.{name}") };
                let accepted = suggest::accepted(name, known.iter().copied());
                let fault = Fault::new(field, "is not known", accepted).at(self.text, key.span());
                self.faults.push(fault);
            }
        }
    }

    /// The tables of the scenario.
    pub(super) fn sections(&mut self, known: &[&str]) {
        self.only(self.user, "", known);
    }

    /// The table `[name]`, which knows the keys `known`.
    pub(super) fn section(&mut self, name: &str, known: &[&str]) -> Section<'t> {
        let root = Section { name: String::new(), user: Some(self.user), fallback: Some(self.fallback) };
        self.within(&root, name, Some(known))
    }

    /// The table `name` inside another; with `known` none, whatever it holds.
    pub(super) fn within(&mut self, outer: &Section<'t>, name: &str, known: Option<&[&str]>) -> Section<'t> {
        let field = if outer.name.is_empty() { name.to_owned() } else { format!("{}.{name}", outer.name) };
        let fallback = outer.fallback.and_then(|table| table.get(name)).and_then(|value| as_table(value));
        let mut user = None;
        if let Some(value) = outer.user.and_then(|table| table.get(name)) {
            match as_table(value) {
                Some(table) => {
                    if let Some(known) = known {
                        self.only(table, &field, known);
                    }
                    user = Some(table);
                }
                None => {
                    let entry = Entry { field: field.clone(), value };
                    self.refuse(&entry, "is not a table", format!("[{field}]"));
                }
            }
        }
        Section { name: field, user, fallback }
    }

    /// The content of `[name]` of the scenario, or else of the default one.
    pub(super) fn whole(&mut self, name: &str) -> Vec<(&'t str, Entry<'t>)> {
        let root = Section { name: String::new(), user: Some(self.user), fallback: Some(self.fallback) };
        let section = self.within(&root, name, None);
        let table = section.user.or(section.fallback);
        let Some(table) = table else { return Vec::new() };
        table
            .iter()
            .map(|(key, value)| {
                let key = key.get_ref().as_ref();
                (key, Entry { field: format!("{name}.{key}"), value })
            })
            .collect()
    }

    /// The value of a key, by the scenario or else by the default one.
    pub(super) fn entry(&self, section: &Section<'t>, key: &str) -> Option<Entry<'t>> {
        let value = section
            .user
            .and_then(|table| table.get(key))
            .or_else(|| section.fallback.and_then(|table| table.get(key)))?;
        Some(Entry { field: format!("{}.{key}", section.name), value })
    }

    fn required(&mut self, section: &Section<'t>, key: &str) -> Option<Entry<'t>> {
        let entry = self.entry(section, key);
        if entry.is_none() {
            self.faults.push(Fault::new(format!("{}.{key}", section.name), "is missing", ""));
        }
        entry
    }

    /// One quantity.
    pub(super) fn quantity(
        &mut self,
        section: &Section<'t>,
        key: &str,
        units: Units,
        must: Must,
    ) -> Option<f64> {
        let entry = self.required(section, key)?;
        self.value(&entry, units, must)
    }

    /// The quantity in an entry.
    pub(super) fn value(&mut self, entry: &Entry<'t>, units: Units, must: Must) -> Option<f64> {
        if self.is_full() {
            return None;
        }
        let value = match entry.value.get_ref() {
            DeValue::String(text) => match units::read(text, units) {
                Ok(value) => value,
                Err(accepted) => {
                    self.refuse(entry, &format!("is \"{text}\""), accepted);
                    return None;
                }
            },
            other => {
                let names = units.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
                let problem = format!("is {} {}", article(other.type_str()), other.type_str());
                self.refuse(
                    entry,
                    &problem,
                    format!("a number, a space and its unit in quotes; units: {names}"),
                );
                return None;
            }
        };
        if must.admits(value) {
            return Some(value);
        }
        let text = entry.value.get_ref().as_str().unwrap_or_default();
        self.refuse(entry, &format!("is \"{text}\""), must.describe(units, text));
        None
    }

    /// One quantity for all axes, or a list of three.
    pub(super) fn three(
        &mut self,
        section: &Section<'t>,
        key: &str,
        units: Units,
        must: Must,
    ) -> Option<Vector3<f64>> {
        let entry = self.required(section, key)?;
        self.list(&entry, 3, units, must).map(|values| Vector3::from_column_slice(&values))
    }

    /// One quantity that counts `length` times, or a list of that length.
    pub(super) fn list(
        &mut self,
        entry: &Entry<'t>,
        length: usize,
        units: Units,
        must: Must,
    ) -> Option<Vec<f64>> {
        let Some(items) = entry.value.get_ref().as_array() else {
            return self.value(entry, units, must).map(|value| vec![value; length]);
        };
        if items.len() != length {
            let problem = format!("has {} values", items.len());
            self.refuse(entry, &problem, format!("one quantity, or a list of {length}"));
            return None;
        }
        let mut values = Vec::with_capacity(length);
        for (i, value) in items.iter().enumerate() {
            let item = Entry { field: format!("{}[{i}]", entry.field), value };
            values.extend(self.value(&item, units, must));
        }
        (values.len() == length).then_some(values)
    }

    /// One word out of `accepted`: its place among them.
    pub(super) fn word(&mut self, section: &Section<'t>, key: &str, accepted: &[&str]) -> Option<usize> {
        let entry = self.required(section, key)?;
        self.choice(&entry, accepted)
    }

    /// The word in an entry, as its place among `accepted`.
    pub(super) fn choice(&mut self, entry: &Entry<'t>, accepted: &[&str]) -> Option<usize> {
        let found = entry.value.get_ref().as_str();
        let place = found.and_then(|word| accepted.iter().position(|known| *known == word));
        if place.is_none() && !self.is_full() {
            let problem =
                found.map_or_else(|| "is not a word in quotes".to_owned(), |word| format!("is \"{word}\""));
            let accepted = suggest::accepted(found.unwrap_or_default(), accepted.iter().copied());
            self.refuse(entry, &problem, accepted);
        }
        place
    }

    /// A whole number from zero on.
    pub(super) fn whole_number(&mut self, section: &Section<'t>, key: &str) -> Option<u64> {
        let entry = self.required(section, key)?;
        let value = entry.value.get_ref().as_integer();
        let value = value.and_then(|i| u64::from_str_radix(i.as_str(), i.radix()).ok());
        if value.is_none() {
            self.refuse(&entry, "is no whole number", "0, 1, 2, ...");
        }
        value
    }

    /// `true` or `false`.
    pub(super) fn switch(&mut self, section: &Section<'t>, key: &str) -> Option<bool> {
        let entry = self.required(section, key)?;
        let value = entry.value.get_ref().as_bool();
        if value.is_none() {
            self.refuse(&entry, "is no switch", "true, false");
        }
        value
    }
}

pub(super) fn as_table<'t>(value: &'t Spanned<DeValue<'t>>) -> Option<&'t DeTable<'t>> {
    value.get_ref().as_table()
}

fn article(word: &str) -> &'static str {
    if word.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" }
}
