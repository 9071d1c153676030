//! Writes the filter that has the missing effects.

use core::fmt::Write as _;

use runs::AnyFilter;
use sinscal::{InnerLeverArm, Kind, Law};

/// What must be known of the filter that is extended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BaseFilter {
    /// Name on the command line, for instance `36d-p`.
    pub name: String,
    /// Path of its type, for instance `sinscal::Sins36P`.
    pub path: String,
    /// Names of what it measures.
    pub measures: Vec<String>,
    /// Whether it has inner lever arms, through which the dither couples without further states.
    pub has_inner_lever_arm: bool,
}

impl BaseFilter {
    /// What must be known of `filter`.
    pub fn of(filter: &dyn AnyFilter) -> Self {
        let path = filter.path();
        // the types of the library are re-exported at its root
        let own = path.rsplit("::").next().unwrap_or(path);
        let path = if path.starts_with("sinscal::") { format!("sinscal::{own}") } else { path.into() };
        Self {
            name: filter.name().into(),
            path,
            measures: filter.measures().into_iter().map(Into::into).collect(),
            has_inner_lever_arm: filter.blocks().iter().any(|leaf| leaf.is::<InnerLeverArm>()),
        }
    }
}

/// A name as a type: `accel-delay` as `AccelDelay`.
pub fn type_name(effect: &str) -> String {
    effect
        .split('-')
        .map(|word| {
            let mut letters = word.chars();
            letters
                .next()
                .map_or(String::new(), |first| first.to_ascii_uppercase().to_string() + letters.as_str())
        })
        .collect()
}

/// Fields of a declaration that extends `base` by `effects`, a line each.
///
/// `dither-size-effect` becomes the block `Dither`, which needs no states, where inner lever arms are declared.
pub fn fields(base: &BaseFilter, effects: &[&str]) -> String {
    let with_inner = base.has_inner_lever_arm || effects.contains(&"inner-lever-arm");
    let mut fields = String::new();
    for effect in effects {
        let block = if *effect == "dither-size-effect" && with_inner { "dither" } else { effect };
        fields += &format!("    {}: {},\n", block.replace('-', "_"), type_name(block));
    }
    fields
}

/// Rust source of a law as a block, for a file that uses the prelude and [`USED_BY_LAWS`].
pub fn block(law: &Law) -> String {
    let effect = law.effect().info();
    let (name, equation) = (effect.name(), effect.equation());
    let (kind, first) = if law.kind() == Kind::Rate { ("Rate", "RATE") } else { ("Force", "FORCE") };
    let of_type = type_name(name);
    let kin = effect.kin().map_or(String::new(), |kin| format!("\n        .akin_to({kin:?})"));
    format!(
        r#"/// `{equation}`: how an error goes, and not why.
#[derive(Debug)]
pub struct {of_type};

impl Effect for {of_type} {{
    const EFFECT: EffectInfo = EffectInfo::new({name:?}, sinscal::Kind::{kind}, &["x", "y", "z"], {unit:?}, {prior:?})
        .model({equation:?}, {description:?})
        .sheet({sheet:?}, {scale:?}){kin};
}}

impl Block for {of_type} {{
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = {name:?};
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {{
        Self::EFFECT.states(visit);
    }}

    fn input_jacobian<T: Real>(signals: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {{
        for i in 0..3 {{
            put(sinscal::{first} + i, i, {code});
        }}
    }}
}}
"#,
        unit = effect.unit(),
        prior = effect.prior_sigma,
        description = effect.description(),
        sheet = effect.sheet_unit,
        scale = effect.sheet_scale,
        code = law.code(),
    )
}

/// Rust source that declares `base` with `effects` added, with [`fields`], and every [`block`] of a law among them.
pub fn declaration(base: &BaseFilter, effects: &[&str]) -> String {
    let own = base.path.rsplit("::").next().unwrap_or(&base.path);
    let fields = fields(base, effects);
    let mut name = base.name.clone();
    let mut of_type = own.to_string();
    for effect in effects {
        name += &format!("-{effect}");
        of_type += &type_name(effect);
    }
    let laws: Vec<Law> = effects.iter().filter_map(|effect| Law::named(effect)).collect();
    let used = if laws.is_empty() { "" } else { USED_BY_LAWS };
    let source = format!(
        "use sinscal::prelude::*;\n{used}\n/// {} with {}.\n#[derive(Debug, StateBlocks)]\n#[filter(name = \"{name}\", \
         measures({}))]\npub struct {of_type} {{\n    #[base]\n    base: {},\n{fields}}}\n",
        base.name,
        effects.join(", "),
        base.measures.join(", "),
        base.path,
    );
    laws.iter().fold(source, |mut source, law| {
        // Writing to a string does not fail.
        let _ = write!(source, "\n{}", block(law));
        source
    })
}

/// What the source of a law needs beside the prelude.
pub const USED_BY_LAWS: &str = "use sinscal::{Effect, EffectInfo, Signals};\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_written_as_a_block_of_its_equation() {
        let law = Law::named("accel-bias-by-temperature-times-force-j-squared").unwrap();
        let source = block(&law);
        let product =
            "put(sinscal::FORCE + i, i, signals.temperature[i] * signals.force[(i + 1) % 3].powi(2));";
        for part in ["pub struct AccelBiasByTemperatureTimesForceJSquared;", product, "sinscal::Kind::Force"]
        {
            assert!(source.contains(part), "{part}\n{source}");
        }
    }

    #[test]
    fn dither_couples_through_inner_lever_arms() {
        let base = BaseFilter {
            name: "43d-p".into(),
            path: "sinscal::Sins43P".into(),
            measures: vec!["velocity".into(), "position".into()],
            has_inner_lever_arm: true,
        };
        let source = declaration(&base, &["dither-size-effect"]);
        assert_eq!(
            source,
            "use sinscal::prelude::*;\n\n/// 43d-p with dither-size-effect.\n#[derive(Debug, StateBlocks)]\n\
             #[filter(name = \"43d-p-dither-size-effect\", measures(velocity, position))]\n\
             pub struct Sins43PDitherSizeEffect {\n    #[base]\n    base: sinscal::Sins43P,\n    dither: Dither,\n}\n"
        );
        assert_eq!(type_name("gyro-g-sensitivity"), "GyroGSensitivity");
    }
}
