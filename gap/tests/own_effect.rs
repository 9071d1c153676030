//! An effect of one's own is priced and named beside those of the catalogue: that of the example.

use gap::{Options, Verdict};

#[allow(dead_code, reason = "the example prints what is looked at here")]
#[path = "../../examples/find_the_missing_effect.rs"]
mod example;

#[test]
fn own_effect_is_named() {
    let d = example::find(&Options { rerun: false, ..Options::default() }).unwrap();
    assert_eq!(d.verdict, Verdict::EffectsFound, "{}", d.sentence);
    assert_eq!(d.effects[0].name, "spin-sensitivity");
    assert!((d.effects[0].estimate[0] - 3e-3).abs() < 5.0 * d.effects[0].sigma[0], "{:?}", d.effects);
}
