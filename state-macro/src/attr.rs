//! Attributes, to keys and values. A mistake in one key does not hide the others.

use proc_macro2::{Ident, TokenTree};
use syn::ext::IdentExt;
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Error, LitStr, Meta, Path, Result, Token, Type, parenthesized};

use crate::errors::Errors;

/// What the struct is declared to be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Filter,
    Group,
}

impl Kind {
    fn of(path: &Path) -> Option<Self> {
        if path.is_ident("filter") {
            Some(Kind::Filter)
        } else if path.is_ident("group") {
            Some(Kind::Group)
        } else {
            None
        }
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

/// `measures(velocity, position)`.
pub(crate) struct Measures {
    pub(crate) keyword: Ident,
    pub(crate) names: Vec<Ident>,
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
}

impl Attributes {
    pub(crate) fn read(attrs: &[Attribute], errors: &mut Errors) -> Self {
        let mut read = Attributes::default();
        for attr in attrs {
            if attr.path().is_ident("base") {
                errors.at(attr, "`#[base]` marks the first field of a filter, not the struct");
            }
            let Some(kind) = Kind::of(attr.path()) else { continue };
            match read.kind {
                Some(earlier) if earlier != kind => {
                    errors.at(attr, "a declaration is a filter or a group, not both");
                    continue;
                }
                _ => read.kind = Some(kind),
            }
            read.arguments(kind, attr, errors);
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
        let key = input.call(Ident::parse_any)?;
        let text = key.to_string();
        if !kind.keys().contains(&text.as_str()) {
            return Err(Error::new(key.span(), unknown_key(kind, &text)));
        }
        let twice = match text.as_str() {
            "measures" => {
                let measures = measures(key.clone(), input, errors)?;
                self.measures.replace(measures).is_some()
            }
            "name" => self.name.replace(value(input, "`name` is a text: `name = \"43d-b\"`")?).is_some(),
            "dynamics" => {
                let words = "`dynamics` is a type: `dynamics = Strapdown`";
                self.dynamics.replace(value(input, words)?).is_some()
            }
            _ => {
                let words = "`crate` is a path: `crate = ::sinscal::calib_core`";
                self.krate
                    .replace(
                        input
                            .parse::<Token![=]>()
                            .and_then(|_| Path::parse_mod_style(input))
                            .map_err(reword(words))?,
                    )
                    .is_some()
            }
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
    let near = kind.keys().iter().map(|known| (distance(known, key), known)).min();
    if let Some((edits, known)) = near
        && edits <= known.len() / 3
    {
        message += &format!("; did you mean `{known}`?");
    }
    message
}

fn measures(keyword: Ident, input: ParseStream, errors: &mut Errors) -> Result<Measures> {
    const WORDS: &str = "`measures` is a list of names: `measures(velocity, position)`";
    if !input.peek(syn::token::Paren) {
        return Err(Error::new(keyword.span(), WORDS));
    }
    let content;
    parenthesized!(content in input);
    let mut names = Vec::new();
    separated(&content, errors, |input, _| {
        names.push(input.call(Ident::parse_any).map_err(reword(WORDS))?);
        Ok(())
    });
    Ok(Measures { keyword, names })
}

/// `= value`.
fn value<T: syn::parse::Parse>(input: ParseStream, words: &'static str) -> Result<T> {
    input.parse::<Token![=]>().and_then(|_| input.parse()).map_err(reword(words))
}

fn reword(words: &'static str) -> impl FnOnce(Error) -> Error {
    move |error| Error::new(error.span(), words)
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
    /// Its documentation.
    pub(crate) docs: Vec<Attribute>,
}

impl FieldAttributes {
    pub(crate) fn read(attrs: &[Attribute], errors: &mut Errors) -> Self {
        let mut read = FieldAttributes { base: false, docs: Vec::new() };
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
            } else if path.is_ident("doc") {
                read.docs.push(attr.clone());
            }
        }
        read
    }
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
