//! The item, to a declaration: named fields, each of them a block.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{ToTokens, quote};
use syn::spanned::Spanned;
use syn::{Attribute, Data, DeriveInput, Fields, Type, Visibility};

use crate::attr::{Attributes, FieldAttributes};
use crate::errors::Errors;

/// A struct of blocks.
pub(crate) struct Declaration<'a> {
    pub(crate) ident: &'a Ident,
    pub(crate) vis: &'a Visibility,
    pub(crate) attrs: &'a Attributes,
    /// At least one.
    pub(crate) fields: Vec<Field<'a>>,
}

/// A block of a declaration.
pub(crate) struct Field<'a> {
    pub(crate) ident: &'a Ident,
    pub(crate) ty: &'a Type,
    pub(crate) base: bool,
    pub(crate) consider: bool,
    pub(crate) docs: Vec<Attribute>,
    /// An earlier field has the same type.
    pub(crate) repeated: bool,
}

impl<'a> Declaration<'a> {
    /// `None`, with the reason in `errors`, when the item has no blocks to declare.
    pub(crate) fn of(input: &'a DeriveInput, attrs: &'a Attributes, errors: &mut Errors) -> Option<Self> {
        let generic = generics(input, errors);
        let fields = match &input.data {
            Data::Struct(data) => match &data.fields {
                Fields::Named(fields) => &fields.named,
                Fields::Unnamed(fields) => {
                    errors.at(
                        fields,
                        "a declaration names its blocks: `struct Nav { attitude: Attitude, ... }`",
                    );
                    return None;
                }
                Fields::Unit => {
                    errors.at(
                        &input.ident,
                        "a unit struct declares no blocks: name them, as in `struct Nav { attitude: Attitude, ... }`",
                    );
                    return None;
                }
            },
            Data::Enum(data) => {
                errors.at(data.enum_token, "blocks are declared by a struct: all of them are there at once");
                return None;
            }
            Data::Union(data) => {
                errors.at(data.union_token, "blocks are declared by a struct: all of them are there at once");
                return None;
            }
        };
        if fields.is_empty() {
            errors.at(
                &input.ident,
                "a declaration of no blocks: name at least one, as in `attitude: Attitude`",
            );
        }
        let fields: Vec<Field> = fields
            .iter()
            .filter_map(|field| {
                let FieldAttributes { base, consider, docs } = FieldAttributes::read(&field.attrs, errors);
                let ident = field.ident.as_ref()?;
                Some(Field { ident, ty: &field.ty, base, consider, docs, repeated: false })
            })
            .collect();
        if generic || fields.is_empty() {
            return None;
        }
        Some(Declaration { ident: &input.ident, vis: &input.vis, attrs, fields })
    }

    /// The field that is extended.
    pub(crate) fn base(&self) -> Option<&Field<'a>> {
        self.fields.iter().find(|field| field.base)
    }
}

impl Field<'_> {
    /// The first and the last place of the field in the source.
    pub(crate) fn ends(&self) -> (Span, Span) {
        let last = self.ty.to_token_stream().into_iter().last();
        (self.ident.span(), last.map_or_else(|| self.ty.span(), |token| token.span()))
    }
}

/// The field without its attributes: what a mistake about it points at.
impl ToTokens for Field<'_> {
    fn to_tokens(&self, tokens: &mut TokenStream) {
        let Field { ident, ty, .. } = self;
        tokens.extend(quote!(#ident: #ty));
    }
}

fn generics(input: &DeriveInput, errors: &mut Errors) -> bool {
    let generics = &input.generics;
    if !generics.params.is_empty() {
        errors.at(
            &generics.params,
            "a declaration has no parameters: its blocks are known types, and the scalar is chosen where the filter is used",
        );
    } else if let Some(clause) = &generics.where_clause {
        errors.at(clause, "a declaration has no parameters, so there is nothing for `where` to say");
    } else {
        return false;
    }
    true
}
