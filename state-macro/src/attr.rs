//! Attributes, to keys and values. A mistake in one key does not hide the others.

use proc_macro2::{Ident, TokenStream, TokenTree};
use quote::ToTokens;
use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream, Parser};
use syn::token::Paren;
use syn::{Attribute, Error, LitStr, Meta, Path, Result, Token, Type, parenthesized};

use crate::errors::Errors;

/// What the struct is declared to be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Filter,
    Group,
}

impl Kind {
    const ALL: [Self; 2] = [Kind::Filter, Kind::Group];

    fn of(path: &Path) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| path.is_ident(kind.keyword()))
    }

    /// The kind of an attribute that rustc reports as unknown: what was meant is not missing too.
    fn meant(path: &Path) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| misspells(path, kind.keyword()))
    }

    fn keyword(self) -> &'static str {
        match self {
            Kind::Filter => "filter",
            Kind::Group => "group",
        }
    }

    fn keys(self) -> &'static [&'static str] {
        match self {
            Kind::Filter => &["measures", "name", "dynamics", "crate"],
            Kind::Group => &["dynamics", "crate"],
        }
    }
}

/// `measures(velocity, my::Range)`.
pub(crate) struct Measures {
    pub(crate) keyword: Ident,
    pub(crate) list: Vec<Measured>,
}

/// What is measured.
pub(crate) enum Measured {
    /// One of ours, by its name.
    Ours(Ident),
    /// Any measurement, by its type.
    Type(Path),
}

/// The measurements that have names, and their types in `sinscal::measurements`.
const OURS: [(&str, &str); 6] = [
    ("velocity", "Velocity"),
    ("position", "Position"),
    ("attitude", "Attitude"),
    ("rate", "Rate"),
    ("height", "Height"),
    ("heading", "Heading"),
];

impl Measured {
    /// A word that begins with a small letter is a name.
    fn of(path: Path) -> Self {
        match path.get_ident() {
            Some(name) if name.unraw().to_string().starts_with(|c: char| !c.is_uppercase()) => {
                Measured::Ours(name.clone())
            }
            _ => Measured::Type(path),
        }
    }

    /// The type called by a name of ours; of a name that is none, what to say.
    pub(crate) fn named(name: &Ident) -> std::result::Result<Ident, String> {
        let text = name.unraw().to_string();
        if let Some((_, ty)) = OURS.iter().find(|(ours, _)| *ours == text) {
            return Ok(Ident::new(ty, name.span()));
        }
        let names = OURS.map(|(ours, _)| ours);
        let near = near(&names, &text, |_| text.len() / 2);
        Err(format!(
            "there is no measurement `{text}`: ours are {}, one of your own is named by its type{}",
            names.join(", "),
            near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
        ))
    }
}

impl ToTokens for Measured {
    fn to_tokens(&self, tokens: &mut TokenStream) {
        match self {
            Measured::Ours(name) => name.to_tokens(tokens),
            Measured::Type(path) => path.to_tokens(tokens),
        }
    }
}

/// The attributes of the struct.
#[derive(Default)]
pub(crate) struct Attributes {
    /// `None` when there is neither `#[filter]` nor `#[group]`.
    pub(crate) kind: Option<Kind>,
    pub(crate) measures: Option<Measures>,
    pub(crate) name: Option<LitStr>,
    pub(crate) dynamics: Option<Type>,
    /// `crate = path`.
    pub(crate) krate: Option<Path>,
    /// Some of the keys could not be read: what is missing may be among them.
    pub(crate) garbled: bool,
}

impl Attributes {
    pub(crate) fn read(attrs: &[Attribute], errors: &mut Errors) -> Self {
        let mut read = Attributes::default();
        for attr in attrs {
            if attr.path().is_ident("base") {
                errors.at(attr, "`#[base]` marks the first field of a filter, not the struct");
            }
            if attr.path().is_ident("consider") {
                errors.at(attr, "`#[consider]` marks a field, not the struct");
            }
            let Some(kind) = Kind::of(attr.path()).or_else(|| Kind::meant(attr.path())) else { continue };
            match read.kind {
                Some(earlier) if earlier != kind => {
                    errors.at(attr, "a declaration is a filter or a group, not both");
                    continue;
                }
                _ => read.kind = Some(kind),
            }
            let known = errors.len();
            read.arguments(kind, attr, errors);
            read.garbled |= errors.len() > known;
        }
        read
    }

    fn arguments(&mut self, kind: Kind, attr: &Attribute, errors: &mut Errors) {
        let list = match &attr.meta {
            Meta::Path(_) => return,
            Meta::List(list) => list,
            Meta::NameValue(_) => {
                let keyword = kind.keyword();
                return errors.at(attr, format_args!("keys stand in parentheses: `#[{keyword}(...)]`"));
            }
        };
        let parser = |input: ParseStream| {
            separated(input, errors, |input, errors| self.key(kind, input, errors));
            Ok(())
        };
        if let Err(error) = parser.parse2(list.tokens.clone()) {
            errors.push(error);
        }
    }

