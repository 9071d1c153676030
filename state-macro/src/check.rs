//! What the names of a declaration show to be wrong. What only types can tell is left to `calib_core::declare`.

use quote::ToTokens;
use syn::{GenericArgument, PathArguments, Type};

use crate::ast::Declaration;
use crate::attr::{Kind, Measured};
use crate::errors::Errors;
use crate::layout::Layout;
use crate::view::shown;

/// Reports every mistake that is seen without types, and marks the fields it has spoken about.
pub(crate) fn check(declaration: &mut Declaration, errors: &mut Errors) {
    kind(declaration, errors);
    measures(declaration, errors);
    name(declaration, errors);
    bases(declaration, errors);
    wrapped(declaration, errors);
    types(declaration, errors);
    dynamics(declaration, errors);
}

fn kind(declaration: &Declaration, errors: &mut Errors) {
    if declaration.attrs.kind.is_none() {
        errors.at(
            declaration.ident,
            "a filter or a group of blocks? Say `#[filter(measures(...))]` or `#[group]` above the struct",
        );
    }
}

fn measures(declaration: &Declaration, errors: &mut Errors) {
    let Some(measures) = &declaration.attrs.measures else {
        let attrs = declaration.attrs;
        if attrs.kind == Some(Kind::Filter) && !attrs.garbled && declaration.base().is_none() {
            errors.at(
                declaration.ident,
                "a filter without a base says what it measures: `#[filter(measures(velocity, position))]`",
            );
        }
        return;
    };
    if measures.list.is_empty() {
        errors.at(&measures.keyword, "a filter measures something: `measures(velocity, position)`");
    }
    for (i, measured) in measures.list.iter().enumerate() {
        let text = shown(measured);
        if measures.list[..i].iter().any(|earlier| shown(earlier) == text) {
            errors.at(measured, format_args!("`{text}` is measured twice"));
        }
        let Measured::Ours(name) = measured else { continue };
        match Measured::named(name) {
            Err(words) => errors.at(name, words),
            // without dynamics that is what is wrong, and is told
            Ok(ty) if declaration.attrs.krate.is_some() && declaration.attrs.dynamics.is_some() => errors.at(
                name,
                format_args!(
                    "with `crate` measurements are named by their types, `sinscal::measurements::{ty}`"
                ),
            ),
            Ok(_) => {}
        }
    }
}

fn name(declaration: &Declaration, errors: &mut Errors) {
    let Some(name) = &declaration.attrs.name else { return };
    let text = name.value();
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if text.is_empty() || !text.chars().all(allowed) {
        errors.at(
            name,
            "a filter's name is made of lower-case letters, digits and hyphens: `name = \"43d-b\"`",
        );
    }
}

/// A base that cannot be one is taken for a field like any other.
fn bases(declaration: &mut Declaration, errors: &mut Errors) {
    let group = declaration.attrs.kind == Some(Kind::Group);
    let leading = declaration.fields[0].ident;
    let mut first = None;
    for (i, field) in declaration.fields.iter_mut().enumerate().filter(|(_, field)| field.base) {
        let ident = field.ident;
        if group {
            errors.at(&*field, format_args!("`{ident}` in a group: only a filter extends a base"));
            field.base = false;
        } else if let Some(first) = first {
            errors.at(&*field, format_args!("a second base: the filter already extends `{first}`"));
            field.base = false;
            // its blocks are those of the other one, more likely than not
            field.repeated = true;
        } else if i > 0 {
            errors.at(&*field, format_args!("the base comes first: `{ident}` stands after `{leading}`"));
        }
        first = first.or(Some(ident));
    }
}

/// A block in an `Option` or the like is taken for the block.
fn wrapped(declaration: &mut Declaration, errors: &mut Errors) {
    for field in &mut declaration.fields {
        if let Some(inner) = inner(field.ty) {
            let ident = field.ident;
            let (shown, bare) = (shown(field.ty), shown(inner));
            errors.at(
                field.ty,
                format_args!(
                    "`{shown}` is not a state block: a field is one block, which is there, as in `{ident}: {bare}`"
                ),
            );
            field.ty = inner;
        }
    }
}

/// What a type that is no block holds.
fn inner(ty: &Type) -> Option<&Type> {
    const WRAPPERS: [&str; 4] = ["Option", "Vec", "Box", "PhantomData"];
    match ty {
        Type::Array(array) => Some(innermost(&array.elem)),
        Type::Reference(reference) => Some(innermost(&reference.elem)),
        Type::Path(path) => {
            let last = path.path.segments.last()?;
            let PathArguments::AngleBracketed(arguments) = &last.arguments else { return None };
            match arguments.args.first()? {
                GenericArgument::Type(held) if WRAPPERS.iter().any(|name| last.ident == name) => {
                    Some(innermost(held))
                }
                _ => None,
            }
        }
        _ => None,
    }
}

fn innermost(ty: &Type) -> &Type {
    inner(ty).unwrap_or(ty)
}

/// The same type twice; a type under two names, or within a group, is left to the compiler.
fn types(declaration: &mut Declaration, errors: &mut Errors) {
    let mut seen: Vec<(String, String)> = Vec::new();
    for field in &mut declaration.fields {
        let ty = field.ty.to_token_stream().to_string();
        match seen.iter().find(|(earlier, _)| *earlier == ty) {
            Some((_, name)) => {
                let ident = field.ident;
                let shown = shown(field.ty);
                errors.at(
                    &*field,
                    format_args!("`{ident}` declares a block twice: `{name}` is already `{shown}`"),
                );
                field.repeated = true;
            }
            None => seen.push((ty, field.ident.to_string())),
        }
    }
}

fn dynamics(declaration: &Declaration, errors: &mut Errors) {
    let attrs = declaration.attrs;
    if let Some(krate) = &attrs.krate
        && Layout::of(declaration).is_none()
    {
        errors.at(krate, "`crate` without `dynamics`: only `sinscal` has dynamics to fall back on");
    }
}
