//! The filter loop does not allocate: the allocator of this test aborts when it does.

mod common;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use common::{sample, setup, signals};
use nalgebra::Vector3;
use sinscal::prelude::*;
use sinscal::{Form, Sins43B};

#[cfg(debug_assertions)]
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// A filter that considers what is not the unit's.
#[derive(StateBlocks)]
#[filter(name = "considering")]
struct Considering {
    #[base]
    sins: Sins43B,
    #[consider]
    latitude: SiteLatitude,
    #[consider]
    lag: ThermometerLag,
}

fn calibrates_without_allocation<F: Filter<Dynamics = Strapdown>, C: Form>() {
    let mut updates = 0;
    // a reference that fits no motion here, and is not refused for it
    let mut setup = setup();
    setup.reference.velocity = 1e6;
    setup.reference.position = 1e6;
    let mut run = Calibration::<F, C>::new(&setup).expect("a sound setup");
    assert_no_alloc(|| {
        for pass in 0..2 {
            for k in 0..500 {
                let time = f64::from(k) * 0.01;
                let now = signals(time);
                let mut sample = sample(time, now.rate * 0.01, now.force * 0.01);
                sample.dither = Vector3::repeat(0.08);
                sample.reference.velocity = Some(Vector3::zeros());
                sample.reference.position = Some(Vector3::zeros());
                if let Ok(Some(_)) = run.step(&sample) {
                    updates += 1;
                }
            }
            if pass == 0 {
                run.begin_pass();
            }
        }
        run.parameters(&mut |_| ());
    });
    assert_eq!(updates, 2 * 10);
}

#[test]
fn the_loop_does_not_allocate_in_either_form() {
    calibrates_without_allocation::<Sins43B, Conventional>();
    calibrates_without_allocation::<Sins43B, Ud>();
}

#[test]
fn nor_does_it_where_states_are_considered() {
    calibrates_without_allocation::<Considering, Conventional>();
    calibrates_without_allocation::<Considering, Ud>();
}
