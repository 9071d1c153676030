//! `sinscal new`: a cargo project around a filter of one's own, with every subcommand.

use std::path::{Path, PathBuf};

use clap::Args;
use gap::BaseFilter;
use miette::{Result, miette};
use runs::AnyFilter;
use sinscal::Law;

use crate::arguments;
use crate::compose::{Change, base_of};
use crate::output::{self, Files};
use crate::vocabulary::vocabulary;
use std::sync::Arc;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal new my-unit
  sinscal new my-unit --filter 36d-p --with accel-delay
  sinscal new my-unit --from findings/diagnosis.json";

/// Our own effect as a type.
const EFFECT: &str = "Spin";
/// The navigation, gyro and accelerometer errors that a filter begins with where it extends none.
const FIELDS: &str = "    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
    outer_lever: OuterLeverArm,
";

/// The files, what they are made of, and where they go.
const PROJECT: [(&str, &str); 7] = [
    ("Cargo.toml", include_str!("project/manifest.txt")),
    ("README.md", include_str!("project/readme.txt")),
    ("src/main.rs", include_str!("project/main.rs.txt")),
    ("src/lib.rs", include_str!("project/lib.rs.txt")),
    ("src/spin.rs", include_str!("project/spin.rs.txt")),
    ("tests/blocks.rs", include_str!("project/blocks.rs.txt")),
    ("benches/cycle.rs", include_str!("project/cycle.rs.txt")),
];

/// Write a cargo project around a filter of your own: the declaration, its tests, a benchmark, and a program with every subcommand
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The folder to make; its name becomes that of project and filter
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// The filter to extend; without, one that begins with navigation, gyro and accelerometer errors
    #[arg(long, value_name = "NAME", ignore_case = true, value_parser = arguments::filter(), conflicts_with = "from")]
    filter: Option<Arc<dyn AnyFilter>>,
    #[command(flatten)]
    change: Change,
    /// Extend the filter of a diagnosis by what that has found
    #[arg(long, value_name = "DIAGNOSIS.json")]
    from: Option<PathBuf>,
    /// The checkout of sinscal to build on; under `cargo run` the one it runs from, else the published version
    #[arg(long, value_name = "PATH")]
    sinscal: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let name = name(&self.folder)?;
        if self.folder.exists() {
            return Err(miette!("{}: is there already; name a folder that is not", self.folder.display()));
        }
        let filter = match (&self.filter, &self.from) {
            (Some(filter), _) => Some(self.change.of(filter)?),
            (None, Some(from)) => {
                let (base, found) = base_of(from)?;
                Some(self.change.beside(&base, found)?)
            }
            (None, None) => None,
        };
        let checkout = self.sinscal.as_deref().map(checkout).transpose()?.or_else(running_from);
        let values = values(&name, filter.as_deref(), checkout.as_deref())?;
        let mut files = Files::default();
        let laws = laws(filter.as_deref());
        let own = (!laws.is_empty()).then(|| laws_file(&laws));
        let templates = PROJECT.into_iter().chain(own.as_deref().map(|text| ("src/laws.rs", text)));
        for (path, template) in templates {
            let path = self.folder.join(path);
            let text = values.iter().fold(template.to_owned(), |text, (key, value)| text.replace(key, value));
            files.folder(path.parent().unwrap_or(&self.folder))?;
            files.write(&path, |file| file.write_all(text.as_bytes()))?;
        }
        // the versions that the checkout was tested with
        if let Some(lock) = checkout.map(|checkout| checkout.join("Cargo.lock")).filter(|lock| lock.is_file())
        {
            let content = std::fs::read(&lock).map_err(|error| miette!("{}: {error}", lock.display()))?;
            files.write(&self.folder.join("Cargo.lock"), |file| file.write_all(&content))?;
        }
        files.commit()?;
        output::print(&format!(
            "{}: a filter called {name}; next:\n  cd {}\n  cargo test\n  cargo run --release -- calibrate LOG --filter {name}\n",
            self.folder.display(),
            self.folder.display()
        ))
    }
}

/// The name of project and filter: that of the folder.
fn name(folder: &Path) -> Result<String> {
    let name = folder.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let begins = name.chars().next().is_some_and(|c| c.is_ascii_lowercase());
    if !begins || !name.chars().all(allowed) || name.ends_with('-') || name.contains("--") {
        return Err(miette!(
            "{}: the folder's name becomes that of the filter: lower-case letters, digits and hyphens, such as my-unit",
            folder.display()
        ));
    }
    if vocabulary().filter(name).is_ok() {
        return Err(miette!("{}: there is a filter called {name}; choose another name", folder.display()));
    }
    Ok(name.to_owned())
}

/// The laws that a filter has beside its declaration.
fn laws(filter: Option<&dyn AnyFilter>) -> Vec<Law> {
    let with = filter.map_or(Vec::new(), |filter| filter.with());
    with.into_iter().filter_map(Law::named).collect()
}

