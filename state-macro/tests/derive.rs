//! What the derive writes, run on a family of dynamics small enough to check by hand.
#![deny(warnings)]

mod toy;

use calib_core::{
    Block, Dim, Estimate, Extended, Filter, Shape, View, declares, first_state, leaves, measurement_rows,
    relaxations, relaxes,
};
use state_macro::StateBlocks;
use toy::{Beacon, Bias, Force, Place, PlaceSeen, Rail, Scale, Speed, SpeedSeen, Sum, Sway, Wander};

#[derive(StateBlocks)]
#[filter(dynamics = Rail, measures(PlaceSeen), crate = calib_core)]
struct Cart {
    place: Place,
    speed: Speed,
    /// Errors of the accelerometer.
    accel: Accel,
    beacon: Beacon,
    sway: Sway,
}

#[derive(StateBlocks)]
#[group(dynamics = Rail, crate = calib_core)]
pub(crate) struct Accel {
    scale: Scale,
    bias: Bias,
}

#[derive(StateBlocks)]
#[group(dynamics = Rail, crate = calib_core)]
struct Start {
    place: Place,
    speed: Speed,
}

#[derive(StateBlocks)]
#[group(dynamics = Rail, crate = calib_core)]
struct Aids {
    beacon: Beacon,
}

#[derive(StateBlocks)]
#[filter(crate = calib_core, measures(toy::SpeedSeen, PlaceSeen), name = "long-cart")]
struct LongCart {
    #[base]
    cart: Cart,
    r#wander: Wander,
}

#[derive(StateBlocks)]
#[filter(crate = calib_core)]
struct SameMeasurements {
    #[base]
    cart: LongCart,
}

#[derive(StateBlocks)]
#[filter(crate = calib_core, dynamics = toy::Rail, measures(SpeedSeen, Sum, PlaceSeen,))]
struct FromGroups {
    start: Start,
    accel: Accel,
}

#[test]
fn sizes_are_constants() {
    const { assert!(Cart::DIM == 5 && LongCart::DIM == 6 && Accel::DIM == 2 && FromGroups::DIM == 4) }
    let _: Dim<5, 2, 1>;
    fn shape<F: Filter>() -> (usize, usize, usize) {
        (F::Shape::STATES, F::Shape::CORE, F::Shape::ROWS)
    }
    assert_eq!(shape::<Cart>(), (5, 2, 1));
    assert_eq!(shape::<LongCart>(), (6, 2, 2));
    assert_eq!(shape::<SameMeasurements>(), (6, 2, 2));
    assert_eq!(shape::<FromGroups>(), (4, 2, 3));
}

#[test]
fn offsets_have_names() {
    assert_eq!(Cart::OFFSETS, CartOffsets { place: 0, speed: 1, accel: 2, beacon: 4, sway: 5 });
    assert_eq!(LongCart::OFFSETS, LongCartOffsets { cart: 0, wander: 5 });
    assert_eq!(Accel::OFFSETS, AccelOffsets { scale: 0, bias: 1 });
}

#[test]
fn names_and_measurements_are_declared() {
    assert_eq!(Cart::NAME, "cart");
    assert_eq!(LongCart::NAME, "long-cart");
    assert_eq!(SameMeasurements::NAME, "same-measurements");
    fn measured<F: Filter>() -> Vec<&'static str> {
        F::MEASURES.iter().map(|info| info.name).collect()
    }
    assert_eq!(measured::<Cart>(), ["place"]);
    assert_eq!(measured::<LongCart>(), ["speed", "place"]);
    assert_eq!(measured::<SameMeasurements>(), ["speed", "place"]);
    assert_eq!(LongCart::rows(1), 1..2);
}

#[test]
fn states_come_in_order() {
    let mut blocks = Vec::new();
    LongCart::states(&mut |info| blocks.push(info.block));
    assert_eq!(blocks, ["Place", "Speed", "Scale", "Bias", "Beacon", "Wander"]);
}

#[test]
fn jacobians_are_shifted_to_their_fields() {
    let mut entries = Vec::new();
    LongCart::input_jacobian(&Force { force: 9.5 }, &mut |input, state, value: f64| {
        entries.push((input, state, value));
    });
    assert_eq!(entries, [(0, 2, 9.5), (0, 3, 1.0), (0, 5, 1.0)]);

    let mut entries = Vec::new();
    <LongCart as Block>::measurement_jacobian(&(), &mut |channel, state, value: f32| {
        entries.push((channel, state, value));
    });
    assert_eq!(entries, [(0, 4, -1.0)]);

    let mut entries = Vec::new();
    relaxations::<LongCart, f64>(|state, relaxation| entries.push((state, relaxation.rate)));
    assert_eq!(entries, [(5, 0.1)]);
}