    fn key(&mut self, kind: Kind, input: ParseStream, errors: &mut Errors) -> Result<()> {
        let Ok(key) = input.call(Ident::parse_any) else {
            return Err(input.error(format_args!("expected a key: {}", kind.keys().join(", "))));
        };
        let text = key.to_string();
        let words = match text.as_str() {
            _ if !kind.keys().contains(&text.as_str()) => {
                return Err(Error::new(key.span(), unknown_key(kind, &text)));
            }
            "measures" => "`measures` is a list of names and types: `measures(velocity, position)`",
            "name" => "`name` is a text: `name = \"43d-b\"`",
            "dynamics" => "`dynamics` is a type: `dynamics = Strapdown`",
            _ => "`crate` is a path: `crate = ::sinscal::calib_core`",
        };
        let malformed = |_| Error::new(key.span(), words);
        let twice = match text.as_str() {
            "measures" => {
                if !input.peek(Paren) {
                    return Err(Error::new(key.span(), words));
                }
                let list = measured(input, words, errors)?;
                self.measures.replace(Measures { keyword: key.clone(), list }).is_some()
            }
            "name" => self.name.replace(value(input, <LitStr as Parse>::parse).map_err(malformed)?).is_some(),
            "dynamics" => {
                self.dynamics.replace(value(input, <Type as Parse>::parse).map_err(malformed)?).is_some()
            }
            _ => self.krate.replace(value(input, Path::parse_mod_style).map_err(malformed)?).is_some(),
        };
        if twice {
            return Err(Error::new(key.span(), format_args!("`{text}` is given twice")));
        }
        Ok(())
    }
}

fn unknown_key(kind: Kind, key: &str) -> String {
    let keyword = kind.keyword();
    if kind == Kind::Group && Kind::Filter.keys().contains(&key) {
        return format!(
            "`{key}` belongs to `#[filter(...)]`: a group is a part of filters and measures nothing itself"
        );
    }
    let keys = kind.keys().join(", ");
    let mut message = format!("unknown key `{key}`: `#[{keyword}(...)]` takes {keys}");
    if let Some(known) = near(kind.keys(), key, |known| known.len() / 3) {
        message += &format!("; did you mean `{known}`?");
    }
    message
}

/// The one of `known` that is no more than `most` edits away from `word`.
fn near<'a>(known: &[&'a str], word: &str, most: impl Fn(&str) -> usize) -> Option<&'a str> {
    let (edits, near) = known.iter().map(|known| (distance(known, word), *known)).min()?;
    (edits <= most(near)).then_some(near)
}

/// `(velocity, my::Range)`.
fn measured(input: ParseStream, words: &str, errors: &mut Errors) -> Result<Vec<Measured>> {
    let content;
    parenthesized!(content in input);
    let mut list = Vec::new();
    separated(&content, errors, |input, _| {
        let path = if input.peek(Ident::peek_any) && !input.peek2(Token![::]) {
            input.call(Ident::parse_any).map(Path::from)
        } else {
            input.call(Path::parse_mod_style)
        };
        list.push(Measured::of(path.map_err(|error| Error::new(error.span(), words))?));
        Ok(())
    });
    Ok(list)
}

/// `= value`.
fn value<T>(input: ParseStream, parse: impl FnOnce(ParseStream) -> Result<T>) -> Result<T> {
    input.parse::<Token![=]>()?;
    parse(input)
}

/// Reads what stands between commas; after a mistake goes on behind the next one.
fn separated(
    input: ParseStream,
    errors: &mut Errors,
    mut read: impl FnMut(ParseStream, &mut Errors) -> Result<()>,
) {
    while !input.is_empty() {
        let outcome = read(input, errors);
        let ended = input.is_empty() || input.peek(Token![,]);
        match outcome {
            Err(error) => errors.push(error),
            Ok(()) if !ended => errors.push(input.error("expected `,`")),
            Ok(()) => {}
        }
        while !input.is_empty() && !input.peek(Token![,]) {
            let _ = input.parse::<TokenTree>();
        }
        let _ = input.parse::<Option<Token![,]>>();
    }
}

/// The attributes of a field.
pub(crate) struct FieldAttributes {
    /// The field is marked `#[base]`.
    pub(crate) base: bool,
    /// The field is marked `#[consider]`.
    pub(crate) consider: bool,
    /// Its documentation.
    pub(crate) docs: Vec<Attribute>,
}

impl FieldAttributes {
    pub(crate) fn read(attrs: &[Attribute], errors: &mut Errors) -> Self {
        let mut read = FieldAttributes { base: false, consider: false, docs: Vec::new() };
        for attr in attrs {
            let path = attr.path();
            if let Some(kind) = Kind::of(path) {
                let keyword = kind.keyword();
                errors.at(attr, format_args!("`#[{keyword}]` describes the struct, not a field of it"));
            } else if path.is_ident("base") {
                if !matches!(attr.meta, Meta::Path(_)) {
                    errors.at(attr, "`#[base]` takes nothing: the base is the type of its field");
                } else if read.base {
                    errors.at(attr, "`#[base]` is given twice");
                }
                read.base = true;
            } else if path.is_ident("consider") {
                if !matches!(attr.meta, Meta::Path(_)) {
                    errors.at(attr, "`#[consider]` takes nothing: all states of its field are considered");
                } else if read.consider {
                    errors.at(attr, "`#[consider]` is given twice");
                }
                read.consider = true;
            } else if path.is_ident("doc") {
                read.docs.push(attr.clone());
            } else if misspells(path, "base") {
                read.base = true;
            }
        }
        if let Some(attr) = attrs.iter().find(|attr| read.base && attr.path().is_ident("consider")) {
            errors.at(attr, "a base is not considered as a whole: its leading states are what is navigated");
            read.consider = false;
        }
        read
    }
}

/// Whether an attribute is nearly the one called `name`. rustc, which knows all that there are, reports it and says what is
/// similar; here it is read as what was meant.
fn misspells(path: &Path, name: &str) -> bool {
    path.get_ident().is_some_and(|ident| (1..=2).contains(&distance(&ident.to_string(), name)))
}

/// Edits that turn `a` into `b`.
fn distance(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.bytes().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, to) in b.bytes().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