/// Their file.
fn laws_file(laws: &[Law]) -> String {
    let blocks: Vec<String> = laws.iter().map(gap::block).collect();
    format!(
        "//! Laws that a diagnosis proposed: how an error goes, and not why.\n\nuse sinscal::prelude::*;\n{}\n{}",
        gap::USED_BY_LAWS,
        blocks.join("\n")
    )
}

/// What stands for what in the templates.
fn values(
    name: &str,
    filter: Option<&dyn AnyFilter>,
    checkout: Option<&Path>,
) -> Result<[(&'static str, String); 11]> {
    let (fields, measures) = match filter {
        None => (FIELDS.to_owned(), "velocity, position".to_owned()),
        Some(filter) => {
            if !filter.without().is_empty() {
                return Err(miette!(
                    "--without: a declaration extends a filter; it cannot take blocks out of it"
                ));
            }
            let base = BaseFilter::of(filter);
            let fields = gap::fields(&base, &filter.with());
            (format!("    #[base]\n    base: {},\n{fields}", base.path), base.measures.join(", "))
        }
    };
    let laws = laws(filter);
    let types: Vec<String> = laws.iter().map(|law| gap::type_name(&law.name())).collect();
    let used = match &*types {
        [] => String::new(),
        [one] => format!("pub use laws::{one};\n"),
        several => format!("pub use laws::{{{}}};\n", several.join(", ")),
    };
    let tests = laws.iter().zip(&types).map(|(law, of_type)| test_of_law(law, of_type, name)).collect();
    let version = env!("CARGO_PKG_VERSION");
    let dependency = |folder: &str, features: &str| match checkout {
        Some(checkout) => {
            let path = checkout.join(folder);
            format!("{{ path = {:?}{features} }}", path.display().to_string().trim_end_matches('/'))
        }
        None => format!("{{ version = \"{version}\"{features} }}"),
    };
    Ok([
        ("@name@", name.to_owned()),
        ("@crate@", name.replace('-', "_")),
        ("@Filter@", gap::type_name(name)),
        ("@Effect@", EFFECT.to_owned()),
        ("@fields@", fields),
        ("@measures@", measures),
        ("@mod laws@", if types.is_empty() { "" } else { "mod laws;\n" }.to_owned()),
        ("@use laws@", used),
        ("@tests of laws@", tests),
        // with its checker for the tests: one build serves tests and program
        ("@sinscal@", dependency("", ", features = [\"check\"]")),
        ("@cli@", dependency("cli", "")),
    ])
}

/// A test that the block of a law does what the law does at run time.
fn test_of_law(law: &Law, of_type: &str, name: &str) -> String {
    let (crate_name, law) = (name.replace('-', "_"), law.name());
    let test = law.replace('-', "_");
    format!(
        r#"
#[test]
fn {test}_is_what_it_is_at_run_time() {{
    use sinscal::AnyEffect;
    let law = sinscal::Law::named("{law}").expect("a law").effect();
    for k in 1..=100 {{
        let wave = |i: i32| f64::from(k * (7 * i + 3)).sin();
        let vector = |i: i32| [wave(i), wave(i + 1), wave(i + 2)].into();
        let signals = Signals {{
            rate: vector(1),
            force: vector(4),
            temperature: vector(7),
            temperature_rate: vector(10),
            gyro_temperature: vector(13),
            gyro_temperature_rate: vector(16),
            dither: vector(19),
            time: 1e3 * wave(22),
            ..Signals::default()
        }};
        let error = |effect: &dyn AnyEffect| {{
            let mut error = [0.0; 6];
            effect.error(&signals, &[1.0, -2.0, 3.0], &mut error);
            error
        }};
        let compiled = error(<dyn AnyEffect>::of::<{crate_name}::{of_type}>());
        for (a, b) in compiled.into_iter().zip(error(law)) {{
            assert!((a - b).abs() <= 1e-12 * b.abs(), "{{a}} and {{b}}");
        }}
    }}
    println!("{{}}", check::block::<{crate_name}::{of_type}>().expect("a sound block"));
}}
"#
    )
}

/// A checkout that was named.
fn checkout(path: &Path) -> Result<PathBuf> {
    if !is_checkout(path) {
        return Err(miette!(
            "{}: is no checkout of sinscal: there is no cli/Cargo.toml of the package sinscal-cli in it",
            path.display()
        ));
    }
    path.canonicalize().map_err(|error| miette!("{}: {error}", path.display()))
}

fn is_checkout(path: &Path) -> bool {
    let manifest = std::fs::read_to_string(path.join("cli/Cargo.toml")).unwrap_or_default();
    manifest.lines().any(|line| line.trim() == "name = \"sinscal-cli\"")
}

/// The checkout that `cargo run` runs the program from.
fn running_from() -> Option<PathBuf> {
    let manifest = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR")?);
    manifest.ancestors().take(2).find(|folder| is_checkout(folder)).map(Path::to_owned)
}
