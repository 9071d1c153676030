//! A declaration, to the paths and names that are written.

use proc_macro2::{Ident, TokenStream};
use quote::{ToTokens, format_ident, quote, quote_spanned};
use syn::ext::IdentExt;

use crate::ast::{Declaration, Field};
use crate::attr::{Attributes, Kind, Measured};

/// What the implementations of a declaration name.
pub(crate) struct Layout<'a> {
    pub(crate) declaration: &'a Declaration<'a>,
    /// Path of the core.
    pub(crate) core: TokenStream,
    /// Type of the dynamics.
    pub(crate) dynamics: TokenStream,
    /// Name in reports.
    pub(crate) name: String,
    /// Name of the view.
    pub(crate) view: Ident,
    /// Name of the struct of offsets.
    pub(crate) offsets: Ident,
}

impl<'a> Layout<'a> {
    /// `None` when nothing says what the dynamics are.
    pub(crate) fn of(declaration: &'a Declaration<'a>) -> Option<Self> {
        let Declaration { ident, attrs, .. } = declaration;
        let core = core(attrs);
        let dynamics = match (&attrs.dynamics, declaration.base()) {
            (Some(dynamics), _) => dynamics.to_token_stream(),
            (None, Some(Field { ty, .. })) => quote!(<#ty as #core::Block>::Dynamics),
            (None, None) => default_dynamics(attrs)?,
        };
        Some(Layout {
            declaration,
            core,
            dynamics,
            name: attrs.name.as_ref().map_or_else(|| kebab(&ident.unraw().to_string()), |name| name.value()),
            view: format_ident!("{}View", ident),
            offsets: format_ident!("{}Offsets", ident),
        })
    }

    /// Types of the measurements, each once; `None` where they are those of the base. What the names showed to be wrong is left out.
    pub(crate) fn measured(&self) -> Option<Vec<TokenStream>> {
        let Declaration { attrs, .. } = self.declaration;
        if attrs.measures.is_none() && self.declaration.base().is_some() {
            return None;
        }
        let mut types: Vec<TokenStream> = Vec::new();
        for measured in attrs.measures.iter().flat_map(|measures| &measures.list) {
            let ty = match measured {
                Measured::Type(path) => path.to_token_stream(),
                Measured::Ours(_) if attrs.krate.is_some() => continue,
                Measured::Ours(name) => match Measured::named(name) {
                    Ok(ty) => quote_spanned!(name.span()=> ::sinscal::measurements::#ty),
                    Err(_) => continue,
                },
            };
            if !types.iter().any(|earlier| earlier.to_string() == ty.to_string()) {
                types.push(ty);
            }
        }
        Some(types)
    }

    /// Whether a filter is written. A struct that says neither counts as one, so that its uses compile.
    pub(crate) fn is_filter(&self) -> bool {
        self.declaration.attrs.kind != Some(Kind::Group)
    }
}

/// Path of the core.
pub(crate) fn core(attrs: &Attributes) -> TokenStream {
    attrs.krate.as_ref().map_or_else(|| quote!(::sinscal::calib_core), ToTokens::to_token_stream)
}

/// Dynamics of a declaration that says nothing about them; none where `sinscal` may be out of reach.
pub(crate) fn default_dynamics(attrs: &Attributes) -> Option<TokenStream> {
    attrs.krate.is_none().then(|| quote!(::sinscal::Strapdown))
}

/// `GnssIns15` to `gnss-ins15`.
pub(crate) fn kebab(name: &str) -> String {
    let chars: Vec<char> = name.chars().collect();
    let mut kebab = String::new();
    for (i, c) in chars.iter().enumerate() {
        if c.is_uppercase() && i > 0 {
            let begins = !chars[i - 1].is_uppercase() || chars.get(i + 1).is_some_and(|c| c.is_lowercase());
            if begins && chars[i - 1] != '_' {
                kebab.push('-');
            }
        }
        match c {
            '_' => kebab.push('-'),
            _ => kebab.extend(c.to_lowercase()),
        }
    }
    kebab
}
