//! `#[derive(StateBlocks)]`: a struct of state blocks becomes an error-state Kalman filter.
//!
//! The derive sees names, not types. What follows from names (attributes, the shape of the struct, a type named
//! twice) it reports itself, every mistake at once; what follows from types it writes as constants that the
//! compiler evaluates, each with the span of the field it judges. The passes, in order:
//!
//! | file       | from, to                                                        |
//! |------------|-----------------------------------------------------------------|
//! | `attr`     | attributes, to keys and values                                  |
//! | `ast`      | the item, to a `Declaration` with named fields                  |
//! | `check`    | a `Declaration`, to the mistakes its names show                 |
//! | `layout`   | a `Declaration`, to the paths and names that are written        |
//! | `expand`   | a `Layout`, to the implementations                              |
//! | `fallback` | an item that is no declaration, to impls that keep rustc quiet  |

use proc_macro::TokenStream;
use syn::{DeriveInput, parse_macro_input};

mod ast;
mod attr;
mod check;
mod errors;
mod expand;
mod fallback;
mod layout;
#[cfg(test)]
mod tests;
mod view;

/// Makes a filter, or a group of blocks for use in filters, of a struct whose fields are state blocks.
///
/// The struct holds no data: a field declares a block, in the order of its states. What a block is, what it
/// needs beside it and what it does to the system is known to its type.
///
/// ```text
/// #[derive(StateBlocks)]
/// #[filter(measures(velocity, position))]
/// pub struct Sins39P {
///     #[base]
///     sins: Sins36P,
///     inner_lever: InnerLeverArm,
/// }
/// ```
///
/// # On the struct
///
/// `#[filter(...)]` or `#[group(...)]`, one of them, with these keys, comma-separated, each at most once:
///
/// | key                        | in            | meaning                                                     |
/// |----------------------------|---------------|-------------------------------------------------------------|
/// | `measures(velocity, ...)`  | filter        | measurements in the order of the rows, ours by name (`velocity`, `position`, `attitude`, `rate`, `height`, `heading`), any by its type; needed without a base, whose measurements are inherited |
/// | `name = "39d-p"`           | filter        | name in reports: lower-case letters, digits, hyphens; by default the kebab-case of the struct's name |
/// | `dynamics = Type`          | filter, group | dynamics of the leading states; by default those of the base, `sinscal::Strapdown` without one |
/// | `crate = path`             | filter, group | where `calib_core` is, by default `::sinscal::calib_core`    |
///
/// # On a field
///
/// `#[base]` on the first field of a filter: the filter extends the filter of that type.
///
/// `#[consider]` on a field of parameters: its states are considered. No measurement changes them, and what their priors make uncertain is
/// in the covariance of the others (Schmidt 1966).
///
/// Documentation of a field becomes the documentation of its method on the view.
///
/// # What is written
///
/// For `pub struct Nav` (the visibility is that of the struct):
///
/// - `impl Block for Nav`, and for a filter `impl Filter for Nav`;
/// - `Nav::DIM`, the number of states, and `Nav::OFFSETS`, a `NavOffsets` with the first state of each field;
/// - `NavView<'a, T>`, the estimate by name: one method per field returns the view of its block. The view of
///   a filter with a base dereferences to the view of the base.
#[proc_macro_derive(StateBlocks, attributes(filter, group, base, consider))]
pub fn derive_state_blocks(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    expand::derive(&input).into()
}
