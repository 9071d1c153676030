//! The next run that would decide.

use gap::menu::Menu;
use runs::Vocabulary;

#[test]
fn changing_dither_parts_the_size_effect_from_the_bias() {
    let menu = menu("39d-p").unwrap().propose("dither-size-effect", "accel-bias");
    assert!(menu[0].run.contains("dither amplitude"), "{menu:?}");
    assert!(menu[0].shows > 3.0 && menu[1].shows < 1.0, "{menu:?}");
}

#[test]
#[ignore = "seven simulated runs: run with --release -- --ignored"]
fn several_rates_part_the_nonlinearity_from_the_scale_factor() {
    let menu = menu("36d-p").unwrap().propose("gyro-rate-nonlinearity", "gyro-scale");
    let shows = |run: &str| menu.iter().find(|p| p.run.contains(run)).map_or(0.0, |p| p.shows);
    assert!(shows("5, 20 and 60 deg/s") > 3.0 * shows("eighteen rotations at 10 deg/s"), "{menu:?}");
}

fn menu(filter: &str) -> Result<Menu, gap::menu::ProposalError> {
    let vocabulary = Vocabulary::standard();
    Menu::new(&*vocabulary.filter(filter).expect("a filter of the library"), vocabulary.effects())
}
