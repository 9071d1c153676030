//! Implementations for an item that declares nothing, so that the mistake is reported alone and not with every
//! use of the item.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use syn::DeriveInput;

use crate::attr::{Attributes, Kind};
use crate::layout;

pub(crate) fn expand(input: &DeriveInput, attrs: &Attributes) -> Option<TokenStream> {
    let core = layout::core(attrs);
    let dynamics = match &attrs.dynamics {
        Some(dynamics) => dynamics.to_token_stream(),
        None => layout::default_dynamics(attrs)?,
    };
    let DeriveInput { ident, vis, .. } = input;
    let name = ident.to_string();
    let mut generics = input.generics.clone();
    generics.make_where_clause().predicates.push(syn::parse_quote!(Self: 'static));
    let (implemented, ty, clause) = generics.split_for_impl();
    let filter = (attrs.kind != Some(Kind::Group)).then(|| {
        quote! {
            #[automatically_derived]
            impl #implemented #core::Filter for #ident #ty #clause {
                type Shape = #core::Dim<0, 0, 0>;
                const MEASURES: &'static [#core::MeasurementInfo] = &[];
                fn residual<Scalar: #core::Real>(
                    _: usize,
                    _: &<<Self as #core::Block>::Dynamics as #core::Dynamics>::Point<Scalar>,
                    _: &[Scalar],
                    _: &mut impl ::core::ops::FnMut(usize, Scalar),
                ) {}
                fn residual_jacobian<Scalar: #core::Real>(
                    _: &<<Self as #core::Block>::Dynamics as #core::Dynamics>::Point<Scalar>,
                    _: &mut impl ::core::ops::FnMut(usize, usize, Scalar),
                ) {}
            }
        }
    });
    Some(quote! {
        #[automatically_derived]
        impl #implemented #core::Block for #ident #ty #clause {
            type Dynamics = #dynamics;
            type View<'view, Scalar: #core::Real> = #core::BlockView<'view, Self, Scalar>;
            const NAME: &'static str = #name;
            const DIM: usize = 0;
            fn states(_: &mut dyn ::core::ops::FnMut(#core::StateInfo)) {}
        }

        #filter

        #[automatically_derived]
        #[allow(dead_code)]
        impl #implemented #ident #ty #clause {
            #vis const DIM: usize = 0;
        }
    })
}
