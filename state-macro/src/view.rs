//! The estimate by name: the view of a declaration, and its offsets.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote, quote_spanned};
use syn::spanned::Spanned;

use crate::ast::{Declaration, Field};
use crate::layout::Layout;

/// The structs that a declaration adds to its module.
pub(crate) fn expand(layout: &Layout) -> TokenStream {
    let offsets = offsets(layout);
    let view = view(layout);
    quote!(#offsets #view)
}

fn offsets(layout: &Layout) -> TokenStream {
    let Layout { declaration, offsets, .. } = layout;
    let Declaration { ident, vis, fields, .. } = declaration;
    let docs = format!(" First state of each field of [`{ident}`].");
    let fields = fields.iter().map(|Field { ident, ty, .. }| {
        let docs = format!(" First state of `{ident}`: `{}`.", shown(ty));
        quote! {
            #[doc = #docs]
            #vis #ident: usize
        }
    });
    quote! {
        #[doc = #docs]
        #[derive(
            ::core::clone::Clone,
            ::core::marker::Copy,
            ::core::fmt::Debug,
            ::core::cmp::PartialEq,
            ::core::cmp::Eq,
        )]
        #[allow(dead_code)]
        #vis struct #offsets {
            #(#fields,)*
        }
    }
}

fn view(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, view, .. } = layout;
    let Declaration { ident, vis, fields, .. } = declaration;
    let docs = format!(" An estimate of [`{ident}`] by name.");
    let name = view.to_string();
    let base = declaration.base().map(|field| (field.ident, view_of(field, core)));
    let held = base.as_ref().map(|(_, base)| quote!(base: #base,));
    let begun = base.as_ref().map(|(field, base)| {
        quote! {
            base: <#base as #core::View<'a, T>>::at(estimate, offset + #ident::OFFSETS.#field),
        }
    });
    let deref = base.as_ref().map(|(_, base)| {
        quote! {
            #[automatically_derived]
            impl<'a, T: #core::Real> ::core::ops::Deref for #view<'a, T> {
                type Target = #base;
                #[inline]
                fn deref(&self) -> &Self::Target {
                    &self.base
                }
            }
        }
    });
    let methods = fields.iter().map(|field| {
        let Field { ident: name, ty, docs, .. } = field;
        let view = view_of(field, core);
        let at = quote_spanned!(field.ty.span()=> <#view as #core::View<'a, T>>::at);
        let default = format!(" The states of `{name}`: `{}`.", shown(ty));
        let docs = if docs.is_empty() { quote!(#[doc = #default]) } else { quote!(#(#docs)*) };
        quote! {
            #docs
            #[inline]
            #vis fn #name(&self) -> #view {
                #at(self.estimate, self.offset + #ident::OFFSETS.#name)
            }
        }
    });
    quote! {
        #[doc = #docs]
        #[allow(dead_code)]
        #vis struct #view<'a, T: #core::Real> {
            #held
            estimate: #core::Estimate<'a, T>,
            offset: usize,
        }

        #[automatically_derived]
        #[allow(dead_code)]
        impl<'a, T: #core::Real> #view<'a, T> {
            #(#methods)*
        }

        #[automatically_derived]
        impl<'a, T: #core::Real> #core::View<'a, T> for #view<'a, T> {
            #[inline]
            fn at(estimate: #core::Estimate<'a, T>, offset: usize) -> Self {
                Self {
                    estimate,
                    offset,
                    #begun
                }
            }
        }

        #[automatically_derived]
        impl<T: #core::Real> ::core::fmt::Debug for #view<'_, T> {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                f.debug_struct(#name).finish_non_exhaustive()
            }
        }

        #deref
    }
}

/// The view of a field's block.
fn view_of(field: &Field, core: &TokenStream) -> TokenStream {
    let ty = field.ty;
    quote_spanned!(ty.span()=> <#ty as #core::Block>::View<'a, T>)
}

/// A type as it is written, for documentation.
pub(crate) fn shown(ty: &impl ToTokens) -> String {
    ty.to_token_stream().to_string().replace(' ', "")
}
