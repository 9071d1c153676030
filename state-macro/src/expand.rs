//! A layout, to the implementations and the constants that judge it.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream};
use quote::{ToTokens, quote, quote_spanned};
use syn::DeriveInput;
use syn::ext::IdentExt;
use syn::spanned::Spanned;

use crate::ast::{Declaration, Field};
use crate::attr::{Attributes, Kind};
use crate::check;
use crate::errors::Errors;
use crate::fallback;
use crate::layout::Layout;
use crate::view;

/// All that the derive writes: the mistakes, and implementations that hold in spite of them.
pub(crate) fn derive(input: &DeriveInput) -> TokenStream {
    let mut errors = Errors::default();
    let attrs = Attributes::read(&input.attrs, &mut errors);
    let Some(mut declaration) = Declaration::of(input, &attrs, &mut errors) else {
        let fallback = fallback::expand(input, &attrs);
        return quote!(#errors #fallback);
    };
    check::check(&mut declaration, &mut errors);
    let expanded = Layout::of(&declaration).map(|layout| expand(&layout));
    quote!(#errors #expanded)
}

fn expand(layout: &Layout) -> TokenStream {
    let core = &layout.core;
    let view = view::expand(layout);
    let parts = parts(layout);
    let measures = layout.is_filter().then(|| measures(layout));
    let rules = rules(layout);
    let block = block(layout);
    let filter = layout.is_filter().then(|| filter(layout));
    let inherent = inherent(layout);
    quote! {
        #view
        const _: () = {
            #[allow(unused_imports)]
            use #core::declare::{Undescribed as _, Unmeasured as _};
            #parts
            #measures
            #rules
            #block
            #filter
            #inherent
        };
    }
}

/// What the rules must know of the fields.
fn parts(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, dynamics, .. } = layout;
    let count = declaration.fields.len();
    let parts = declaration.fields.iter().map(|field| {
        let Field { ident, ty, .. } = field;
        let name = ident.unraw().to_string();
        let base = field.base.then(|| quote!(.base(#core::declare::Measured::<#ty>::MEASURES)));
        let repeated = field.repeated.then(|| quote!(.repeated()));
        quote!(#core::declare::Describe::<#ty, #dynamics>::PART.named(#name) #base #repeated)
    });
    quote! {
        const PARTS: [#core::declare::Part; #count] = [#(#parts),*];
    }
}

/// The measurements, as indices.
fn measures(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, .. } = layout;
    let measures = match (&declaration.attrs.measures, declaration.base()) {
        (Some(measures), _) => {
            let channels = channels(layout);
            let names = measures.names.iter().map(|name| name.unraw().to_string());
            quote!(&[#(#core::declare::channel(#channels, #names)),*])
        }
        (None, Some(Field { ty, .. })) => {
            quote!(#core::declare::inherited(#core::declare::Measured::<#ty>::MEASURES))
        }
        (None, None) => quote!(&[]),
    };
    quote! {
        const MEASURES: &[usize] = #measures;
    }
}

/// The constants that judge the fields, the measurements and the whole.
fn rules(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, .. } = layout;
    let Declaration { ident, attrs, fields, .. } = declaration;
    let leading = of_dynamics(layout, quote!(NEEDS));
    let Some(kind) = attrs.kind else { return TokenStream::new() };
    let judge = match kind {
        Kind::Filter => quote!(filter_field),
        Kind::Group => quote!(group_field),
    };
    let mut rules: TokenStream = fields
        .iter()
        .enumerate()
        .map(|(i, field)| rule(core, field.ends(), quote!(#core::declare::#judge(&PARTS, #i, #leading))))
        .collect();
    if kind == Kind::Filter {
        let size = of_dynamics(layout, quote!(CORE));
        let whole = quote!(#core::declare::filter(&PARTS, #leading, #size));
        rules.extend(rule(core, (ident.span(), ident.span()), whole));
        let channels = channels(layout);
        for name in attrs.measures.iter().flat_map(|measures| &measures.names) {
            let text = name.unraw().to_string();
            let known = quote!(#core::declare::measurement(#channels, #text));
            rules.extend(rule(core, (name.span(), name.span()), known));
        }
    }
    let offsets = fields.iter().map(|field| field.ident);
    rules.extend(quote! {
        const _: () = ::core::assert!(
            #core::declare::contiguous(&PARTS, &[#(#ident::OFFSETS.#offsets),*], #ident::DIM),
        );
    });
    rules
}

/// A constant that does not evaluate when `verdict` has something to say, and says it from `first` to `last`.
fn rule(core: &TokenStream, (first, last): (Span, Span), verdict: TokenStream) -> TokenStream {
    let mut message = Group::new(Delimiter::Parenthesis, quote_spanned!(last=> "{}", VERDICT.as_str()));
    message.set_span(last);
    let panic = quote_spanned!(first=> ::core::panic!);
    quote! {
        const _: () = {
            const VERDICT: #core::declare::Text = #verdict;
            if !VERDICT.is_empty() {
                #panic #message
            }
        };
    }
}

fn block(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, dynamics, view, .. } = layout;
    let Declaration { ident, attrs, fields, .. } = declaration;
    let needs = (attrs.kind == Some(Kind::Group)).then(|| {
        quote! {
            const NEEDS: &'static [#core::Need] =
                &#core::declare::needs::<{ #core::declare::count_needs(&PARTS) }>(&PARTS);
        }
    });
    let states = fields.iter().map(|field| forward(field, core, "states", quote!(visit)));
    let inputs = fields.iter().map(|field| {
        let Field { ident, .. } = field;
        let signals = same(field, core, "signals");
        let put = quote!(|input, state, value| put(input, Self::OFFSETS.#ident + state, value));
        forward(field, core, "input_jacobian", quote!(#signals(signals), &mut #put))
    });
    let measurements = fields.iter().map(|field| {
        let Field { ident, .. } = field;
        let point = same(field, core, "point");
        let put = quote!(|channel, state, value| put(channel, Self::OFFSETS.#ident + state, value));
        forward(field, core, "measurement_jacobian", quote!(#point(at), &mut #put))
    });
    let relaxations = fields.iter().map(|field| {
        let Field { ident, .. } = field;
        let put = quote!(|state, relaxation| put(Self::OFFSETS.#ident + state, relaxation));
        forward(field, core, "relaxation", quote!(&mut #put))
    });
    quote! {
        #[automatically_derived]
        impl #core::Block for #ident {
            type Dynamics = #dynamics;
            type View<'a, T: #core::Real> = #view<'a, T>;
            const DIM: usize = #core::declare::dim(&PARTS);
            const SET: #core::BlockSet = #core::declare::set(&PARTS);
            #needs
            const RELAXES: bool = #core::declare::relaxes(&PARTS);

            fn states(visit: &mut dyn ::core::ops::FnMut(#core::StateInfo)) {
                #(#states)*
            }

            #[inline(always)]
            fn input_jacobian<T: #core::Real>(
                signals: &<Self::Dynamics as #core::Dynamics>::Signals<T>,
                put: &mut impl ::core::ops::FnMut(usize, usize, T),
            ) {
                #(#inputs)*
            }

            #[inline(always)]
            fn measurement_jacobian<T: #core::Real>(
                at: &<Self::Dynamics as #core::Dynamics>::Point<T>,
                put: &mut impl ::core::ops::FnMut(usize, usize, T),
            ) {
                #(#measurements)*
            }

            #[inline(always)]
            fn relaxation<T: #core::Real>(put: &mut impl ::core::ops::FnMut(usize, #core::Relaxation<T>)) {
                #(#relaxations)*
            }
        }
    }
}

fn filter(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, name, .. } = layout;
    let Declaration { ident, .. } = declaration;
    let size = of_dynamics(layout, quote!(CORE));
    let channels = channels(layout);
    quote! {
        #[automatically_derived]
        impl #core::Filter for #ident {
            const NAME: &'static str = #name;
            type Shape = #core::Dim<
                { #core::declare::dim(&PARTS) },
                { #size },
                { #core::declare::rows(#channels, MEASURES) },
            >;
            const MEASURES: &'static [usize] = MEASURES;
        }
    }
}

/// The dimension and the offsets by name, and a use of the fields, which no code reads.
fn inherent(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, offsets, .. } = layout;
    let Declaration { ident, vis, fields, .. } = declaration;
    let names: Vec<&Ident> = fields.iter().map(|field| field.ident).collect();
    quote! {
        #[automatically_derived]
        #[allow(dead_code)]
        impl #ident {
            /// Number of states.
            #vis const DIM: usize = #core::declare::dim(&PARTS);
            /// First state of each field.
            #vis const OFFSETS: #offsets = {
                let [#(#names),*] = #core::declare::offsets(&PARTS);
                #offsets { #(#names),* }
            };
        }

        #[allow(dead_code)]
        fn declared(#ident { #(#names),* }: #ident) -> #ident {
            #ident { #(#names),* }
        }
    }
}

/// The dynamics as those of the block that is written, with the span of what was said about them.
fn dynamics(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, dynamics, .. } = layout;
    let ident = declaration.ident;
    quote_spanned!(dynamics.span()=> <#ident as #core::Block>::Dynamics)
}

fn channels(layout: &Layout) -> TokenStream {
    of_dynamics(layout, quote!(CHANNELS))
}

/// A constant of the dynamics.
fn of_dynamics(layout: &Layout, constant: TokenStream) -> TokenStream {
    let core = &layout.core;
    let span = layout.dynamics.span();
    let dynamics = dynamics(layout);
    quote_spanned!(span=> <#dynamics as #core::Dynamics>::#constant)
}

/// A call of a function of the field's block. Every path to the block has the same span, so that rustc says once
/// what is wrong with it.
fn forward(field: &Field, core: &TokenStream, function: &str, arguments: TokenStream) -> TokenStream {
    let Field { ty, .. } = field;
    let span = ty.span();
    let function = Ident::new(function, span);
    let generics = (function != "states").then(|| quote_spanned!(span=> ::<T>));
    let path = quote_spanned!(span=> <#ty as #core::Block>::#function #generics);
    quote!(#path(#arguments);)
}

/// The conversion of the declaration's signals or point to those of the field, the identity.
fn same(field: &Field, core: &TokenStream, function: &str) -> TokenStream {
    let Field { ty, .. } = field;
    let span = ty.span();
    let function = Ident::new(function, span);
    quote_spanned!(span=>
        <<#ty as #core::Block>::Dynamics as #core::declare::Same<Self::Dynamics>>::#function::<T>
    )
}
