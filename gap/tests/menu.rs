//! The next run that would decide.

use gap::menu::propose;
use sinscal::{Sins36P, Sins39P};

#[test]
fn changing_dither_parts_the_size_effect_from_the_bias() {
    let menu = propose::<Sins39P>("dither-size-effect", "accel-bias").unwrap();
    assert!(menu[0].run.contains("dither amplitude"), "{menu:?}");
    assert!(menu[0].shows > 3.0 && menu[1].shows < 1.0, "{menu:?}");
}

#[test]
#[ignore = "seven simulated runs each: run with --release -- --ignored"]
fn what_parts_other_pairs() {
    for (effect, other, run) in [
        ("accel-cubic", "accel-scale", "45 deg"),
        ("gyro-rate-nonlinearity", "gyro-scale", "5, 20 and 60 deg/s"),
        ("accel-temperature-bias", "accel-bias-drift", "temperature rises and falls"),
    ] {
        let menu = propose::<Sins36P>(effect, other).unwrap();
        println!("{effect} {other}: {menu:#?}");
        assert!(menu[0].run.contains(run), "{effect} {other}: {menu:?}");
    }
}
