//! Whoever adds a block to the vocabulary is told here what it still lacks.
//!
//! `tests/effects_jacobians` goes through the same catalogue with finite differences of an independent model and with NaN in
//! every input that a block's table does not list; it fails by itself for a block without such a model.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use sinscal::EFFECTS;

/// Blocks that are no effects: the navigation errors that every filter begins with, the dither, which has no states of its
/// own, and the room for others; and what blocks are made with.
const OTHERS: [&str; 8] = ["attitude", "velocity", "position", "dither", "open", "groups", "effect", "mod"];
/// Tables of the dynamics, not of a block.
const DYNAMICS: &str = "strapdown-";

fn stems(folder: &str, ending: &str) -> BTreeSet<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.replace('_', "-")))
        .collect()
}

fn catalogue() -> BTreeSet<String> {
    EFFECTS.iter().map(|effect| effect.name().to_owned()).collect()
}

#[test]
fn every_block_is_in_the_catalogue_with_its_table_and_its_derivation() {
    let blocks: BTreeSet<String> =
        stems("models/blocks", "rs").into_iter().filter(|name| !OTHERS.contains(&name.as_str())).collect();
    assert_eq!(blocks, catalogue(), "blocks and the catalogue in models/effects/catalogue.rs");
    let tables: BTreeSet<String> =
        stems("models/tables", "toml").into_iter().filter(|name| !name.starts_with(DYNAMICS)).collect();
    assert_eq!(tables, catalogue(), "tables and the catalogue");
    let derived = stems("models/derivation/effects", "py");
    let missing: Vec<_> = catalogue().into_iter().filter(|name| !derived.contains(name)).collect();
    assert!(missing.is_empty(), "without a derivation: {missing:?}");
}

#[test]
fn every_effect_is_documented_and_has_units_that_people_may_write() {
    for effect in EFFECTS {
        let name = effect.name();
        for (what, text) in [
            ("description", effect.description()),
            ("equation", effect.equation()),
            ("source", effect.source()),
            ("unit", effect.unit()),
        ] {
            assert!(!text.trim().is_empty(), "{name}: its {what} is empty");
        }
        assert!(effect.equation().contains('='), "{name}: `{}` is no equation", effect.equation());
        let units = logs::units::of_parameters(effect.unit());
        let size = logs::units::scale(units, effect.sheet_unit).expect(name);
        assert!((size / effect.sheet_scale - 1.0).abs() < 1e-12, "{name}: {} is {size}", effect.sheet_unit);
        assert_eq!(logs::units::scale(units, effect.unit()), Ok(1.0), "{name}");
    }
}

/// The doc comment of a block gives its equation, its sign and where its prior comes from.
#[test]
fn every_block_says_its_equation_sign_and_prior() {
    for name in catalogue() {
        let path = format!("models/blocks/{}.rs", name.replace('-', "_"));
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(&path)).expect(&path);
        for part in ["Equation", "Sign", "Prior"] {
            assert!(text.contains(&format!("/// - {part}: ")), "{path} does not say its {part}");
        }
    }
}
