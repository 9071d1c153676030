//! A layout, to the implementations and the constants that judge it.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use quote::{ToTokens, quote, quote_spanned};
use syn::ext::IdentExt;
use syn::spanned::Spanned;
use syn::{DeriveInput, Type};

use crate::ast::{Declaration, Field};
use crate::attr::{Attributes, Kind};
use crate::check;
use crate::errors::Errors;
use crate::fallback;
use crate::layout::Layout;
use crate::view::{self, shown};

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
    let belong = layout.declaration.fields.iter().map(|field| belongs(layout, field));
    let rules = rules(layout);
    let block = block(layout);
    let own = if layout.is_filter() { filter(layout) } else { counted(layout) };
    let inherent = inherent(layout);
    quote! {
        #view
        const _: () = {
            #[allow(unused_imports)]
            use #core::declare::{Baseless as _, Misfit as _, Other as _, Unmeasured as _, Unrelated as _};
            #parts
            #measures
            #(#belong)*
            #rules
            #block
            #own
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
        let base = field.base.then(|| quote!(.base(#core::declare::Base::<#ty>::MEASURES)));
        let repeated = field.repeated.then(|| quote!(.repeated()));
        let considered = field.consider.then(|| quote!(.considered()));
        quote!(#core::declare::Field::<#ty, #dynamics>::PART.named(#name) #base #repeated #considered)
    });
    quote! {
        const PARTS: [#core::declare::Part; #count] = [#(#parts),*];
    }
}

/// What is measured, and the demand that every measurement be one of the declaration's dynamics.
fn measures(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, dynamics, .. } = layout;
    let Some(types) = layout.measured() else {
        let base = declaration.base().map(|field| field.ty);
        return quote! {
            const MEASURES: &[#core::MeasurementInfo] =
                #core::declare::inherited(#core::declare::Base::<#base>::MEASURES);
        };
    };
    let rules = types.iter().enumerate().map(|(k, ty)| {
        let own = at(core, ty.span());
        let fit = quote_spanned! {ty.span()=>
            #own::declare::Fit::<<#ty as #own::Measurement>::Dynamics, #dynamics>::SAME
        };
        let known = quote!(#core::declare::Family::<#dynamics>::KNOWN);
        rule(core, ends(ty), quote!(#core::declare::measurement(MEASURES, #k, #fit || !#known)))
    });
    quote! {
        const MEASURES: &[#core::MeasurementInfo] =
            &[#(#core::declare::Measured::<#types, #dynamics>::INFO),*];
        #(#rules)*
    }
}

/// The first and the last place of tokens in the source.
fn ends(tokens: &TokenStream) -> (Span, Span) {
    let mut tokens = tokens.clone().into_iter().map(|token| token.span());
    let first = tokens.next().unwrap_or_else(Span::call_site);
    (first, tokens.last().unwrap_or(first))
}

/// The constants that judge the fields, the measurements and the whole.
fn rules(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, .. } = layout;
    let Declaration { ident, attrs, fields, .. } = declaration;
    let leading = of_family(layout, "NEEDS");
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
        let size = of_family(layout, "CORE");
        let whole = quote!(#core::declare::filter(&PARTS, #leading, #size));
        rules.extend(rule(core, (ident.span(), ident.span()), whole));
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
    let Layout { declaration, core, dynamics, name, view, .. } = layout;
    let Declaration { ident, attrs, fields, .. } = declaration;
    let needs = (attrs.kind == Some(Kind::Group)).then(|| {
        quote! {
            const NEEDS: &'static [#core::Need] =
                &#core::declare::needs::<{ #core::declare::count_needs(&PARTS) }>(&PARTS);
        }
    });
    let clause = clause(layout);
    let visitor = quote_spanned!(dynamics.span()=> #core::BlockVisitor<#dynamics>);
    let signals = of_dynamics(layout, "Signals");
    let point = of_dynamics(layout, "Point");
    let types: Vec<&Type> = fields.iter().map(|field| field.ty).collect();
    let names: Vec<&Ident> = fields.iter().map(|field| field.ident).collect();
    quote! {
        #[automatically_derived]
        impl #core::Block for #ident #clause {
            type Dynamics = #dynamics;
            type View<'a, T: #core::Real> = #view<'a, T>;
            const NAME: &'static str = #name;
            const DIM: usize = #core::declare::dim(&PARTS);
            #needs
            const PARTS: &'static [#core::declare::Part] = &PARTS;

            fn states(visit: &mut dyn ::core::ops::FnMut(#core::StateInfo)) {
                #(#core::declare::Field::<#types, #dynamics>::states(visit);)*
            }

            #[inline(always)]
            fn input_jacobian<T: #core::Real>(
                signals: &#signals,
                put: &mut impl ::core::ops::FnMut(usize, usize, T),
            ) {
                #(#core::declare::Field::<#types, #dynamics>::input_jacobian::<T>(
                    Self::OFFSETS.#names, signals, put,
                );)*
            }

            #[inline(always)]
            fn measurement_jacobian<T: #core::Real>(
                at: &#point,
                put: &mut impl ::core::ops::FnMut(usize, usize, T),
            ) {
                #(#core::declare::Field::<#types, #dynamics>::measurement_jacobian::<T>(
                    Self::OFFSETS.#names, at, put,
                );)*
            }

            #[inline(always)]
            fn blocks(first: usize, visitor: &mut impl #visitor) {
                #(#core::declare::Field::<#types, #dynamics>::blocks(
                    first + Self::OFFSETS.#names, visitor,
                );)*
            }
        }
    }
}

/// The number of states as a type.
fn counted(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, .. } = layout;
    let ident = declaration.ident;
    let clause = clause(layout);
    quote! {
        #[automatically_derived]
        impl #core::Counted for #ident #clause {
            type States = #core::declare::Size<{ #core::declare::dim(&PARTS) }>;
        }
    }
}