#[test]
fn rows_are_channels_or_functions_of_them() {
    let force = Force { force: 9.5 };
    // place by its states and the beacon's
    assert_eq!(measurement_rows::<Cart, f64>(&(), &force), [[1.0, 0.0, 0.0, 0.0, -1.0]]);
    // the base measures it after the speed
    let rows = measurement_rows::<SameMeasurements, f64>(&(), &force);
    assert_eq!(rows, [[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0, -1.0, 0.0]]);
    // a sum between two channels: the chain rule
    let rows = measurement_rows::<FromGroups, f32>(&(), &Force { force: 9.5 });
    assert_eq!(rows, [[0.0, 1.0, 0.0, 0.0], [1.0, 3.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]);
    let mut slopes = Vec::new();
    FromGroups::residual_jacobian(&(), &mut |row, channel, value: f64| slopes.push((row, channel, value)));
    assert_eq!(slopes, [(0, 1, 1.0), (1, 0, 1.0), (1, 1, 3.0), (2, 0, 1.0)]);
}

#[test]
fn residuals_are_those_of_the_measurement() {
    for (measured, expected) in [(0, vec![(0, -7.0)]), (1, vec![])] {
        let mut residuals = Vec::new();
        Cart::residual(measured, &(), &[7.0], &mut |row, z: f64| residuals.push((row, z)));
        assert_eq!(residuals, expected);
    }
}

#[test]
fn a_declaration_knows_its_blocks() {
    const { assert!(relaxes::<LongCart>() && !relaxes::<Cart>() && !relaxes::<Accel>()) }
    const { assert!(declares::<LongCart, Bias>() && declares::<LongCart, Sway>() && declares::<Accel, Scale>()) }
    const { assert!(!declares::<Accel, Beacon>() && !declares::<Cart, Wander>()) }
    // a group is no block of its own
    const { assert!(!declares::<Cart, Accel>()) }
    let mut found = Vec::new();
    leaves::<LongCart>(|leaf| found.push((leaf.name, leaf.first, leaf.states)));
    let blocks = ["Place", "Speed", "Scale", "Bias", "Beacon", "Sway", "Wander"];
    assert_eq!(found, std::array::from_fn::<_, 7, _>(|i| (blocks[i], i.min(5), usize::from(i != 5))));
    assert_eq!(first_state::<LongCart, Wander>(), Some(5));
    assert_eq!(first_state::<Cart, Wander>(), None);
}

#[test]
fn a_group_extends_a_filter_without_a_count() {
    type Grown = Extended<FromGroups, Aids>;
    type Twice = Extended<Grown, Accel>;
    const { assert!(Grown::DIM == 5 && Twice::DIM == 7 && declares::<Twice, Beacon>()) }
    assert_eq!((<Grown as Filter>::Shape::STATES, <Twice as Filter>::Shape::STATES), (5, 7));
    assert_eq!((Twice::NAME, Twice::MEASURES), ("from-groups", FromGroups::MEASURES));
    let mut found = Vec::new();
    leaves::<Twice>(|leaf| found.push((leaf.name, leaf.first)));
    let names =
        [("Place", 0), ("Speed", 1), ("Scale", 2), ("Bias", 3), ("Beacon", 4), ("Scale", 5), ("Bias", 6)];
    assert_eq!(found, names);
}

#[test]
fn an_estimate_is_read_by_name() {
    let x: Vec<f64> = (0..6).map(f64::from).collect();
    let p: [[f64; 6]; 6] =
        std::array::from_fn(|i| std::array::from_fn(|j| ((6 * i + j) * (6 * i + j)) as f64));
    let view = LongCartView::at(Estimate { x: &x, p: &p }, 0);
    assert_eq!(view.wander().values(), [5.0]);
    assert_eq!(view.wander().sigma(0), 35.0);
    assert_eq!(view.cart().beacon().values(), [4.0]);
    // Fields of the base, as if they were declared here.
    assert_eq!(view.beacon().values(), [4.0]);
    assert_eq!(view.accel().bias().values(), [3.0]);
    assert_eq!(view.accel().bias().sigma(0), 21.0);
    assert!(view.sway().values().is_empty());
    assert_eq!(format!("{view:?}"), "LongCartView { .. }");
}
