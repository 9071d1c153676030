//! What is written, formatted, for one declaration of each kind.

use proc_macro2::TokenStream;
use quote::quote;

use crate::expand::derive;
use crate::layout::kebab;

fn expanded(declaration: TokenStream) -> String {
    let input = syn::parse2(declaration).expect("an item");
    let file = syn::parse2(derive(&input)).expect("items");
    prettyplease::unparse(&file)
}

#[test]
fn filter() {
    insta::assert_snapshot!(expanded(quote! {
        #[filter(measures(velocity, position), name = "tiny")]
        pub struct Tiny {
            attitude: Attitude,
            /// Errors of the gyros.
            gyro: GyroErrors,
        }
    }));
}

#[test]
fn filter_with_base() {
    insta::assert_snapshot!(expanded(quote! {
        #[filter]
        pub(crate) struct Sins39P {
            #[base]
            sins: Sins36P,
            inner_lever: InnerLeverArm,
        }
    }));
}

#[test]
fn group() {
    insta::assert_snapshot!(expanded(quote! {
        #[group]
        pub struct GyroErrors {
            scale: GyroScale,
            bias: blocks::GyroBias,
        }
    }));
}

#[test]
fn own_dynamics() {
    insta::assert_snapshot!(expanded(quote! {
        #[filter(dynamics = motion::ConstantVelocity, measures(motion::Range), crate = calib_core)]
        struct Tracker {
            position: TrackPosition,
        }
    }));
}

#[test]
fn fallback() {
    insta::assert_snapshot!(expanded(quote! {
        #[filter(measures(velocity))]
        pub struct Nav<T>(Attitude, T);
    }));
}

#[test]
fn mistakes_do_not_stop_the_expansion() {
    let written = expanded(quote! {
        #[filter(measures(velocity, velocity), colour = "red")]
        struct Nav {
            gyro: GyroErrors,
            again: GyroErrors,
        }
    });
    assert_eq!(written.matches("compile_error!").count(), 3);
    assert!(written.contains("impl ::sinscal::calib_core::Filter for Nav"));
}

#[test]
fn names_become_kebab_case() {
    for (name, kebab_case) in [
        ("Nav", "nav"),
        ("LongCart", "long-cart"),
        ("GNSSFilter", "gnss-filter"),
        ("GnssIns15", "gnss-ins15"),
        ("Sins43B", "sins43-b"),
        ("With_Underscore", "with-underscore"),
    ] {
        assert_eq!(kebab(name), kebab_case);
    }
}