fn filter(layout: &Layout) -> TokenStream {
    let Layout { declaration, core, dynamics, .. } = layout;
    let ident = declaration.ident;
    let clause = clause(layout);
    let size = of_family(layout, "CORE");
    let point = of_dynamics(layout, "Point");
    let (residual, jacobian) = match layout.measured() {
        Some(types) => {
            let places: Vec<usize> = (0..types.len()).collect();
            let residuals = quote! {
                match measured {
                    #(#places => #core::declare::Measured::<#types, #dynamics>::residual::<T>(at, reading, put),)*
                    _ => {}
                }
            };
            let jacobians = quote! {
                #(#core::declare::Measured::<#types, #dynamics>::jacobian::<T>(MEASURES, #places, at, put);)*
            };
            (residuals, jacobians)
        }
        None => {
            let base = declaration.base().map(|field| field.ty);
            (
                quote!(#core::declare::Base::<#base>::residual::<T>(measured, at, reading, put);),
                quote!(#core::declare::Base::<#base>::residual_jacobian::<T>(at, put);),
            )
        }
    };
    quote! {
        #[automatically_derived]
        impl #core::Filter for #ident #clause {
            type Shape = #core::Dim<
                { #core::declare::dim(&PARTS) },
                { #size },
                { #core::declare::rows(MEASURES) },
            >;
            const MEASURES: &'static [#core::MeasurementInfo] = MEASURES;

            #[inline]
            fn residual<T: #core::Real>(
                measured: usize,
                at: &#point,
                reading: &[T],
                put: &mut impl ::core::ops::FnMut(usize, T),
            ) {
                let _ = (measured, at, reading, &put);
                #residual
            }

            #[inline(always)]
            fn residual_jacobian<T: #core::Real>(
                at: &#point,
                put: &mut impl ::core::ops::FnMut(usize, usize, T),
            ) {
                let _ = (at, &put);
                #jacobian
            }
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

/// What the implementations take for granted: that given dynamics are dynamics. Where they are none rustc says so here, and
/// nowhere within.
fn clause(layout: &Layout) -> Option<TokenStream> {
    layout.declaration.attrs.dynamics.as_ref().map(|given| {
        let core = at(&layout.core, given.span());
        quote_spanned!(given.span()=> where #given: #core::Dynamics)
    })
}

/// Tokens with the span of what they are about: rustc points at the whole of a path.
fn at(tokens: &TokenStream, span: Span) -> TokenStream {
    let mut tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
    tokens.iter_mut().for_each(|token| token.set_span(span));
    tokens.into_iter().collect()
}

/// A constant of the dynamics, which says nothing where they are none.
fn of_family(layout: &Layout, item: &str) -> TokenStream {
    let Layout { core, dynamics, .. } = layout;
    let span = dynamics.span();
    let item = Ident::new(item, span);
    quote_spanned!(span=> #core::declare::Family::<#dynamics>::#item)
}

/// A type of the dynamics.
fn of_dynamics(layout: &Layout, item: &str) -> TokenStream {
    let Layout { core, dynamics, .. } = layout;
    let span = dynamics.span();
    let item = Ident::new(item, span);
    quote_spanned!(span=> <#dynamics as #core::Dynamics>::#item<T>)
}

/// The demand that a field be a block of the declaration's dynamics. Every path to the block has the span of its
/// type, so that rustc says once what is wrong with it.
fn belongs(layout: &Layout, field: &Field) -> TokenStream {
    let Layout { declaration, core, dynamics, .. } = layout;
    let Field { ident, ty, .. } = field;
    let name = ident.unraw().to_string();
    let family = match &declaration.attrs.dynamics {
        Some(given) => shown(given),
        None if declaration.base().is_some() => "those of the base".to_owned(),
        None => "Strapdown".to_owned(),
    };
    let own = at(core, ty.span());
    let fit = quote_spanned! {ty.span()=>
        #own::declare::Fit::<<#ty as #own::Block>::Dynamics, #dynamics>::SAME
    };
    let last = ty.to_token_stream().into_iter().last().map_or_else(|| ty.span(), |token| token.span());
    rule(
        core,
        (ty.span(), last),
        quote! {
            #core::declare::belongs(
                #name,
                #family,
                #fit || !#core::declare::Family::<#dynamics>::KNOWN,
            )
        },
    )
}
